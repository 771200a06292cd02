"""The paper's solver: the dense matrix of influence and an active set by inversion (Johnson 1985, Section 5.9)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.bem.contact import Answer, count_patches, no_answer
from weier.jit import kernel

Array = NDArray[np.float64]

ROUNDS = 100  # a warm-started load takes 2-8 rounds of dropping and adding nodes


@kernel
def _system(influence: Array, nodes: NDArray[np.int64]) -> Array:
    """The matrix of influence on the nodes in contact, bordered by the height of the flat and the load."""
    n, points = nodes.size, influence.size
    matrix = np.zeros((n + 1, n + 1))
    for i in range(n):
        for j in range(n):
            matrix[i, j] = influence[(nodes[i] - nodes[j]) % points]
        matrix[i, n] = 1.0
        matrix[n, i] = 1.0 / points
    return matrix


@kernel
def _displacement(influence: Array, pressure: Array, nodes: NDArray[np.int64]) -> Array:
    """The dense product, over the nodes that carry pressure."""
    points = influence.size
    u = np.zeros(points)
    for j in nodes:
        for i in range(points):
            u[i] += influence[(i - j) % points] * pressure[j]
    return u


@kernel
def _update(contact: NDArray[np.bool_], pressure: Array, gap: Array, tolerance: float, stiffness: float) -> bool:
    """Release nodes in tension, add nodes in penetration; whether anything changed."""
    changed = False
    for i in range(contact.size):
        if contact[i] and pressure[i] < -tolerance * stiffness:
            contact[i] = False
            changed = True
        elif not contact[i] and gap[i] < -tolerance:
            contact[i] = True
            changed = True
    return changed


@kernel
def solve_loads(height: Array, influence: Array, pressure: Array, loads: Array, tolerance: float) -> Answer:
    """Solve every load from the heaviest down, each from the contact of the one before.

    Parameters
    ----------
    height, influence : array, shape (N,)
        Profile in g_0, displacement per nodal pressure in g_0/p_0*.
    pressure : array, shape (N,)
        Where it is positive the search for the contact begins; overwritten with the last solution.
    loads : array, shape (loads,)
        Mean pressures, increasing, in p_0*.
    tolerance : float
        Largest penetration, and largest tension times the compliance of one node, in g_0.

    Returns
    -------
    Answer
        Arrays over the loads, in their order; work counts dense solutions.

    """
    answer = no_answer(loads.size)
    contact = pressure > 0
    for load in range(loads.size - 1, -1, -1):
        changed = True
        rounds = 0
        while changed and rounds < ROUNDS:
            nodes = np.flatnonzero(contact)
            n = nodes.size
            right = np.zeros((n + 1, 2))
            right[:n, 0] = height[nodes]
            right[n, 0] = loads[load]
            right[n, 1] = 1.0
            solution = np.linalg.solve(_system(influence, nodes), right)
            pressure[:] = 0.0
            pressure[nodes] = solution[:n, 0]
            gap = solution[n, 0] - height + _displacement(influence, pressure, nodes)
            changed = _update(contact, pressure, gap, tolerance, 1 / influence[0])
            rounds += 1
        pressure[:] = np.maximum(pressure, 0.0)
        gap = solution[n, 0] - height + _displacement(influence, pressure, nodes)
        answer.flat[load] = solution[n, 0]
        answer.resistance[load] = -solution[n, 1]
        answer.contact_nodes[load] = n
        answer.patches[load] = count_patches(contact)
        answer.residual[load] = max(
            np.abs(gap[nodes]).max(), -gap.min(), abs(pressure.mean() - loads[load]) * influence[0]
        )
        answer.work[load] = rounds
    return answer
