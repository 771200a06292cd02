"""Stability at the extremes: every method where digits are lost, examined load by load, as tables and a figure."""

from weier.accuracy.extremes.cases import extremes
from weier.accuracy.extremes.measurement import measure
from weier.accuracy.extremes.report import failures, write_summary

__all__ = ["extremes", "failures", "measure", "write_summary"]
