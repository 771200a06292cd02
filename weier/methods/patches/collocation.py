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

from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need
from numpy.typing import NDArray

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.chebyshev import collocation_point
from weier.methods.patches.pair_kernel import take_logarithms
from weier.methods.patches.segments import Segments, distances_to_next, move_segments
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


@kernel
def assemble(
    segments: Segments, phi: Array, approach: float, series: CosineSeries, load: float, dual: bool
) -> tuple[Array, Array]:
    """The Jacobian and, as two columns, the residual and its derivative in the mean pressure."""
    N, n = phi.size, segments.centre.size
    size = N + 2 * n + 1
    system = System(np.zeros((size, size)), np.zeros((size, 2)), N, N + n)
    _fill_segment_rows(system, segments, phi, approach, series, load, dual)
    if dual:
        _fill_closure_rows(system, segments, phi, approach, series.period)
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
    jacobian, row = system.jacobian, system.width + i
    value, slope, _ = evaluate_series(series, segments.crest[i], segments.centre[i])
    scale = 1 / segments.half_width[i]
    total = (approach + value) * scale
    dtotal_dc = slope
    potential, dln_dx, dln_dr = log_potentials(segments, i, series.period)
    for j in range(segments.centre.size):
        r = segments.half_width[j]
        dV_dc, dV_dr = 0.0, 0.0
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            weight = r * segments.weight[q]
            jacobian[row, q] = 2 * potential[q] * scale
            total += 2 * potential[q] * phi[q] * scale
            dV_dc -= 2 * weight * phi[q] * dln_dx[q]
            dV_dr += 2 * (potential[q] + weight * dln_dr[q]) * phi[q]
        dtotal_dc -= dV_dc
        jacobian[row, system.centre + j] += dV_dc * r * scale
        jacobian[row, system.width + j] += dV_dr * scale
    jacobian[row, system.centre + i] += dtotal_dc
    jacobian[row, -1] = scale
    system.right_side[row, 0] = total


@kernel
def log_potentials(segments: Segments, i: int, period: float) -> tuple[Array, Array, Array]:
    """Of all nodes, at the centre of segment i: w r ln|2 sin(pi (x-s)/L)|, d ln/dx and r d ln/dr.

    From a node of another segment, d ln/dx = (pi/L) cot(pi (x-s)/L) and r d ln/dr = -r t d ln/dx. From one of its
    own, s = r t away, d ln/dx counts as 0, since the segment moves with its centre, r d ln/dr = (pi s/L) cot(pi s/L),
    and the singular part ln|t| is integrated in closed form by `Segments.log_weight`.
    """
    factor, n, N = np.pi / period, segments.centre.size, segments.node.size
    distance, dln_dx, dln_dr = np.empty(N), np.zeros(N), np.ones(N)
    for j in range(n):
        s, c = angle_between_centres(segments, i, j, factor)
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            x, sine, cosine = segments.half_width[j] * segments.node[q], segments.sine[q], segments.cosine[q]
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
def _fill_load_row(system: System, segments: Segments, phi: Array, force: float, period: float) -> None:
    """The contacts carry the load, int rho dx = p L; the row is divided by the largest half-width."""
    scale, carried = 1 / segments.half_width.max(), 0.0
    for j in range(segments.centre.size):
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            weight = scale * segments.half_width[j] * segments.weight[q]
            system.jacobian[-1, q] = weight
            system.jacobian[-1, system.width + j] += weight * phi[q]
        carried += system.jacobian[-1, system.width + j]
    system.right_side[-1, 0], system.right_side[-1, 1] = carried - scale * force, -scale * period


@kernel
def _fill_closure_rows(system: System, segments: Segments, phi: Array, approach: float, period: float) -> None:
    """int rho dx = 0: each gap, which opens at one end of its segment, has closed at the other.

    And the approach is minus the mean gap: approach = (1/L) int (x - c) rho dx.
    """
    jacobian, right_side = system.jacobian, system.right_side
    jacobian[-1, -1], right_side[-1, 0] = -1.0, -approach
    for j in range(segments.centre.size):
        row, r = system.width + j, segments.half_width[j]
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            weight = r * r * segments.weight[q] * segments.node[q] / period
            jacobian[row, q], jacobian[-1, q] = segments.weight[q], weight
            right_side[row, 0] += segments.weight[q] * phi[q]
            right_side[-1, 0] += weight * phi[q]
            jacobian[-1, row] += 2 * weight * phi[q]


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
        factors = _factorise(jacobian)
        previous_size = step_size
        segments, phi, approach, step_size = _take_step(segments, phi, approach, factors, right_side, series.period)
        if not step_size < np.inf:
            break
        if _is_small(step_size, previous_size, tolerance):
            sensitivity = -back_substitute(factors, right_side[:, 1].copy())
            return NewtonResult(steps, segments, phi, approach, sensitivity, factors)
    raise ConvergenceError(f"Newton's method fails under the mean pressure {load:.6g} p_0*", float(step_size))


def _is_small(step_size: float, previous_size: float, tolerance: float) -> bool:
    """Whether a step is below the tolerance, or so small that it should have shrunk more, were it not rounding."""
    return step_size < tolerance or (step_size < MAX_ROUNDING_STEP and step_size > MIN_ROUNDING_RATIO * previous_size)


def _factorise(matrix: Array) -> Factors:
    """The factors of a matrix; if it is singular, what is solved with them is not finite."""
    lu, pivot, _ = scipy.linalg.lapack.dgetrf(matrix.T, overwrite_a=True)  # LAPACK's columns are numpy's rows
    return lu.T, pivot


@kernel
def back_substitute(factors: Factors, right_side: Array) -> Array:
    """Solve with factors of the transposed matrix, whose columns are the rows of this array."""
    lu, pivot = factors
    x, n = right_side.copy(), right_side.size
    for j in range(n):
        x[j] = (x[j] - _dot(lu[j, :j], x[:j])) / lu[j, j]
    for j in range(n - 2, -1, -1):
        x[j] -= _dot(lu[j, j + 1 :], x[j + 1 :])
    for j in range(n - 1, -1, -1):
        x[j], x[pivot[j]] = x[pivot[j]], x[j]
    return x


@kernel
def _dot(a: Array, b: Array) -> float:
    """The product of two vectors, as four sums, which the compiler brings together in one register."""
    s, t, u, v = 0.0, 0.0, 0.0, 0.0
    whole = a.size // 4 * 4
    for i in range(0, whole, 4):
        s, t, u, v = s + a[i] * b[i], t + a[i + 1] * b[i + 1], u + a[i + 2] * b[i + 2], v + a[i + 3] * b[i + 3]
    for i in range(whole, a.size):
        s += a[i] * b[i]
    return s + t + (u + v)


@kernel
def _take_step(
    segments: Segments, phi: Array, approach: float, factors: Factors, right_side: Array, period: float
) -> tuple[Segments, Array, float, float]:
    """The unknowns after a step, and its size: inf or NaN if it cannot be taken, and nothing has changed."""
    step = -back_substitute(factors, right_side[:, 0].copy())
    size = relative_step(segments, phi, step)
    if size < np.inf:
        size = max(size, _largest_loss(segments, step, period))
    if not size < np.inf:
        return segments, phi, approach, size
    return apply_step(segments, step[phi.size :], period), phi + step[: phi.size], approach + step[-1], size


@kernel
def relative_step(segments: Segments, phi: Array, step: Array) -> float:
    """The largest relative change of any segment's density, centre or width; NaN if the step is not finite."""
    if not np.all(np.isfinite(step)):
        return np.nan
    largest = np.abs(step[phi.size : -1]).max()
    for j in range(segments.centre.size):
        here = slice(segments.first_node[j], segments.first_node[j + 1])
        largest = max(largest, np.abs(step[here]).max() / np.abs(phi[here]).max())
    return largest


@kernel
def _largest_loss(segments: Segments, step: Array, period: float) -> float:
    """The largest change of a distance between segments, over itself; inf if one of them or a width is lost."""
    n, r, distance = segments.centre.size, segments.half_width, distances_to_next(segments, period)
    growth, shift = step[-1 - n : -1], step[-1 - 2 * n : -1 - n]
    largest = 0.0
    for j in range(n):
        k = (j + 1) % n
        loss = (r[j] * (growth[j] + shift[j]) + r[k] * (growth[k] - shift[k])) / distance[j]
        if loss >= 1 or growth[j] <= -1:
            return np.inf
        largest = max(largest, abs(loss))
    return largest


@kernel
def apply_step(segments: Segments, step: Array, period: float) -> Segments:
    """The segments moved and widened by so many half-widths."""
    n, r = segments.centre.size, segments.half_width
    return move_segments(segments, segments.centre + step[:n] * r, r * (1 + step[n : 2 * n]), period)
