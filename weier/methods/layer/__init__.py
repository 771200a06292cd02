"""The non-linear layer model (4.3): each wave bears on the half-plane through a layer of all finer waves.

docs/layer.md derives the formulas; each module names its sections.
"""

from weier.methods.layer.method import METHOD
from weier.methods.layer.solver import POINTS, curve, tail_closure

__all__ = ["METHOD", "POINTS", "curve", "tail_closure"]
