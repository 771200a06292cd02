"""The nodes about a contact or a gap that its polynomials are fitted on."""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.edges import Edges
from weier.methods.bem.polynomials import DEGREE, TERMS, derivative, value

EDGE = 0.384947631413  # nodes from the last one in contact to the edge of a flat punch, in the mean of a step
MAX_BEYOND = 1.5  # nodes from the last one in contact to its edge: half a node in all that a grid can miss
MARGIN = 2  # nodes beyond a contact or a gap that its polynomial is fitted on, at each end; more if it has few itself
MAX_MARGIN = (TERMS + 1) // 2 + MARGIN
CREST_MARGIN = DEGREE // 2  # and beyond the highest node of a gap, or the node of least pressure in a contact
MAX_FITTED = 25  # nodes that a polynomial is fitted on: more add nothing
MIN_POLYNOMIAL = 3  # nodes of a window: a parabola


@kernel
def window(nodes: int, margin: int) -> tuple[Indices, Array, float]:
    """Nodes to fit on, counted from the first in the window; their s in [-1, 1]; the nodes in one s."""
    whole = nodes + 2 * margin
    fitted = min(whole, MAX_FITTED)
    scale = (whole - 1) / 2
    offset = np.empty(fitted, np.int64)
    for i in range(fitted):
        offset[i] = (i * (whole - 1) + (fitted - 1) // 2) // (fitted - 1)
    return offset, offset / scale - 1, scale


@kernel
def margin_of(edge: Edges, run: int) -> int:
    """Nodes beyond both ends of a run that belong to no further one, at most as many as the polynomial needs."""
    before, nodes = edge[run + 1] - edge[run], edge[run + 2] - edge[run + 1]
    after = edge[run + 3] - edge[run + 2] if run + 3 < edge.size else edge[2] - edge[1]
    return min(max(MARGIN, (TERMS - nodes + 1) // 2), before, after)


@kernel
def average_under_triangle(polynomial: Array, scale: float) -> Array:
    """The moving average of a polynomial under a triangle of the nodes' spacing."""
    second = derivative(derivative(polynomial))
    fourth = derivative(derivative(second))
    return polynomial + second / (12 * scale**2) + fourth / (360 * scale**4)


@kernel
def added_by_triangles(polynomial: Array, nodes: int, scale: float) -> Array:
    """What that average adds at the nodes of a run, to second differences."""
    second = derivative(derivative(polynomial))
    values = np.empty(nodes)
    for i in range(nodes):
        values[i] = value(second, (i - (nodes - 1) / 2) / scale) / (12 * scale**2)
    return values


@kernel
def side_margin(node: int, contact: Flags) -> int:
    """Nodes to each side of this one that are in contact if it is, and not if it is not; at most CREST_MARGIN."""
    margin = 1
    while (
        margin < CREST_MARGIN
        and contact[node - margin - 1] == contact[node]
        and contact[(node + margin + 1) % contact.size] == contact[node]
    ):
        margin += 1
    return margin
