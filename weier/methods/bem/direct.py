"""The paper's solver: dense influence matrix and active set by inversion (Johnson 1985, Section 5.9).

It solves the equations of docs/bem.md, "The discrete problem": A p + d = z on the active set with the mean gap d and
the load balance. With z = 0 and unit load the same matrix gives the tangent pressure and -R.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each

from weier.kernels.arrays import Array, Flags
from weier.kernels.blas import one_thread
from weier.methods.bem.staircase import NodalSolution
from weier.surface.waves import Waves
from weier.theory.halfplane import influence_coefficients

MAX_ROUNDS = 100  # corrections of the active set; 2 to 8 are usual


class ActiveSet(NamedTuple):
    """One load: the last solution, on the nodes in contact, and whether another round would change them.

    plane : height of the rigid plane above the mean plane, in g_0
    resistance : minus its derivative with respect to the mean pressure at fixed contact, in g_0/p_0*
    pressure : of the nodes, shape (N,), in p_0*, free of tension
    tangent_pressure : its derivative with respect to the mean pressure, shape (N,)
    contact : whether a node is in contact, shape (N,)
    rounds : dense solutions so far
    converged : whether the last one changed no node
    """

    plane: float
    resistance: float
    pressure: Array
    tangent_pressure: Array
    contact: Flags
    rounds: int
    converged: bool


class DenseSolver:
    """One profile on a grid: each load is warm-started from the previous contact."""

    def __init__(self, profile: Waves, points: int, max_residual: float) -> None:
        """Fill the matrix; all nodes are in contact at first."""
        self._height, influence = profile.sampled_height(points), influence_coefficients(points, profile.period)
        self._matrix, self._max_residual = scipy.linalg.circulant(influence), max_residual
        self._contact = np.ones(points, bool)

    @one_thread
    def solve_discrete(self, load: float, with_tangent: bool) -> NodalSolution:
        """Return the solution under a load, with its derivative, which costs nothing; work counts dense solutions."""
        solved = solve_load(self._matrix, self._height, self._contact, load, self._max_residual)
        self._contact, pressure = solved.contact, solved.pressure
        gap = solved.plane - self._height + self._matrix @ pressure
        unbalanced = abs(pressure.mean() - load) * self._matrix[0, 0]
        return NodalSolution(
            solved.plane,
            solved.resistance if with_tangent else np.nan,
            pressure,
            gap,
            solved.tangent_pressure,
            self._matrix @ solved.tangent_pressure,
            solved.contact,
            max(np.abs(gap[solved.contact]).max(), -gap.min(), unbalanced),
            float(solved.rounds),
        )


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
