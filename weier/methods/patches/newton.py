"""Few contacts or gaps, whose set is right: Newton's method for their density and edges, with a dense matrix.

The formulas are those of docs/patches.md: "Contacts and gaps" for the integral equation, "Chebyshev polynomials" for
the nodes and points, "Few segments" for the derivatives and for when a set is refused, "Two grids" for the
corrections and when they end, and "Edges" for the strengths.

Two problems have the same integral equation, int rho(s) cot(pi (x-s)/L) ds = f(x) on the segments, for a density
rho = sqrt(1-t^2) phi(t) that vanishes at their ends:

contacts (primal)
    rho is the pressure, and f = -L z'/(2 pi). Then the gap is constant on each contact; that it is 0 takes an
    equation of height for each, 2 int rho ln|2 sin(pi (x-s)/L)| ds + indentation + z - max z = 0. The load is
    int rho dx = p L.
gaps (dual)
    rho is the slope of the gap, and f = -2 pi L p_full, where p_full is the pressure of full contact. Each gap closes
    at its far end, int rho dx = 0. The mean gap follows from its moment, d = -(1/L) int (x - c) rho dx.

The unknowns are, in this order, phi at all nodes; all centres and all half-widths, whose changes are counted in
units of the half-width; and the approach, which is the indentation (primal) or -d (dual), so that its derivative in
the mean pressure is the resistance in both problems.

A load goes through these steps:

1. `_newton_iteration` solves the equations on few nodes, which resolve three digits, by factorising their matrix. It
   starts close to the solution, and gives up where a step would leave a segment no width or make two overlap.
2. `solve_on_segments` interpolates the density to as many nodes as the tolerance needs. There `_advance` assembles
   the equations and makes corrections, each by the factors of the last matrix on few nodes (`_correction`). On one
   segment the density a_k U_k makes the left side L a_k T_(k+1), so that the fast modes are solved one by one. Only
   the slow modes, by which segments act on each other and on their ends, need the matrix.
3. `_add_resistance` finds the derivative of all unknowns by the load with the same corrections (`_find_tangent`).
4. `solve_few_contacts` checks the inequalities (`_violations`) and certifies the solution. Where the set of segments
   turns out to be wrong, it is refused: `many_contacts` corrects it.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices, Records
from weier.kernels.jit import kernel
from weier.methods.chebyshev import Table, gauss_rule, log_moments
from weier.methods.errors import ConvergenceError
from weier.methods.patches.certificate import certify, contact_residual, gap_uncertainty
from weier.methods.patches.inequalities import find_negative_intervals, minima_outside
from weier.methods.patches.segments import (
    COARSE_TOLERANCE,
    Blocks,
    ContactState,
    Segments,
    Sides,
    apply_blocks,
    are_resolved,
    coefficient_tails,
    distances_between,
    estimate_node_count,
    increase_node_count,
    make_blocks,
    make_segments,
    segment_strengths,
)
from weier.methods.patches.surface import CosineSeries, Surface, evaluate_series
from weier.theory.halfplane import take_logarithms

Matrix = NDArray[np.float64]
Factors = tuple[Matrix, NDArray[np.int32]]

MAX_UNKNOWNS = 5000  # The matrix then takes 0.2 GB.
MAX_STEPS = 25  # Corrections of one solution; usually two for the unknowns and two for their tangent are enough.
MAX_NEWTON_STEPS = 8  # Two or three steps are usual; a guess that takes more is not near enough to the solution.
# Corrections below this relative size that stop shrinking are rounding, as in a contact that has just been born.
MAX_ROUNDING_STEP = 1e-4
# A correction must be at most this part of the second before it, since two in a row may be of one size where two
# contacts nearly merge. If it is larger, the slow modes need more than the few nodes.
MAX_RATIO = 0.5
# Corrections of the tangent end when further ones would change the resistance by less than this part of it.
TANGENT_TOLERANCE = 1e-11
# After a correction whose relative size is below this, the equations are not assembled again: their matrix, of the
# state before it, changed the resistance of 360 random loads by 1.6e-11 at most, of 5e-11 that are stated.
MAX_FROZEN_CORRECTION = 1e-10
MAX_NODE_ROUNDS = 8  # Rounds of adding nodes; one or two are usual.
MIN_ANGLE = 1e-8  # Below it sin(y) = y and y cot(y) = 1 to rounding.
# This tension, over the largest pressure, may remain where two contacts have nearly merged. The gap that it would
# open changes the resistance in proportion to it, and the compliance in proportion to its square.
MAX_TENSION = 1e-9
# An overlap shows that a contact is missing if it is beyond this part of the approach, which is rounding, and beyond
# so many times the residual on the contacts, which is how well the gap is known. That is tighter than the tolerance,
# since next to its birth a contact changes the resistance far more than the compliance.
MIN_OVERLAP, OVERLAP_FACTOR = 1e-12, 10.0


class System(NamedTuple):
    """The linear equations of a Newton step.

    matrix : the derivatives of all equations in one unknown a row, shape (unknowns, equations)
    residual, by_load : of the equations, and its derivative in the mean pressure, shape (equations,)
    tangent : derivative of the unknowns by the mean pressure, shape (unknowns,)
    sine, cosine : of pi r t/L at the nodes, shape (nodes,). By the addition theorem, they give sin(pi (x-s)/L)
        without a further call; no digit is lost, for both angles are counted from the centre of one segment.
    point_sine, point_cosine : the same at the points, shape (nodes + segments,)
    """

    matrix: Matrix
    residual: Array
    by_load: Array
    tangent: Array
    sine: Array
    cosine: Array
    point_sine: Array
    point_cosine: Array


class TwoGrids(NamedTuple):
    """The matrices that turn a residual on many nodes into a change of the unknowns (docs/patches.md, "Two grids").

    restriction : from the residual at the points of many nodes, sum eta_m T_m, to its first terms at those of few
    interpolation : from phi at few nodes to phi at many
    fast : from the residual to the change of phi in the modes that few nodes do not have, a_k = eta_(k+1)/L
    lift : from the residual to what these modes change of the height at the centre of their own contact, over its r
    expansion : from phi at many nodes to its coefficients in U_k
    factors : LU factors of the Jacobian on few nodes, and their pivots
    """

    restriction: Blocks
    interpolation: Blocks
    fast: Blocks
    lift: Blocks
    expansion: Blocks
    factors: Factors


_NO_BLOCKS = Blocks(np.empty(0), np.zeros((3, 1), np.int64))
_NO_FACTORS = np.empty((2, 2), order="F"), np.empty(0, np.int32)
NO_GRIDS = TwoGrids._make((*5 * [_NO_BLOCKS], _NO_FACTORS))  # Newton's steps take no corrections.


@lru_cache(maxsize=256)
def _modes(less: int, count: int, period: float, dual: bool) -> tuple[Table, Table, Table, Table]:
    """Matrices of one segment on `less` nodes and on `count`: restriction, interpolation, fast modes, and their lift.

    The residual at the count + 1 points is a sum of T_m, m <= count. Its terms up to m = less are what the fewer
    points can represent. The others are taken off by a_k = eta_(k+1)/L, k >= less, as a_k U_k makes L a_k T_(k+1).
    Such a mode changes the height at the centre of its own contact by 2 r a_k int sqrt(1-t^2) U_k ln|t| dt.
    """
    few, many = gauss_rule(less, True), gauss_rule(count, True)
    to_T, kept = gauss_rule(count + 1, False).expansion, min(less, count)
    restriction = gauss_rule(less + 1, False).polynomial[: kept + 1].T @ to_T[: kept + 1]
    interpolation = many.polynomial[:kept].T @ few.expansion[:kept]
    to_U = to_T[less + 1 :] / period
    lift = 2 * (not dual) * log_moments(count)[None, less:] @ to_U
    return restriction, interpolation, many.polynomial[less:].T @ to_U, lift


@lru_cache(maxsize=64)
def _mode_blocks(few: tuple[int, ...], many: tuple[int, ...], period: float, dual: bool) -> tuple[Blocks, ...]:
    """The matrices of `TwoGrids` for these node counts of each segment; kept, since other loads often have them."""
    modes = (_modes(less, count, period, dual) for less, count in zip(few, many, strict=True))
    expansions = (gauss_rule(count, True).expansion for count in many)
    return *map(make_blocks, zip(*modes, strict=True)), make_blocks(expansions)


def _make_system(node_count: Indices, load: float) -> System:
    """Arrays for the equations on so many nodes of each segment.

    ConvergenceError is raised if they are more than a dense matrix holds.
    """
    nodes, segments = int(node_count.sum()), node_count.size
    size = nodes + 2 * segments + 1
    if size > MAX_UNKNOWNS:
        raise ConvergenceError(
            f"{size} unknowns under {load:.6g} p_0* are more than a dense matrix holds, {MAX_UNKNOWNS}"
        )
    unknowns = np.empty((size, size)), np.empty(size), np.empty(size), np.zeros(size)
    points = nodes + segments
    return System(*unknowns, np.empty(nodes), np.empty(nodes), np.empty(points), np.empty(points))


@kernel
def _assemble(system: System, now: ContactState, approach: float, series: CosineSeries) -> None:
    """Fill in the residuals of all equations at a state, and their derivatives by all unknowns and by the load.

    First is the integral equation at all points, then the height (primal) or the closure (dual) of each segment, and
    last the load or the mean gap.
    """
    segments, n = now.segments, now.segments.centre.size
    for k in range(system.residual.size):
        system.residual[k], system.by_load[k] = 0.0, 0.0
        for i in range(system.residual.size):
            system.matrix[k, i] = 0.0
    _fill_sines(system.sine, system.cosine, segments, segments.node, 0, series.period)
    _fill_sines(system.point_sine, system.point_cosine, segments, segments.point, 1, series.period)
    for j in range(n):
        _add_forcing(system, now, series, j)
        _add_cauchy_integral(system, segments, now.phi, series.period, j)
    if now.dual:
        _fill_closure_rows(system, now, approach, series.period)
    else:
        for i in range(n):
            _fill_height_row(system, now, approach, series, i)
        _fill_load_row(system, now, series.period)


@kernel
def _fill_sines(sine: Array, cosine: Array, segments: Segments, t: Array, more: int, period: float) -> None:
    """Sine and cosine of pi r t/L, where each segment has so many t more than nodes."""
    for j in range(segments.centre.size):
        for q in range(segments.first_node[j] + j * more, segments.first_node[j + 1] + (j + 1) * more):
            angle = np.pi / period * segments.half_width[j] * t[q]
            sine[q], cosine[q] = np.sin(angle), np.cos(angle)


@kernel
def _add_forcing(system: System, now: ContactState, series: CosineSeries, i: int) -> None:
    """The forcing -f at the points x = c + r t of segment i, and r times its derivatives in c and r."""
    segments, centre = now.segments, now.phi.size + i
    r, width = segments.half_width[i], centre + segments.centre.size
    for a in range(segments.first_node[i] + i, segments.first_node[i + 1] + i + 1):
        value, slope, curvature = evaluate_series(
            series, segments.crest[i], segments.centre[i] + r * segments.point[a]
        )
        if now.dual:
            system.residual[a] += 2 * np.pi * series.period * (now.load - series.maximum - value)
            system.by_load[a] = 2 * np.pi * series.period
            dforcing_dx = -2 * np.pi * series.period * slope
        else:
            system.residual[a] += slope * series.period / (2 * np.pi)
            dforcing_dx = curvature * series.period / (2 * np.pi)
        system.matrix[centre, a] += dforcing_dx * r
        system.matrix[width, a] += dforcing_dx * r * segments.point[a]


@kernel
def _angle_between_centres(segments: Segments, i: int, j: int, factor: float) -> tuple[float, float]:
    """Sine and cosine of pi (c_i - c_j)/L."""
    angle = factor * (segments.origin[i] - segments.origin[j] + (segments.centre[i] - segments.centre[j]))
    return np.sin(angle), np.cos(angle)


@kernel
def _add_cauchy_integral(system: System, segments: Segments, phi: Array, period: float, j: int) -> None:
    """I = int rho cot(pi (x-s)/L) ds over segment j at all points x = c_i + r_i t.

    With K = cot and dK/ds = (pi/L) (1 + K^2), dI/dc_j = sum w r phi dK/ds = -dI/dx, and
    r_j dI/dr_j = sum w r phi (K + r_j t dK/ds). Where i = j, x moves with the segment: then nothing changes with
    c_j, and r_j t dI/dx is added to the derivative in r_j.
    """
    n, size, factor, r = segments.centre.size, segments.point.size, np.pi / period, segments.half_width[j]
    centre, width = system.matrix[segments.node.size :], system.matrix[segments.node.size + n :]
    sine, cosine = np.empty(size), np.empty(size)  # of pi (x - c_j)/L
    for i in range(n):
        s, c = _angle_between_centres(segments, i, j, factor)
        for a in range(segments.first_node[i] + i, segments.first_node[i + 1] + i + 1):
            sine[a] = s * system.point_cosine[a] + c * system.point_sine[a]
            cosine[a] = c * system.point_cosine[a] - s * system.point_sine[a]
    integral, by_centre, by_width = np.zeros(size), np.zeros(size), np.zeros(size)
    for q in range(segments.first_node[j], segments.first_node[j + 1]):
        u, v, cot = system.sine[q], system.cosine[q], system.matrix[q, :size]
        for a in range(size):  # loops of their own, which the compiler turns into operations on four at a time
            cot[a] = (cosine[a] * v + sine[a] * u) / (sine[a] * v - cosine[a] * u)
        weight, lever = r * segments.weight[q], r * segments.node[q]
        here = weight * phi[q]
        for a in range(size):
            term, slope = here * cot[a], factor * here * (1 + cot[a] * cot[a])
            cot[a] *= weight
            integral[a] += term
            by_centre[a] += slope
            by_width[a] += term + lever * slope
    for i in range(n):
        own = segments.half_width[i]
        for a in range(segments.first_node[i] + i, segments.first_node[i + 1] + i + 1):
            system.residual[a] += integral[a]
            if i == j:
                width[i, a] += by_width[a] - own * segments.point[a] * by_centre[a]
            else:
                centre[i, a] -= by_centre[a] * own
                width[i, a] -= by_centre[a] * own * segments.point[a]
                centre[j, a] += by_centre[a] * r
                width[j, a] += by_width[a]


@kernel
def _fill_height_row(system: System, now: ContactState, approach: float, series: CosineSeries, i: int) -> None:
    """The gap is 0 at the centre x = c_i of contact i. The row is divided by r_i, so that all rows are of one size.

    Contact j contributes V_j = 2 int rho ln|2 sin(pi (x-s)/L)| ds, with dV_j/dc_j = -dV_j/dx and r_j dV_j/dr_j. The
    whole, approach + z - max z + sum V_j, has the derivative z' - sum dV_j/dc_j in c_i.
    """
    segments, phi, n = now.segments, now.phi, now.segments.centre.size
    row = system.matrix[:, phi.size + n + i]
    value, slope, _ = evaluate_series(series, segments.crest[i], segments.centre[i])
    scale = 1 / segments.half_width[i]
    total = (approach + value) * scale
    row[phi.size + i] = slope
    potential, dln_dx, dln_dr = _log_potentials(system, segments, i, series.period)
    for j in range(n):
        r, dV_dc, dV_dr = segments.half_width[j], 0.0, 0.0
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            weight = r * segments.weight[q]
            row[q] = 2 * potential[q] * scale
            total += 2 * potential[q] * phi[q] * scale
            dV_dc -= 2 * weight * phi[q] * dln_dx[q]
            dV_dr += 2 * (potential[q] + weight * dln_dr[q]) * phi[q]
        row[phi.size + i] -= dV_dc
        row[phi.size + j] += dV_dc * r * scale
        row[phi.size + n + j] += dV_dr * scale
    row[-1] = scale
    system.residual[phi.size + n + i] = total


@kernel
def _log_potentials(system: System, segments: Segments, i: int, period: float) -> tuple[Array, Array, Array]:
    """Of all nodes, at the centre of segment i: w r ln|2 sin(pi (x-s)/L)|, d ln/dx and r d ln/dr.

    From a node of another segment, d ln/dx = (pi/L) cot(pi (x-s)/L) and r d ln/dr = -r t d ln/dx. From one of its
    own, s = r t away, d ln/dx counts as 0, since the segment moves with its centre, r d ln/dr = (pi s/L) cot(pi s/L),
    and the singular part ln|t| is integrated in closed form by `Segments.log_weight`.
    """
    factor, n, N = np.pi / period, segments.centre.size, segments.node.size
    distance, dln_dx, dln_dr = np.empty(N), np.zeros(N), np.ones(N)
    for j in range(n):
        s, c = _angle_between_centres(segments, i, j, factor)
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            x, sine, cosine = segments.half_width[j] * segments.node[q], system.sine[q], system.cosine[q]
            if i != j:
                distance[q] = abs(2 * (s * cosine - c * sine))
                dln_dx[q] = factor * (c * cosine + s * sine) / (s * cosine - c * sine)
                dln_dr[q] = -x * dln_dx[q]
            elif factor * abs(x) < MIN_ANGLE:
                distance[q] = 2 * factor * segments.half_width[j]
            else:
                distance[q] = abs(2 * sine / segments.node[q])
                dln_dr[q] = factor * x * cosine / sine
    take_logarithms(distance)
    for j in range(n):
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            distance[q] *= segments.half_width[j] * segments.weight[q]
            if i == j:
                distance[q] += segments.half_width[j] * segments.log_weight[q]
    return distance, dln_dx, dln_dr


@kernel
def _fill_load_row(system: System, now: ContactState, period: float) -> None:
    """The contacts carry the load, int rho dx = p L; the row is divided by the largest half-width."""
    segments, row = now.segments, system.matrix[:, -1]
    scale, widths, carried = 1 / segments.half_width.max(), now.phi.size + segments.centre.size, 0.0
    for j in range(segments.centre.size):
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            row[q] = scale * segments.half_width[j] * segments.weight[q]
            row[widths + j] += row[q] * now.phi[q]
        carried += row[widths + j]
    system.residual[-1], system.by_load[-1] = carried - scale * (now.load * period), -scale * period


@kernel
def _fill_closure_rows(system: System, now: ContactState, approach: float, period: float) -> None:
    """int rho dx = 0: each gap, which opens at one end of its segment, has closed at the other.

    And the approach is minus the mean gap: approach = (1/L) int (x - c) rho dx.
    """
    segments, matrix, residual = now.segments, system.matrix, system.residual
    matrix[-1, -1], residual[-1] = -1.0, -approach
    for j in range(segments.centre.size):
        row, r = now.phi.size + segments.centre.size + j, segments.half_width[j]
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            matrix[q, row], matrix[q, -1] = segments.weight[q], r * r * segments.weight[q] * segments.node[q] / period
            moment = matrix[q, -1] * now.phi[q]
            residual[row] += segments.weight[q] * now.phi[q]
            residual[-1] += moment
            matrix[row, -1] += 2 * moment


@kernel
def _solve_factorised(lu: Matrix, pivot: NDArray[np.int32], x: Array) -> None:
    """Replace a right side by the solution for it, by LAPACK's factors of a matrix."""
    for k in range(x.size):
        x[k], x[pivot[k]] = x[pivot[k]], x[k]
    for k in range(x.size):
        for i in range(k + 1, x.size):
            x[i] -= x[k] * lu[i, k]
    for k in range(x.size - 1, -1, -1):
        x[k] /= lu[k, k]
        for i in range(k):
            x[i] -= x[k] * lu[i, k]


@kernel
def _correction(grids: TwoGrids, residual: Array) -> Array:
    """The change of the unknowns that removes a residual, but for what fast modes do to other segments.

    The right side of the equations on few nodes is the restricted residual at their points; the heights (or closures)
    less the lift of the fast modes; and the load. Their solution is interpolated and the fast modes are added. The
    edges and the approach are the same unknowns on both grids.
    """
    restricted, lift = apply_blocks(grids.restriction, residual), apply_blocks(grids.lift, residual)
    few, points = restricted.size, grids.restriction.start[2, -1]
    slow, change = np.empty(few + residual.size - points), np.empty(residual.size)
    for q in range(slow.size):
        slow[q] = restricted[q] if q < few else residual[points + q - few]
    for j in range(lift.size):
        slow[few + j] -= lift[j]
    _solve_factorised(grids.factors[0], grids.factors[1], slow)
    phi, fast = apply_blocks(grids.interpolation, slow), apply_blocks(grids.fast, residual)
    few = grids.interpolation.start[2, -1]
    for q in range(residual.size):
        change[q] = -(phi[q] + fast[q] if q < phi.size else slow[few + q - phi.size])
    return change


def _change_nodes(now: ContactState, node_count: Indices, interpolation: Blocks) -> ContactState:
    """The density on so many nodes of each segment, in arrays of its own."""
    origin, centre, half_width = now.segments.extent
    segments = make_segments(now.segments.crest, origin, centre.copy(), half_width.copy(), node_count)
    return ContactState(now.dual, now.load, now.approach, segments, apply_blocks(interpolation, now.phi))


def on_few_nodes(now: ContactState, series: CosineSeries) -> ContactState:
    """The state on as few nodes as a guess has, for Newton's method to start from."""
    count = estimate_node_count(now.segments.extent, series, COARSE_TOLERANCE)
    counts = tuple(now.segments.node_count.tolist()), tuple(count.tolist())
    return _change_nodes(now, count, _mode_blocks(*counts, series.period, now.dual)[1])


def _own_density(guess: ContactState, series: CosineSeries) -> ContactState:
    """The guess with the slope that each gap has under the pressure of full contact if it were the only one.

    A guess of gaps has no slope yet, and this is one to begin with. With no density, the residual is the forcing. On
    0 few nodes there are no slow modes, so that the fast ones, a_k = eta_(k+1)/L, are all.
    """
    counts = tuple(guess.segments.node_count.tolist())
    fast = _mode_blocks(len(counts) * (0,), counts, series.period, True)[2]
    system = _make_system(guess.segments.node_count, guess.load)
    _advance(_copy(guess), np.zeros(system.residual.size), system, NO_GRIDS, series, 0.0, 0)
    return guess._replace(phi=guess.phi - apply_blocks(fast, system.residual))


def _copy(now: ContactState) -> ContactState:
    """A state whose unknowns may be overwritten."""
    segments = now.segments._replace(centre=now.segments.centre.copy(), half_width=now.segments.half_width.copy())
    return now._replace(segments=segments, phi=now.phi.copy())


@kernel
def _move(now: ContactState, step: Array, period: float) -> float:
    """Make a step, in place, and return its size: the unknowns are of no use if it is inf or NaN.

    The size is the largest relative change of any segment's density, centre or width, or of a distance between
    segments: NaN if the step is not finite, and inf if a width or a distance would not be positive.
    """
    segments, r, phi, size = now.segments, now.segments.half_width, now.phi, 0.0
    n, N, distance = r.size, phi.size, distances_between(segments.origin, segments.centre, r, period)
    for j in range(n):
        k, of_phi, of_step = (j + 1) % n, 0.0, 0.0
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            of_phi, of_step = max(of_phi, abs(phi[q])), max(of_step, abs(step[q]))
        relative = of_step / of_phi if of_step > 0 else 0.0  # gaps begin without a density
        shift, growth = step[N + j], step[N + n + j]
        loss = (r[j] * (growth + shift) + r[k] * (step[N + n + k] - step[N + k])) / distance[j]
        is_lost = loss >= 1 or growth <= -1
        size = np.inf if is_lost else max(size, relative, abs(shift), abs(growth), abs(loss))
    total = 0.0
    for q in range(step.size):
        total += step[q]
    for q in range(N):
        phi[q] += step[q]
    for j in range(n):
        segments.centre[j] += step[N + j] * r[j]
        r[j] *= 1 + step[N + n + j]
    return size if np.isfinite(total) else np.nan


@kernel
def _advance(
    now: ContactState, step: Array, system: System, grids: TwoGrids, series: CosineSeries, tolerance: float, most: int
) -> tuple[float, float, int, bool]:
    """Make a step and then at most `most` corrections, in place; assemble the equations at each new state.

    It serves two callers. Newton's method calls it with `most` = 0 for its steps: it makes the step and assembles the
    equations for the next one, unless the step was within the tolerance, so that it was the last. `solve_on_segments`
    calls it with `most` > 0 and a step of 0: corrections follow, each from the residual of the state that the one
    before has left. The error that a correction leaves is about its size times its ratio to the one before. They end
    when that is below the tolerance, or when they stop shrinking and are as small as rounding. After one below
    `MAX_FROZEN_CORRECTION`, the equations stay those before it.

    Returns the approach, the size of the last correction, how many there were, and whether they converged.
    """
    approach, count, before, previous, is_solved, is_stuck = now.approach, 0, np.inf, np.inf, False, False
    while True:  # with one call of each function, which the compiler copies to where it is called
        size = _move(now, step, series.period)
        approach += step[-1]
        if count > 0:
            ratio, is_stuck = size / previous if count > 1 else 1.0, not (size < 1 and size <= MAX_RATIO * before)
            before, previous = previous, size
            is_solved = size * ratio < tolerance or (is_stuck and size < MAX_ROUNDING_STEP)
        if (count == 0 and most > 0) or not size < (MAX_FROZEN_CORRECTION if most > 0 else tolerance):
            _assemble(system, now, approach, series)
        if count == most or is_solved or is_stuck:
            return approach, size, count, is_solved
        step = _correction(grids, system.residual)
        count += 1


@kernel
def _find_tangent(system: System, grids: TwoGrids) -> tuple[int, float]:
    """Fill in the tangent; return how many corrections it took, and the relative error of the resistance in it.

    The tangent solves J tangent = -by_load, where J is the Jacobian on many nodes. It starts from 0, and each
    correction is that of the residual J tangent + by_load, which takes the place of `by_load`.
    """
    before, previous, error, tangent, residual = np.inf, np.inf, np.inf, system.tangent, system.by_load
    for step in range(1, MAX_STEPS + 1):
        change, size = _correction(grids, residual), 0.0
        for k in range(tangent.size):
            tangent[k] += change[k]
            size = max(size, abs(change[k]))
            for i in range(tangent.size):
                residual[i] += change[k] * system.matrix[k, i]
        error = abs(change[-1] / tangent[-1])
        ratio, is_stuck = size / max(previous, 1e-300), not size <= MAX_RATIO * before
        before, previous = previous, size
        # The first correction is the whole tangent, so that the ratio of the second to it says nothing.
        if step > 2 and error * ratio < TANGENT_TOLERANCE:
            return step, error * ratio
        if is_stuck:
            break
    return step, error


def _newton_iteration(guess: ContactState, series: CosineSeries) -> tuple[ContactState, Factors, int]:
    """The solution on the nodes of a guess, the factors of the last matrix, and the steps.

    ConvergenceError is raised if the steps do not shrink.
    """
    now, system = _copy(guess), _make_system(guess.segments.node_count, guess.load)
    change, (lu, pivot) = np.zeros(system.residual.size), _NO_FACTORS
    for steps in range(MAX_NEWTON_STEPS + 1):
        tolerance = COARSE_TOLERANCE if steps > 0 else 0.0  # there are no equations before the first step
        approach, size, *_ = _advance(now, -change, system, NO_GRIDS, series, tolerance, 0)
        now = now._replace(approach=approach)
        if size < tolerance:
            return now, (lu, pivot), steps
        lu, pivot, change, is_singular = scipy.linalg.lapack.dgesv(system.matrix.T, system.residual, overwrite_a=True)
        if is_singular or not size < np.inf:
            break
    raise ConvergenceError(f"Newton's method fails under the mean pressure {now.load:.6g} p_0*", float(size))


def solve_on_segments(
    surface: Surface, guess: ContactState, tolerance: float
) -> tuple[ContactState, int, System, TwoGrids]:
    """The state that solves the equations on the segments of a guess, whether the inequalities hold or not.

    Also the number of Newton's steps and corrections, and the equations and matrices of the last of them. Segments
    whose coefficients have not decayed get more nodes. ConvergenceError is raised unless the corrections fall below
    the tolerance, or to rounding.
    """
    series, load = surface.series(guess.dual), guess.load
    coarse, factors, steps = _newton_iteration(guess, series)
    few = coarse.segments
    count = estimate_node_count(few.extent, series, tolerance)
    count = np.maximum(count, few.node_count)
    for _ in range(MAX_NODE_ROUNDS):
        system = _make_system(count, load)
        counts = tuple(few.node_count.tolist()), tuple(count.tolist())
        grids = TwoGrids._make((*_mode_blocks(*counts, series.period, guess.dual), factors))
        now, none = _change_nodes(coarse, count, grids.interpolation), np.zeros(system.residual.size)
        approach, size, more, is_solved = _advance(now, none, system, grids, series, tolerance, MAX_STEPS)
        steps += more
        if not is_solved:
            raise ConvergenceError(f"the density does not converge under the mean pressure {load:.6g} p_0*", size)
        state = now._replace(approach=approach, coefficient=apply_blocks(grids.expansion, now.phi))
        resolved = are_resolved(state.segments, state.coefficient, tolerance)
        if np.all(resolved):
            return state, steps, system, grids
        count = increase_node_count(count, resolved, load)
    raise ConvergenceError(f"the density needs more nodes than expected under the mean pressure {load:.6g} p_0*")


def _add_resistance(state: ContactState, system: System, grids: TwoGrids) -> tuple[ContactState, int]:
    """The state with its resistance and the strengths of the tangent pressure at its edges, and the corrections.

    ConvergenceError is raised unless the corrections become small.
    """
    steps, error = _find_tangent(system, grids)
    if not error <= TANGENT_TOLERANCE:
        why = f"the resistance does not converge under the mean pressure {state.load:.6g} p_0*"
        raise ConvergenceError(why, error)
    strength = _tangent_strengths(state, system.tangent)
    return state._replace(resistance=float(system.tangent[-1]), tangent_strength=strength), steps


@kernel
def _tangent_strengths(state: ContactState, tangent: Array) -> Sides:
    """B at the edges of each segment, shape (segments, 2).

    An edge that moves out at the speed v turns the pressure A s^(1/2) into the tangent pressure B/s^(1/2) with
    B = A v/2 (docs/patches.md, "Edges").
    """
    strength, N, n = segment_strengths(state), state.phi.size, state.segments.centre.size
    for j in range(n):
        shift, growth, r = tangent[N + j], tangent[N + n + j], state.segments.half_width[j]
        strength[j, 0] = abs(0.5 * strength[j, 0] * (growth - shift) * r)
        strength[j, 1] = abs(0.5 * strength[j, 1] * (growth + shift) * r)
    return strength


def solve_few_contacts(surface: Surface, guess: ContactState, tolerance: float) -> tuple[ContactState, int]:
    """The state under one load, from a guess on few nodes, and the number of Newton's steps and corrections.

    A guess of contacts has Hertz's pressure, which is near enough; one of gaps has no slope yet. ConvergenceError is
    raised if Newton's method fails, or if the state does not meet the contact conditions.
    """
    series = surface.series(guess.dual)
    start = _own_density(guess, series) if guess.dual else guess
    state, steps, system, grids = solve_on_segments(surface, start, tolerance)
    state, more = _add_resistance(state, system, grids)
    residual = contact_residual(state, series)
    minima, negative, margin = _violations(state, series, residual.max(), tolerance)
    height = 2 * state.segments.half_width * residual if state.dual else residual
    state = state._replace(segment_residual=height)
    return certify(state, residual, minima, negative, series, tolerance, margin), steps + more


def _violations(
    state: ContactState, series: CosineSeries, residual: float, tolerance: float
) -> tuple[Records, Records, float]:
    """Minima off the segments below a margin, intervals on the segments with negative values, and the margin.

    ConvergenceError is raised if there is more overlap or tension than rounding leaves. The limits of both are no
    smaller than the last coefficients of a density, which bound what its nodes resolve. Of contacts, the limit of an
    overlap is less, since the gap off them is known as well as it vanishes on them, to the residual. The margin is
    how well a gap will be known once the state is certified, with this overlap, residual and tension left: minima
    below it may be births (docs/patches.md, "The error of the resistance").
    """
    unresolved = coefficient_tails(state.segments, state.coefficient, 0)
    outside, inside = (MAX_TENSION, tolerance) if state.dual else (tolerance, MAX_TENSION)
    scale, margin = state.load if state.dual else abs(state.approach), 0.0
    limit = max(tolerance, outside, float(unresolved.max())) * scale
    if not state.dual:
        limit = min(limit, max(MIN_OVERLAP * scale, OVERLAP_FACTOR * residual))
        margin = gap_uncertainty(limit + OVERLAP_FACTOR * residual + MAX_TENSION * scale, series)
    minima, negative = minima_outside(state, series, margin), find_negative_intervals(state)
    allowed = np.maximum(unresolved, max(tolerance, inside))[negative["segment"]]
    is_tensile = negative.size > 0 and np.any(negative["relative"] < -allowed)
    if is_tensile or minima["value"].min(initial=0.0) < -limit:
        raise ConvergenceError(f"another set of contacts is in contact under the mean pressure {state.load:.6g} p_0*")
    return minima, negative, margin
