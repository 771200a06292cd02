"""Speed against accuracy: every method and setting on the profiles of a scene, against the exact contact."""

from weier.accuracy.tradeoff.measurement import measure, variants
from weier.accuracy.tradeoff.report import write_table

__all__ = ["measure", "variants", "write_table"]
