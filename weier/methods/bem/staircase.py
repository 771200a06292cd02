"""Sub-grid correction of the edges of contact (docs/bem.md, "The staircase").

On a grid an edge of contact advances by one node at a time, so that R(p) is a staircase and h(p) a polygon. The load
increments since and until an edge advances locate it within its step, and correct R and h.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel

EDGE_OFFSET = 0.384947631413  # alpha, in nodes: edge of the continuum beyond the last node at the middle of a step
COMPLIANCE_EXCESS = 1 / 24  # error of h at the beginning of a step over delta_R (Delta_- + Delta_+)
TRANSFERRED_FRACTION = 0.439056239  # f_t = -(A^-1)_01/(A^-1)_00: pressure that an open node moves to each neighbour
CLOSED_FRACTION = (5 - TRANSFERRED_FRACTION) / 6  # f_c: fraction of a step from which a single-node gap is closed
SINGLE_NODE_SQUARE = 1 / (2 * math.log(2))  # Hertz: squared half-width, in nodes, of a single-node contact at f = 1


class NodalSolution(NamedTuple):
    """Discrete solution at one load, with its derivative at fixed active set.

    plane : mean gap d, in g_0
    resistance : R = -dd/dp at fixed active set, in g_0/p_0*; NaN where it was not computed
    pressure : nodal p, shape (N,), in p_0*
    gap : nodal g, shape (N,), in g_0
    tangent_pressure : q = dp/d(mean pressure), of mean 1, shape (N,); meaningless where R is NaN
    tangent_displacement : A q, equal to R in contact, shape (N,), in g_0/p_0*; meaningless where R is NaN
    contact : active set, shape (N,)
    residual : largest violation of a contact condition, in g_0
    work : cost in the solver's own unit
    """

    plane: float
    resistance: float
    pressure: Array
    gap: Array
    tangent_pressure: Array
    tangent_displacement: Array
    contact: Flags
    residual: float
    work: float


@kernel
def _step_corrections(
    contact: Flags,
    pressure: Array,
    gap: Array,
    tangent_pressure: Array,
    tangent_displacement: Array,
    resistance: float,
) -> tuple[float, float, NDArray[np.float64], Flags]:
    """Return the corrections of the mean gap (to add) and of R (to subtract), the edge offsets and the closed gaps.

    The edge offset is the distance, in nodes, of an edge from the last node in contact, shape (2, N): right edges of
    contacts, then left edges. Gaps of one node that are closed in the continuum are flagged, shape (N,).

    Contacts of a single node contribute no correction: their edges are not well separated.
    """
    points, gap_correction, resistance_correction = contact.size, 0.0, 0.0
    edge_offset = np.zeros((2, points))
    load_since, load_until = np.zeros((2, points)), np.zeros((2, points))
    for j in range(points):
        for side in range(2):
            outwards = 1 - 2 * side
            outside, inside = (j + outwards) % points, (j - outwards) % points
            if not contact[j] or contact[outside]:
                continue
            edge_offset[side, j] = EDGE_OFFSET
            q, closing_rate = tangent_pressure[j], resistance - tangent_displacement[outside]
            if q > 0 and closing_rate > 0:
                since, until = max(pressure[j], 0.0) / q, max(gap[outside], 0.0) / closing_rate
                load_since[side, j], load_until[side, j] = since, until
                if contact[inside] and since + until > 0:
                    step, f = q * closing_rate / points, since / (since + until)
                    gap_correction += step * (since + until) * (COMPLIANCE_EXCESS - (f - f * f) / 2)
                    resistance_correction += (f - 0.5) * step
                    edge_offset[side, j] += f - 0.5
    closed = _locate_single_node_edges(contact, load_since, load_until, edge_offset)
    return gap_correction, resistance_correction, edge_offset, closed


@kernel
def _locate_single_node_edges(
    contact: Flags,
    load_since: NDArray[np.float64],
    load_until: NDArray[np.float64],
    edge_offset: NDArray[np.float64],
) -> Flags:
    """Fill in `edge_offset` at contacts and gaps of one node; return which of these gaps are closed, shape (N,).

    Both follow from a parabola (docs/bem.md, "The staircase"). A contact has the squared half-width f/(2 ln 2), a gap
    2 (f_c - f)/(1 + f_t) + 2 x_c^2, in nodes. The offset x_c from the node is a quarter of the difference of the load
    increments on both sides over their sum.

    load_since, load_until : load increments Delta_- and Delta_+ of each edge, shape (2, N), in p_0*
    """
    points, closed = contact.size, np.zeros(contact.size, np.bool_)
    for j in range(points):
        if contact[j] and not (contact[(j - 1) % points] or contact[(j + 1) % points]):
            since, until = load_since[0, j], 0.5 * (load_until[0, j] + load_until[1, j])
            if since > 0 and until > 0:
                half_width = np.sqrt(SINGLE_NODE_SQUARE * since / (since + until))
                shift = (load_until[1, j] - load_until[0, j]) / (4 * (since + until))
                edge_offset[0, j], edge_offset[1, j] = half_width + shift, half_width - shift
    for j in range(points):  # after the contacts, since the edges of a single-node gap are more accurate
        left, right = (j - 1) % points, (j + 1) % points
        if contact[left] and contact[right] and not contact[j]:
            since, until = 0.5 * (load_since[0, left] + load_since[1, right]), load_until[0, left]
            if since + until > 0:
                shift = (load_since[0, left] - load_since[1, right]) / (4 * (since + until))
                fraction = since / (since + until)
                square = 2 * (CLOSED_FRACTION - fraction) / (1 + TRANSFERRED_FRACTION) + 2 * shift * shift
                closed[j] = square <= 0
                half_width = np.sqrt(max(square, 0.0))
                edge_offset[0, left], edge_offset[1, right] = 1 + shift - half_width, 1 - shift - half_width
    return closed


class ContactPoint(NamedTuple):
    """One load of a curve.

    plane : mean gap d, in g_0
    resistance : R = dh/dp, in g_0/p_0*
    first, last : first and last node of each contact, shape (contacts,); empty in full contact
    edge : left and right edge of each contact in turn, in nodes, shape (2 contacts,)
    residual : largest violation of a contact condition at the nodes, in g_0
    work : cost in the solver's own unit
    """

    plane: float
    resistance: float
    first: Indices
    last: Indices
    edge: Array
    residual: float
    work: float


def contact_on_nodes(solution: NodalSolution) -> ContactPoint:
    """Return the discrete solution without correction, with edges half a node beyond the last node in contact."""
    first, last = contact_runs(solution.contact)
    edge = np.stack([first - 0.5, last + 0.5], axis=1).ravel()
    return ContactPoint(solution.plane, solution.resistance, first, last, edge, solution.residual, solution.work)


def remove_staircase(solution: NodalSolution) -> ContactPoint:
    """Return the corrected solution (`in_continuum`)."""
    return ContactPoint(*in_continuum(solution), solution.residual, solution.work)


@kernel
def in_continuum(solution: NodalSolution) -> tuple[float, float, Indices, Indices, Array]:
    """Return corrected mean gap, resistance, nodes and edges of the contacts, as in `ContactPoint`.

    Mean gap and resistance are clipped at 0; both are 0 if all gaps are closed.
    """
    gap_correction, resistance_correction, edge_offset, closed = _step_corrections(
        solution.contact,
        solution.pressure,
        solution.gap,
        solution.tangent_pressure,
        solution.tangent_displacement,
        solution.resistance,
    )
    contact = solution.contact.copy()
    for j in range(contact.size):
        contact[j] = contact[j] or closed[j]
    first, last = contact_runs(contact)
    edge = np.empty(2 * first.size)
    for j in range(first.size):
        edge[2 * j] = first[j] - edge_offset[1, first[j]]
        edge[2 * j + 1] = last[j] + edge_offset[0, last[j] % contact.size]
    plane, resistance = 0.0, 0.0
    if first.size > 0:
        plane, resistance = (
            max(solution.plane + gap_correction, 0.0),
            max(solution.resistance - resistance_correction, 0.0),
        )
    return plane, resistance, first, last, edge


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
