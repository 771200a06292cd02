"""One load on the grid, solved: what the continuum is told of it."""

from __future__ import annotations

from typing import NamedTuple

from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import kernel

MAX_RATE_TOLERANCE = 1e-2  # of the rate: what corrections at 16 points a wave are off themselves
RATE_FACTOR = 1e6  # per g_0 of the residual: 1e-8 goes with 1e-2, 1e-10 with 1e-4


@kernel
def rate_tolerance(residual: float) -> float:
    """How flat A q is to be in contact, as a share of the rate, beside a residual of the heights, in g_0.

    The resistance holds the square of it; of the correction it is about the share that is lost.
    """
    return min(MAX_RATE_TOLERANCE, RATE_FACTOR * residual)


@kernel
def next_node(node: int, points: int) -> int:
    """The node after this one of so many; a remainder takes as long as ten additions."""
    return node + 1 if node + 1 < points else 0


class GridSolution(NamedTuple):
    """A converged solution on N nodes, and its rate per mean pressure; arrays of shape (N,).

    plane : height H of the plane above the mean plane, in g_0
    rate : by which it sinks on the contact as it stands, in g_0/p_0*
    pressure, deformed : p, in p_0*, and z - A p, in g_0
    per_load, displacement : q, of mean 1, and A q, in g_0/p_0*
    contact : whether a node is in contact
    """

    plane: float
    rate: float
    pressure: Array
    deformed: Array
    per_load: Array
    displacement: Array
    contact: Flags
