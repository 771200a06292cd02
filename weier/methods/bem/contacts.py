"""What the grid knows of each contact, and of each crest that may touch between its nodes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.edges import Steps, correct_edge
from weier.methods.bem.grid_solution import Continuum, GridSolution, next_node
from weier.methods.bem.grids import copy_values
from weier.methods.bem.interaction import add_grid_moments
from weier.methods.bem.local_fit import (
    EDGE,
    MAX_BEYOND,
    MIN_POLYNOMIAL,
    TERMS,
    added_by_triangles,
    fit_window,
    margin_of,
    remainder,
    scale_of,
    side_margin,
)
from weier.methods.bem.narrow_contacts import contact_edges, highest
from weier.methods.bem.narrow_gaps import Gaps

WIDE, NARROW, CREST = 0, 1, 2


class GridContacts(NamedTuple):
    """Contacts on the grid and crests between them, from left to right; each of shape (contacts,).

    kind : WIDE, NARROW if it has polynomials, or CREST if it is no contact on the grid but may be one
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
    grid_mixed, grid_cross : energies of its force, and of its share, with A q of the others
    force_moments, share_moments : first to third moments of force and share about `position`, (contacts, 3)
    """

    kind: Indices
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
    grid_cross: Array
    force_moments: Array
    share_moments: Array


@kernel
def _numbers(count: int) -> Array:
    """Zeros; calling this is compiled faster than np.zeros is."""
    return np.zeros(count)


@kernel
def _polynomials(count: int) -> Array:
    """Zeros, of a polynomial each."""
    return np.zeros((count, TERMS))


@kernel
def make_contacts(count: int) -> GridContacts:
    """Room for so many."""
    return GridContacts(
        kind=np.zeros(count, np.int64),
        position=_numbers(count),
        force=_numbers(count),
        share=_numbers(count),
        self_compliance=_numbers(count),
        edge_compliance=_numbers(count),
        edge_resistance=_numbers(count),
        edge_drop=_numbers(count),
        edge_yield=_numbers(count),
        left=_numbers(count),
        right=_numbers(count),
        closed_after=np.zeros(count, np.int64),
        origin=_numbers(count),
        scale=_numbers(count),
        limit=_numbers(count),
        centre=_numbers(count),
        half_width=_numbers(count),
        height=_polynomials(count),
        rate=_polynomials(count),
        height_rest=np.zeros((count, 2, TERMS + 2)),
        rate_rest=np.zeros((count, 2, TERMS + 2)),
        grid_mixed=_numbers(count),
        grid_cross=_numbers(count),
        force_moments=np.zeros((count, 3)),
        share_moments=np.zeros((count, 3)),
    )


@kernel
def find_contacts(
    crest: Flags, crests: int, gaps: Gaps, steps: Steps, solution: GridSolution, continuum: Continuum
) -> tuple[GridContacts, Flags]:
    """All contacts and the marked crests, and which contacts and gaps have polynomials."""
    edge, points = solution.edge, solution.pressure.size
    runs = edge.size - 2
    polynomial = gaps.polynomial.copy()
    contacts = make_contacts(runs // 2 + crests)
    contact_of = np.zeros(runs, np.int64)  # of a gap, the one before it
    used = 0
    for run in range(runs):
        start, nodes = edge[run + 1] % points, edge[run + 2] - edge[run + 1]
        if solution.contact[start]:
            contact_of[run] = used
            polynomial[run] = add_contact(run, polynomial[run], solution, continuum, contacts, used)
            used += 1
        else:
            used = add_crests(start, nodes, crest, solution, continuum, contacts, used)
    for run in range(runs):
        before = after = run  # of gaps between its nodes; what a narrow gap adds belongs half to each side of it
        if not solution.contact[edge[run + 1] % points]:
            contact_of[run] = contact_of[run - 1]
            before, after = run - 1, (run + 1) % runs
        for beside in (contact_of[before], contact_of[after]):
            contacts.edge_compliance[beside] += gaps.adds[run, 0] / 2
            contacts.edge_resistance[beside] += gaps.adds[run, 1] / 2
    for run in range(runs):
        alone = not (polynomial[run] or polynomial[run - 1])  # else its edge belongs to a narrow contact or gap
        place_edge(run, alone, steps, gaps.edge, contact_of[run], solution, continuum, contacts)
    return contacts, polynomial


@kernel
def add_contact(
    run: int, polynomial: bool, solution: GridSolution, continuum: Continuum, contacts: GridContacts, at: int
) -> bool:
    """Enter a contact; whether it has a polynomial, as it should if `polynomial`."""
    edge, points = solution.edge, solution.pressure.size
    start, nodes = edge[run + 1] % points, edge[run + 2] - edge[run + 1]
    spacing = continuum.period / points
    force = np.empty(nodes)
    share = np.empty(nodes)
    for i in range(nodes):
        force[i] = solution.pressure[(start + i) % points] * spacing
        share[i] = solution.per_load[(start + i) % points] * spacing
    half_width = ((nodes - 1) / 2 + EDGE) * spacing
    contacts.kind[at] = WIDE
    contacts.position[at] = (start + (nodes - 1) / 2) * spacing
    contacts.force[at] = force.sum()
    contacts.share[at] = share.sum()
    contacts.self_compliance[at] = -2 * np.log(np.sin(min(np.pi * half_width / continuum.period, np.pi / 2)))
    margin = margin_of(edge, run)
    if not polynomial or nodes + 2 * margin < MIN_POLYNOMIAL or not contacts.share[at] > 0:
        return False
    scale = enter_polynomials(start, margin, force, share, solution, continuum, contacts, at)
    reach, limit = ((nodes - 1) / 2 + EDGE) / scale, ((nodes - 1) / 2 + MAX_BEYOND) / scale
    centre, width, found = contact_edges(contacts.height[at], contacts.force[at], 0.0, reach)
    if not found or abs(centre) + width > limit:
        return False
    contacts.kind[at], contacts.limit[at] = NARROW, limit
    contacts.centre[at], contacts.half_width[at] = centre, width
    contacts.position[at] += centre * scale * spacing
    smoothing, own = added_by_triangles(contacts.rate[at], nodes, scale), 0.0
    for i in range(nodes):
        others = displacement = solution.displacement[(start + i) % points]
        for j in range(nodes):
            others -= continuum.influence[abs(i - j)] * share[j]
        own += share[i] * (displacement - others)
        contacts.grid_mixed[at] += force[i] * (others + smoothing[i])
        contacts.grid_cross[at] += share[i] * (others + smoothing[i] / 2)
        x = (i - (nodes - 1) / 2 - centre * scale) * spacing
        add_grid_moments(force[i], x, spacing, contacts.force_moments[at])
        add_grid_moments(share[i], x, spacing, contacts.share_moments[at])
    contacts.self_compliance[at] = own / contacts.share[at] ** 2
    return True


@kernel
def enter_polynomials(
    start: int, margin: int, force: Array, share: Array, solution: GridSolution, continuum: Continuum,
    contacts: GridContacts, at: int,
) -> float:  # fmt: skip
    """Fit the surface as a contact with these nodal forces sees it, and A q of the others; the nodes in one s.

    The fit is to the nodes of the contact, which begins at `start`, and some more at both ends. The next two terms of
    each polynomial are entered, too.
    """
    nodes, points, windows = force.size, solution.pressure.size, continuum.windows
    window = nodes + 2 * margin
    offset, scale, following = windows.offset[window], scale_of(window), windows.following[window]
    values = np.empty((2, windows.fitted[window]))
    for i in range(values.shape[1]):
        node = (start - margin + offset[i]) % points
        values[0, i], values[1, i] = solution.deformed[node], solution.displacement[node]
        for j in range(nodes):
            influence = continuum.influence[abs(offset[i] - margin - j)]
            values[0, i] += influence * force[j]
            values[1, i] -= influence * share[j]
    fitted, degree, ratio = fit_window(windows, window, values), windows.degree[window], scale * continuum.angle
    copy_values(fitted[0], contacts.height[at])
    copy_values(fitted[1], contacts.rate[at])
    remainder(fitted[0], following, degree, ratio, contacts.height_rest[at])
    remainder(fitted[1], following, degree, ratio, contacts.rate_rest[at])
    contacts.origin[at] = (start + (nodes - 1) / 2) * continuum.period / points
    contacts.scale[at] = scale * continuum.period / points
    return scale


@kernel
def place_edge(
    run: int, alone: bool, steps: Steps, gap_edge: Array, which: int, solution: GridSolution, continuum: Continuum,
    contacts: GridContacts,
) -> None:  # fmt: skip
    """Place the edge at which a run begins: at that of a narrow gap, or by itself if no narrow run has it."""
    points, node = solution.pressure.size, solution.edge[run + 1]
    begins = solution.contact[node % points]  # a contact begins here
    gap = run - 1 if begins else run
    position = gap_edge[gap, 1] if begins else gap_edge[gap, 0]
    if alone:
        compliance, resistance = correct_edge(steps, run)
        contacts.edge_compliance[which] += compliance
        contacts.edge_resistance[which] += resistance
        contacts.edge_drop[which] += steps.drop[run]
        if steps.load[run] > 0:
            contacts.edge_yield[which] += steps.drop[run] / (steps.load[run] * contacts.share[which])
        beyond = steps.place[run] + EDGE
        position = (node - beyond if begins else node - 1 + beyond) * continuum.period / points
    elif run == 0 and begins:  # the gap before it ends in the next period
        position -= continuum.period
    if run == 0 and not begins:  # the contact before it ends there
        position += continuum.period
    if begins:
        contacts.left[which] = position
    else:
        contacts.right[which] = position
        contacts.closed_after[which] = int(gap_edge[run, 0] == gap_edge[run, 1])


@kernel
def find_crests(plane: float, solution: GridSolution, displacement: Array, crest: Flags) -> int:
    """Mark the crests in the gaps that may touch between two nodes, and return how many are new.

    The node of such a crest is the highest of three, and no farther below the plane than they bend. The surface is
    displaced by so much more than on the grid.
    """
    points = crest.size
    new = 0
    for node in range(points):
        right = next_node(node, points)
        if solution.contact[node - 1] or solution.contact[node] or solution.contact[right]:
            continue
        before = solution.deformed[node - 1] - displacement[node - 1]
        here = solution.deformed[node] - displacement[node]
        after = solution.deformed[right] - displacement[right]
        if before <= here and after < here and plane - here < 2 * here - before - after:
            known = False
            for beside in range(-2, 3):
                known |= crest[(node + beside) % points]
            if not known:
                crest[node] = True
                new += 1
    return new


@kernel
def add_crests(
    start: int, nodes: int, crest: Flags, solution: GridSolution, continuum: Continuum, contacts: GridContacts,
    used: int,
) -> int:  # fmt: skip
    """Enter the marked crests of a gap; the contacts then used."""
    for i in range(nodes):
        node = (start + i) % crest.size
        if crest[node]:
            none, margin = np.zeros(1), side_margin(node, solution.contact)
            scale = enter_polynomials(node, margin, none, none, solution, continuum, contacts, used)
            top = highest(contacts.height[used], 1 / scale)
            contacts.kind[used], contacts.limit[used], contacts.centre[used] = CREST, 1.0, top
            contacts.position[used] = contacts.origin[used] + top * contacts.scale[used]
            used += 1
    return used
