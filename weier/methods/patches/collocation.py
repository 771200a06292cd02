"""The equations on a set of segments whose ends are unknown, and their Jacobian.

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

Newton's method starts close to the solution, and gives up where a step would leave a segment no width or make two
overlap: then their number is wrong.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need
from numpy.typing import NDArray

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.chebyshev import collocation_point
from weier.methods.patches.segments import Segments, distances_to_next, move_segments, values_of_next
from weier.methods.patches.surface import CosineSeries, evaluate_series

Factors = tuple[Array, NDArray[np.int32]]

MAX_STEPS = 25
MAX_ROUNDING_STEP = 1e-5  # smaller steps that no longer shrink are rounding, as in a contact that has just been born
MIN_ROUNDING_RATIO = 0.3  # of a step over the one before: free of rounding, Newton's steps shrink far more
MIN_ANGLE = 1e-8  # below it sin(y) = y and y cot(y) = 1 to rounding


class System(NamedTuple):
    """The linear equations of a Newton step.

    jacobian : shape (unknowns, unknowns)
    right_side : the residual and its derivative in the mean pressure, as columns, shape (unknowns, 2)
    centre, width : index of the first column for the centres and for the half-widths; phi stands before them, and the
        approach behind. The equations of height (primal) or of closure (dual) begin at row `width`.
    """

    jacobian: Array
    right_side: Array
    centre: int
    width: int


def assemble(
    segments: Segments, phi: Array, approach: float, series: CosineSeries, load: float, dual: bool
) -> tuple[Array, Array]:
    """The Jacobian and, as two columns, the residual and its derivative in the mean pressure."""
    N, n = phi.size, segments.centre.size
    size = N + 2 * n + 1
    system = System(np.zeros((size, size)), np.zeros((size, 2)), N, N + n)
    _fill_segment_rows(system, segments, phi, approach, series, load, dual)
    if dual:
        _fill_closure_rows(system, segments, phi)
        _fill_mean_gap_row(system, segments, phi, approach, series.period)
    else:
        _fill_load_row(system, segments, phi, load * series.period, series.period)
    return system.jacobian, system.right_side


@kernel
def _fill_segment_rows(
    system: System, segments: Segments, phi: Array, approach: float, series: CosineSeries, load: float, dual: bool
) -> None:
    """The integral equation and, for contacts, the heights: all rows in which every node has its own element."""
    n = segments.centre.size
    for i in range(n):
        points = collocation_points(segments, i, series.period)
        _add_forcing(system, segments, series, load, dual, points, i)
        for j in range(n):
            _add_cauchy_integral(system, segments, phi, series.period, points, i, j)
        if not dual:
            _fill_height_row(system, segments, phi, approach, series, i)


@kernel
def collocation_points(segments: Segments, i: int, period: float) -> Array:
    """The points t of segment i, and sine and cosine of pi r t/L, as columns."""
    count = segments.first_node[i + 1] - segments.first_node[i]
    point = np.empty((count + 1, 3))
    for a in range(count + 1):
        point[a, 0] = collocation_point(a, count)
        angle = np.pi / period * segments.half_width[i] * point[a, 0]
        point[a, 1], point[a, 2] = np.sin(angle), np.cos(angle)
    return point


@kernel
def _add_forcing(
    system: System, segments: Segments, series: CosineSeries, load: float, dual: bool, points: Array, i: int
) -> None:
    """The forcing -f at the points x = c + r t of segment i, and r times its derivatives in c and r."""
    r, right_side = segments.half_width[i], system.right_side
    for a in range(points.shape[0]):
        row, t = segments.first_node[i] + i + a, points[a, 0]
        value, slope, curvature = evaluate_series(series, segments.crest[i], segments.centre[i] + r * t)
        if dual:
            right_side[row, 0] = 2 * np.pi * series.period * (load - series.maximum - value)
            right_side[row, 1] = 2 * np.pi * series.period
            dforcing_dx = -2 * np.pi * series.period * slope
        else:
            right_side[row, 0] = slope * series.period / (2 * np.pi)
            dforcing_dx = curvature * series.period / (2 * np.pi)
        system.jacobian[row, system.centre + i] = dforcing_dx * r
        system.jacobian[row, system.width + i] = dforcing_dx * r * t


@kernel
def angle_between_centres(segments: Segments, i: int, j: int, factor: float) -> tuple[float, float]:
    """Sine and cosine of pi (c_i - c_j)/L."""
    angle = factor * (segments.origin[i] - segments.origin[j] + (segments.centre[i] - segments.centre[j]))
    return np.sin(angle), np.cos(angle)


@kernel
def _add_cauchy_integral(
    system: System, segments: Segments, phi: Array, period: float, points: Array, i: int, j: int
) -> None:
    """I = int rho cot(pi (x-s)/L) ds over segment j at the points x = c_i + r_i t of segment i.

    With K = cot and dK/ds = (pi/L) (1 + K^2), dI/dc_j = sum w r phi dK/ds = -dI/dx, and
    r_j dI/dr_j = sum w r phi (K + r_j t_q dK/ds). Where i = j, x moves with the segment: then nothing changes with
    c_j, and r_j t dI/dx is added to the derivative in r_j.
    """
    jacobian, factor = system.jacobian, np.pi / period
    own_r, r = segments.half_width[i], segments.half_width[j]
    here = slice(
        segments.first_node[j], segments.first_node[j + 1]
    )  # a slice: numba need not expect negative indices
    node, weight = segments.node[here], r * segments.weight[here]
    weighted_phi, node_sine, node_cosine = weight * phi[here], segments.sine[here], segments.cosine[here]
    s, c = angle_between_centres(segments, i, j, factor)
    for a in range(points.shape[0]):
        row, t, u, v = segments.first_node[i] + i + a, points[a, 0], points[a, 1], points[a, 2]
        sine, cosine, cot = s * v + c * u, c * v - s * u, jacobian[row, here]
        for q in range(cot.size):  # a loop of its own, which the compiler turns into operations on four at a time
            cot[q] = (cosine * node_cosine[q] + sine * node_sine[q]) / (sine * node_cosine[q] - cosine * node_sine[q])
        integral, dI_dc, dI_dr = 0.0, 0.0, 0.0
        for q in range(cot.size):
            term, dterm_ds = weighted_phi[q] * cot[q], weighted_phi[q] * factor * (1 + cot[q] * cot[q])
            cot[q] *= weight[q]
            integral += term
            dI_dc += dterm_ds
            dI_dr += term + r * node[q] * dterm_ds
        if i == j:
            dI_dr, dI_dc = dI_dr - r * t * dI_dc, 0.0
        system.right_side[row, 0] += integral
        jacobian[row, system.centre + i] -= dI_dc * own_r
        jacobian[row, system.width + i] -= dI_dc * own_r * t
        jacobian[row, system.centre + j] += dI_dc * r
        jacobian[row, system.width + j] += dI_dr


@kernel
def _fill_height_row(
    system: System, segments: Segments, phi: Array, approach: float, series: CosineSeries, i: int
) -> None:
    """The gap is 0 at the centre x = c_i of contact i. The row is divided by r_i, so that all rows are of one size.

    Contact j contributes V_j = 2 int rho ln|2 sin(pi (x-s)/L)| ds, with dV_j/dc_j = -dV_j/dx and r_j dV_j/dr_j. The
    whole, approach + z - max z + sum V_j, has the derivative z' - sum dV_j/dc_j in c_i.
    """
    jacobian, row, factor = system.jacobian, system.width + i, np.pi / series.period
    value, slope, _ = evaluate_series(series, segments.crest[i], segments.centre[i])
    scale = 1 / segments.half_width[i]
    total = (approach + value) * scale
    dtotal_dc = slope
    for j in range(segments.centre.size):
        r = segments.half_width[j]
        s, c = angle_between_centres(segments, i, j, factor)
        dV_dc, dV_dr = 0.0, 0.0
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            weight = r * segments.weight[q]
            if i == j:
                potential, dln_dx, dln_dr = log_potential_at_own_centre(segments, q, r, factor)
            else:
                potential, dln_dx, dln_dr = log_potential_at_other_centre(segments, q, r, factor, s, c)
            jacobian[row, q] = 2 * potential * scale
            total += 2 * potential * phi[q] * scale
            dV_dc -= 2 * weight * phi[q] * dln_dx
            dV_dr += 2 * (potential + weight * dln_dr) * phi[q]
        dtotal_dc -= dV_dc
        jacobian[row, system.centre + j] += dV_dc * r * scale
        jacobian[row, system.width + j] += dV_dr * scale
    jacobian[row, system.centre + i] += dtotal_dc
    jacobian[row, -1] = scale
    system.right_side[row, 0] = total


@kernel
def log_potential_at_own_centre(segments: Segments, q: int, r: float, factor: float) -> tuple[float, float, float]:
    """Node q of contact i at the centre of that contact, s = r t away: w r ln|2 sin(pi s/L)|, d ln/dx, r d ln/dr.

    d ln/dx counts as 0, since the contact moves with its centre; r d ln/dr = (pi s/L) cot(pi s/L). The singular part
    ln|t| is integrated in closed form by `Segments.log_weight`.
    """
    weight, x = r * segments.weight[q], r * segments.node[q]
    small = factor * abs(x) < MIN_ANGLE
    log = np.log(2 * factor) if small else np.log(abs(2 * segments.sine[q] / x))
    dln_dr = 1.0 if small else factor * x * segments.cosine[q] / segments.sine[q]
    return weight * (np.log(r) + log) + r * segments.log_weight[q], 0.0, dln_dr


@kernel
def log_potential_at_other_centre(
    segments: Segments, q: int, r: float, factor: float, s: float, c: float
) -> tuple[float, float, float]:
    """The same for node q of another contact, whose centre is away by the angle with the sine s and the cosine c.

    d/dx ln|2 sin(pi (x-s)/L)| = (pi/L) cot(pi (x-s)/L), and r d ln/dr = -r t d ln/dx.
    """
    sine = s * segments.cosine[q] - c * segments.sine[q]
    dln_dx = factor * (c * segments.cosine[q] + s * segments.sine[q]) / sine
    return r * segments.weight[q] * np.log(abs(2 * sine)), dln_dx, -r * segments.node[q] * dln_dx


def _fill_load_row(system: System, segments: Segments, phi: Array, force: float, period: float) -> None:
    """The contacts carry the load, int rho dx = p L; the row is divided by the largest half-width."""
    scale = 1 / segments.half_width.max()
    weight = scale * _at_nodes(segments, segments.half_width) * segments.weight
    carried = _segment_sums(segments, weight * phi)
    system.jacobian[-1, : phi.size], system.jacobian[-1, system.width : -1] = weight, carried
    system.right_side[-1] = carried.sum() - scale * force, -scale * period


def _fill_closure_rows(system: System, segments: Segments, phi: Array) -> None:
    """int rho dx = 0: each gap, which opens at one end of its segment, has closed at the other."""
    row = system.width + _at_nodes(segments, np.arange(segments.centre.size))
    system.jacobian[row, np.arange(phi.size)] = segments.weight
    system.right_side[system.width : -1, 0] = _segment_sums(segments, segments.weight * phi)


def _fill_mean_gap_row(system: System, segments: Segments, phi: Array, approach: float, period: float) -> None:
    """The approach is minus the mean gap: approach = (1/L) int (x - c) rho dx."""
    jacobian = system.jacobian
    weight = _at_nodes(segments, segments.half_width**2) * segments.weight * segments.node / period
    moment = _segment_sums(segments, weight * phi)
    jacobian[-1, : phi.size], jacobian[-1, system.width : -1], jacobian[-1, -1] = weight, 2 * moment, -1.0
    system.right_side[-1, 0] = moment.sum() - approach


def _at_nodes(segments: Segments, value: NDArray[Any]) -> NDArray[Any]:
    """The value of each segment at all of its nodes."""
    return np.repeat(value, np.diff(segments.first_node))


def _segment_sums(segments: Segments, value: Array) -> Array:
    """The sum over the nodes of each segment."""
    return np.add.reduceat(value, segments.first_node[:-1])


class NewtonResult(NamedTuple):
    """Where Newton's method has led.

    steps : how many it took
    segments, phi, approach, sensitivity : the unknowns and their derivatives in the load, as in `ContactState`
    factors : of the last matrix
    """

    steps: int
    segments: Segments
    phi: Array
    approach: float
    sensitivity: Array
    factors: Factors


def newton_iteration(
    segments: Segments,
    phi: Array,
    approach: float,
    series: CosineSeries,
    load: float,
    dual: bool,
    tolerance: float,
) -> NewtonResult:
    """Solve for phi, the centres, the half-widths and the approach; ConvergenceError if the steps do not shrink."""
    step_size = np.inf
    for steps in range(1, MAX_STEPS + 1):
        jacobian, right_side = assemble(segments, phi, approach, series, load, dual)
        solution, factors = _solve(jacobian, right_side)
        step, previous_size = -solution[:, 0], step_size
        step_size = max(relative_step(segments, phi, step), _largest_loss(segments, step, series.period))
        if not step_size < np.inf:
            break
        phi, approach = phi + step[: phi.size], approach + step[-1]
        segments = apply_step(segments, step[phi.size :], series.period)
        if _is_small(step_size, previous_size, tolerance):
            return NewtonResult(steps, segments, phi, approach, -solution[:, 1], factors)
    raise ConvergenceError(f"Newton's method fails under the mean pressure {load:.6g} p_0*", float(step_size))


def _is_small(step_size: float, previous_size: float, tolerance: float) -> bool:
    """Whether a step is below the tolerance, or so small that it should have shrunk more, were it not rounding."""
    return step_size < tolerance or (step_size < MAX_ROUNDING_STEP and step_size > MIN_ROUNDING_RATIO * previous_size)


def _solve(matrix: Array, right_side: Array) -> tuple[Array, Factors]:
    """The solution, NaN if the matrix is singular, and the factors used."""
    lu, pivot, singular = scipy.linalg.lapack.dgetrf(matrix.T, overwrite_a=True)  # LAPACK's columns are numpy's rows
    if singular:
        return np.full_like(right_side, np.nan), (lu, pivot)
    return back_substitute((lu, pivot), right_side), (lu, pivot)


def back_substitute(factors: Factors, right_side: Array) -> Array:
    """Solve with factors."""
    return np.asarray(scipy.linalg.lapack.dgetrs(*factors, right_side, trans=1)[0])


def relative_step(segments: Segments, phi: Array, step: Array) -> float:
    """The largest relative change of any segment's density, centre or width; NaN if the step is not finite."""
    if not np.all(np.isfinite(step)):
        return np.nan
    starts = segments.first_node[:-1]
    change = np.maximum.reduceat(np.abs(step[: phi.size]), starts) / np.maximum.reduceat(np.abs(phi), starts)
    return float(max(change.max(), np.abs(step[phi.size : -1]).max()))


def _largest_loss(segments: Segments, step: Array, period: float) -> float:
    """The largest change of a distance between segments, over itself; inf if one of them or a width is lost."""
    n, r, distance = segments.centre.size, segments.half_width, distances_to_next(segments, period)
    growth, shift = step[-1 - n : -1], step[-1 - 2 * n : -1 - n]
    loss = (r * (growth + shift) + values_of_next(r * (growth - shift))) / distance
    if np.any(loss >= 1) or np.any(growth <= -1):
        return np.inf
    return float(np.abs(loss).max())


def apply_step(segments: Segments, step: Array, period: float) -> Segments:
    """The segments moved and widened by so many half-widths."""
    n, r = segments.centre.size, segments.half_width
    return move_segments(segments, segments.centre + step[:n] * r, r * (1 + step[n : 2 * n]), period)
