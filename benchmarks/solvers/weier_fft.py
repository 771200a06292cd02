"""weier's fast boundary elements: `curve` as a user calls it, and load by load to see the pressure."""

from __future__ import annotations

from typing import NamedTuple

from benchmarks.problem import Problem, Step
from weier.kernels.arrays import Array
from weier.methods.bem import curve as solve_curve
from weier.methods.bem import fft
from weier.methods.bem.grids import Hierarchy, full_contact, grid_of, nested_grids


class Descent(NamedTuple):
    """The grids, the coarsest one's pressure, and the working arrays."""

    hierarchy: Hierarchy
    coarse: Array
    state: fft.State
    with_resistance: bool

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """The grids keep their own start and tolerance."""
        _, residual, pairs = fft.cascade(load, self.hierarchy, self.coarse, self.state)
        pressure = self.state.pressure.copy()
        if self.with_resistance:
            finest = grid_of(self.hierarchy, self.hierarchy.points.size - 1)
            pairs += fft.solve_rate(fft.RATE_TOLERANCE, finest, self.state)[1]
        return Step(pressure, pairs, residual <= self.hierarchy.max_residual[-1])


def begin(problem: Problem, with_resistance: bool = False) -> Descent:
    """Grids and arrays."""
    hierarchy = nested_grids(problem.profile, problem.points, problem.tolerance)
    start = full_contact(hierarchy, float(problem.loads[-1]))
    return Descent(hierarchy, start, fft.make_grid_state(problem.points), with_resistance)


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
