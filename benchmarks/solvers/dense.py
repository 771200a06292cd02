"""The paper's solver as one would write it in NumPy: a dense matrix, an active set, inversion (Section 5.1)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import circulant

from benchmarks.problem import Problem, Step
from weier.halfplane import influence_coefficients

Array = NDArray[np.float64]

ROUNDS = 100  # 2-8 are usual


class Inversion(NamedTuple):
    """Heights and the matrix of influence, shape (points, points)."""

    height: Array
    influence: Array

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """Solve on the contact, drop what pulls, add what penetrates, until nothing changes."""
        points = self.height.size
        stiffness = 1 / self.influence[0, 0]
        contact = np.ones(points, bool) if start is None else start > 0
        rounds, changed = 0, True
        while changed and rounds < ROUNDS:
            nodes = np.flatnonzero(contact)
            border = np.ones((nodes.size, 1))
            matrix = np.block([[self.influence[np.ix_(nodes, nodes)], border], [border.T / points, np.zeros((1, 1))]])
            solution = np.linalg.solve(matrix, np.append(self.height[nodes], load))
            pressure = np.zeros(points)
            pressure[nodes] = solution[:-1]
            gap = solution[-1] - self.height + self.influence[:, nodes] @ pressure[nodes]
            wrong = np.where(contact, pressure < -tolerance * stiffness, gap < -tolerance)
            contact ^= wrong
            rounds, changed = rounds + 1, bool(wrong.any())
        return Step(np.maximum(pressure, 0.0), rounds, not changed)


def begin(problem: Problem) -> Inversion:
    """Fill the matrix."""
    return Inversion(problem.height, circulant(influence_coefficients(problem.points, problem.profile.period)))
