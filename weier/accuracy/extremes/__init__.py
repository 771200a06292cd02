"""Stability at the extremes: every method where digits are lost, examined load by load, as a table and a figure."""

from weier.accuracy.extremes.cases import Extreme, extremes
from weier.accuracy.extremes.examine import Examined, Outcome, examine
from weier.accuracy.extremes.measure import measure
from weier.accuracy.extremes.report import failures, write_table
from weier.data.check import Verdict

__all__ = ["Examined", "Extreme", "Outcome", "Verdict", "examine", "extremes", "failures", "measure", "write_table"]
