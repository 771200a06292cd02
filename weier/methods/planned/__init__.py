"""Curves within a tolerance: the cheapest methods, load by load, that their error models allow.

How they are chosen is in docs/planned.md; each module names the sections that it rests on.
"""

from weier.methods.planned.method import planning_method

__all__ = ["planning_method"]
