"""Boundary elements (Section 5.1): equal elements, piecewise linear pressure, periodic.

docs/bem.md derives the formulas; each module names its sections. `grids` nests grids, `active_set` (preconditioned by
`edges`) solves on them, `staircase` corrects the edges, `solver` and `error_model` return the curve with its
bounds.
"""

from weier.methods.bem.method import METHOD, grid, points_of, within_few_points
from weier.methods.bem.solver import POINTS_PER_WAVE, checked_points, curve

__all__ = [
    "METHOD",
    "POINTS_PER_WAVE",
    "checked_points",
    "curve",
    "grid",
    "points_of",
    "within_few_points",
]
