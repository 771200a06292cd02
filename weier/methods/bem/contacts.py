"""What the grid knows of each contact, and of each crest that may touch between its nodes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel

WIDE, NARROW, CREST = 0, 1, 2


class GridContacts(NamedTuple):
    """Contacts on the grid and crests between them, from left to right; each of shape (contacts,).

    kind : WIDE, NARROW if it has polynomials, or CREST if it is no contact on the grid but may be one
    run : of the grid that it is; that of its gap for a crest
    position : of the middle, in lambda_0
    force, share : on the grid, per period, and its rate per mean pressure
    self_compliance : displacement per force of its own on the grid, in g_0/p_0* per lambda_0
    edge_compliance, edge_resistance : what its lone edges add to compliance and resistance
    edge_drop, edge_yield : by how much one step of these lowers the resistance, and more force does, per force
    left, right : its edges by themselves, or those of narrow gaps beside it, in lambda_0
    closed_after : 1 where the gap after it is closed in the continuum
    origin, scale : of the variable s of the polynomials, in lambda_0
    limit : how far from the origin it may reach as long as its polynomials mean anything, in s
    centre, half_width : where the search for its edges begins, in s
    height, rate : polynomials of the surface as this contact sees it and of A q of the others, (contacts, TERMS)
    height_rest, rate_rest : two terms beyond these, as polynomials, shape (contacts, 2, TERMS + 2)
    grid_mixed, grid_energy, grid_cross : energies of its force with A q of the others, of its share with itself and
        twice with the others, and of its share with the others
    force_moments, share_moments : first and second moments of force and share about `position`, (contacts, 2)
    """

    kind: Indices
    run: Indices
    position: Array
    force: Array
    share: Array
    self_compliance: Array
    edge_compliance: Array
    edge_resistance: Array
    edge_drop: Array
    edge_yield: Array
    left: Array
    right: Array
    closed_after: Indices
    origin: Array
    scale: Array
    limit: Array
    centre: Array
    half_width: Array
    height: Array
    rate: Array
    height_rest: Array
    rate_rest: Array
    grid_mixed: Array
    grid_energy: Array
    grid_cross: Array
    force_moments: Array
    share_moments: Array


@kernel
def make_contacts(contacts: int, terms: int) -> GridContacts:
    """Room for so many."""
    number = np.zeros((18, contacts))
    integer = np.zeros((3, contacts), np.int64)
    return GridContacts(
        integer[0], integer[1], number[0], number[1], number[2], number[3], number[4], number[5], number[6],
        number[7], number[8], number[9], integer[2], number[10], number[11], number[12], number[13], number[14],
        np.zeros((contacts, terms)), np.zeros((contacts, terms)), np.zeros((contacts, 2, terms + 2)),
        np.zeros((contacts, 2, terms + 2)), number[15], number[16], number[17], np.zeros((contacts, 2)),
        np.zeros((contacts, 2)),
    )  # fmt: skip
