"""Curves within a tolerance: the cheapest methods, load by load, that their error models allow."""

from weier.methods.planned.method import planning_method

__all__ = ["planning_method"]
