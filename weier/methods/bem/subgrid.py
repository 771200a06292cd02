"""Edges of contact between the nodes: what the continuum adds to a solution on a grid (docs/subgrid.md)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.contact_list import ContactList, list_contacts
from weier.methods.bem.contacts import CREST, NARROW, WIDE, GridContacts, make_contacts
from weier.methods.bem.edges import Edges
from weier.methods.bem.errors import EDGE_REST, REST, expected_errors
from weier.methods.bem.grid_solution import Continuum, GridSolution, next_node
from weier.methods.bem.grids import Grid
from weier.methods.bem.interaction import make_interaction
from weier.methods.bem.local_fit import (
    CREST_MARGIN,
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
from weier.methods.bem.lone_edges import Steps, correct_edge, find_steps
from weier.methods.bem.narrow_contacts import contact_edges, highest
from weier.methods.bem.narrow_gaps import correct_gap, is_dip
from weier.methods.bem.redistribution import add_grid_moments, redistribute

MAX_ROUNDS = 5  # of judging crests again


class Correction(NamedTuple):
    """What the continuum adds to a solution on the grid.

    verified : whether forces were found that are positive, and no crest stands above the plane but those that touch
    compliance, resistance : in g_0 and g_0/p_0*
    contacts : in the continuum
    compliance_error, resistance_error : estimates
    uncertain : whether a contact or a gap may be one too many or too few
    """

    verified: bool
    compliance: float
    resistance: float
    contacts: ContactList
    compliance_error: float
    resistance_error: float
    uncertain: bool


@kernel
def correct(solution: GridSolution, grid: Grid, edge: Edges, continuum: Continuum) -> Correction:
    """What the continuum adds to a converged solution, whose edges are `edge`.

    Crests that may touch are told by the plane on the grid at first. The corrected plane and pressure judge all
    crests again, until no more of them may touch.
    """
    points = solution.pressure.size
    crest, displacement = np.zeros(points, np.bool_), np.zeros(points)
    crests = find_crests(solution.plane, solution, displacement, crest)
    for _ in range(MAX_ROUNDS):
        correction = _correct_with(crest, crests, solution, grid, edge, continuum, displacement)
        new = find_crests(solution.plane - correction.compliance, solution, displacement, crest)
        if new == 0 or not correction.verified:
            return correction
        crests += new
    return _refuse(correction)


@kernel
def _refuse(correction: Correction) -> Correction:
    """The same as one that is not verified."""
    return Correction(
        False, correction.compliance, correction.resistance, correction.contacts, correction.compliance_error,
        correction.resistance_error, True,
    )  # fmt: skip


@kernel
def _correct_with(
    crest: Flags, crests: int, solution: GridSolution, grid: Grid, edge: Edges, continuum: Continuum,
    displacement: Array,
) -> Correction:  # fmt: skip
    """The correction with these crests, and the displacement of all nodes that goes with it."""
    runs = edge.size - 2
    points = solution.pressure.size
    owned = np.zeros(runs, np.bool_)  # edges that belong to a narrow contact or gap
    polynomial = narrow_runs(edge, solution.contact, continuum.narrow)
    contacts = make_contacts(runs // 2 + crests, TERMS)
    contact_of = np.zeros(runs, np.int64)  # of a gap, the one before it
    gap_edge = np.full((runs, 2), np.nan)  # of a gap with a polynomial, in lambda_0
    gap_adds = np.zeros((runs, 2))  # to compliance and resistance
    errors = np.zeros(2)
    uncertain = False
    used = 0
    for run in range(runs):
        start, nodes = edge[run + 1] % points, edge[run + 2] - edge[run + 1]
        if solution.contact[start]:
            contact_of[run] = used
            polynomial[run] = add_contact(
                start, nodes, polynomial[run], edge, run, solution, continuum, contacts, used
            )
            used += 1
        else:
            used = add_crests(start, nodes, run, crest, solution, continuum, contacts, used)
            if polynomial[run]:
                gap = correct_gap(start, nodes, margin_of(edge, run), REST, solution, grid, continuum)
                polynomial[run] = gap.left <= gap.right
                gap_edge[run] = gap.left, gap.right
                gap_adds[run] = gap.compliance, gap.resistance
                errors[0] += gap.compliance_error
                errors[1] += gap.resistance_error
                uncertain |= gap.uncertain
        if polynomial[run]:
            owned[run] = owned[(run + 1) % runs] = True
    steps = find_steps(solution, edge, continuum.period)
    for run in range(runs):
        if not solution.contact[edge[run + 1] % points]:
            contact_of[run] = contact_of[run - 1]
            for side in (
                run - 1,
                (run + 1) % runs,
            ):  # what a gap adds belongs to the contacts beside it, half to each
                contacts.edge_compliance[contact_of[side]] += gap_adds[run, 0] / 2
                contacts.edge_resistance[contact_of[side]] += gap_adds[run, 1] / 2
    for run in range(runs):
        place_edge(run, edge, owned[run], steps, gap_edge, contact_of, solution, continuum, contacts)
    added, faster, opened, settled, doubtful = open_gaps(
        contacts, contact_of, edge, errors, solution, grid, continuum
    )
    interaction = make_interaction(contacts, used, grid, continuum)
    forces = redistribute(contacts, used, solution.plane, solution.rate, continuum.period, interaction)
    for node in range(points):
        displacement[node] = interaction.displacement[node]
    verified = forces.found and settled
    for at in range(used):
        beyond = abs(forces.centre[at]) + forces.half_width[at] > contacts.limit[at]
        verified &= not (contacts.kind[at] != WIDE and forces.touching[at] and beyond)
    error, rate_error, unsure, judged = expected_errors(
        solution, edge, steps, polynomial, contacts, used, forces, continuum.angle, continuum.period
    )
    listed = list_contacts(contacts, used, forces, opened, solution, continuum.period)
    return Correction(
        verified and judged, added + forces.compliance, faster + forces.resistance,
        listed, errors[0] + error, errors[1] + rate_error, uncertain or doubtful or unsure,
    )  # fmt: skip


@kernel
def open_gaps(
    contacts: GridContacts, contact_of: Indices, edge: Edges, errors: Array, solution: GridSolution, grid: Grid,
    continuum: Continuum,
) -> tuple[float, float, Array, bool, bool]:  # fmt: skip
    """Add what gaps between two nodes add to the contacts that they divide, and their errors.

    Returns what they add where all nodes touch, edges of the open ones, shape (gaps, 2), whether all were found, and
    whether one may be open or closed.
    """
    compliance = resistance = 0.0
    found, uncertain = True, False
    runs, run = edge.size - 2, -1
    opened, count = np.empty((8, 2)), 0
    for node in range(solution.pressure.size):
        while run + 1 < runs and edge[run + 2] <= node:
            run += 1
        if not is_dip(node, solution):
            continue
        margin = side_margin(node, solution.contact)
        factor = REST if margin == CREST_MARGIN else EDGE_REST
        gap = correct_gap(node, 1, margin, factor, solution, grid, continuum)
        if not gap.left <= gap.right:
            found = False
            continue
        uncertain |= gap.uncertain
        if gap.left < gap.right:
            if count == opened.shape[0]:
                opened = np.concatenate((opened, np.empty((count, 2))))
            opened[count] = gap.left, gap.right
            count += 1
        errors[0] += gap.compliance_error
        errors[1] += gap.resistance_error
        if runs > 0:
            contacts.edge_compliance[contact_of[run]] += gap.compliance
            contacts.edge_resistance[contact_of[run]] += gap.resistance
        else:
            compliance += gap.compliance
            resistance += gap.resistance
    return compliance, resistance, opened[:count], found, uncertain


@kernel
def narrow_runs(edge: Edges, contact: Flags, most: int) -> Flags:
    """Contacts and gaps to be given polynomials: from the narrowest on, those that share no edge with others."""
    runs = edge.size - 2
    nodes = np.empty(runs, np.int64)
    for run in range(runs):
        nodes[run] = 2 * (edge[run + 2] - edge[run + 1]) + (0 if contact[edge[run + 1] % contact.size] else 1)
    chosen = np.zeros(runs, np.bool_)
    taken = np.zeros(runs, np.bool_)
    for run in np.argsort(nodes, kind="mergesort"):
        after = (run + 1) % runs
        if nodes[run] // 2 <= most and not (taken[run] or taken[after]):
            chosen[run] = taken[run] = taken[after] = True
    return chosen


@kernel
def add_contact(
    start: int, nodes: int, polynomial: bool, edge: Edges, run: int,
    solution: GridSolution, continuum: Continuum, contacts: GridContacts, at: int,
) -> bool:  # fmt: skip
    """Enter a contact; whether it has a polynomial, as it should if `polynomial`."""
    points = solution.pressure.size
    spacing = continuum.period / points
    force = np.empty(nodes)
    share = np.empty(nodes)
    for i in range(nodes):
        force[i] = solution.pressure[(start + i) % points] * spacing
        share[i] = solution.per_load[(start + i) % points] * spacing
    half_width = ((nodes - 1) / 2 + EDGE) * spacing
    contacts.kind[at], contacts.run[at] = WIDE, run
    contacts.position[at] = (start + (nodes - 1) / 2) * spacing
    contacts.force[at] = force.sum()
    contacts.share[at] = share.sum()
    contacts.self_compliance[at] = -2 * np.log(np.sin(min(np.pi * half_width / continuum.period, np.pi / 2)))
    margin = margin_of(edge, run)
    if not polynomial or nodes + 2 * margin < MIN_POLYNOMIAL or not contacts.share[at] > 0:
        return False
    whole = nodes + 2 * margin
    offset, scale = continuum.windows.offset[whole], scale_of(whole)
    seen = np.empty((2, continuum.windows.fitted[whole]))  # z as this contact sees it, and A q of the others
    for i in range(seen.shape[1]):
        node = (start - margin + offset[i]) % points
        seen[0, i], seen[1, i] = solution.deformed[node], solution.displacement[node]
        for j in range(nodes):
            influence = continuum.influence[abs(offset[i] - margin - j)]
            seen[0, i] += influence * force[j]
            seen[1, i] -= influence * share[j]
    fitted = fit_window(continuum.windows, whole, seen)
    height, rate = fitted[0], fitted[1]
    centre, width, found = contact_edges(height, contacts.force[at], 0.0, ((nodes - 1) / 2 + EDGE) / scale)
    limit = ((nodes - 1) / 2 + MAX_BEYOND) / scale
    if not found or abs(centre) + width > limit:
        return False
    mixed = energy = own = 0.0  # of the grid: with the rate of the others at its own nodes, and of its own
    for i in range(nodes):
        others = displacement = solution.displacement[(start + i) % points]
        for j in range(nodes):
            others -= continuum.influence[abs(i - j)] * share[j]
        mixed += force[i] * others
        energy += share[i] * others
        own += share[i] * (displacement - others)
    smoothing = added_by_triangles(rate, nodes, scale)
    contacts.kind[at], contacts.limit[at] = NARROW, limit
    contacts.origin[at] = contacts.position[at]
    enter_polynomials(fitted, whole, centre, width, continuum, spacing, contacts, at)
    contacts.self_compliance[at] = own / contacts.share[at] ** 2
    for i in range(nodes):
        x = (i - (nodes - 1) / 2) * spacing
        add_grid_moments(force[i], x, spacing, contacts.force_moments[at])
        add_grid_moments(share[i], x, spacing, contacts.share_moments[at])
    contacts.grid_mixed[at] = mixed + np.sum(force * smoothing)
    contacts.grid_energy[at] = own + 2 * energy + np.sum(share * smoothing)
    contacts.grid_cross[at] = energy + np.sum(share * smoothing) / 2
    return True


@kernel
def enter_polynomials(
    fitted: Array, whole: int, centre: float, half_width: float, continuum: Continuum, spacing: float,
    contacts: GridContacts, at: int,
) -> None:  # fmt: skip
    """Enter what was fitted in the window of a contact: heights, rates of others, and the next two terms of each."""
    scale, degree, following = scale_of(whole), continuum.windows.degree[whole], continuum.windows.following[whole]
    contacts.scale[at] = scale * spacing
    contacts.centre[at], contacts.half_width[at] = centre, half_width
    contacts.height[at], contacts.rate[at] = fitted[0], fitted[1]
    contacts.height_rest[at] = remainder(fitted[0], following, degree, scale * continuum.angle)
    contacts.rate_rest[at] = remainder(fitted[1], following, degree, scale * continuum.angle)


@kernel
def place_edge(
    run: int, edge: Edges, owned: bool, steps: Steps, gap_edge: Array, contact_of: Indices, solution: GridSolution,
    continuum: Continuum, contacts: GridContacts,
) -> None:  # fmt: skip
    """Place the edge at which a run begins: at that of a narrow gap, or by itself if no narrow run has it."""
    points, node = solution.pressure.size, edge[run + 1]
    begins = solution.contact[node % points]  # a contact begins here
    which = contact_of[run]
    gap = run - 1 if begins else run
    position = gap_edge[gap, 1] if begins else gap_edge[gap, 0]
    if not owned:
        nodes = min(edge[run + 2] - node, node - edge[run])
        compliance, resistance = correct_edge(steps, run, nodes, float(np.mean(solution.pressure)))
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
    start: int, nodes: int, run: int, crest: Flags, solution: GridSolution, continuum: Continuum,
    contacts: GridContacts, used: int,
) -> int:  # fmt: skip
    """Enter the marked crests of a gap; the contacts then used."""
    points = solution.pressure.size
    spacing = continuum.period / points
    for i in range(nodes):
        node = (start + i) % points
        if not crest[node]:
            continue
        margin = side_margin(node, solution.contact)
        whole = 1 + 2 * margin
        scale = scale_of(whole)
        seen = np.empty((2, whole))
        for j in range(whole):
            near = (node - margin + j) % points
            seen[0, j], seen[1, j] = (solution.deformed[near], solution.displacement[near])
        fitted = fit_window(continuum.windows, whole, seen)
        top = highest(fitted[0], 0.0, 1 / scale)
        contacts.kind[used], contacts.run[used] = CREST, run
        contacts.position[used] = (node + top * scale) * spacing
        contacts.origin[used] = node * spacing
        contacts.limit[used] = 1.0
        enter_polynomials(fitted, whole, top, 0.0, continuum, spacing, contacts, used)
        used += 1
    return used
