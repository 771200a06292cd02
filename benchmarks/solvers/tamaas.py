"""tamaas: the projected conjugate gradients of Polonsky and Keer on a one-dimensional half-plane."""

from __future__ import annotations

import math
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.problem import Problem, Step

Array = NDArray[np.float64]

ITERATIONS = 20_000


class PolonskyKeer:
    """A model and its solver; the pressure in the model is where the next load starts."""

    def __init__(self, problem: Problem) -> None:
        self.package: Any = import_module("tamaas")
        self.package.set_log_level(self.package.LogLevel.error)
        self.model = self.package.Model(
            self.package.model_type.basic_1d, [float(problem.profile.period)], [problem.points]
        )
        self.model.nu = 0.0
        self.model.E = 1 / math.pi  # u_k = p_k/(pi E* k): heights in g_0, pressure in p_0*
        self.height = problem.height

    def solver(self, tolerance: float) -> Any:
        """Its solver for the pressure at this relative complementarity error."""
        solver = self.package.PolonskyKeerRey(self.model, self.height, tolerance)
        solver.max_iter = ITERATIONS
        return solver

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """From the pressure given; from uniform pressure where that fails, as it does with few nodes in contact."""
        solver = self.solver(tolerance)
        for pressure in (load if start is None else start, load):
            self.model.traction[...] = pressure
            try:
                error = solver.solve(load)
            except self.package.FloatingPointError:
                continue
            return Step(np.array(self.model.traction), math.nan, error <= tolerance)
        return Step(np.full(self.height.size, load), math.nan, False)


class CountedPolonskyKeer(PolonskyKeer):
    """The same, which counts gradients: each iteration takes one pair of FFTs for it and one for its step."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)

        class Count(self.package.Functional):  # type: ignore[misc, name-defined]
            gradients = 0

            def computeF(self, pressure: Array, gap: Array) -> float:
                return 0.0

            def computeGradF(self, pressure: Array, gap: Array) -> None:
                self.gradients += 1

        self.count = Count()

    def solver(self, tolerance: float) -> Any:
        """Its solver with the counter as one more term of the energy, always 0."""
        solver = super().solver(tolerance)
        solver.addFunctionalTerm(self.count)
        return solver

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """The same pressure, and the pairs of FFTs."""
        self.count.gradients = 0
        step = super().solve(load, start, tolerance)
        return step._replace(work=2.0 * self.count.gradients)


def begin(problem: Problem) -> PolonskyKeer:
    """A model with its FFT plans."""
    return PolonskyKeer(problem)
