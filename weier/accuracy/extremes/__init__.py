"""Stability at the extremes: all methods at the limits of floats, load by load, as tables and a figure."""

from weier.accuracy.extremes.extremes_page import failures, main, parts
from weier.accuracy.extremes.ill_conditioned import extremes
from weier.accuracy.extremes.measurement import measure

__all__ = ["extremes", "failures", "main", "measure", "parts"]
