"""Edges of contact between the nodes: what the continuum adds to a solution on a grid (docs/subgrid.md)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.contact_list import ContactList, blank_list, list_contacts
from weier.methods.bem.continuum import Continuum
from weier.methods.bem.correction_error import expected_errors
from weier.methods.bem.edge_error import find_steps, next_order
from weier.methods.bem.edges import Edges
from weier.methods.bem.gaps import correct_gap, find_dips, open_gaps
from weier.methods.bem.grid_contacts import BIRTH, NARROW, WIDE, Contacts, make_contacts
from weier.methods.bem.grid_solution import GridSolution, next_node
from weier.methods.bem.grids import Grid
from weier.methods.bem.interaction import redistribute
from weier.methods.bem.moments import add_grid_moments
from weier.methods.bem.narrow_contacts import contact_edges, crest
from weier.methods.bem.polynomials import TERMS, remainder
from weier.methods.bem.windows import (
    EDGE,
    MAX_BEYOND,
    MIN_POLYNOMIAL,
    added_by_triangles,
    fit_window,
    margin_of,
    scale_of,
    side_margin,
)

CURVATURE = 1 / 24  # c of docs/subgrid.md, for piecewise-linear pressure


class Correction(NamedTuple):
    """What the continuum adds to compliance and resistance, the contacts there, and the errors that are expected."""

    compliance: float
    resistance: float
    contacts: ContactList
    compliance_error: float
    resistance_error: float


@kernel
def correct(solution: GridSolution, grid: Grid, edge: Edges, continuum: Continuum) -> Correction:
    """What the continuum adds to a converged solution, whose edges are `edge`.

    Where no contact under its polynomial carries its force, as next to a merger, its edges are taken by themselves.
    """
    without = np.zeros(edge.size - 2, np.bool_)
    correction, again = _correct_without(without, solution, grid, edge, continuum)
    while again:
        correction, again = _correct_without(without, solution, grid, edge, continuum)
    return correction


@kernel
def _correct_without(
    without: Flags, solution: GridSolution, grid: Grid, edge: Edges, continuum: Continuum
) -> tuple[Correction, bool]:
    """The same, if the runs `without` have no polynomials; whether more of them, marked there, must not have one."""
    runs = edge.size - 2
    points = solution.pressure.size
    owned = np.zeros(runs, np.bool_)  # edges that belong to a narrow contact or gap
    polynomial = narrow_runs(edge, solution.contact, continuum.narrow, without)
    contacts = make_contacts(runs // 2 + count_crests(solution), TERMS)
    contact_of = np.zeros(runs, np.int64)  # of a gap, the one before it
    gap_edge = np.full((runs, 2), np.nan)  # of a gap with a polynomial, in lambda_0
    compliance = resistance = off = rate_off = 0.0
    merging = False
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
            used = add_crests(start, nodes, run, solution, continuum, contacts, used)
            if polynomial[run]:
                gap = correct_gap(start, nodes, edge, run, solution, grid, continuum)
                polynomial[run] = gap.left <= gap.right
                gap_edge[run] = gap.left, gap.right
                compliance += gap.compliance
                resistance += gap.resistance
                off += gap.compliance_error
                rate_off += gap.resistance_error
                merging |= gap.uncertain
        if polynomial[run]:
            owned[run] = owned[(run + 1) % runs] = True
    for run in range(runs):
        if not solution.contact[edge[run + 1] % points]:
            contact_of[run] = contact_of[run - 1]
    for run in range(runs):
        place_edge(run, edge[run + 1], owned[run], gap_edge, contact_of, solution, continuum, contacts)
    dip, dips = find_dips(solution)
    opened, slower, missed, rate_missed = open_gaps(dip, dips, solution, grid, continuum)
    off += missed
    rate_off += rate_missed
    compliance += opened
    resistance += slower
    higher, faster = redistribute(contacts, used, solution.plane, solution.rate, compliance, continuum.period)
    again = False
    for at in range(used):
        if contacts.lost[at]:
            again = without[contacts.run[at]] = True
    if again:
        return _no_correction(), True
    steps = find_steps(solution, edge, float(np.mean(solution.pressure)), continuum.period)
    lower, slower = next_order(edge, steps, polynomial)
    more_off, more_rate_off, uncertain = expected_errors(
        solution, edge, steps, polynomial, contacts, used, continuum.angle, continuum.period
    )
    listed = list_contacts(contacts, used, dips, solution, continuum.period, uncertain or merging)
    return Correction(
        compliance + higher - lower, resistance + faster - slower, listed, off + more_off, rate_off + more_rate_off
    ), False


@kernel
def _no_correction() -> Correction:
    """One that is to be refused."""
    return Correction(np.nan, np.nan, blank_list(), np.nan, np.nan)


@kernel
def narrow_runs(edge: Edges, contact: Flags, most: int, without: Flags) -> Flags:
    """Contacts and gaps to be given polynomials: from the narrowest on, those that share no edge with others.

    The runs `without` get none.
    """
    runs = edge.size - 2
    nodes = np.empty(runs, np.int64)
    for run in range(runs):
        nodes[run] = 2 * (edge[run + 2] - edge[run + 1]) + (0 if contact[edge[run + 1] % contact.size] else 1)
    chosen = np.zeros(runs, np.bool_)
    taken = np.zeros(runs, np.bool_)
    for run in np.argsort(nodes, kind="mergesort"):
        after = (run + 1) % runs
        if nodes[run] // 2 <= most and not (taken[run] or taken[after] or without[run]):
            chosen[run] = taken[run] = taken[after] = True
    return chosen


@kernel
def add_contact(
    start: int, nodes: int, polynomial: bool, edge: Edges, run: int,
    solution: GridSolution, continuum: Continuum, contacts: Contacts, at: int,
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
    contacts.reach[at] = half_width
    contacts.force[at] = force.sum()
    contacts.share[at] = share.sum()
    if contacts.share[at] > 0:
        for i in range(nodes):
            ahead = solution.displacement[(start + i) % points] - solution.rate
            contacts.uneven[at] += share[i] / contacts.share[at] * ahead
    contacts.self_compliance[at] = -2 * np.log(np.sin(min(np.pi * half_width / continuum.period, np.pi / 2)))
    contacts.edge_compliance[at] = contacts.edge_resistance[at] = 0.0
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
        add_grid_moments(force[i], x, spacing, contacts.grid_force_moments[at])
        add_grid_moments(share[i], x, spacing, contacts.grid_share_moments[at])
    contacts.grid_mixed[at] = mixed + np.sum(force * smoothing)
    contacts.grid_energy[at] = own + 2 * energy + np.sum(share * smoothing)
    contacts.grid_cross[at] = energy + np.sum(share * smoothing) / 2
    return True


@kernel
def enter_polynomials(
    fitted: Array, whole: int, centre: float, half_width: float, continuum: Continuum, spacing: float,
    contacts: Contacts, at: int,
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
    run: int, node: int, owned: bool, gap_edge: Array, contact_of: Indices, solution: GridSolution,
    continuum: Continuum, contacts: Contacts,
) -> None:  # fmt: skip
    """Place the edge at which a run begins: at that of a narrow gap, or by itself if no narrow run has it."""
    points = solution.pressure.size
    begins = solution.contact[node % points]  # a contact begins here
    which = contact_of[run]
    gap = run - 1 if begins else run
    position = gap_edge[gap, 1] if begins else gap_edge[gap, 0]
    if not owned:
        found = correct_edge(node % points, solution)
        contacts.edge_compliance[which] += found.compliance
        contacts.edge_resistance[which] += found.resistance
        if found.load > 0:
            contacts.edge_drop[which] += found.drop
            contacts.edge_yield[which] += found.drop / (found.load * contacts.share[which])
        position = (node - found.beyond if begins else node - 1 + found.beyond) * continuum.period / points
    if begins:
        contacts.left[which] = position
    else:
        contacts.right[which] = position
        contacts.joined[which] = gap_edge[run, 0] == gap_edge[run, 1]


class EdgeCorrection(NamedTuple):
    """What an edge of wide runs adds to a solution on the grid.

    compliance, resistance : in g_0 and g_0/p_0*
    beyond : how far it is beyond its node, in nodes
    drop : of the resistance in its step, D
    load : that its step takes, a + b; 0 where it is not known
    """

    compliance: float
    resistance: float
    beyond: float
    drop: float
    load: float


@kernel
def correct_edge(start: int, solution: GridSolution) -> EdgeCorrection:
    """What an edge of wide runs adds to compliance and resistance, and its step."""
    points = solution.pressure.size
    inside, outside = (start, start - 1) if solution.contact[start] else (start - 1, start)
    closing = solution.displacement[inside] - solution.displacement[outside]
    if not (solution.per_load[inside] > 0 and closing > 0):
        return EdgeCorrection(0.0, 0.0, EDGE, 0.0, 0.0)
    since = max(solution.pressure[inside], 0.0) / solution.per_load[inside]
    until = max(solution.plane - solution.deformed[outside], 0.0) / closing
    if not since + until > 0:
        return EdgeCorrection(0.0, 0.0, EDGE, 0.0, 0.0)
    step = since / (since + until)
    drop = solution.per_load[inside] * closing / points
    higher = drop * (since + until) * ((step - step * step) / 2 - CURVATURE)
    return EdgeCorrection(higher, (0.5 - step) * drop, step + EDGE - 0.5, drop, since + until)


@kernel
def _is_crest(node: int, solution: GridSolution) -> bool:
    """Whether a node is the highest of three in a gap, and no farther below the plane than they bend."""
    right = next_node(node, solution.deformed.size)
    if solution.contact[node - 1] or solution.contact[node] or solution.contact[right]:
        return False
    before, here, after = solution.deformed[node - 1], solution.deformed[node], solution.deformed[right]
    return before <= here and after < here and solution.plane - here < 2 * here - before - after


@kernel
def count_crests(solution: GridSolution) -> int:
    """Crests in the gaps that may touch between two nodes."""
    crests = 0
    for node in range(solution.contact.size):
        crests += _is_crest(node, solution)
    return crests


@kernel
def add_crests(
    start: int, nodes: int, run: int, solution: GridSolution, continuum: Continuum, contacts: Contacts, used: int
) -> int:
    """Enter the crests of a gap that may touch between two nodes; the contacts then used."""
    points = solution.pressure.size
    spacing = continuum.period / points
    for i in range(nodes):
        node = (start + i) % points
        if not _is_crest(node, solution):
            continue
        margin = side_margin(node, solution.contact)
        whole = 1 + 2 * margin
        scale = scale_of(whole)
        seen = np.empty((2, whole))
        for j in range(whole):
            near = (node - margin + j) % points
            seen[0, j], seen[1, j] = (solution.deformed[near], solution.displacement[near])
        fitted = fit_window(continuum.windows, whole, seen)
        top = crest(fitted[0], 0.0, 1 / scale)
        contacts.kind[used], contacts.run[used] = BIRTH, run
        contacts.position[used] = (node + top * scale) * spacing
        contacts.reach[used] = contacts.force[used] = contacts.share[used] = 0.0
        contacts.self_compliance[used] = 0.0
        contacts.edge_compliance[used] = contacts.edge_resistance[used] = 0.0
        contacts.origin[used] = node * spacing
        enter_polynomials(fitted, whole, top, 0.0, continuum, spacing, contacts, used)
        contacts.grid_mixed[used] = contacts.grid_energy[used] = 0.0
        used += 1
    return used
