"""Gaps too thin to be segments: cracks in closed form (docs/patches.md, "Thin gaps").

Their edges follow from the pressure of the merged contact, since the field of a crack decays with the square of the
distance. `find_thin_gaps` finds them; `Cracks` has their effect on mean gap and resistance. With x = c + b t and the
tension -p = sum sigma_k U_k(t), the gap is 2 pi b sqrt(1-t^2) sum sigma_k U_k(t)/(k+1).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices, Records
from weier.kernels.jit import kernel
from weier.methods.chebyshev import evaluate_expansion, gauss_rule
from weier.methods.patches.edge_iteration import MAX_SQUARE, MAX_STEPS
from weier.methods.patches.given_edges import Forces, Punches
from weier.methods.patches.kind import EPS, OnContacts
from weier.methods.patches.segments import ContactState, Cracks, coefficient_tails
from weier.methods.patches.surface import CosineSeries, Sides

# nodes on a crack: the pressure is a polynomial of low degree up to terms in b/l, with l the distance to the nearest
# edge; 8 nodes resolve it to rounding up to b = l/10
NODES = 8


def settle_edges(
    singularities: Callable[[Array, Array], tuple[Sides, Sides]],
    middle: Array,
    half_width: Array,
    most: float,
    enough: float = float(np.sqrt(EPS)),
) -> tuple[Array, Array, Flags]:
    """Return middles and half-widths of segments without interaction by Newton's method, and which settle.

    singularities : k_0 and k_1/2 at both edges, up to a common factor, from middles and half-widths
    most : largest distance of an edge from the origin of the middles; segments that pass it are not settled
    enough : largest move of a settled edge, in half-widths
    """
    c, r, inside = middle, half_width, np.abs(middle) + half_width < most
    for _ in range(MAX_STEPS):
        singular, strength = singularities(c, r)
        move = singular / np.maximum(np.abs(strength), 1e-300)  # the move is in half-widths
        settled = inside & np.all((strength > 0) & (np.abs(move) < enough), axis=1)
        growth = np.clip(1 + move.sum(axis=1), 1 / MAX_SQUARE, MAX_SQUARE)
        c, r = c + np.clip(0.5 * (move[:, 1] - move[:, 0]), -1, 1) * r, np.sqrt(growth) * r
        inside &= np.abs(c) + r < most
        if np.all(settled | ~inside):
            break
        c, r = np.where(inside, c, middle), np.where(inside, r, half_width)
    return c, r, settled & inside


def gap_singularities(c: NDArray[np.float64]) -> tuple[Sides, Sides]:
    """Return k_0 and k_1/2 at the edges of gaps in the pressures sum c_k T_k, up to a common factor."""
    k = np.arange(c.shape[1])
    sign = np.stack([(-1.0) ** k, np.ones(k.size)], axis=1)
    return -(c[:, :1] + 0.5 * c[:, 1:2] * sign[1]), (c * k)[:, 2:] @ sign[2:]


def find_thin_gaps(
    pressure: OnContacts,
    tangent: OnContacts,
    contact: Indices,
    middle: Array,
    reach: Array,
    radius: Array,
    period: float,
) -> tuple[Cracks, Flags]:
    """Return the cracks that open in intervals of tension, and which of the intervals these are.

    Parameters
    ----------
    pressure, tangent : p of the contacts without the gaps, in p_0*, and q = dp/dP, at points on contacts
    contact, middle, reach : contact, middle and half-width of each interval, in the coordinate t of its contact
    radius : half-width of each of these contacts, in lambda_0, shape (intervals,)

    Notes
    -----
    By reciprocity, a gap w at given load increases the mean gap by (1/L) int q w dx, and its growth with the load
    increases the resistance by pi^2 b^2/L sum q_k^2/(k+1), with q = sum q_k U_k.
    """
    if contact.size == 0:
        return Cracks(), np.zeros(0, bool)
    first, second, k = gauss_rule(NODES, False), gauss_rule(NODES, True), np.arange(NODES)

    def singularities(t: Array, b: Array) -> tuple[Sides, Sides]:
        return gap_singularities(pressure(contact, t[:, None] + b[:, None] * first.node) @ first.expansion.T)

    t, b, found = settle_edges(singularities, middle, np.sqrt(2.0) * reach, 1.0)
    if not np.any(found):
        return Cracks(), found
    contact, t, b, length = contact[found], t[found], b[found], (b * radius)[found]
    tau = t[:, None] + b[:, None] * second.node
    tension, q = (value @ second.expansion.T for value in (-pressure(contact, tau), tangent(contact, tau)))
    opening = 2 * np.pi * length[:, None] * tension / (k + 1)  # coefficients of w/sqrt(1-tau^2) in U_k
    # At an end w = Omega(1) sqrt(1-tau^2) - Omega'(1) sqrt(2) (s/b)^(3/2), and the gap is (4 pi/3) A s^(3/2).
    slope = -(opening * (k * (k + 1) * (k + 2) / 3)).sum(axis=1)
    slope_at_left = -(opening * ((-1.0) ** k * k * (k + 1) * (k + 2) / 3)).sum(axis=1)
    strength = 0.75 / np.pi * np.sqrt(2.0) * 0.5 * (slope + slope_at_left) / length**1.5
    volume = 0.5 * np.pi * length * opening[:, 0]
    lift = 0.5 * np.pi / period * length * (opening * q).sum(axis=1)
    rise = np.pi**2 / period * length**2 * (q**2 / (k + 1)).sum(axis=1)
    at_ends = np.abs(np.stack([q @ (-1.0) ** k, q.sum(axis=1)])).mean(axis=0)
    return Cracks(contact, t, b, length, strength, at_ends * np.sqrt(0.5 * length), volume, lift, rise), found


def are_thin(negative: Records, thinness: float) -> Flags:
    """Return which intervals of tension on contacts, in order, give a gap that is thin relative to its distances."""
    t, reach = 0.5 * (negative["start"] + negative["end"]), 0.5 * np.sqrt(2.0) * (negative["end"] - negative["start"])
    same = negative["segment"][1:] == negative["segment"][:-1]
    apart = np.where(same, negative["start"][1:] - negative["end"][:-1], np.inf)
    nearest = np.minimum(np.minimum(np.append(np.inf, apart), np.append(apart, np.inf)), 1 - np.abs(t))
    return np.asarray(reach < thinness * nearest)[: negative.size]


def with_cracks(
    state: ContactState, series: CosineSeries, punches: Punches, tangent: Forces, tensions: Records, residual: Array
) -> tuple[ContactState, Records]:
    """Return a state with the thin gaps in its intervals of tension, and the other intervals.

    Intervals that the residual or undecayed coefficients may cause are uncertain and remain as well.
    """
    if tensions.size == 0:
        return state, tensions
    kind, period = state.kind, series.period
    tail = coefficient_tails(state.segments, state.coefficient)
    is_certain = kind.are_certain(tensions, tail, float(residual.max()), state.load)
    contacts = kind.contacts_of(state.segments.extent, period)
    contact, t, reach = kind.tensions(contacts, tensions[is_certain], period).T
    order = np.lexsort((t, contact))
    contact, t, reach = np.asarray(contact[order], np.int64), t[order], reach[order]
    fields = kind.pressures(state, series, punches, tangent)
    cracks, found = find_thin_gaps(*fields, contact, t, reach, contacts[2][contact], period)
    approach, resistance = state.approach - float(cracks.lift.sum()), state.resistance + float(cracks.rise.sum())
    remaining = np.concatenate([tensions[~is_certain], tensions[is_certain][order][~found]])
    return state._replace(cracks=cracks, approach=approach, resistance=resistance), remaining


@kernel
def densities_on_contacts(
    first_node: Indices, coefficient: Array, contact: Indices, t: NDArray[np.float64], singular: bool
) -> NDArray[np.float64]:
    """Evaluate sqrt(1-t^2) sum a_k U_k or, singular, sum b_k T_k/sqrt(1-t^2) on contacts."""
    value = np.empty(t.shape)
    for i in range(contact.size):
        a = coefficient[first_node[contact[i]] : first_node[contact[i] + 1]]
        for k in range(t.shape[1]):
            at = t[i, k]
            root = np.sqrt((1 - at) * (1 + at))
            if singular:
                value[i, k] = (evaluate_expansion(a, at) - at * evaluate_expansion(a[1:], at)) / root
            else:
                value[i, k] = evaluate_expansion(a, at) * root
    return value
