"""Edges of contact on a grid, and the extrapolation of residuals across them for the preconditioner.

The residual is extrapolated into the gaps, multiplied by A^-1 and restricted by the transpose of the extrapolation,
so that the preconditioner is symmetric (docs/numerics.md, "Fast boundary elements").
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.staircase import EDGE_OFFSET

# contact widths over which the residual falls linearly to 0 in a gap. A jump at the edge, as with 1, would give a
# logarithmically large force. Its cost is in `python -m benchmarks tuning`.
REACH = 2


@kernel
def find_edges(contact: Flags, space: Indices) -> Indices:
    """Return the nodes at which contact begins or ends, with one more edge on either side.

    The first and the last number are the last and the first edge, shifted by one period. They are written to `space`,
    shape (N + 2,); without an edge they are meaningless.
    """
    edges = 0
    for i in range(contact.size):
        if contact[i] != contact[i - 1]:
            edges += 1
            space[edges] = i
    if edges:
        space[0] = space[edges] - contact.size
        space[edges + 1] = space[1] + contact.size
    return space[: edges + 2]


@kernel
def _path_into_gap(which: int, edge: Indices, contact: Flags) -> tuple[int, int, int]:
    """Return the last node in contact at an edge, the direction into the gap and the number of nodes to go."""
    before, here, after = edge[which - 1], edge[which], edge[which + 1]
    if contact[here]:
        return here, -1, min(here - before + 1, REACH * (after - here))
    # A negative index counts from the end, so that the path may cross the end of the period.
    node = here - 1 - contact.size if here > 0 else -1
    return node, 1, min(after - here + 1, REACH * (here - before))


@kernel
def extrapolate_into_gap(values: Array, edge: Indices, contact: Flags) -> None:
    """Extrapolate the value at each edge into the gap, falling linearly to 0."""
    for which in range(1, edge.size - 1):
        node, side, reach = _path_into_gap(which, edge, contact)
        fall = values[node] / reach
        for step in range(1, reach):
            values[node + side * step] += fall * (reach - step)


@kernel
def restrict_from_gap(values: Array, edge: Indices, contact: Flags) -> None:
    """Apply the transpose: add the values in the gap to the edge, with linearly falling weights."""
    for which in range(1, edge.size - 1):
        node, side, reach = _path_into_gap(which, edge, contact)
        total = 0.0
        for step in range(1, reach):
            total += values[node + side * step] * (reach - step)
        values[node] += total / reach


@kernel
def punch_shape(edge: Indices, contact: Flags, shape: Array) -> None:
    """Set q to the pressure of flat punches on all contacts, N/sqrt(distances to both edges in nodes).

    The edges are `EDGE_OFFSET` beyond the last nodes, as in the continuum. The sum is scaled by the caller.
    """
    points = contact.size
    for i in range(points):
        shape[i] = 1.0 if edge.size == 2 else 0.0
    for run in range(1, edge.size - 1):
        start, nodes = edge[run], edge[run + 1] - edge[run]
        if contact[start]:
            for i in range(nodes):
                shape[(start + i) % points] = points / np.sqrt((i + EDGE_OFFSET) * (nodes - 1 - i + EDGE_OFFSET))
