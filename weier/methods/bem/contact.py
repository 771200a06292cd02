"""What both solvers of the boundary elements share: the form of the solution, and the count of contacts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.jit import kernel

Array = NDArray[np.float64]


class DiscreteSolution(NamedTuple):
    """The discrete solution over the loads, each of shape (loads,).

    plane : height of the rigid plane above the mean plane (the mean gap d), in g_0
    resistance : rate at which it sinks with the mean pressure while the contact stays as it is, in g_0/p_0*
    contact_nodes, patches : nodes in contact, and the number of unbroken runs of them
    residual : largest violation of a contact condition, as a length in g_0
    work : solver's own measure of cost
    """

    plane: Array
    resistance: Array
    contact_nodes: NDArray[np.int64]
    patches: NDArray[np.int64]
    residual: Array
    work: Array


@kernel
def blank_solution(loads: int) -> DiscreteSolution:
    """An solution with nothing in it yet."""
    return DiscreteSolution(
        np.empty(loads),
        np.full(loads, np.nan),
        np.empty(loads, np.int64),
        np.empty(loads, np.int64),
        np.empty(loads),
        np.zeros(loads),
    )


@kernel
def count(contact: NDArray[np.bool_]) -> int:
    """Nodes in contact."""
    nodes = 0
    for i in range(contact.size):
        nodes += contact[i]
    return nodes


@kernel
def count_patches(contact: NDArray[np.bool_]) -> int:
    """Unbroken runs of contact around the period; 0 when nothing separates them (full contact)."""
    runs = 0
    for i in range(contact.size):
        runs += contact[i] and not contact[i - 1]
    return runs
