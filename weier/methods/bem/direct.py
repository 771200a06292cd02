"""The paper's solver: the dense matrix of influence and an active set by inversion (Johnson 1985, Section 5.9)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are used: a tenth of a second each, that few jobs need

from weier.kernels.arrays import Array, Flags
from weier.kernels.blas import one_thread
from weier.methods.bem.fft import DiscreteSolution, count_patches
from weier.methods.progress import count_load

MAX_ROUNDS = 100  # a warm-started load takes 2-8 rounds of dropping and adding nodes


class ActiveSet(NamedTuple):
    """One load: the last solution, on the nodes in contact, and whether another round would change them.

    plane : height of the rigid plane above the mean plane, in g_0
    resistance : rate at which it sinks with the mean pressure while the contact stays as it is, in g_0/p_0*
    pressure : of the nodes, shape (N,), in p_0*, free of tension
    contact : whether a node is in contact, shape (N,)
    rounds : dense solutions so far
    converged : whether the last one changed no node
    """

    plane: float
    resistance: float
    pressure: Array
    contact: Flags
    rounds: int
    converged: bool


@one_thread
def solve_loads(
    height: Array, influence: Array, pressure: Array, loads: Array, max_residual: float
) -> DiscreteSolution:
    """Solve every load from the heaviest down, each from the contact of the one before.

    Parameters
    ----------
    height, influence : array, shape (N,)
        Profile in g_0, displacement per nodal pressure in g_0/p_0*.
    pressure : array, shape (N,)
        Where it is positive the search for the contact begins; overwritten with the last solution.
    loads : array, shape (loads,)
        Mean pressures, increasing, in p_0*.
    max_residual : float
        Largest penetration, and largest tension times the compliance of one node, in g_0.

    Returns
    -------
    DiscreteSolution
        Arrays over the loads, in their order; work counts dense solutions.

    """
    rows, matrix, contact = np.empty((loads.size, 6)), scipy.linalg.circulant(influence), pressure > 0
    for load in range(loads.size - 1, -1, -1):
        solved = solve_load(matrix, height, contact, loads[load], max_residual)
        contact, pressure[:] = solved.contact, solved.pressure
        gap = solved.plane - height + matrix @ pressure
        residual = max(np.abs(gap[contact]).max(), -gap.min(), abs(pressure.mean() - loads[load]) * influence[0])
        nodes, patches = contact.sum(), count_patches(contact)
        rows[load] = solved.plane, solved.resistance, nodes, patches, residual, solved.rounds
        count_load()
    return DiscreteSolution(*rows.T)


def solve_load(matrix: Array, height: Array, contact: Flags, load: float, max_residual: float) -> ActiveSet:
    """Drop the nodes in tension and add those that penetrate, until there are none or MAX_ROUNDS are over.

    `matrix`, shape (N, N), is of displacement per nodal pressure; `contact` is where the search begins.
    """
    rounds, converged = 0, False
    while not converged and rounds < MAX_ROUNDS:
        nodes = contact if contact.any() else height == height.max()  # something has to carry the load
        plane, resistance, pressure = _on_contact(matrix, nodes, height, load)
        gap = plane - height + matrix @ pressure
        tensile = nodes & (pressure < -max_residual / matrix[0, 0])
        penetrating = ~nodes & (gap < -max_residual)
        contact = nodes & ~tensile | penetrating
        rounds, converged = rounds + 1, np.array_equal(contact, nodes)
    return ActiveSet(plane, resistance, np.maximum(pressure, 0.0), nodes, rounds, converged)


def _on_contact(matrix: Array, contact: Flags, height: Array, load: float) -> tuple[float, float, Array]:
    """Height of the plane, the rate at which it sinks, and pressure, were all nodes in contact held there."""
    nodes = np.flatnonzero(contact)
    n, points = nodes.size, contact.size
    system, right = np.ones((n + 1, n + 1)), np.zeros((n + 1, 2))
    system[:n, :n], system[n, :n], system[n, n] = matrix[np.ix_(nodes, nodes)], 1 / points, 0.0
    right[:n, 0], right[n] = height[nodes], (load, 1.0)
    solution, pressure = np.linalg.solve(system, right), np.zeros(points)
    pressure[nodes] = solution[:n, 0]
    return solution[n, 0], -solution[n, 1], pressure
