"""Boundary elements (Section 5.1): equal elements, piecewise linear pressure, periodic.

docs/bem.md derives the formulas; each module names its sections. `grids` nests grids, `active_set` (preconditioned by
`edges`) solves on them, `staircase` corrects the edges, `boundary_elements` and `stated_errors` return the curve with
its bounds.
"""

from weier.methods.bem.boundary_elements import (
    METHOD,
    POINTS_PER_WAVE,
    curve,
    points_of,
    within_few_points,
)

__all__ = ["METHOD", "POINTS_PER_WAVE", "curve", "points_of", "within_few_points"]
