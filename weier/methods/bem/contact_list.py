"""The contacts in the continuum, as a list: where they end, and what they carry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.gaps import Dips
from weier.methods.bem.grid_contacts import Contacts
from weier.methods.bem.grid_solution import GridSolution


class ContactList(NamedTuple):
    """The contacts in one period from left to right, each array of shape (contacts,); empty in full contact.

    left, right : edges, in lambda_0, the left one in [0, period)
    force, share : force per length, in p_0* lambda_0, and its rate per mean pressure, in lambda_0
    uncertain : whether a contact or a gap may be one too many or too few: a birth or a closing gap is near
    """

    left: Array
    right: Array
    force: Array
    share: Array
    uncertain: bool


class ContactTable(NamedTuple):
    """The same for all loads, end to end in the order in which they were solved.

    first, number : where those of a load begin, and how many they are, shape (loads,)
    left, right, force, share : of each contact
    uncertain : shape (loads,)
    """

    first: Indices
    number: Indices
    left: Array
    right: Array
    force: Array
    share: Array
    uncertain: Flags


@kernel
def blank_list() -> ContactList:
    """A list of no contacts."""
    return ContactList(np.empty(0), np.empty(0), np.empty(0), np.empty(0), False)


@kernel
def blank_table(loads: int) -> ContactTable:
    """The same with nothing in it yet."""
    return ContactTable(
        np.zeros(loads, np.int64), np.zeros(loads, np.int64), np.empty(0), np.empty(0), np.empty(0), np.empty(0),
        np.zeros(loads, np.bool_),
    )  # fmt: skip


@kernel
def append_contacts(table: ContactTable, end: int, load: int, listed: ContactList) -> tuple[ContactTable, int]:
    """The table with the contacts of one load after those up to `end`, and their new end."""
    contacts = listed.left.size
    if end + contacts > table.left.size:
        room = 2 * table.left.size + contacts
        table = ContactTable(
            table.first, table.number, _lengthened(table.left, room), _lengthened(table.right, room),
            _lengthened(table.force, room), _lengthened(table.share, room), table.uncertain,
        )  # fmt: skip
    table.first[load], table.number[load], table.uncertain[load] = end, contacts, listed.uncertain
    here = slice(end, end + contacts)
    table.left[here], table.right[here] = listed.left, listed.right
    table.force[here], table.share[here] = listed.force, listed.share
    return table, end + contacts


@kernel
def _lengthened(values: Array, room: int) -> Array:
    longer = np.empty(room)
    longer[: values.size] = values
    return longer


@kernel
def list_contacts(
    contacts: Contacts, used: int, dips: Dips, solution: GridSolution, period: float, uncertain: bool
) -> ContactList:
    """All that touch in the continuum: those that gaps between two nodes divide, and those born between nodes."""
    gaps = np.flatnonzero(dips.left < dips.right)
    room = used + gaps.size
    for dip in range(dips.uncertain.size):
        uncertain |= dips.uncertain[dip]
    listed = ContactList(np.empty(room), np.empty(room), np.empty(room), np.empty(room), uncertain)
    count = 0
    if used == 0:
        count = _between_gaps(listed, dips, gaps, solution, period)
    joined = used > 0 and contacts.joined[used - 1]
    around = joined  # the last contact and the first are one
    for at in range(used):
        if contacts.touching[at]:
            first = count
            count = _divide(listed, count, contacts, at, dips, gaps, solution, period)
            if joined and first > 0:
                _join(listed, first - 1, first, count)
                count -= 1
        joined = contacts.joined[at]
    if around and count > 1:
        _join(listed, count - 1, 0, count)
        count -= 1
    order = np.argsort(listed.left[:count] - period * np.floor(listed.left[:count] / period))
    left = listed.left[order]
    turns = period * np.floor(left / period)
    return ContactList(
        left - turns, listed.right[order] - turns, listed.force[order], listed.share[order], listed.uncertain
    )


@kernel
def _join(listed: ContactList, before: int, after: int, count: int) -> None:
    """Make one of two contacts, at the place of the second, and move up those behind the first."""
    width = listed.right[before] - listed.left[before]
    listed.left[after] -= width
    listed.force[after] += listed.force[before]
    listed.share[after] += listed.share[before]
    for at in range(before, count - 1):
        listed.left[at], listed.right[at] = listed.left[at + 1], listed.right[at + 1]
        listed.force[at], listed.share[at] = listed.force[at + 1], listed.share[at + 1]


@kernel
def _between_gaps(listed: ContactList, dips: Dips, gaps: Indices, solution: GridSolution, period: float) -> int:
    """Where all nodes touch: the contacts between the gaps that stand between nodes."""
    for i in range(gaps.size):
        last = i + 1 == gaps.size
        right = dips.left[gaps[0]] + period if last else dips.left[gaps[i + 1]]
        _enter_part(listed, i, dips.right[gaps[i]], right, solution, period)
    return gaps.size


@kernel
def _divide(
    listed: ContactList, count: int, contacts: Contacts, at: int, dips: Dips, gaps: Indices, solution: GridSolution,
    period: float,
) -> int:  # fmt: skip
    """Enter one contact, or its parts between gaps that stand between two nodes; the contacts then entered."""
    begin, width = contacts.left[at], contacts.right[at] - contacts.left[at]
    width -= period * np.round(
        (width - 2 * contacts.reach[at]) / period
    )  # one edge may be counted in the next period
    end = begin + max(width, 0.0)
    first = count
    for turn in range(2):  # a contact may lie across the end of the period
        for gap in gaps:
            left, right = dips.left[gap] + turn * period, dips.right[gap] + turn * period
            if begin < left and right < end:
                _enter_part(listed, count, begin, left, solution, period)
                count += 1
                begin = right
    if count == first:
        listed.left[count], listed.right[count] = begin, end
        listed.force[count] = contacts.force[at] + contacts.change[at]
        listed.share[count] = contacts.share[at]
    else:
        _enter_part(listed, count, begin, end, solution, period)
    return count + 1


@kernel
def _enter_part(
    listed: ContactList, at: int, left: float, right: float, solution: GridSolution, period: float
) -> None:
    """Enter a part of a contact with what its nodes carry."""
    points = solution.pressure.size
    spacing = period / points
    listed.left[at], listed.right[at] = left, right
    listed.force[at] = listed.share[at] = 0.0
    for node in range(int(np.ceil(left / spacing)), int(np.floor(right / spacing)) + 1):
        listed.force[at] += solution.pressure[node % points] * spacing
        listed.share[at] += solution.per_load[node % points] * spacing
