"""Gaps of a few nodes, or of none: the dual problem, in which the pressure that closes the gap is a polynomial."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.continuum import Continuum
from weier.methods.bem.edges import Edges
from weier.methods.bem.grid_solution import GridSolution, next_node
from weier.methods.bem.grids import Grid
from weier.methods.bem.narrow_contacts import crest, gap_edges, gap_energy
from weier.methods.bem.polynomials import REST, derivative, expansion, remainder, slopes, value
from weier.methods.bem.windows import (
    CREST_MARGIN,
    EDGE,
    MAX_BEYOND,
    MIN_POLYNOMIAL,
    added_by_triangles,
    average_under_triangle,
    fit_window,
    margin_of,
    scale_of,
    side_margin,
)

ZETA_3 = 1.2020569031595942  # Riemann's zeta(3)
ALIAS = 2 * ZETA_3 / (2 * np.pi) ** 4  # times z'''' dx^3: what aliases of the triangles add to the pressure
EDGE_REST = 4.0  # in place of REST where the window ends at an edge of contact, near which the pressure is a root
# Of gaps that no node sees: what is left of their share of the numbers, and of their depth, which polynomial and
# aliases give with an error of angle^5 (measured on one wave at 32 to 256 points, where they are 6e-4 and 1.3e-3).
OPEN_SHARE = 0.01
OPEN_DEPTH = 0.01


class Dips(NamedTuple):
    """Least pressures inside contacts, which may be gaps between two nodes, by position; each of shape (dips,).

    left, right : edges of the gap, in lambda_0; NaN where there is none
    uncertain : whether a gap may be there or not
    """

    left: Array
    right: Array
    uncertain: Flags


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


@kernel
def _edges_not_found() -> GapCorrection:
    """Nothing yet: the edges of such a gap are taken one by one."""
    return GapCorrection(0.0, 0.0, np.nan, np.nan, 0.0, 0.0, False)


@kernel
def correct_gap(
    start: int, nodes: int, edge: Edges, run: int, solution: GridSolution, grid: Grid, continuum: Continuum
) -> GapCorrection:
    """What a narrow gap adds to compliance and resistance by its polynomial."""
    points = solution.pressure.size
    spacing = continuum.period / points
    margin = margin_of(edge, run)
    if nodes + 2 * margin < MIN_POLYNOMIAL:
        return _edges_not_found()
    gap = np.empty(nodes)
    opening = np.empty(nodes)  # its rate, per mean pressure
    for i in range(nodes):
        node = (start + i) % points
        gap[i] = solution.plane - solution.deformed[node]
        opening[i] = solution.displacement[node] - solution.rate
    whole = nodes + 2 * margin
    offset, scale = continuum.windows.offset[whole], scale_of(whole)
    seen = np.empty((3, continuum.windows.fitted[whole]))  # pressure that closes this gap, its rate, and z
    for i in range(seen.shape[1]):
        node = (start - margin + offset[i]) % points
        seen[0, i], seen[1, i], seen[2, i] = (solution.pressure[node], solution.per_load[node], grid.height[node])
        for j in range(nodes):
            stiffness = continuum.stiffness[abs(offset[i] - margin - j)]
            seen[0, i] -= stiffness * gap[j]
            seen[1, i] -= stiffness * opening[j]
    nodal_pressure, nodal_rate, profile = fit_window(continuum.windows, whole, seen)
    pressure = average_under_triangle(nodal_pressure, scale) + ALIAS / spacing * _fourth(profile, scale)
    rate = average_under_triangle(nodal_rate, scale)
    centre, half_width, found = _edges_of_gap(pressure, nodes, scale)
    if not found:
        return _edges_not_found()
    off, rate_off, uncertain = _errors_of_depth(
        nodal_pressure, pressure, rate, nodes, whole, REST, continuum, spacing
    )
    grid_mixed = grid_energy = mixed = energy = 0.0
    smoothing = added_by_triangles(rate, nodes, scale)
    for i in range(nodes):
        own = solution.per_load[(start + i) % points]
        for j in range(nodes):
            own -= continuum.stiffness[abs(i - j)] * opening[j]
        grid_mixed += spacing * gap[i] * (own + smoothing[i])
        grid_energy += spacing * opening[i] * (own + smoothing[i])
    half_length = half_width * scale * spacing
    if half_width > 0:
        mixed, energy = gap_energy(
            expansion(pressure, centre, half_width), expansion(rate, centre, half_width), half_length
        )
    middle = (start + (nodes - 1) / 2 + centre * scale) * spacing
    compliance, resistance = ((grid_mixed - mixed) / continuum.period, (grid_energy - energy) / continuum.period)
    return GapCorrection(
        compliance, resistance, middle - half_length, middle + half_length, off, rate_off, uncertain
    )  # fmt: skip


@kernel
def _errors_of_depth(
    nodal_pressure: Array, pressure: Array, rate: Array, nodes: int, whole: int, factor: float, continuum: Continuum,
    spacing: float,
) -> tuple[float, float, bool]:  # fmt: skip
    """Errors of both numbers by `factor` times the next two terms of the pressure; whether these may close the gap.

    They are much where few nodes are in the window, or an edge of contact is near it.
    """
    scale, following = scale_of(whole), continuum.windows.following[whole]
    rest = remainder(nodal_pressure, following, continuum.windows.degree[whole], scale * continuum.angle)
    least, depth, bend = deepest(pressure, (nodes + 1) / 2 / scale)
    per_load = value(rate, least)
    if bend <= 0 or per_load <= 0:
        return 0.0, 0.0, False
    off = factor * (abs(value(rest[0], least)) + abs(value(rest[1], least)))
    if depth <= -off:
        return 0.0, 0.0, False
    resistance = (2 * np.pi * per_load * scale * spacing) ** 2 * off / (bend * continuum.period)
    return resistance * (max(depth, 0.0) + off) / per_load, resistance, abs(depth) <= off


@kernel
def _edges_of_gap(pressure: Array, nodes: int, scale: float) -> tuple[float, float, bool]:
    """Centre and half width of a gap of so many nodes; 0 if the continuum has none there; whether this is known."""
    centre, half_width, found = gap_edges(pressure, 0.0, ((nodes + 1) / 2 - EDGE) / scale)
    if not found:  # from the parabola at the least pressure instead, which few nodes may see far off their middle
        least, depth, bend = deepest(pressure, (nodes + 1) / 2 / scale)
        if depth <= 0:
            return least, 0.0, bend > 0
        if bend > 0:
            centre, half_width, found = gap_edges(pressure, least, np.sqrt(4 * depth / bend))
    return (centre, half_width, found and abs(centre) + half_width <= ((nodes - 1) / 2 + MAX_BEYOND) / scale)


@kernel
def _fourth(polynomial: Array, scale: float) -> Array:
    """Fourth differences of a polynomial."""
    return derivative(derivative(derivative(derivative(polynomial)))) / scale**4


@kernel
def deepest(pressure: Array, reach: float) -> tuple[float, float, float]:
    """Where the pressure is least, at most `reach` from the middle; how far below 0, and its second derivative."""
    least = crest(-pressure, 0.0, reach)
    return least, -value(pressure, least), slopes(pressure, least)[1]


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
def _is_dip(node: int, solution: GridSolution) -> bool:
    """Whether a node has the least pressure of three in contact, and less than they bend."""
    after = next_node(node, solution.pressure.size)
    if not (solution.contact[node - 1] and solution.contact[node] and solution.contact[after]):
        return False
    left, here, right = (solution.pressure[node - 1], solution.pressure[node], solution.pressure[after])
    return here <= left and here < right and here < left + right - 2 * here


@kernel
def find_dips(solution: GridSolution) -> tuple[Indices, Dips]:
    """Nodes at which a gap may open between two of them, and room for what becomes of them."""
    points = solution.pressure.size
    nodes = np.empty(points // 2 + 1, np.int64)
    dips = 0
    for node in range(points):
        if _is_dip(node, solution):
            nodes[dips] = node
            dips += 1
    return nodes[:dips], Dips(np.full(dips, np.nan), np.full(dips, np.nan), np.zeros(dips, np.bool_))


@kernel
def open_gaps(
    nodes: Indices, dips: Dips, solution: GridSolution, grid: Grid, continuum: Continuum
) -> tuple[float, float, float, float]:
    """What gaps between two nodes add to compliance and resistance, and errors of both; their edges go to `dips`."""
    total = np.zeros(4)
    for dip in range(nodes.size):
        total += _open_gap(dip, nodes[dip], dips, solution, grid, continuum)
    return total[0], total[1], total[2], total[3]


@kernel
def _open_gap(dip: int, node: int, dips: Dips, solution: GridSolution, grid: Grid, continuum: Continuum) -> Array:
    """What one gap adds, as `open_gaps`."""
    points = solution.pressure.size
    spacing = continuum.period / points
    total = np.zeros(4)
    margin = side_margin(node, solution.contact)
    whole = 1 + 2 * margin
    scale = scale_of(whole)
    seen = np.empty((3, whole))
    for j in range(whole):
        near = (node - margin + j) % points
        seen[0, j], seen[1, j], seen[2, j] = (solution.pressure[near], solution.per_load[near], grid.height[near])
    nodal_pressure, nodal_rate, profile = fit_window(continuum.windows, whole, seen)
    pressure = average_under_triangle(nodal_pressure, scale) + ALIAS / spacing * _fourth(profile, scale)
    rate = average_under_triangle(nodal_rate, scale)
    least, depth, bend = deepest(pressure, 1 / scale)
    per_load = value(rate, least)
    if bend <= 0 or per_load <= 0:
        return total
    length = scale * spacing
    total[2], total[3] = _uncertain_opening(depth, bend, per_load, length, continuum, spacing)
    dips.uncertain[dip] = total[2] > 0 and abs(depth) * total[3] <= total[2] * per_load
    factor = REST if margin == CREST_MARGIN else EDGE_REST
    off, rate_off, uncertain = _errors_of_depth(nodal_pressure, pressure, rate, 1, whole, factor, continuum, spacing)
    total[2] += off
    total[3] += rate_off
    dips.uncertain[dip] |= uncertain
    if depth <= 0:
        return total
    centre, half_width, found = gap_edges(pressure, least, np.sqrt(4 * depth / bend))
    if not found or abs(centre) + half_width > 1:
        missed = (2 * np.pi * per_load * length) ** 2 * depth / (bend * continuum.period)
        total[2] += missed * depth / per_load
        total[3] += missed
        dips.uncertain[dip] = True
        return total
    mixed, energy = gap_energy(
        expansion(pressure, centre, half_width), expansion(rate, centre, half_width), half_width * length
    )
    middle = (node + centre * scale) * spacing
    dips.left[dip], dips.right[dip] = (middle - half_width * length, middle + half_width * length)
    total[0], total[1] = -mixed / continuum.period, -energy / continuum.period
    total[2] += OPEN_SHARE * abs(mixed) / continuum.period
    total[3] += OPEN_SHARE * abs(energy) / continuum.period
    return total
