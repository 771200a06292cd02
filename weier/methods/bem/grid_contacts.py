"""Contacts on the grid, and crests that may touch between its nodes: what the correction knows of each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel

WIDE, NARROW, BIRTH = 0, 1, 2


class Contacts(NamedTuple):
    """Contacts on the grid, and crests that may touch between nodes, by position; each of shape (contacts,).

    kind : WIDE, NARROW or BIRTH
    position, reach : of the centre, and half width, in lambda_0
    force, share : on the grid, per period, and of it per mean pressure
    uneven : by how much farther it is displaced per mean pressure than the rate: the rest of an unfinished solution
    self_compliance : displacement per force of its own on the grid, in g_0/p_0* per lambda_0
    edge_compliance, edge_resistance : what its edges add, if they stand alone
    edge_drop, edge_yield : by how much one step of these lowers the resistance, and more force, per force
    run : of the grid that it is; that of its gap for a crest
    limit : in s, from the origin, how far it may reach as long as its polynomials mean anything
    lost : whether no contact under its polynomials carries its force; found by `redistribute`
    joined : whether the gap after it is closed in the continuum
    left, right : edges, in lambda_0; found by `redistribute` for those with a polynomial
    touching, change : whether it touches in the continuum, and with how much more force; found by `redistribute`
    origin : of the polynomials, in lambda_0
    scale : length of one s of the polynomials, in lambda_0
    centre, half_width : in s; where the search for the edges begins
    height, rate : polynomials of the surface as this contact sees it and of A q of the others, (contacts, TERMS)
    grid_mixed, grid_energy : energies of `contact_energy` on the grid
    grid_cross : of the rates of others alone, with this contact's share
    grid_force_moments, grid_share_moments : first to third moments of force and share on the grid, about `position`,
        shape (contacts, 3)
    height_rest, rate_rest : what the polynomials leave of two terms beyond them, shape (contacts, 2, terms + 2)
    pressed : displacement of it by what others carry more than on the grid, or elsewhere; found by `redistribute`
    share_change, tilt : of each share, and of the surface by `Effects`; found by `redistribute`
    off, rate_off : sizes of what else higher moments change of compliance and resistance; found by `redistribute`
    penetration, closing : of each crest that is narrow or new, by how much it stands above the plane that it does not
        touch, in g_0, and the rate of that per mean pressure; found by `redistribute`
    """

    kind: Indices
    position: Array
    reach: Array
    force: Array
    share: Array
    uneven: Array
    self_compliance: Array
    edge_compliance: Array
    edge_resistance: Array
    edge_drop: Array
    edge_yield: Array
    run: Indices
    limit: Array
    lost: Flags
    joined: Flags
    left: Array
    right: Array
    touching: Flags
    change: Array
    origin: Array
    scale: Array
    centre: Array
    half_width: Array
    height: Array
    rate: Array
    grid_mixed: Array
    grid_energy: Array
    grid_cross: Array
    grid_force_moments: Array
    grid_share_moments: Array
    height_rest: Array
    rate_rest: Array
    share_change: Array
    tilt: Array
    off: Array
    rate_off: Array
    pressed: Array
    penetration: Array
    closing: Array


@kernel
def make_contacts(contacts: int, terms: int) -> Contacts:
    """Room for so many."""
    return Contacts(
        np.zeros(contacts, np.int64), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts),
        np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts),
        np.zeros(contacts), np.zeros(contacts), np.zeros(contacts, np.int64), np.zeros(contacts),
        np.zeros(contacts, np.bool_),
        np.zeros(contacts, np.bool_), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts, np.bool_),
        np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts),
        np.zeros((contacts, terms)), np.zeros((contacts, terms)), np.zeros(contacts), np.zeros(contacts),
        np.zeros(contacts), np.zeros((contacts, 3)), np.zeros((contacts, 3)),
        np.zeros((contacts, 2, terms + 2)), np.zeros((contacts, 2, terms + 2)), np.zeros(contacts),
        np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts),
        np.zeros(contacts),
    )  # fmt: skip
