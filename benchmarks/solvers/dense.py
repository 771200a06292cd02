"""The paper's solver: a dense matrix, an active set, inversion (Section 5.1), load by load to see the pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import circulant

from benchmarks.problem import Problem, Step
from weier.kernels.arrays import Array
from weier.methods.bem import direct
from weier.theory.halfplane import influence_coefficients


class Inversion(NamedTuple):
    """Heights and the matrix of influence, shape (points, points)."""

    height: Array
    influence: Array

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """Solve from the nodes that carry load in `start`."""
        contact = np.ones(self.height.size, bool) if start is None else start > 0
        found = direct.solve_load(self.influence, self.height, contact, load, tolerance)
        return Step(found.pressure, found.rounds, found.converged)


def begin(problem: Problem) -> Inversion:
    """Fill the matrix."""
    return Inversion(problem.height, circulant(influence_coefficients(problem.points, problem.profile.period)))
