"""How far the edges of punches must move for their pressure to vanish there: Newton's method, contact by contact.

Near an edge p = (k_0 + k_1 s)/sqrt(s) at the distance s within. An edge that moves out by 2 k_0/k_1 is free of the
singularity, to first order and whatever the others do: the Jacobian of k_0 in the edges is diagonal at the solution.
Far from it, two closed forms tell more. A contact much narrower than the gaps beside it is Hertz's, whose width
squared follows from psi exactly. And a gap much narrower than the contacts beside it, where the pressure would be a
parabola of tension, has p = |x| (K + kappa (x^2-b^2)/2)/sqrt(x^2-b^2), so that k_0 and k_1 at one edge tell the width
squared which it should have; no gap is left where that is negative.

The slope of a gap with given edges (dual) has the same form, and so have the rules: a narrow gap in a parabola of
tension is like Hertz's contact, and beside a narrow contact dw/dx = (K + kappa (x^2-b^2))/sqrt(x^2-b^2). Only the
signs differ, for the slope is negative where a gap closes on its right.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.patches.punches import Punches, chebyshev_rule, forces_of_expansion, regular_part

Sides = NDArray[np.float64]  # at the left and the right edge of each contact, shape (contacts, 2)

MIN_SQUARE, MAX_SQUARE = 0.02, 6.0  # of a width, in one step, over its square so far
MAX_CONTACT_SHIFT, MAX_GAP_SHIFT = 1.4, 0.7  # in half-widths
BLIND_GROWTH = 0.5  # of a half-width where psi tells no curvature
MAX_PREDICTED_MOVE = 0.3  # in half-widths, up to which the pressure is carried along


class EdgeMoves(NamedTuple):
    """One step of Newton's method.

    outward : how far each edge moves out of its contact, in lambda_0, shape (contacts, 2)
    closing : whether the gap on the right of each contact has nothing to hold it open, shape (contacts,)
    largest : move of any edge over the half-width of its contact or of its gap, the narrower one
    """

    outward: Sides
    closing: Flags
    largest: float


def singular_parts(punches: Punches, b: Array) -> Sides:
    """psi(-1) and psi(1) of each contact, in p_0*."""
    return _end_sums(punches, b)


def distances(left: Array, right: Array, period: float) -> Array:
    """From each right edge to the next left one, round the period."""
    after = np.concatenate([left[1:], left[:1] + period])
    return after - right


def edge_moves(punches: Punches, b: Array, a: Array) -> EdgeMoves:
    """The moves from the coefficients of psi in T_k and of its regular part in U_k."""
    r, outward_sign = punches.half_width, np.array([1.0, -1.0 if punches.dual else 1.0])
    psi = outward_sign * singular_parts(punches, b)
    gap = distances(punches.centre - r, punches.centre + r, punches.period)
    phi = outward_sign * _end_sums(punches, a * (punches.degree + 1))
    inward_fall = -outward_sign * _end_sums(punches, b * punches.degree**2)
    by_contact = _moves_by_contact(r, psi, phi)
    by_gap, closing, gap_is_narrow = _moves_by_gap(r, gap, psi, inward_fall, 0.25 if punches.dual else -0.75)
    outward = np.where(gap_is_narrow, by_gap, by_contact)
    room = np.minimum(r, 0.5 * np.minimum(gap, np.roll(gap, 1)))
    return EdgeMoves(outward, closing, float(np.max(np.abs(outward) / room[:, None])))


def _end_sums(punches: Punches, coefficient: Array) -> Sides:
    """The sums over k of the coefficients of each contact, at -1 with the sign (-1)^k."""
    first, signed = punches.first_node[:-1], np.where(punches.degree % 2 == 0, coefficient, -coefficient)
    return np.stack([np.add.reduceat(signed, first), np.add.reduceat(coefficient, first)], axis=1)


def _moves_by_contact(r: Array, psi: Sides, phi: Sides) -> Sides:
    """Outward moves by Hertz's contact: (r + dr)^2 = r^2 + 2 r dr with dr the mean of both edges' moves."""
    safe = np.where(phi > 0, phi, 1.0)
    x = np.where(phi > 0, psi / safe, BLIND_GROWTH * np.sign(psi))
    growth = _growth_of_square(0.5 * (x[:, 0] + x[:, 1]))
    shift = np.clip(0.5 * (x[:, 1] - x[:, 0]), -MAX_CONTACT_SHIFT, MAX_CONTACT_SHIFT)
    return np.stack([growth - shift, growth + shift], axis=1) * r[:, None]


def _growth_of_square(linear: Array) -> Array:
    """The growth of a width, over itself, whose square grows by twice the linear growth."""
    return np.asarray(np.sqrt(np.clip(1 + 2 * linear, MIN_SQUARE, MAX_SQUARE)) - 1)


def _moves_by_gap(
    r: Array, gap: Array, psi: Sides, inward_fall: Sides, share_of_k_0: float
) -> tuple[Sides, Flags, NDArray[np.bool_]]:
    """Outward moves by the gaps beside; which right gaps close; and at which edges the gap is the narrower.

    For gaps between contacts kappa b^2 is in proportion to b k_1 - 3 k_0/4, and for contacts between gaps (dual) to
    b k_1 + k_0/4, with b the half-width of what lies between.
    """
    width = np.stack([np.roll(gap, 1), gap], axis=1) / 2
    k_0, k_1 = psi * np.sqrt(r / 2)[:, None], (inward_fall + psi / 4) * np.sqrt(0.5 / r)[:, None]
    curvature = width * k_1 + share_of_k_0 * k_0
    safe = np.where(curvature > 0, curvature, 1.0)
    growth = np.where(curvature > 0, -2 * k_0 / safe, np.where(k_0 > 0, -1.0, 1.0))
    left, right = growth[:, 1], np.roll(growth[:, 0], -1)  # of the gap on the right, from both of its ends
    narrow = np.stack([gap < 2 * r, gap < 2 * np.roll(r, -1)], axis=1)  # than the contact at either end
    both = narrow.all(axis=1)
    linear = np.where(both, 0.5 * (left + right), np.where(narrow[:, 0], left, right))
    closing = narrow.any(axis=1) & (1 + 2 * linear < 0)
    shift = np.where(both, np.clip(0.5 * (right - left), -MAX_GAP_SHIFT, MAX_GAP_SHIFT), 0.0)
    widening = _growth_of_square(linear)
    outward_right, outward_left_of_next = -0.5 * gap * (widening - shift), -0.5 * gap * (widening + shift)
    at_edges = np.stack([np.roll(narrow[:, 1], 1), narrow[:, 0]], axis=1)
    return np.stack([np.roll(outward_left_of_next, 1), outward_right], axis=1), closing, at_edges


def moved_expansion(punches: Punches, b: Array, centre: Array, half_width: Array) -> Array:
    """Coefficients of psi when the segments have moved: to second order the solution, if Newton's step moved them.

    With w = (dc + t dr)/r, psi + w [(1-t^2) phi' - t phi].
    """
    a, moved = regular_part(punches.first_node, b), np.empty(b.size)
    r = punches.half_width
    for group in punches.groups:
        contact, node, count = group.contact, group.node, group.rule.node.size
        rule = chebyshev_rule(count, False)
        t = rule.node
        k = np.arange(1, count)[:, None]
        bracket = -k * rule.polynomial[1:]  # (1-t^2) U_k' - t U_k = -(k+1) T_(k+1)
        shift, growth = (centre - punches.centre)[contact, None], (half_width - r)[contact, None]
        w = np.clip((shift + t * growth) / r[contact, None], -MAX_PREDICTED_MOVE, MAX_PREDICTED_MOVE)
        psi = b[node] @ rule.polynomial + w * (a[node[:, :-1]] @ bracket)
        moved[node] = psi @ rule.polynomial.T * (2 / count)
        moved[node[:, 0]] *= 0.5
    return moved


def transfer_forces(punches: Punches, b: Array, origin: Indices, half_width: Array, node_count: Indices) -> Array:
    """The forces on other segments, each of which is the old one `origin`, or new where that is -1: then 0."""
    first = np.concatenate([[0], np.cumsum(node_count)])
    force, kept = np.zeros(first[-1]), np.flatnonzero(origin >= 0)
    counts = np.stack([punches.node_count[origin[kept]], node_count[kept]], axis=1)
    for old, new in np.unique(counts, axis=0):
        here = kept[(counts[:, 0] == old) & (counts[:, 1] == new)]
        rows = b[punches.first_node[origin[here]][:, None] + np.arange(old)]
        force[first[here][:, None] + np.arange(new)] = forces_of_expansion(
            rows, half_width[here], int(new), punches.dual
        )
    return force


@kernel
def sample_forces(
    centre: Array, half_width: Array, first_node: Indices, b: Array, period: float,
    new_centre: Array, new_half_width: Array, new_first_node: Indices, which: Indices, force: Array,
) -> None:  # fmt: skip
    """Fill in the forces on the contacts `which` from the pressure, less its tension, of the old contacts."""
    left = centre - half_width
    for j in which:
        count = new_first_node[j + 1] - new_first_node[j]
        for q in range(count):
            t = -np.cos((q + 0.5) * np.pi / count)
            x = new_centre[j] + new_half_width[j] * t
            x -= period * np.floor((x - left[0]) / period)
            i = np.searchsorted(left, x, side="right") - 1
            s = (x - centre[i]) / half_width[i]
            pressure = 0.0
            if abs(s) < 1:
                after, here = 0.0, 0.0
                for k in range(first_node[i + 1] - 1, first_node[i], -1):
                    here, after = b[k] + 2 * s * here - after, here
                pressure = max(b[first_node[i]] + s * here - after, 0.0) / np.sqrt((1 - s) * (1 + s))
            weight = np.pi / count * new_half_width[j] * np.sqrt((1 - t) * (1 + t))
            force[new_first_node[j] + q] = weight * pressure
