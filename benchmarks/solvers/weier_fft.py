"""weier's fast boundary elements: `curve` as a user calls it, and load by load to see the pressure."""

from __future__ import annotations

from typing import NamedTuple

from benchmarks.problem import Problem, Step
from weier.kernels.arrays import Array
from weier.methods.bem import active_set
from weier.methods.bem import curve as solve_curve


class Descent(NamedTuple):
    """The grids, and whether they are to find the resistance."""

    grids: active_set.NestedSolver
    with_resistance: bool

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """The grids keep their own start and tolerance."""
        self.grids.solve(load)
        pressure = self.grids.state.pressure.copy()
        if self.with_resistance:
            self.grids.solve_rate()
        return Step(pressure, self.grids.work, self.grids.residual <= self.grids.grid.max_residual)


def begin(problem: Problem, with_resistance: bool = False) -> Descent:
    """Grids and arrays."""
    return Descent(active_set.NestedSolver(problem.profile, problem.points, problem.tolerance), with_resistance)


def begin_with_resistance(problem: Problem) -> Descent:
    """A solver for the heights and, beside these, for the resistance."""
    return begin(problem, with_resistance=True)


def curve(problem: Problem, resistance: bool = False) -> object:
    """The whole curve in one call."""
    return solve_curve(
        problem.profile, problem.loads, points=problem.points, tolerance=problem.tolerance, resistance=resistance,
        edges="nodes",
    )  # fmt: skip


def curve_with_resistance(problem: Problem) -> object:
    """The whole curve and its derivative."""
    return curve(problem, resistance=True)
