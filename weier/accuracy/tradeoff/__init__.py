"""Speed against accuracy: every method and setting on the profiles of a scene, against the contact patches."""

from weier.accuracy.tradeoff.contenders import REFERENCE, contenders
from weier.accuracy.tradeoff.measure import measure
from weier.accuracy.tradeoff.report import write_table

__all__ = ["REFERENCE", "contenders", "measure", "write_table"]
