"""Sub-grid correction of the edges of contact (docs/bem.md, "The staircase").

On a grid an edge of contact advances by one node at a time, so that R(p) is a staircase and h(p) a polygon. The load
increments since and until an edge advances locate it within its step, and correct R and h.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel

EDGE_OFFSET = 0.384947631413  # alpha, in nodes: edge of the continuum beyond the last node at the middle of a step
TRANSFERRED_FRACTION = 0.439056239  # f_t = -(A^-1)_01/(A^-1)_00: pressure that an open node moves to each neighbour
CLOSED_FRACTION = (5 - TRANSFERRED_FRACTION) / 6  # f_c: fraction of a step from which a single-node gap is closed
SINGLE_NODE_SQUARE = 1 / (2 * math.log(2))  # Hertz: squared half-width, in nodes, of a single-node contact at f = 1


class NodalSolution(NamedTuple):
    """Discrete solution at one load, with its derivative at fixed active set.

    plane : mean gap d, in g_0
    resistance : R = -dd/dp at fixed active set, in g_0/p_0*; NaN where it was not computed
    residual : largest violation of a contact condition, in g_0
    work : cost in the solver's own unit
    pressure : nodal p, shape (N,), in p_0*
    gap : nodal g, shape (N,), in g_0
    tangent_pressure : q = dp/d(mean pressure), of mean 1, shape (N,); meaningless where R is NaN
    tangent_displacement : A q, equal to R in contact, shape (N,), in g_0/p_0*; meaningless where R is NaN
    contact : active set, shape (N,)
    """

    plane: float
    resistance: float
    residual: float
    work: float
    pressure: Array
    gap: Array
    tangent_pressure: Array
    tangent_displacement: Array
    contact: Flags


Corrected = tuple[float, float, Indices, Indices, Array]


def on_nodes(solution: NodalSolution) -> Corrected:
    """Return the discrete solution without correction, with edges half a node beyond the last node in contact."""
    first, last = contact_runs(solution.contact)
    edge = np.stack([first - 0.5, last + 0.5], axis=1).ravel()
    return solution.plane, solution.resistance, first, last, edge


@kernel
def in_continuum(solution: NodalSolution) -> Corrected:
    """Return corrected mean gap, resistance, first and last nodes, and left and right edges of the contacts in turn.

    Nodes have the shape (contacts,), edges, in nodes, (2 contacts,); full contact has none. Contacts of a single node
    contribute no correction: their edges are not well separated. Mean gap and resistance are clipped at 0; both are 0
    if all gaps are closed.
    """
    points, plane, resistance = solution.contact.size, solution.plane, solution.resistance
    first, last = contact_runs(solution.contact)
    edge = np.empty(2 * first.size)
    since, until = np.zeros_like(edge), np.zeros_like(edge)
    for e in range(edge.size):  # left and right edge of each contact in turn
        j, outwards, offset = e // 2, 2 * (e % 2) - 1, EDGE_OFFSET
        inside = last[j] if e % 2 else first[j]
        node, outside = inside % points, (inside + outwards) % points
        q = solution.tangent_pressure[node]
        closing_rate = solution.resistance - solution.tangent_displacement[outside]
        if q > 0 and closing_rate > 0:
            since[e] = max(solution.pressure[node], 0.0) / q
            until[e] = max(solution.gap[outside], 0.0) / closing_rate
            if last[j] > first[j] and since[e] + until[e] > 0:
                step, f = q * closing_rate / points, since[e] / (since[e] + until[e])
                plane += step * (since[e] + until[e]) * (1 / 24 - (f - f * f) / 2)
                resistance -= (f - 0.5) * step
                offset += f - 0.5
        edge[e] = inside + outwards * offset
    closed = _locate_single_node_edges(first, last, points, since, until, edge)
    first, last, edge = _merge(first, last, points, edge, closed)
    if first.size == 0:
        plane = resistance = 0.0
    return max(plane, 0.0), max(resistance, 0.0), first, last, edge


@kernel
def _locate_single_node_edges(
    first: Indices, last: Indices, points: int, since: Array, until: Array, edge: Array
) -> Flags:
    """Locate the edges at contacts and gaps of one node; return whether the gap on the right of each is closed.

    Both follow from a parabola (docs/bem.md, "The staircase"). A contact has the squared half-width f/(2 ln 2), a gap
    2 (f_c - f)/(1 + f_t) + 2 x_c^2, in nodes. The offset x_c from the node is a quarter of the difference of the load
    increments on both sides over their sum.

    since, until : load increments Delta_- and Delta_+ of each edge, shape (2 contacts,), in p_0*
    """
    n, closed = first.size, np.empty(first.size, np.bool_)
    for j in range(n):
        before, after = since[2 * j + 1], 0.5 * (until[2 * j] + until[2 * j + 1])
        if first[j] == last[j] and before > 0 and after > 0:
            half_width = np.sqrt(SINGLE_NODE_SQUARE * before / (before + after))
            shift = (until[2 * j] - until[2 * j + 1]) / (4 * (before + after))
            edge[2 * j], edge[2 * j + 1] = first[j] + shift - half_width, first[j] + shift + half_width
    for j in range(n):  # after the contacts, since the edges of a single-node gap are more accurate
        k = (j + 1) % n
        left, right, closed[j] = since[2 * j + 1], since[2 * k], False
        before, after = 0.5 * (left + right), until[2 * j + 1]
        if (first[k] - last[j] - 2) % points == 0 and before + after > 0:
            shift, fraction = (left - right) / (4 * (before + after)), before / (before + after)
            square = 2 * (CLOSED_FRACTION - fraction) / (1 + TRANSFERRED_FRACTION) + 2 * shift * shift
            closed[j], half_width = square <= 0, np.sqrt(max(square, 0.0))
            edge[2 * j + 1], edge[2 * k] = last[j] + 1 + shift - half_width, first[k] - 1 + shift + half_width
    return closed


@kernel
def _merge(first: Indices, last: Indices, points: int, edge: Array, closed: Flags) -> tuple[Indices, Indices, Array]:
    """Return nodes and edges of the contacts that are left when some of the gaps on their right are closed."""
    n, count = first.size, 0
    merged_first, merged_last, merged_edge = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(2 * n)
    for j in range(n):
        if not closed[j - 1]:
            end = j
            while closed[end % n]:
                end += 1
            k, turn = end % n, end // n * points
            merged_first[count], merged_last[count] = first[j], last[k] + turn
            merged_edge[2 * count], merged_edge[2 * count + 1] = edge[2 * j], edge[2 * k + 1] + turn
            count += 1
    return merged_first[:count], merged_last[:count], merged_edge[: 2 * count]


@kernel
def contact_runs(contact: Flags) -> tuple[Indices, Indices]:
    """Return the first and last node of each contact, shape (contacts,); empty in full contact.

    `first` lies in the period; `last` exceeds N - 1 if the contact extends across its end.
    """
    n, count = contact.size, 0
    first, last = np.empty(n // 2 + 1, np.int64), np.empty(n // 2 + 1, np.int64)
    for i in range(n):
        if contact[i] and not contact[i - 1]:
            end = i
            while contact[(end + 1) % n]:
                end += 1
            first[count], last[count], count = i, end, count + 1
    return first[:count], last[:count]
