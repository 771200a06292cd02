"""Boundary elements (Section 5.1): equal elements, piecewise linear pressure, periodic.

docs/bem.md derives the formulas; each module names its sections. `grids` nests grids, `active_set` (preconditioned by
`edges`) solves on them, `staircase` corrects the edges, `loading_curve` and `stated_errors` return the curve with its
bounds.
"""

from weier.methods.bem.boundary_elements import METHOD, grid, points_of, within_few_points
from weier.methods.bem.loading_curve import POINTS_PER_WAVE, checked_points, curve

__all__ = [
    "METHOD",
    "POINTS_PER_WAVE",
    "checked_points",
    "curve",
    "grid",
    "points_of",
    "within_few_points",
]
