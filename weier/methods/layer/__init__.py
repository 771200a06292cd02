"""The non-linear layer model (4.3): one wave at a time, on a half-plane through a layer of all finer waves."""

from weier.methods.layer.curve import Curve, compliance, curve, resistance, tail_table
from weier.methods.layer.method import METHOD

__all__ = ["METHOD", "Curve", "compliance", "curve", "resistance", "tail_table"]
