"""Boundary elements (Section 5.1): N equal elements, linear pressure, periodic images, mean pressure removed.

The formulas are derived in docs/bem.md; each module names the sections that it rests on. From the heights of a
profile follow nested grids (`grids`), on these pressure and tangent pressure at the nodes (`active_set`, with `edges`
for its preconditioner, or the paper's own `direct`), from both the edges between nodes (`staircase`), and at last the
curve and the bounds on its errors (`solver`, `error_model`). `fields` has the nodal values themselves, and `method`
is how the rest of the package chooses and calls all this.
"""

from weier.methods.bem.fields import Field, field
from weier.methods.bem.method import METHOD, points_of, within_few_points
from weier.methods.bem.solver import POINTS_PER_WAVE, SOLVERS, BemCurve, checked_points, curve

__all__ = [
    "METHOD",
    "POINTS_PER_WAVE",
    "SOLVERS",
    "BemCurve",
    "Field",
    "checked_points",
    "curve",
    "field",
    "points_of",
    "within_few_points",
]
