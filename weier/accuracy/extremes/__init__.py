"""Stability at the extremes: all methods at the limits of floats, load by load, as tables and a figure."""

from weier.accuracy.extremes.cases import extremes
from weier.accuracy.extremes.measurement import measure
from weier.accuracy.extremes.report import failures, main, parts

__all__ = ["extremes", "failures", "main", "measure", "parts"]
