"""weier's fast boundary elements: whole curves as users call them, and single loads whose pressure is examined."""

from __future__ import annotations

from typing import NamedTuple

from benchmarks.problem import Problem, Step
from weier.kernels.arrays import Array
from weier.methods.bem import active_set
from weier.methods.bem import curve as solve_curve
from weier.methods.bem.staircase import in_continuum


class NestedGrids(NamedTuple):
    """The nested grids of a problem, and whether the staircase is removed from their solutions."""

    grids: active_set.NestedSolver
    total_amplitude: float
    is_staircase_removed: bool

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """Solve by the method's own start and tolerance, which make the other two arguments superfluous."""
        found = self.grids.solve_discrete(load, with_tangent=self.is_staircase_removed)
        plane = in_continuum(found)[0] if self.is_staircase_removed else found.plane
        converged = found.residual <= self.grids.grid.max_residual
        return Step(found.pressure, found.work, converged, self.total_amplitude - plane)


def begin(problem: Problem) -> NestedGrids:
    """Make the grids for the paper's scheme, whose edges of contact move from node to node."""
    return _begin(problem, is_staircase_removed=False)


def begin_default(problem: Problem) -> NestedGrids:
    """Make the grids for the default: with resistance and without staircase."""
    return _begin(problem, is_staircase_removed=True)


def _begin(problem: Problem, is_staircase_removed: bool) -> NestedGrids:
    grids = active_set.NestedSolver(problem.profile, problem.points, problem.tolerance)
    return NestedGrids(grids, problem.profile.total_amplitude, is_staircase_removed)


def curve(problem: Problem) -> object:
    """Solve for the whole compliance curve by the paper's scheme."""
    grids = begin(problem).grids
    return [grids.solve_discrete(load, with_tangent=False).plane for load in problem.loads]


def curve_default(problem: Problem) -> object:
    """Solve for the whole curve as by default: compliance and resistance with their bounds."""
    return solve_curve(problem.profile, problem.loads, points=problem.points, max_residual=problem.tolerance)
