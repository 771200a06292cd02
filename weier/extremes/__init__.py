"""Stability at the extremes: every method where digits are lost, examined load by load, as a table and a figure."""

from weier.extremes.cases import Extreme, extremes
from weier.extremes.examine import Examined, Outcome, examine
from weier.extremes.measure import measure
from weier.extremes.report import failures, write_table
from weier.verdict import Verdict

__all__ = ["Examined", "Extreme", "Outcome", "Verdict", "examine", "extremes", "failures", "measure", "write_table"]
