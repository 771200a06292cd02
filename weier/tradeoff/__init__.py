"""Speed against accuracy: every method and setting on the profiles of a scene, against the contact patches."""

from weier.tradeoff.contenders import REFERENCE, contenders
from weier.tradeoff.measure import measure
from weier.tradeoff.report import write_table

__all__ = ["REFERENCE", "contenders", "measure", "write_table"]
