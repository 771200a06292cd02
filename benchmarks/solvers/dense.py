"""The paper's solver: a dense matrix, an active set, inversion (Section 5.1), load by load to see the pressure.

It solves the equations of docs/bem.md, "The discrete problem": A p + d = z on the active set with the mean gap d and
the load balance (Johnson 1985, Section 5.9). With z = 0 and unit load the same matrix gives the tangent pressure and
-R.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import circulant

from benchmarks.problem import Problem, Step
from weier.kernels.arrays import Array, Flags
from weier.theory.halfplane import influence_coefficients

MAX_ROUNDS = 100  # limit on corrections of the active set; 2 to 8 are usual


class ActiveSet(NamedTuple):
    """The solution at one load, and whether the active set has converged.

    plane : height of the rigid plane above the mean plane, in g_0
    resistance : minus its derivative with respect to the mean pressure at fixed contact, in g_0/p_0*
    pressure : nodal pressure without tension, shape (N,), in p_0*
    tangent_pressure : its derivative with respect to the mean pressure, shape (N,)
    contact : whether a node is in contact, shape (N,)
    rounds : dense solutions so far
    converged : whether the last one left the active set unchanged
    """

    plane: float
    resistance: float
    pressure: Array
    tangent_pressure: Array
    contact: Flags
    rounds: int
    converged: bool


class Inversion(NamedTuple):
    """Heights and the matrix of influence, shape (points, points)."""

    height: Array
    influence: Array

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """Solve from the nodes that carry load in `start`."""
        contact = np.ones(self.height.size, bool) if start is None else start > 0
        found = solve_load(self.influence, self.height, contact, load, tolerance)
        return Step(found.pressure, found.rounds, found.converged)


def begin(problem: Problem) -> Inversion:
    """Return the solver with its matrix."""
    return Inversion(problem.height, circulant(influence_coefficients(problem.points, problem.profile.period)))


def solve_load(matrix: Array, height: Array, contact: Flags, load: float, max_residual: float) -> ActiveSet:
    """Drop nodes in tension and add penetrating ones, until there are none or after MAX_ROUNDS.

    `matrix`, shape (N, N), gives displacements per nodal pressure; `contact` is the initial active set.
    """
    rounds, converged = 0, False
    while not converged and rounds < MAX_ROUNDS:
        nodes = contact if contact.any() else height == height.max()  # at least one node carries the load
        plane, resistance, pressure, tangent_pressure = _on_contact(matrix, nodes, height, load)
        gap = plane - height + matrix @ pressure
        tensile = nodes & (pressure < -max_residual / matrix[0, 0])
        penetrating = ~nodes & (gap < -max_residual)
        contact = nodes & ~tensile | penetrating
        rounds, converged = rounds + 1, np.array_equal(contact, nodes)
    return ActiveSet(plane, resistance, np.maximum(pressure, 0.0), tangent_pressure, nodes, rounds, converged)


def _on_contact(matrix: Array, contact: Flags, height: Array, load: float) -> tuple[float, float, Array, Array]:
    """Return plane, resistance, pressure and tangent pressure for a given contact, with tension allowed."""
    nodes = np.flatnonzero(contact)
    n, points = nodes.size, contact.size
    system, right = np.ones((n + 1, n + 1)), np.zeros((n + 1, 2))
    system[:n, :n], system[n, :n], system[n, n] = matrix[np.ix_(nodes, nodes)], 1 / points, 0.0
    right[:n, 0], right[n] = height[nodes], (load, 1.0)
    solution, pressure = np.linalg.solve(system, right), np.zeros((2, points))
    pressure[:, nodes] = solution[:n].T
    return solution[n, 0], -solution[n, 1], pressure[0], pressure[1]
