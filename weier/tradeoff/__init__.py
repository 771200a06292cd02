"""Speed against accuracy: every method and setting on the profiles of a scene, against the contact patches."""

from weier.tradeoff.contenders import REFERENCE, Contender, contenders
from weier.tradeoff.measure import measure
from weier.tradeoff.report import write_table

__all__ = ["REFERENCE", "Contender", "contenders", "measure", "write_table"]
