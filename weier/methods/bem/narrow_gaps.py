"""Gaps of a few nodes, or of none: the dual problem, in which the pressure that closes the gap is a polynomial."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices, Record, Records, record_type
from weier.kernels.jit import kernel
from weier.methods.bem.active_set import circulant_product, dot
from weier.methods.bem.factors import OPEN_DEPTH, REST
from weier.methods.bem.grid_solution import Continuum, GridSolution, next_node
from weier.methods.bem.grids import Grid
from weier.methods.bem.local_fit import (
    CREST_MARGIN,
    EDGE,
    MAX_BEYOND,
    MIN_POLYNOMIAL,
    TERMS,
    added_by_triangles,
    average_under_triangle,
    derivative,
    expansion,
    fit_without,
    margin_of,
    remainder,
    scale_of,
    side_margin,
    size,
    slopes,
    value,
    without_own,
)
from weier.methods.bem.narrow_contacts import gap_edges, gap_energy, highest

ZETA_3 = 1.2020569031595942  # Riemann's zeta(3)
ALIAS = 2 * ZETA_3 / (2 * np.pi) ** 4  # times z'''' dx^3: what aliases of the triangles add to the pressure


# What the continuum changes of a run:
#
# left, right : edges of a gap with a polynomial, in lambda_0, the same where it is closed; else NaN
# compliance, resistance : what it adds to these, or what the gaps between the nodes of a contact add
# compliance_error, resistance_error : by what polynomials leave
GAP = record_type(("left right compliance resistance compliance_error resistance_error", np.float64, ()))


class Gaps(NamedTuple):
    """Narrow gaps, and those between two nodes in contact.

    polynomial : of each gap, whether it has one; of each contact, whether it may have one; shape (runs,)
    runs : shape (runs,), but one where all nodes touch
    opened : edges of those between two nodes that are open, from left to right, shape (gaps, 2)
    found : whether all between two nodes have edges, or are closed
    """

    polynomial: Flags
    runs: Records
    opened: Array
    found: bool


@kernel
def find_gaps(solution: GridSolution, continuum: Continuum) -> Gaps:
    """Correct all narrow gaps, and find those that open between two nodes."""
    edge, points = solution.edge, solution.pressure.size
    pressure = _pressure_without_residual(solution, continuum.grid)
    polynomial = narrow_runs(edge, solution.contact, continuum.narrow)
    gaps = np.zeros(max(polynomial.size, 1), GAP)
    for run in range(polynomial.size):
        gap, start = gaps[run], edge[run + 1] % points
        gap.left = gap.right = np.nan
        if polynomial[run] and not solution.contact[start]:
            nodes, margin = edge[run + 2] - edge[run + 1], margin_of(edge, run)
            gap.left, gap.right = correct_gap(start, nodes, margin, REST, pressure, solution, continuum, gap)
            polynomial[run] = gap.left <= gap.right
    opened, count, run, found = np.empty((points, 2)), 0, -1, True
    for node in range(points):
        while run + 1 < polynomial.size and edge[run + 2] <= node:
            run += 1
        if is_dip(node, solution):
            margin = side_margin(node, solution.contact)
            # Beside an edge of contact the pressure is a root, of which a polynomial leaves twice as much.
            factor = REST if margin == CREST_MARGIN else 2 * REST
            left, right = correct_gap(node, 1, margin, factor, pressure, solution, continuum, gaps[run])
            found &= left <= right
            if left < right:
                opened[count, 0], opened[count, 1] = left, right
                count += 1
    return Gaps(polynomial, gaps, opened[:count], found)


@kernel
def _pressure_without_residual(solution: GridSolution, grid: Grid) -> Array:
    """Nodal pressure less what the residual of the heights in contact makes of it, shape (N,).

    A gap of few nodes opens by so little pressure that the residual at one node beside it would tell how much.
    """
    points = solution.pressure.size
    residual, pressure = np.zeros(points), np.empty(points)
    for i in range(points):
        if solution.contact[i]:
            residual[i] = solution.plane - solution.deformed[i]
    circulant_product(grid.inverse, residual, np.zeros(points // 2 + 1, np.complex128), pressure)
    for i in range(points):
        pressure[i] = solution.pressure[i] - pressure[i]
    return pressure


@kernel
def narrow_runs(edge: Indices, contact: Flags, most: int) -> Flags:
    """Contacts and gaps to be given polynomials: from the narrowest on, those that share no edge with others."""
    runs = edge.size - 2
    chosen = np.zeros(runs, np.bool_)
    taken = np.zeros(runs, np.bool_)
    for nodes in range(1, most + 1):
        for of_contacts in (True, False):
            for run in range(runs):
                after = (run + 1) % runs
                if edge[run + 2] - edge[run + 1] != nodes or taken[run] or taken[after]:
                    continue
                if contact[edge[run + 1] % contact.size] == of_contacts:
                    chosen[run] = taken[run] = taken[after] = True
    return chosen


@kernel
def correct_gap(
    start: int, nodes: int, margin: int, factor: float, relaxed: Array, solution: GridSolution, continuum: Continuum,
    correction: Record,
) -> tuple[float, float]:  # fmt: skip
    """Edges of a narrow gap by its polynomial, fitted on `margin` more nodes each side; NaN where none are found.

    What it changes is added to the `correction`; without edges they are taken one by one. The gap may stand between
    two nodes: then its one node is the one of least pressure. The error is `factor` times the next two terms of the
    polynomial; `relaxed` is the nodal pressure without what the residual makes of it.
    """
    grid, points, window = continuum.grid, solution.pressure.size, nodes + 2 * margin
    spacing = continuum.period / points
    if window < MIN_POLYNOMIAL:
        return np.nan, np.nan
    gap, opening = np.zeros(nodes), np.zeros(nodes)  # the latter per mean pressure
    for i in range(nodes):
        node = (start + i) % points
        if not solution.contact[node]:
            gap[i] = solution.plane - solution.deformed[node]
            opening[i] = solution.displacement[node] - solution.rate
    scale, stiffness, windows = scale_of(window), continuum.stiffness, continuum.windows
    nodal_pressure = fit_without(relaxed, gap, stiffness, start, margin, windows)  # the one that closes this gap
    nodal_rate = fit_without(solution.per_load, opening, stiffness, start, margin, windows)
    profile = fit_without(grid.height, np.zeros(nodes), stiffness, start, margin, windows)
    pressure, rate = average_under_triangle(nodal_pressure, scale), average_under_triangle(nodal_rate, scale)
    pressure += ALIAS / spacing * derivative(derivative(derivative(derivative(profile)))) / scale**4
    centre, half_width, found = _edges_of_gap(pressure, nodes, scale)
    if not found:
        return np.nan, np.nan
    _add_errors_of_depth(nodal_pressure, pressure, rate, nodes, window, factor, continuum, spacing, correction)
    half_length = half_width * scale * spacing
    mixed, energy = gap_energy(
        expansion(pressure, centre, half_width), expansion(rate, centre, half_width), half_length
    )
    closing = without_own(solution.per_load, opening, stiffness, start, 0, np.arange(nodes))
    closing += added_by_triangles(rate, nodes, scale)
    correction.compliance += (spacing * dot(gap, closing) - mixed) / continuum.period
    correction.resistance += (spacing * dot(opening, closing) - energy) / continuum.period
    middle = (start + (nodes - 1) / 2 + centre * scale) * spacing
    return middle - half_length, middle + half_length


@kernel
def _add_errors_of_depth(
    nodal_pressure: Array, pressure: Array, rate: Array, nodes: int, window: int, factor: float, continuum: Continuum,
    spacing: float, correction: Record,
) -> None:  # fmt: skip
    """Add errors of both numbers by `factor` times the next two terms of the pressure, which may close the gap.

    They are much where few nodes are in the window, or an edge of contact is near it.
    """
    scale, rest = scale_of(window), np.empty((2, TERMS + 2))
    remainder(nodal_pressure, continuum.windows, window, continuum.angle, rest)
    least, depth, bend = deepest(pressure, (nodes + 1) / 2 / scale)
    per_load = value(rate, least)
    error = factor * size(rest, least)
    error += OPEN_DEPTH * continuum.angle**3 * bend / scale**2  # times the square of the wavenumber
    error += continuum.grid.max_residual * continuum.angle / (2 * np.pi * spacing)  # heights are off by such a wave
    if bend > 0 and per_load > 0 and depth > -error:
        resistance = (2 * np.pi * per_load * scale * spacing) ** 2 * error / (bend * continuum.period)
        correction.compliance_error += resistance * (max(depth, 0.0) + error) / per_load
        correction.resistance_error += resistance


@kernel
def _edges_of_gap(pressure: Array, nodes: int, scale: float) -> tuple[float, float, bool]:
    """Centre and half width of a gap of so many nodes; 0 if the continuum has none there; whether this is known."""
    centre, half_width, found = gap_edges(pressure, 0.0, ((nodes + 1) / 2 - EDGE) / scale)
    if not found:  # from the parabola at the least pressure instead, which few nodes may see far from their middle
        least, depth, bend = deepest(pressure, (nodes + 1) / 2 / scale)
        if depth <= 0:
            return least, 0.0, bend > 0
        if bend > 0:
            centre, half_width, found = gap_edges(pressure, least, np.sqrt(4 * depth / bend))
    return (centre, half_width, found and abs(centre) + half_width <= ((nodes - 1) / 2 + MAX_BEYOND) / scale)


@kernel
def deepest(pressure: Array, reach: float) -> tuple[float, float, float]:
    """Where the pressure is least, at most `reach` from the middle; how far below 0, and its second derivative."""
    least = highest(-pressure, reach)
    return least, -value(pressure, least), slopes(pressure, least)[1]


@kernel
def is_dip(node: int, solution: GridSolution) -> bool:
    """Whether a node has the least pressure of three in contact, and less than they bend."""
    after = next_node(node, solution.pressure.size)
    if not (solution.contact[node - 1] and solution.contact[node] and solution.contact[after]):
        return False
    left, here, right = (solution.pressure[node - 1], solution.pressure[node], solution.pressure[after])
    return here <= left and here < right and here < left + right - 2 * here
