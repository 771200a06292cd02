"""The non-linear layer model (4.3): one wave at a time, on a half-plane through a layer of all finer waves.

The formulas are derived in docs/layer.md; each module names the sections that it rests on.
"""

from weier.methods.layer.method import METHOD
from weier.methods.layer.solver import POINTS, LayerCurve, compliance, curve, resistance, tail_closure

__all__ = ["METHOD", "POINTS", "LayerCurve", "compliance", "curve", "resistance", "tail_closure"]
