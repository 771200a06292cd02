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
# force : per length, in p_0* lambda_0
LISTED = record_type(("left right force", np.float64, ()))


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
            left, right = _edges(contact, each)
            if closed:  # the one before goes on
                listed[count - 1].right += right - left
                listed[count - 1].force += each.force
            else:
                listed[count].left, listed[count].right, listed[count].force = left, right, each.force
                count += 1
        closed = contact.closed_after and count > 0
    for gap in opened:
        if count == 0:  # all nodes touch
            listed[0].left, listed[0].right = gap[1], gap[0] + period
            listed[0].force, count = solution.pressure.mean() * period, 1
        else:
            count = _divide(listed, count, gap, solution, period)
    for each in listed[:count]:
        turns = period * np.floor(each.left / period)
        each.left, each.right = each.left - turns, each.right - turns
    return listed[np.argsort(listed["left"][:count])]


@kernel
def _edges(contact: Record, each: Record) -> tuple[float, float]:
    """Edges of a contact that touches."""
    if contact.kind == WIDE:
        return contact.left, max(contact.left, contact.right)
    middle, reach = contact.origin + each.centre * contact.scale, each.half_width * contact.scale
    return middle - reach, middle + reach


@kernel
def _divide(listed: Records, count: int, gap: Array, solution: GridSolution, period: float) -> int:
    """Divide the contact that a gap lies in, if there is one; its nodes tell who carries what. The contacts then."""
    for before in listed[:count]:
        turns = period * np.ceil((before.left - gap[0]) / period)
        left, right = gap[0] + turns, gap[1] + turns
        if right < before.right:
            carried = _carried(before.left, left, solution, period)
            all_carried = _carried(before.left, before.right, solution, period)
            after = listed[count]
            after.left, after.right, before.right = right, before.right, left
            after.force = before.force * (1 - carried / all_carried)
            before.force -= after.force
            return count + 1
    return count


@kernel
def _carried(left: float, right: float, solution: GridSolution, period: float) -> float:
    """The pressure that the nodes between two places carry together."""
    points, pressure = solution.pressure.size, 0.0
    for node in range(int(np.ceil(left * points / period)), int(np.floor(right * points / period)) + 1):
        pressure += solution.pressure[node % points]
    return pressure
