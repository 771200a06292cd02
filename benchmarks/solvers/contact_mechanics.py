"""ContactMechanics: the constrained conjugate gradients of Polonsky and Keer on a periodic line scan."""

from __future__ import annotations

import math
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.problem import Problem, Step
from weier.kernels.arrays import Array

ITERATIONS = 20_000  # More than any load needs, so that only the tolerance ends the iteration.


class Silent:
    """A silent logger: the logger of ContactMechanics walks the call stack, which takes some 50 ms per load."""

    def pr(self, *text: Any) -> None:
        """Do nothing."""

    def st(self, *values: Any, **options: Any) -> None:
        """Do nothing."""


class ConstrainedGradients:
    """A substrate, a line scan and the solver; each load starts from the forces of the previous one."""

    def __init__(self, problem: Problem) -> None:
        package = import_module("ContactMechanics")
        period = float(problem.profile.period)
        # u_k = p_k/(pi E* k): heights in g_0, pressure in p_0*; forces are pressure times the length of a cell.
        self.substrate = package.PeriodicFFTElasticHalfSpace((problem.points,), 1 / math.pi, (period,))
        line_scan = import_module("SurfaceTopography").UniformLineScan
        self.scan = line_scan(problem.height, period, periodic=True)
        self.gradients = import_module("ContactMechanics.Optimization").constrained_conjugate_gradients
        self.cell = period / problem.points

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """Solve from given forces; the penetration alone is checked, since the total force is prescribed."""
        result = self.gradients(
            self.substrate,
            self.scan,
            external_force=load * self.cell * self.scan.nb_grid_pts[0],
            initial_forces=None if start is None else -start * self.cell,
            pentol=tolerance,
            forcetol=math.inf,
            thermotol=math.inf,
            maxiter=ITERATIONS,
            logger=Silent(),
        )
        return Step(np.array(result.jac) / self.cell, float(result.nfev), bool(result.success))


def begin(problem: Problem) -> ConstrainedGradients:
    """Return a solver with its FFT plans."""
    return ConstrainedGradients(problem)
