"""Edges of contact between the nodes: what the continuum adds to a solution on a grid (docs/subgrid.md)."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.special import zeta

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.correction_error import expected_errors
from weier.methods.bem.edges import Edges
from weier.methods.bem.grid_solution import GridSolution
from weier.methods.bem.grids import Grid
from weier.methods.bem.interaction import BIRTH, NARROW, WIDE, Contacts, make_contacts, redistribute
from weier.methods.bem.narrow_contacts import contact_edges, crest, gap_edges, gap_energy
from weier.methods.bem.polynomials import DEGREE, TERMS, derivative, expansion, fit_polynomials, value
from weier.theory.halfplane import eigenvalues
from weier.theory.profile import Profile

EDGE = 0.384947631413  # nodes from the last one in contact to the edge of a flat punch, in the mean of a step
CURVATURE = 1 / 24  # c of docs/subgrid.md, for piecewise-linear pressure
ALIAS = 2 * zeta(3) / (2 * np.pi) ** 4  # times z'''' dx^3: what aliases of the triangles add to the pressure
MARGIN = 2  # nodes beyond a contact or a gap that its polynomial is fitted on, at each end; more if it has few itself
CREST_MARGIN = DEGREE // 2  # and beyond the highest node of a gap, or the node of least pressure in a contact
MAX_BEYOND = 1.5  # nodes from the last one in contact to its edge: half a node in all that a grid can miss
MAX_FITTED = 25  # nodes that a polynomial is fitted on: more add nothing
MAX_NARROW = 256  # nodes of a contact or gap with a polynomial; the next edge is then too far to matter
MIN_POLYNOMIAL = 3  # nodes of a window: a parabola
# Of gaps that no node sees: what is left of their share of the numbers, and of their depth, which polynomial and
# aliases give with an error of angle^5 (measured on one wave at 32 to 256 points, where they are 6e-4 and 1.3e-3).
OPEN_SHARE = 0.01
OPEN_DEPTH = 0.01


class Continuum(NamedTuple):
    """What the correction knows of grid and profile, besides `Grid`.

    influence : displacement at j nodes from a unit force, of a line without images, shape (nodes,)
    stiffness : pressure at j nodes from a unit displacement of one node, the same, shape (nodes,)
    narrow : nodes of the largest contact, or gap, that is given a polynomial: half a finest wave
    angle : 2 pi over the points for each of the finest waves
    period : in lambda_0
    """

    influence: Array
    stiffness: Array
    narrow: int
    angle: float
    period: float


class Correction(NamedTuple):
    """What the continuum adds to compliance and resistance, its contact fraction and patches, and expected errors."""

    compliance: float
    resistance: float
    contact_fraction: float
    patches: int
    compliance_error: float
    resistance_error: float


def make_continuum(profile: Profile, points: int) -> Continuum:
    """Tables for a profile on a grid."""
    narrow = min(points // (2 * profile.waves_per_period[-1]) + 1, MAX_NARROW)
    period, nodes = float(profile.period), narrow + DEGREE + 2 * MARGIN
    return Continuum(
        _line_influence(nodes) - 2 * np.log(2 * np.pi / points),
        _line_stiffness(nodes) * points / period,
        narrow,
        2 * np.pi * profile.waves_per_period[-1] / points,
        period,
    )


def _line_influence(nodes: int) -> Array:
    """Displacement by a triangle of pressure of unit force, at whole distances j, but for a constant."""
    j = np.abs(np.arange(-1, nodes + 1.0))
    twice = j * j / 2 * np.log(np.where(j > 0, j, 1))  # integrates ln twice, but for -3/4 j^2
    return np.asarray(3 - 2 * np.diff(twice, 2))


@lru_cache(maxsize=4)
def _line_stiffness(nodes: int, points: int = 2**14) -> Array:
    """Pressure by a unit displacement of one node on a line of unit steps, at whole distances."""
    ring = np.fft.irfft(np.concatenate([[0], 1 / eigenvalues(points, points)[1:]]), points)[:nodes]
    # Far away it is -1/(2 pi^2 j^2), and on the ring the sum of that over all turns; take the others off.
    j = np.arange(1, nodes)
    turns = 1 / (2 * points**2 * np.sin(np.pi * j / points) ** 2) - 1 / (2 * np.pi**2 * j**2)
    return np.asarray(ring + np.concatenate([[1 / (6 * points**2)], turns]))


@kernel
def correct(solution: GridSolution, grid: Grid, edge: Edges, continuum: Continuum) -> Correction:
    """What the continuum adds to a converged solution, whose edges are `edge`."""
    runs = edge.size - 2
    points = solution.pressure.size
    spacing = continuum.period / points
    owned = np.zeros(runs, np.bool_)  # edges that belong to a narrow contact or gap
    polynomial = narrow_runs(edge, solution.contact, continuum.narrow)
    contacts = make_contacts(runs // 2 + count_crests(solution), TERMS)
    contact_of = np.zeros(runs, np.int64)
    compliance = resistance = 0.0
    width = 0.0 if runs else continuum.period
    patches = used = 0
    for run in range(runs):
        start, nodes = edge[run + 1] % points, edge[run + 2] - edge[run + 1]
        if solution.contact[start]:
            contact_of[run] = used
            narrow = add_contact(start, nodes, polynomial[run], edge, run, solution, continuum, contacts, used)
            used += 1
            polynomial[run] &= narrow
            if narrow:
                owned[run] = owned[(run + 1) % runs] = True
            else:
                width += (nodes - 1) * spacing
        else:
            used = add_crests(start, nodes, solution, continuum, contacts, used)
            if polynomial[run]:
                closed, slower, half_width = correct_gap(start, nodes, edge, run, solution, grid, continuum)
                polynomial[run] = half_width > 0
                if half_width > 0:
                    owned[run] = owned[(run + 1) % runs] = True
                    compliance += closed
                    resistance += slower
                    width += (nodes + 1) * spacing - 2 * half_width
    for run in range(runs):
        if not owned[run]:
            start = edge[run + 1] % points
            which = contact_of[run] if solution.contact[start] else contact_of[run - 1]
            higher, faster, beyond = correct_edge(start, solution)
            contacts.edge_compliance[which] += higher
            contacts.edge_resistance[which] += faster
            width += beyond * spacing
    opened, slower, narrower, holes, opened_off, slower_off = open_gaps(solution, grid, continuum)
    compliance += opened
    resistance += slower
    width -= narrower
    higher, faster, wider, patches = redistribute(
        contacts, used, solution.plane, solution.rate, compliance, continuum.period
    )
    off, rate_off = expected_errors(
        solution, edge, polynomial, contacts, used, continuum.angle, grid.tolerance, continuum.period
    )
    return Correction(
        compliance + higher,
        resistance + faster,
        (width + wider) / continuum.period,
        patches + holes,
        off + opened_off,
        rate_off + slower_off,
    )


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
        if nodes[run] // 2 <= most and not taken[run] and not taken[after]:
            chosen[run] = taken[run] = taken[after] = True
    return chosen


@kernel
def window(nodes: int, margin: int) -> tuple[Indices, Array, float]:
    """Nodes to fit on, counted from the first in the window; their s in [-1, 1]; the nodes in one s."""
    whole = nodes + 2 * margin
    fitted = min(whole, MAX_FITTED)
    scale = (whole - 1) / 2
    offset = np.empty(fitted, np.int64)
    for i in range(fitted):
        offset[i] = (i * (whole - 1) + (fitted - 1) // 2) // (fitted - 1)
    return offset, offset / scale - 1, scale


@kernel
def _margin(edge: Edges, run: int) -> int:
    """Nodes beyond both ends of a run that belong to no further one, at most as many as the polynomial needs."""
    before, nodes = edge[run + 1] - edge[run], edge[run + 2] - edge[run + 1]
    after = edge[run + 3] - edge[run + 2] if run + 3 < edge.size else edge[2] - edge[1]
    return min(max(MARGIN, (TERMS - nodes + 1) // 2), before, after)


@kernel
def _second_at_nodes(polynomial: Array, nodes: int, scale: float) -> Array:
    """Second differences of a polynomial at the nodes of a run."""
    second = derivative(derivative(polynomial))
    values = np.empty(nodes)
    for i in range(nodes):
        values[i] = value(second, (i - (nodes - 1) / 2) / scale) / scale**2
    return values


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
    contacts.kind[at] = WIDE
    contacts.position[at] = (start + (nodes - 1) / 2) * spacing
    contacts.reach[at] = half_width
    contacts.force[at] = force.sum()
    contacts.share[at] = share.sum()
    contacts.self_compliance[at] = -2 * np.log(np.sin(min(np.pi * half_width / continuum.period, np.pi / 2)))
    contacts.edge_compliance[at] = contacts.edge_resistance[at] = 0.0
    margin = _margin(edge, run)
    if not polynomial or nodes + 2 * margin < MIN_POLYNOMIAL or not contacts.share[at] > 0:
        return False
    offset, s, scale = window(nodes, margin)
    seen = np.empty((2, offset.size))  # z as this contact sees it, and A q of the others
    for i in range(offset.size):
        node = (start - margin + offset[i]) % points
        seen[0, i], seen[1, i] = solution.deformed[node], solution.displacement[node]
        for j in range(nodes):
            influence = continuum.influence[abs(offset[i] - margin - j)]
            seen[0, i] += influence * force[j]
            seen[1, i] -= influence * share[j]
    height, rate = fit_polynomials(s, seen, min(DEGREE, offset.size - 1))
    centre, width, found = contact_edges(height, contacts.force[at], 0.0, ((nodes - 1) / 2 + EDGE) / scale)
    if not found or abs(centre) + width > ((nodes - 1) / 2 + MAX_BEYOND) / scale:
        return False
    mixed = energy = own = 0.0  # of the grid: with the rate of the others at its own nodes, and of its own
    for i in range(nodes):
        others = displacement = solution.displacement[(start + i) % points]
        for j in range(nodes):
            others -= continuum.influence[abs(i - j)] * share[j]
        mixed += force[i] * others
        energy += share[i] * others
        own += share[i] * (displacement - others)
    rate_bend = _second_at_nodes(rate, nodes, scale)
    contacts.kind[at] = NARROW
    contacts.scale[at] = scale * spacing
    contacts.centre[at], contacts.half_width[at] = centre, width
    contacts.height[at], contacts.rate[at] = height, rate
    contacts.self_compliance[at] = own / contacts.share[at] ** 2
    contacts.grid_mixed[at] = mixed + np.sum(force * rate_bend) / 12
    contacts.grid_energy[at] = own + 2 * energy + np.sum(share * rate_bend) / 12
    return True


@kernel
def correct_gap(
    start: int, nodes: int, edge: Edges, run: int, solution: GridSolution, grid: Grid, continuum: Continuum
) -> tuple[float, float, float]:
    """What a narrow gap adds to compliance and resistance, and its half width, in lambda_0; 0 if not found."""
    points = solution.pressure.size
    spacing = continuum.period / points
    margin = _margin(edge, run)
    if nodes + 2 * margin < MIN_POLYNOMIAL:
        return 0.0, 0.0, 0.0
    gap = np.empty(nodes)
    opening = np.empty(nodes)  # its rate, per mean pressure
    for i in range(nodes):
        node = (start + i) % points
        gap[i] = solution.plane - solution.deformed[node]
        opening[i] = solution.displacement[node] - solution.rate
    offset, s, scale = window(nodes, margin)
    seen = np.empty((3, offset.size))  # pressure that closes this gap, its rate, and z
    for i in range(offset.size):
        node = (start - margin + offset[i]) % points
        seen[0, i], seen[1, i], seen[2, i] = solution.pressure[node], solution.per_load[node], grid.height[node]
        for j in range(nodes):
            stiffness = continuum.stiffness[abs(offset[i] - margin - j)]
            seen[0, i] -= stiffness * gap[j]
            seen[1, i] -= stiffness * opening[j]
    nodal_pressure, nodal_rate, profile = fit_polynomials(s, seen, min(DEGREE, offset.size - 1))
    pressure = _continuous(nodal_pressure, scale) + ALIAS / spacing * _fourth(profile, scale)
    rate = _continuous(nodal_rate, scale)
    centre, half_width, found = gap_edges(pressure, 0.0, ((nodes + 1) / 2 - EDGE) / scale)
    if not found:  # from the parabola at the least pressure instead, which few nodes may see far off their middle
        least, depth, bend = deepest(pressure, (nodes + 1) / 2 / scale)
        if depth > 0 and bend > 0:
            centre, half_width, found = gap_edges(pressure, least, np.sqrt(4 * depth / bend))
    if not found or abs(centre) + half_width > ((nodes - 1) / 2 + MAX_BEYOND) / scale:
        return 0.0, 0.0, 0.0
    grid_mixed = grid_energy = 0.0
    rate_bend = _second_at_nodes(rate, nodes, scale)
    for i in range(nodes):
        own = solution.per_load[(start + i) % points]
        for j in range(nodes):
            own -= continuum.stiffness[abs(i - j)] * opening[j]
        grid_mixed += spacing * gap[i] * (own + rate_bend[i] / 12)
        grid_energy += spacing * opening[i] * (own + rate_bend[i] / 12)
    half_length = half_width * scale * spacing
    mixed, energy = gap_energy(
        expansion(pressure, centre, half_width), expansion(rate, centre, half_width), half_length
    )
    return (grid_mixed - mixed) / continuum.period, (grid_energy - energy) / continuum.period, half_length


@kernel
def _continuous(nodal: Array, scale: float) -> Array:
    """The pressure that triangles of these nodal values stand for: its moving average under a triangle."""
    second = derivative(derivative(nodal))
    fourth = derivative(derivative(second))
    return nodal + second / (12 * scale**2) + fourth / (360 * scale**4)


@kernel
def _fourth(polynomial: Array, scale: float) -> Array:
    """Fourth differences of a polynomial."""
    return derivative(derivative(derivative(derivative(polynomial)))) / scale**4


@kernel
def correct_edge(start: int, solution: GridSolution) -> tuple[float, float, float]:
    """What an edge of wide runs adds to compliance and resistance; how far beyond its node it is, in nodes."""
    points = solution.pressure.size
    inside, outside = (start, start - 1) if solution.contact[start] else (start - 1, start)
    closing = solution.displacement[inside] - solution.displacement[outside]
    if not (solution.per_load[inside] > 0 and closing > 0):
        return 0.0, 0.0, EDGE
    since = max(solution.pressure[inside], 0.0) / solution.per_load[inside]
    until = max(solution.plane - solution.deformed[outside], 0.0) / closing
    if not since + until > 0:
        return 0.0, 0.0, EDGE
    step = since / (since + until)
    drop = solution.per_load[inside] * closing / points
    higher = drop * (since + until) * ((step - step * step) / 2 - CURVATURE)
    return higher, (0.5 - step) * drop, step + EDGE - 0.5


@kernel
def _is_crest(node: int, solution: GridSolution) -> bool:
    """Whether a node is the highest of three in a gap, and no farther below the plane than they bend."""
    points = solution.deformed.size
    before, here, after = (
        solution.deformed[node - 1],
        solution.deformed[node],
        solution.deformed[(node + 1) % points],
    )
    if solution.contact[node - 1] or solution.contact[node] or solution.contact[(node + 1) % points]:
        return False
    return before <= here and after < here and solution.plane - here < 2 * here - before - after


@kernel
def count_crests(solution: GridSolution) -> int:
    """Crests in the gaps that may touch between two nodes."""
    crests = 0
    for node in range(solution.contact.size):
        crests += _is_crest(node, solution)
    return crests


@kernel
def _crest_margin(node: int, contact: Flags) -> int:
    """Nodes to each side of this one that are in contact if it is, and not if it is not; at most CREST_MARGIN."""
    margin = 1
    while (
        margin < CREST_MARGIN
        and contact[node - margin - 1] == contact[node]
        and contact[(node + margin + 1) % contact.size] == contact[node]
    ):
        margin += 1
    return margin


@kernel
def add_crests(
    start: int, nodes: int, solution: GridSolution, continuum: Continuum, contacts: Contacts, used: int
) -> int:
    """Enter the crests of a gap that may touch between two nodes; the contacts then used."""
    points = solution.pressure.size
    for i in range(nodes):
        node = (start + i) % points
        if not _is_crest(node, solution):
            continue
        margin = _crest_margin(node, solution.contact)
        offset, s, scale = window(1, margin)
        seen = np.empty((2, offset.size))
        for j in range(offset.size):
            near = (node - margin + offset[j]) % points
            seen[0, j], seen[1, j] = solution.deformed[near], solution.displacement[near]
        height, rate = fit_polynomials(s, seen, offset.size - 1)
        top = crest(height, 0.0, 1 / scale)
        contacts.kind[used] = BIRTH
        contacts.position[used] = (node + top * scale) * continuum.period / points
        contacts.reach[used] = contacts.force[used] = contacts.share[used] = 0.0
        contacts.self_compliance[used] = 0.0
        contacts.edge_compliance[used] = contacts.edge_resistance[used] = 0.0
        contacts.scale[used] = scale * continuum.period / points
        contacts.centre[used], contacts.half_width[used] = top, 0.0
        contacts.height[used], contacts.rate[used] = height, rate
        contacts.grid_mixed[used] = contacts.grid_energy[used] = 0.0
        used += 1
    return used


@kernel
def deepest(pressure: Array, reach: float) -> tuple[float, float, float]:
    """Where the pressure is least, at most `reach` from the middle; how far below 0, and its second derivative."""
    least = crest(-pressure, 0.0, reach)
    return least, -value(pressure, least), value(derivative(derivative(pressure)), least)


@kernel
def _uncertain_opening(
    depth: float, bend: float, rate: float, length: float, continuum: Continuum, spacing: float
) -> tuple[float, float]:
    """Errors of compliance and resistance by a gap whose depth, the tension that it relieves, is known roughly.

    A narrow gap adds 4 (pi q)^2 depth/(p'' L) to the resistance, q its `rate`, so that an error of the depth, as a
    share of p'' over the square of the finest wavenumber, is one of the resistance; `length` is of one s.
    """
    wavelength = 2 * np.pi * spacing / continuum.angle
    resistance = OPEN_DEPTH * continuum.angle**5 * (rate * wavelength) ** 2 / continuum.period
    off = OPEN_DEPTH * continuum.angle**5 * bend * (wavelength / (2 * np.pi * length)) ** 2
    if depth <= -off:
        return 0.0, 0.0
    return resistance * (max(depth, 0.0) + off) / rate, resistance


@kernel
def open_gaps(
    solution: GridSolution, grid: Grid, continuum: Continuum
) -> tuple[float, float, float, int, float, float]:
    """What gaps between two nodes add to compliance and resistance, their width and number, and errors of both."""
    points = solution.pressure.size
    spacing = continuum.period / points
    compliance = resistance = width = off = rate_off = 0.0
    gaps = 0
    for node in range(points):
        before, here, after = (
            solution.pressure[node - 1],
            solution.pressure[node],
            solution.pressure[(node + 1) % points],
        )
        inside = solution.contact[node - 1] and solution.contact[node] and solution.contact[(node + 1) % points]
        if not inside or not (here <= before and here < after and here < before + after - 2 * here):
            continue
        margin = _crest_margin(node, solution.contact)
        offset, s, scale = window(1, margin)
        seen = np.empty((3, offset.size))
        for j in range(offset.size):
            near = (node - margin + offset[j]) % points
            seen[0, j], seen[1, j], seen[2, j] = solution.pressure[near], solution.per_load[near], grid.height[near]
        nodal_pressure, nodal_rate, profile = fit_polynomials(s, seen, offset.size - 1)
        pressure = _continuous(nodal_pressure, scale) + ALIAS / spacing * _fourth(profile, scale)
        rate = _continuous(nodal_rate, scale)
        least, depth, bend = deepest(pressure, 1 / scale)
        per_load = value(rate, least)
        if bend <= 0 or per_load <= 0:
            continue
        length = scale * spacing
        higher, faster = _uncertain_opening(depth, bend, per_load, length, continuum, spacing)
        off += higher
        rate_off += faster
        if depth <= 0:
            continue
        centre, half_width, found = gap_edges(pressure, least, np.sqrt(4 * depth / bend))
        if not found or abs(centre) + half_width > 1:
            missed = (2 * np.pi * per_load * length) ** 2 * depth / (bend * continuum.period)
            off += missed * depth / per_load
            rate_off += missed
            continue
        mixed, energy = gap_energy(
            expansion(pressure, centre, half_width), expansion(rate, centre, half_width), half_width * length
        )
        off += OPEN_SHARE * abs(mixed) / continuum.period
        rate_off += OPEN_SHARE * abs(energy) / continuum.period
        compliance -= mixed / continuum.period
        resistance -= energy / continuum.period
        width += 2 * half_width * length
        gaps += 1
    return compliance, resistance, width, gaps, off, rate_off
