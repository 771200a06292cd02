"""The non-linear layer model (4.3): one wave at a time, on a half-plane through a layer of all finer waves."""

from weier.layer.curve import Curve, compliance, curve, resistance, tail_table

__all__ = ["Curve", "compliance", "curve", "resistance", "tail_table"]
