"""tamaas: the projected conjugate gradients of Polonsky and Keer on a one-dimensional half-plane."""

from __future__ import annotations

import math
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.problem import Problem, Step
from weier.kernels.arrays import Array

ITERATIONS = 20_000  # More than any load needs, so that only the tolerance ends the iteration.


class PolonskyKeer:
    """A model and its solver; `count`, if any, counts the gradients."""

    def __init__(self, problem: Problem, count: Any = None) -> None:
        package: Any = import_module("tamaas")
        package.set_log_level(package.LogLevel.error)
        self.model = package.Model(package.model_type.basic_1d, [float(problem.profile.period)], [problem.points])
        self.model.nu = 0.0
        self.model.E = 1 / math.pi  # u_k = p_k/(pi E* k): heights in g_0, pressure in p_0*
        self.solver = package.PolonskyKeerRey(self.model, problem.height, problem.tolerance)
        self.solver.max_iter = ITERATIONS
        self.failure = package.FloatingPointError
        self.count = count
        if count:
            self.solver.addFunctionalTerm(count)

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """Solve from a given pressure or, if this fails (few nodes in contact), from uniform pressure."""
        self.solver.tolerance = tolerance
        before = self.count.gradients if self.count else math.nan
        converged = False
        for pressure in (load if start is None else start, load):
            self.model.traction[...] = pressure
            try:
                converged = self.solver.solve(load) <= tolerance
            except self.failure:
                continue
            break
        # An iteration takes one pair of FFTs for the gradient and one for the length of the step.
        work = 2.0 * (self.count.gradients - before) if self.count else math.nan
        return Step(np.array(self.model.traction), work, converged)


def begin(problem: Problem) -> PolonskyKeer:
    """Return a solver with its FFT plans."""
    return PolonskyKeer(problem)


def begin_counted(problem: Problem) -> PolonskyKeer:
    """Return a solver that counts gradients by an additional energy term of value 0, which calls Python."""

    class Count(import_module("tamaas").Functional):
        gradients = 0

        def computeF(self, pressure: Array, gap: Array) -> float:
            return 0.0

        def computeGradF(self, pressure: Array, gap: Array) -> None:
            self.gradients += 1

    return PolonskyKeer(problem, Count())
