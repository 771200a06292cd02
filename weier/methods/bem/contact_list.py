"""The contacts in the continuum, as a list: where they end, and what they carry."""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Record, Records, record_type
from weier.kernels.jit import kernel
from weier.methods.bem.contacts import WIDE
from weier.methods.bem.grid_solution import GridSolution

# A contact, with its left edge in [0, period):
#
# left, right : edges, in lambda_0
# force, share : force per length, in p_0* lambda_0, and its rate per mean pressure, in lambda_0
LISTED = record_type(("left right force share", np.float64, ()))


@kernel
def list_contacts(
    contacts: Records, corrected: Records, opened: Array, solution: GridSolution, period: float
) -> Records:
    """All that touch in the continuum, from left to right.

    Two between which a gap has closed are one; gaps between two nodes, `opened` from left to right, shape (gaps, 2),
    divide one.
    """
    used, listed = contacts.size, np.zeros(contacts.size + opened.shape[0], LISTED)
    count = first = 0
    while first < used and contacts[first - 1].closed_after:
        first += 1
    closed = False  # the gap before
    for i in range(used):
        contact, each = contacts[(first + i) % used], corrected[(first + i) % used]
        if each.touching:
            _enter(listed[count], contact, each)
            if closed:  # the one before goes on
                before, after = listed[count - 1], listed[count]
                before.right += after.right - after.left
                before.force += after.force
                before.share += after.share
            else:
                count += 1
        closed = contact.closed_after and count > 0
    for gap in opened:
        if count == 0:  # all nodes touch
            listed[0].left, listed[0].right = gap[1], gap[0] + period
            listed[0].force, listed[0].share = solution.pressure.mean() * period, period
            count = 1
        else:
            count = _divide(listed, count, gap, solution, period)
    ordered = np.zeros(count, LISTED)
    for at in range(count):  # nearly all are in order already
        turns = period * np.floor(listed[at].left / period)
        listed[at].left, listed[at].right = listed[at].left - turns, listed[at].right - turns
        to = at
        while to > 0 and ordered[to - 1].left > listed[at].left:
            ordered[to] = ordered[to - 1]
            to -= 1
        ordered[to] = listed[at]
    return ordered


@kernel
def _enter(entry: Record, contact: Record, each: Record) -> None:
    """Enter a contact that touches."""
    entry.left, entry.right = contact.left, max(contact.left, contact.right)
    if contact.kind != WIDE:
        middle, reach = contact.origin + each.centre * contact.scale, each.half_width * contact.scale
        entry.left, entry.right = middle - reach, middle + reach
    entry.force, entry.share = each.force, each.share


@kernel
def _divide(listed: Records, count: int, gap: Array, solution: GridSolution, period: float) -> int:
    """Divide the contact that a gap lies in, if there is one; its nodes tell who carries what. The contacts then."""
    for before in listed[:count]:
        turns = period * np.ceil((before.left - gap[0]) / period)
        left, right = gap[0] + turns, gap[1] + turns
        if right < before.right:
            force, share = _carried(before.left, left, solution, period)
            all_force, all_share = _carried(before.left, before.right, solution, period)
            after = listed[count]
            after.left, after.right, before.right = right, before.right, left
            after.force, after.share = before.force * (1 - force / all_force), before.share * (1 - share / all_share)
            before.force -= after.force
            before.share -= after.share
            return count + 1
    return count


@kernel
def _carried(left: float, right: float, solution: GridSolution, period: float) -> tuple[float, float]:
    """What the nodes between two places carry of force and share."""
    points = solution.pressure.size
    force = share = 0.0
    for node in range(int(np.ceil(left * points / period)), int(np.floor(right * points / period)) + 1):
        force += solution.pressure[node % points]
        share += solution.per_load[node % points]
    return force, share
