"""The staircase of a grid, taken off: where each edge of contact is in its step from one node to the next.

On a grid an edge of contact waits at a node while the load rises, and then takes the next one. The resistance is
therefore a staircase, and the compliance a polygon. From the solution and its derivative by the load follow how far
each edge is in its step, and compliance and resistance in the continuum (docs/bem.md, "The staircase").
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel

# Distance from the last node in contact to the edge in the continuum, in nodes, at the middle of a step: alpha of
# docs/bem.md.
EDGE = 0.384947631413
# Excess of the compliance on a grid as a step begins, over delta_R (a + b): docs/bem.md, for triangles.
AT_START_OF_STEP = 1 / 24
# Pressure that an open node moves to each of its neighbours, over its own: -(A^-1)_01/(A^-1)_00, r of docs/bem.md.
NEIGHBOUR_STIFFNESS = 0.439056239
CLOSED_FRACTION = (5 - NEIGHBOUR_STIFFNESS) / 6  # Of a step, from which on a gap of one node is closed: f_c.
# Square of the half-width of a contact of one node as its step ends, in nodes: that of Hertz's contact.
SINGLE_NODE_SQUARE = 1 / (2 * math.log(2))


class NodalSolution(NamedTuple):
    """The discrete solution under one load, and its derivative by the load while the contact stays as it is.

    plane : height of the rigid plane above the mean plane (the mean gap d), in g_0
    resistance : R, by which it falls with the mean pressure, in g_0/p_0*
    pressure : p of the nodes, shape (N,), in p_0*
    gap : g at the nodes, shape (N,), in g_0
    tangent_pressure : q = dp/d(mean pressure), of mean 1, shape (N,)
    tangent_displacement : A q, which is R in contact, shape (N,), in g_0/p_0*; both are meaningless where R is NaN,
        since it was not computed
    contact : whether a node is in contact, shape (N,)
    residual : largest violation of a contact condition, as a length in g_0
    work : solver's own measure of cost
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
def _edges_in_their_steps(
    contact: Flags,
    pressure: Array,
    gap: Array,
    tangent_pressure: Array,
    tangent_displacement: Array,
    resistance: float,
) -> tuple[float, float, NDArray[np.float64], Flags]:
    """The corrections of mean gap, to add, and resistance, to subtract; where the edges are; and closed gaps.

    The third is the distance, in nodes, of an edge from the last node in contact, shape (2, N): of edges on the right
    of contacts, and of those on the left. The last are gaps of one node that have closed in the continuum, shape
    (N,).

    A contact of one node changes neither mean gap nor resistance here: its edges are too close to each other for the
    formula of an edge.
    """
    points, of_gap, of_resistance = contact.size, 0.0, 0.0
    beyond, since, until = np.zeros((2, points)), np.zeros((2, points)), np.zeros((2, points))
    for j in range(points):
        for side in range(2):
            outwards = 1 - 2 * side
            outside, behind = (j + outwards) % points, (j - outwards) % points
            if not contact[j] or contact[outside]:
                continue
            beyond[side, j] = EDGE
            q, t = tangent_pressure[j], resistance - tangent_displacement[outside]
            if q > 0 and t > 0:
                a, b = max(pressure[j], 0.0) / q, max(gap[outside], 0.0) / t
                since[side, j], until[side, j] = a, b
                if contact[behind] and a + b > 0:
                    step, f = q * t / points, a / (a + b)
                    of_gap += step * (a + b) * (AT_START_OF_STEP - (f - f * f) / 2)
                    of_resistance += (f - 0.5) * step
                    beyond[side, j] += f - 0.5
    return of_gap, of_resistance, beyond, _edges_of_single_nodes(contact, since, until, beyond)


@kernel
def _edges_of_single_nodes(
    contact: Flags, since: NDArray[np.float64], until: NDArray[np.float64], beyond: NDArray[np.float64]
) -> Flags:
    """Fill in `beyond` at contacts and gaps of one node; return which of these gaps have closed.

    docs/bem.md, "The staircase", derives both from a parabola: of the surface for a contact, whose half-width squared
    is f/(2 ln 2) nodes, and of the pressure for a gap, whose half-width squared is 2 (f_c - f)/(1 + r) + 2 s^2. The
    shift s beside the node is a quarter of the difference between both sides, of b or of a, over a + b.

    since, until : loads a and b of each edge, of the shape of `beyond`
    """
    points, closed = contact.size, np.zeros(contact.size, np.bool_)
    for j in range(points):
        if contact[j] and not (contact[(j - 1) % points] or contact[(j + 1) % points]):
            a, b = since[0, j], 0.5 * (until[0, j] + until[1, j])
            if a > 0 and b > 0:
                half_width = np.sqrt(SINGLE_NODE_SQUARE * a / (a + b))
                shift = (until[1, j] - until[0, j]) / (4 * (a + b))
                beyond[0, j], beyond[1, j] = half_width + shift, half_width - shift
    for j in range(points):  # The edges of a gap of one node are more accurate than those of a contact beside it.
        before, after = (j - 1) % points, (j + 1) % points
        if contact[before] and contact[after] and not contact[j]:
            a, b = 0.5 * (since[0, before] + since[1, after]), until[0, before]
            if a + b > 0:
                shift = (since[0, before] - since[1, after]) / (4 * (a + b))
                square = 2 * (CLOSED_FRACTION - a / (a + b)) / (1 + NEIGHBOUR_STIFFNESS) + 2 * shift * shift
                closed[j] = square <= 0
                half_width = np.sqrt(max(square, 0.0))
                beyond[0, before], beyond[1, after] = 1 + shift - half_width, 1 - shift - half_width
    return closed


class ContactPoint(NamedTuple):
    """One load of a curve.

    plane : mean gap d, in g_0
    resistance : dh/dp, in g_0/p_0*
    first, last : node of each contact, from left to right, the first one in the period; none in full contact
    edge : left and right edge of each contact in turn, in nodes, shape (edges,)
    residual : largest violation of a contact condition at the nodes, in g_0
    work : solver's own measure of cost
    """

    plane: float
    resistance: float
    first: Indices
    last: Indices
    edge: Array
    residual: float
    work: float


def contact_on_nodes(solution: NodalSolution) -> ContactPoint:
    """The discrete solution as it is, with edges of contact half a node beyond the last one."""
    first, last = contact_runs(solution.contact)
    edge = np.stack([first - 0.5, last + 0.5], axis=1).ravel()
    return ContactPoint(solution.plane, solution.resistance, first, last, edge, solution.residual, solution.work)


def remove_staircase(solution: NodalSolution) -> ContactPoint:
    """The solution in the continuum from the one on nodes (`in_continuum`)."""
    return ContactPoint(*in_continuum(solution), solution.residual, solution.work)


@kernel
def in_continuum(solution: NodalSolution) -> tuple[float, float, Indices, Indices, Array]:
    """Mean gap, resistance, nodes of contacts and their edges in the continuum, as in `ContactPoint`.

    Neither mean gap nor resistance is below 0. Where all gaps have closed, contact is full, and both are 0.
    """
    of_gap, of_resistance, beyond, closed = _edges_in_their_steps(
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
        edge[2 * j] = first[j] - beyond[1, first[j]]
        edge[2 * j + 1] = last[j] + beyond[0, last[j] % contact.size]
    plane, resistance = 0.0, 0.0
    if first.size > 0:
        plane, resistance = max(solution.plane + of_gap, 0.0), max(solution.resistance - of_resistance, 0.0)
    return plane, resistance, first, last, edge


@kernel
def contact_runs(contact: Flags) -> tuple[Indices, Indices]:
    """The first and the last node of each contact, the first one in the period; none in full contact.

    The last node of a contact that extends across the end of the period is counted on from there.
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
