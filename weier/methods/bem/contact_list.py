"""The contacts in the continuum, as a list: where they end, and what they carry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods.bem.contacts import WIDE, GridContacts
from weier.methods.bem.grid_solution import GridSolution
from weier.methods.bem.redistribution import Redistribution


class ContactList(NamedTuple):
    """The contacts in one period from left to right, each array of shape (contacts,); empty in full contact.

    left, right : edges, in lambda_0, the left one in [0, period)
    force, share : force per length, in p_0* lambda_0, and its rate per mean pressure, in lambda_0
    """

    left: Array
    right: Array
    force: Array
    share: Array


@kernel
def list_contacts(
    contacts: GridContacts, forces: Redistribution, opened: Array, solution: GridSolution, period: float
) -> ContactList:
    """All that touch in the continuum.

    Two between which a gap has closed are one; gaps between two nodes, `opened` from left to right, shape (gaps, 2),
    divide one.
    """
    used = contacts.kind.size
    room = used + opened.shape[0]
    listed = ContactList(np.empty(room), np.empty(room), np.empty(room), np.empty(room))
    count = first = 0
    while first < used and contacts.closed_after[first - 1] > 0:
        first += 1
    closed = False  # the gap before
    for i in range(used):
        at = (first + i) % used
        if forces.touching[at]:
            _enter(listed, count, contacts, at, forces)
            if closed:
                _join(listed, count - 1, count)
            else:
                count += 1
        closed = contacts.closed_after[at] > 0 and count > 0
    for gap in range(opened.shape[0]):
        if count == 0:  # all nodes touch
            listed.left[0], listed.right[0] = opened[gap, 1], opened[gap, 0] + period
            listed.force[0], listed.share[0] = solution.pressure.mean() * period, period
            count = 1
        else:
            count = _divide(listed, count, opened[gap], solution, period)
    ordered = ContactList(np.empty(count), np.empty(count), np.empty(count), np.empty(count))
    for at in range(count):  # nearly all are in order already
        turns = period * np.floor(listed.left[at] / period)
        to = at
        while to > 0 and ordered.left[to - 1] > listed.left[at] - turns:
            for values in ordered:
                values[to] = values[to - 1]
            to -= 1
        ordered.left[to], ordered.right[to] = listed.left[at] - turns, listed.right[at] - turns
        ordered.force[to], ordered.share[to] = listed.force[at], listed.share[at]
    return ordered


@kernel
def _enter(listed: ContactList, count: int, contacts: GridContacts, at: int, forces: Redistribution) -> None:
    """Enter a contact that touches."""
    if contacts.kind[at] == WIDE:
        listed.left[count], listed.right[count] = contacts.left[at], max(contacts.left[at], contacts.right[at])
    else:
        middle = contacts.origin[at] + forces.centre[at] * contacts.scale[at]
        reach = forces.half_width[at] * contacts.scale[at]
        listed.left[count], listed.right[count] = middle - reach, middle + reach
    listed.force[count] = contacts.force[at] + forces.change[at]
    listed.share[count] = contacts.share[at] + forces.share_change[at]


@kernel
def _join(listed: ContactList, before: int, after: int) -> None:
    """Make one of two contacts, at the place of the first."""
    listed.right[before] += listed.right[after] - listed.left[after]
    listed.force[before] += listed.force[after]
    listed.share[before] += listed.share[after]


@kernel
def _divide(listed: ContactList, count: int, gap: Array, solution: GridSolution, period: float) -> int:
    """Divide the contact that a gap lies in, if there is one; its nodes tell who carries what. The contacts then."""
    for at in range(count):
        turns = period * np.ceil((listed.left[at] - gap[0]) / period)
        left, right = gap[0] + turns, gap[1] + turns
        if right < listed.right[at]:
            force, share = _carried(listed.left[at], left, solution, period)
            all_force, all_share = _carried(listed.left[at], listed.right[at], solution, period)
            listed.left[count], listed.right[count] = right, listed.right[at]
            listed.right[at] = left
            listed.force[count] = listed.force[at] * (1 - force / all_force)
            listed.share[count] = listed.share[at] * (1 - share / all_share)
            listed.force[at] -= listed.force[count]
            listed.share[at] -= listed.share[count]
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
