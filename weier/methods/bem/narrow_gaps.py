"""Gaps of a few nodes, or of none: the dual problem, in which the pressure that closes the gap is a polynomial."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.factors import EDGE_REST, OPEN_DEPTH, REST
from weier.methods.bem.fft import circulant_product
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
    slopes,
    value,
    without_own,
)
from weier.methods.bem.narrow_contacts import gap_edges, gap_energy, highest

ZETA_3 = 1.2020569031595942  # Riemann's zeta(3)
ALIAS = 2 * ZETA_3 / (2 * np.pi) ** 4  # times z'''' dx^3: what aliases of the triangles add to the pressure


class GapCorrection(NamedTuple):
    """What a narrow gap adds to a solution on the grid.

    compliance, resistance : in g_0 and g_0/p_0*
    left, right : edges, in lambda_0; NaN where they are not found, the same where it is closed in the continuum
    compliance_error, resistance_error : by what its polynomial leaves
    uncertain : whether it may be closed or open
    """

    compliance: float
    resistance: float
    left: float
    right: float
    compliance_error: float
    resistance_error: float
    uncertain: bool


class Gaps(NamedTuple):
    """Narrow gaps, and those between two nodes in contact.

    polynomial : of each gap, whether it has one; of each contact, whether it may have one; shape (runs,)
    edge : of the gaps with a polynomial, in lambda_0, NaN for other runs, shape (runs, 2)
    adds : what each gap adds to compliance and resistance, or what those between its nodes add to those of a
        contact, shape (runs, 2); one row where all nodes touch
    opened : edges of those that are open, from left to right, shape (gaps, 2)
    error : of compliance and resistance, shape (2,)
    found : whether all between two nodes have edges, or are closed
    uncertain : whether one may be open or closed
    """

    polynomial: Flags
    edge: Array
    adds: Array
    opened: Array
    error: Array
    found: bool
    uncertain: bool


@kernel
def find_gaps(solution: GridSolution, continuum: Continuum) -> Gaps:
    """Correct all narrow gaps, and find those that open between two nodes."""
    edge, points = solution.edge, solution.pressure.size
    runs = edge.size - 2
    pressure = _pressure_without_residual(solution, continuum.grid)
    polynomial = narrow_runs(edge, solution.contact, continuum.narrow)
    place, adds, error = np.full((runs, 2), np.nan), np.zeros((max(runs, 1), 2)), np.zeros(2)
    found, uncertain = True, False
    for run in range(runs):
        start = edge[run + 1] % points
        if polynomial[run] and not solution.contact[start]:
            nodes, margin = edge[run + 2] - edge[run + 1], margin_of(edge, run)
            gap = correct_gap(start, nodes, margin, REST, pressure, solution, continuum)
            polynomial[run] = gap.left <= gap.right
            place[run, 0], place[run, 1] = gap.left, gap.right
            adds[run, 0], adds[run, 1] = gap.compliance, gap.resistance
            error[0] += gap.compliance_error
            error[1] += gap.resistance_error
            uncertain |= gap.uncertain
    opened, count, run = np.empty((points, 2)), 0, -1
    for node in range(points):
        while run + 1 < runs and edge[run + 2] <= node:
            run += 1
        if not is_dip(node, solution):
            continue
        margin = side_margin(node, solution.contact)
        factor = REST if margin == CREST_MARGIN else EDGE_REST
        gap = correct_gap(node, 1, margin, factor, pressure, solution, continuum)
        if not gap.left <= gap.right:
            found = False
            continue
        if gap.left < gap.right:
            opened[count, 0], opened[count, 1] = gap.left, gap.right
            count += 1
        error[0] += gap.compliance_error
        error[1] += gap.resistance_error
        uncertain |= gap.uncertain
        adds[run, 0] += gap.compliance
        adds[run, 1] += gap.resistance
    return Gaps(polynomial, place, adds, opened[:count], error, found, uncertain)


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
def _edges_not_found() -> GapCorrection:
    """Nothing yet: the edges of such a gap are taken one by one."""
    return GapCorrection(0.0, 0.0, np.nan, np.nan, 0.0, 0.0, False)


@kernel
def correct_gap(
    start: int, nodes: int, margin: int, factor: float, relaxed: Array, solution: GridSolution, continuum: Continuum
) -> GapCorrection:
    """What a narrow gap adds to compliance and resistance by its polynomial, fitted on `margin` more nodes each side.

    It may stand between two nodes: then its one node is the one of least pressure. The error is `factor` times the
    next two terms of the polynomial; `relaxed` is the nodal pressure without what the residual makes of it.
    """
    grid, points = continuum.grid, solution.pressure.size
    spacing = continuum.period / points
    if nodes + 2 * margin < MIN_POLYNOMIAL:
        return _edges_not_found()
    gap = np.empty(nodes)
    opening = np.empty(nodes)
    for i in range(nodes):
        node = (start + i) % points
        gap[i] = opening[i] = 0.0
        if not solution.contact[node]:
            gap[i] = solution.plane - solution.deformed[node]
            opening[i] = solution.displacement[node] - solution.rate  # per mean pressure
    window = nodes + 2 * margin
    scale, stiffness, windows = scale_of(window), continuum.stiffness, continuum.windows
    nodal_pressure = fit_without(relaxed, gap, stiffness, start, margin, windows)  # the one that closes this gap
    nodal_rate = fit_without(solution.per_load, opening, stiffness, start, margin, windows)
    profile = fit_without(grid.height, np.zeros(nodes), stiffness, start, margin, windows)
    pressure, rate = average_under_triangle(nodal_pressure, scale), average_under_triangle(nodal_rate, scale)
    fourth = derivative(derivative(derivative(derivative(profile))))
    for k in range(TERMS):
        pressure[k] += ALIAS / spacing * fourth[k] / scale**4
    centre, half_width, found = _edges_of_gap(pressure, nodes, scale)
    if not found:
        return _edges_not_found()
    compliance_error, resistance_error, uncertain = _errors_of_depth(
        nodal_pressure, pressure, rate, nodes, window, factor, grid.max_residual, continuum, spacing
    )
    grid_mixed = grid_energy = mixed = energy = 0.0
    closing = without_own(solution.per_load, opening, stiffness, start, np.arange(nodes))
    closing += added_by_triangles(rate, nodes, scale)
    for i in range(nodes):
        grid_mixed += spacing * gap[i] * closing[i]
        grid_energy += spacing * opening[i] * closing[i]
    half_length = half_width * scale * spacing
    if half_width > 0:
        mixed, energy = gap_energy(
            expansion(pressure, centre, half_width), expansion(rate, centre, half_width), half_length
        )
    middle = (start + (nodes - 1) / 2 + centre * scale) * spacing
    compliance, resistance = ((grid_mixed - mixed) / continuum.period, (grid_energy - energy) / continuum.period)
    return GapCorrection(
        compliance, resistance, middle - half_length, middle + half_length, compliance_error, resistance_error,
        uncertain,
    )  # fmt: skip


@kernel
def _errors_of_depth(
    nodal_pressure: Array, pressure: Array, rate: Array, nodes: int, window: int, factor: float,
    max_residual: float, continuum: Continuum, spacing: float,
) -> tuple[float, float, bool]:  # fmt: skip
    """Errors of both numbers by `factor` times the next two terms of the pressure; whether these may close the gap.

    They are much where few nodes are in the window, or an edge of contact is near it.
    """
    scale, rest = scale_of(window), np.empty((2, TERMS + 2))
    remainder(nodal_pressure, continuum.windows, window, continuum.angle, rest)
    least, depth, bend = deepest(pressure, (nodes + 1) / 2 / scale)
    per_load = value(rate, least)
    if bend <= 0 or per_load <= 0:
        return 0.0, 0.0, False
    pressure_error = factor * (abs(value(rest[0], least)) + abs(value(rest[1], least)))
    pressure_error += OPEN_DEPTH * continuum.angle**3 * bend / scale**2  # times the square of the wavenumber
    pressure_error += (
        max_residual * continuum.angle / (2 * np.pi * spacing)
    )  # heights are off by a wave as high as that
    if depth <= -pressure_error:
        return 0.0, 0.0, False
    resistance = (2 * np.pi * per_load * scale * spacing) ** 2 * pressure_error / (bend * continuum.period)
    return resistance * (max(depth, 0.0) + pressure_error) / per_load, resistance, abs(depth) <= pressure_error


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
