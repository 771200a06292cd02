"""Many nodes corrected by few: the solution on many nodes, without a matrix of their size.

On one segment, the density a_k U_k makes the right side L a_k T_(k+1) (`chebyshev`): but for the slow modes, by which
segments feel each other and their ends, the equations are solved mode by mode. The slow modes are those of a few
nodes, and their matrix has been factorised already by Newton's method on these. Each correction leaves about as much
of the error as the density has in the faster modes.

The equations are those of `collocation`, with rows and unknowns in the same order and units. Sums over the nodes of
one segment run, for each node, over all points of another: then nothing is added up across a register, and the
compiler works on several points at a time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.chebyshev import expansion_coefficients
from weier.methods.patches.collocation import (
    Factors,
    NewtonResult,
    angle_between_centres,
    apply_step,
    back_substitute,
    collocation_points,
    log_potential_at_other_centre,
    log_potential_at_own_centre,
    relative_step,
)
from weier.methods.patches.segments import Segments, make_segments
from weier.methods.patches.surface import CosineSeries, evaluate_series

MAX_STEPS = 12
MAX_RATIO = 0.5  # of a step over the one before: with more, the slow modes need more nodes
MAX_ROUNDING_STEP = 1e-5  # steps below this that no longer shrink are rounding, as in a contact just born
SENSITIVITY_TOLERANCE = 1e-11  # of the resistance, that further corrections would change
MAX_RESISTANCE_CHANGE = 1e-8  # of it by the last correction, where rounding ends them


class Change(NamedTuple):
    """A direction in the space of unknowns.

    phi : shape (nodes,)
    centre, half_width : in half-widths, shape (segments,)
    approach : in g_0
    """

    phi: Array
    centre: Array
    half_width: Array
    approach: float


def change_of(unknowns: Array, segments: int) -> Change:
    """The parts of a vector of unknowns."""
    nodes = unknowns.size - 2 * segments - 1
    return Change(unknowns[:nodes], unknowns[nodes : nodes + segments], unknowns[nodes + segments : -1], unknowns[-1])


@kernel
def residuals(
    segments: Segments, phi: Array, approach: float, series: CosineSeries, load: float, dual: bool
) -> Array:
    """What the equations are off, shape (unknowns,)."""
    n, period = segments.centre.size, series.period
    heights = phi.size + n
    row = np.zeros(heights + n + 1)
    density = np.empty(phi.size)
    for j in range(n):
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            density[q] = segments.half_width[j] * segments.weight[q] * phi[q]
    for i in range(n):
        points = collocation_points(segments, i, period)
        first = segments.first_node[i] + i
        for a in range(points.shape[0]):
            value, slope, _ = evaluate_series(
                series, segments.crest[i], segments.centre[i] + segments.half_width[i] * points[a, 0]
            )
            row[first + a] = (
                2 * np.pi * period * (load - series.maximum - value) if dual else slope * period / (2 * np.pi)
            )
        for j in range(n):
            _add_cauchy_sums(row[first : first + points.shape[0]], segments, density, period, points, i, j)
        if not dual:
            value = evaluate_series(series, segments.crest[i], segments.centre[i])[0]
            potential = _potential(segments, phi, period, i)
            row[heights + i] = (approach + value + 2 * potential) / segments.half_width[i]
    if dual:
        row[-1] = -approach
        for j in range(n):
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                row[heights + j] += segments.weight[q] * phi[q]
                row[-1] += segments.half_width[j] * density[q] * segments.node[q] / period
    else:
        row[-1] = (density.sum() - load * period) / segments.half_width.max()
    return row


@kernel
def _add_cauchy_sums(
    row: Array, segments: Segments, density: Array, period: float, points: Array, i: int, j: int
) -> None:
    """Add int rho cot(pi (x-s)/L) ds over segment j at the points of segment i."""
    sine, cosine = _angles(segments, period, points, i, j)
    for q in range(segments.first_node[j], segments.first_node[j + 1]):
        node_sine, node_cosine, here = segments.sine[q], segments.cosine[q], density[q]
        for a in range(row.size):
            row[a] += (
                here
                * (cosine[a] * node_cosine + sine[a] * node_sine)
                / (sine[a] * node_cosine - cosine[a] * node_sine)
            )


@kernel
def _angles(segments: Segments, period: float, points: Array, i: int, j: int) -> tuple[Array, Array]:
    """Sine and cosine of pi (x - c_j)/L at the points x of segment i."""
    s, c = angle_between_centres(segments, i, j, np.pi / period)
    sine, cosine = np.empty(points.shape[0]), np.empty(points.shape[0])
    for a in range(sine.size):
        sine[a] = s * points[a, 2] + c * points[a, 1]
        cosine[a] = c * points[a, 2] - s * points[a, 1]
    return sine, cosine


@kernel
def _potential(segments: Segments, phi: Array, period: float, i: int) -> float:
    """int rho ln|2 sin(pi (x-s)/L)| ds at the centre of segment i."""
    total, factor = 0.0, np.pi / period
    for j in range(segments.centre.size):
        r = segments.half_width[j]
        if i == j:
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                total += log_potential_at_own_centre(segments, q, r, factor)[0] * phi[q]
        else:
            s, c = angle_between_centres(segments, i, j, factor)
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                total += log_potential_at_other_centre(segments, q, r, factor, s, c)[0] * phi[q]
    return total


@kernel
def products(segments: Segments, phi: Array, series: CosineSeries, dual: bool, change: Change) -> Array:
    """The Jacobian of the equations times a change of the unknowns, shape (unknowns,)."""
    n, period = segments.centre.size, series.period
    heights = phi.size + n
    row = np.zeros(heights + n + 1)
    density, more, moment = np.empty(phi.size), np.empty(phi.size), np.empty(phi.size)
    for j in range(n):
        r = segments.half_width[j]
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            density[q] = r * segments.weight[q] * phi[q]
            more[q] = r * segments.weight[q] * change.phi[q] + density[q] * change.half_width[j]
            moment[q] = r * (change.centre[j] + segments.node[q] * change.half_width[j])
    for i in range(n):
        points = collocation_points(segments, i, period)
        first, r = segments.first_node[i] + i, segments.half_width[i]
        shift = r * (change.centre[i] + points[:, 0] * change.half_width[i])
        for a in range(points.shape[0]):
            _, slope, curvature = evaluate_series(series, segments.crest[i], segments.centre[i] + r * points[a, 0])
            row[first + a] = shift[a] * (-2 * np.pi * period * slope if dual else curvature * period / (2 * np.pi))
        for j in range(n):
            _add_cauchy_changes(
                row[first : first + points.shape[0]], segments, density, more, moment, shift, period, points, i, j
            )
        if not dual:
            slope = evaluate_series(series, segments.crest[i], segments.centre[i])[1]
            potential = _potential_change(segments, phi, change, period, i)
            row[heights + i] = (change.approach + slope * r * change.centre[i] + 2 * potential) / r
    if dual:
        row[-1] = -change.approach
        for j in range(n):
            r = segments.half_width[j]
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                row[heights + j] += segments.weight[q] * change.phi[q]
                row[-1] += r * (more[q] + density[q] * change.half_width[j]) * segments.node[q] / period
    else:
        row[-1] = more.sum() / segments.half_width.max()
    return row


@kernel
def _add_cauchy_changes(
    row: Array, segments: Segments, density: Array, more: Array, moment: Array, shift: Array, period: float,
    points: Array, i: int, j: int,
) -> None:  # fmt: skip
    """Add the change of `_add_cauchy_sums`: by the density, and by nodes and points that move, d cot/ds (ds - dx)."""
    sine, cosine = _angles(segments, period, points, i, j)
    for q in range(segments.first_node[j], segments.first_node[j + 1]):
        node_sine, node_cosine, there = segments.sine[q], segments.cosine[q], moment[q]
        here, moved = more[q], density[q] * np.pi / period
        for a in range(row.size):
            cot = (cosine[a] * node_cosine + sine[a] * node_sine) / (sine[a] * node_cosine - cosine[a] * node_sine)
            row[a] += here * cot + moved * (1 + cot * cot) * (there - shift[a])


@kernel
def _potential_change(segments: Segments, phi: Array, change: Change, period: float, i: int) -> float:
    """The change of `_potential`, where segment i moves along with its centre."""
    total, factor = 0.0, np.pi / period
    own = segments.half_width[i] * change.centre[i]
    for j in range(segments.centre.size):
        r, wider = segments.half_width[j], change.half_width[j]
        if i == j:
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                potential, _, dln_dr = log_potential_at_own_centre(segments, q, r, factor)
                total += potential * (change.phi[q] + phi[q] * wider)
                total += r * segments.weight[q] * phi[q] * dln_dr * wider
        else:
            s, c = angle_between_centres(segments, i, j, factor)
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                potential, dln_dx, dln_dr = log_potential_at_other_centre(segments, q, r, factor, s, c)
                total += potential * (change.phi[q] + phi[q] * wider)
                moved = dln_dx * (own - r * change.centre[j]) + dln_dr * wider
                total += r * segments.weight[q] * phi[q] * moved
    return total


def refine(
    coarse: NewtonResult, node_count: Indices, series: CosineSeries, load: float, dual: bool, tolerance: float
) -> NewtonResult:
    """Solve on so many nodes of each segment, from the solution on few: its result with the unknowns on many nodes.

    The steps are corrections of the solution and of its sensitivity. ConvergenceError is raised unless they fall
    below the tolerance, or to rounding.
    """
    few = coarse.segments
    segments = make_segments(few.crest, few.origin, few.centre, few.half_width, node_count, series.period)
    phi = prolong_density(coarse.phi, few.first_node, segments.first_node, np.zeros(segments.node.size))
    approach, N = coarse.approach, segments.node.size
    step_size = np.inf
    for steps in range(1, MAX_STEPS + 1):
        row = residuals(segments, phi, approach, series, load, dual)
        step = -_correction(row, coarse.factors, few, segments, series.period, dual)
        previous, step_size = step_size, relative_step(segments, phi, step)
        is_stuck = not step_size < 1.0 or step_size > MAX_RATIO * previous
        if not is_stuck:
            phi, approach, segments = (
                phi + step[:N],
                approach + step[-1],
                apply_step(segments, step[N:], series.period),
            )
        ratio = step_size / previous if previous < np.inf else 1.0
        if step_size < MAX_ROUNDING_STEP if is_stuck else step_size * ratio < tolerance:
            sensitivity, more = _sensitivity(coarse, segments, phi, series, load, dual)
            return NewtonResult(steps + more, segments, phi, approach, sensitivity, coarse.factors)
        if is_stuck:
            break
    raise ConvergenceError(f"the density does not converge under the mean pressure {load:.6g} p_0*", step_size)


def _sensitivity(
    coarse: NewtonResult, segments: Segments, phi: Array, series: CosineSeries, load: float, dual: bool
) -> tuple[Array, int]:
    """The derivatives of the unknowns in the mean pressure, and the corrections that they took."""
    few, n, N = coarse.segments, segments.centre.size, phi.size
    forcing = np.zeros(N + 2 * n + 1)
    if dual:
        forcing[: N + n] = -2 * np.pi * series.period
    else:
        forcing[-1] = series.period / segments.half_width.max()
    start = prolong_density(coarse.sensitivity, few.first_node, segments.first_node, np.zeros(N))
    found = np.concatenate([start, coarse.sensitivity[few.node.size :]])
    previous = np.inf
    for step in range(1, MAX_STEPS + 1):
        left = forcing - products(segments, phi, series, dual, change_of(found, n))
        change = _correction(left, coarse.factors, few, segments, series.period, dual)
        found += change
        size, resistance_change = relative_step(segments, phi, load * change), abs(change[-1] / found[-1])
        ratio, previous = size / previous, size
        if step > 1 and resistance_change * ratio < SENSITIVITY_TOLERANCE:
            return found, step
        if ratio > MAX_RATIO:
            break
    if resistance_change > MAX_RESISTANCE_CHANGE:
        raise ConvergenceError(f"the resistance does not converge under the mean pressure {load:.6g} p_0*")
    return found, step


def _correction(row: Array, factors: Factors, few: Segments, many: Segments, period: float, dual: bool) -> Array:
    """What makes up for a residual on many nodes: the slow modes by few nodes, the others by themselves."""
    fewer, fast = restrict(row, few.first_node, many.first_node, period, dual)
    slow = back_substitute(factors, fewer)
    density = prolong_density(slow, few.first_node, many.first_node, fast)
    return np.concatenate([density, slow[few.node.size :]])


@kernel
def _cosines(count: int) -> Array:
    """cos(j pi/(2 (count+1))) over one period."""
    cosine = np.empty(4 * count + 4)
    for j in range(cosine.size):
        cosine[j] = np.cos(j * (np.pi / (2 * count + 2)))
    return cosine


@kernel
def restrict(row: Array, few: Indices, many: Indices, period: float, dual: bool) -> tuple[Array, Array]:
    """The residual as fewer nodes see it, and the coefficients in U_k, shape (nodes,), that take off the rest.

    `few` and `many` are `first_node` of both. The residual becomes a sum of T_m, cut off where the fewer nodes end.
    A fast mode also lifts the centre of its own contact, by 2 int sqrt(1-t^2) U_k ln|t| dt.
    """
    n = few.size - 1
    fewer = np.zeros(few[-1] + 2 * n + 1)
    fast, lifted = np.zeros(many[-1]), np.zeros(n)
    for i in range(n):
        count, less = many[i + 1] - many[i], few[i + 1] - few[i]
        cosine, coarser = _cosines(count), _cosines(less)
        for m in range(count + 1):
            total = 0.0
            for a in range(count + 1):
                total += row[many[i] + i + a] * cosine[m * (2 * a + 1) % cosine.size]
            total *= (2 if m > 0 else 1) / (count + 1)
            if m > less:
                fast[many[i] + m - 1] = total / period
                if m % 2 == 1 and not dual and m > 1:
                    lift = np.pi * (1 / (m - 1) + 1 / (m + 1)) * (1 if (m - 1) % 4 == 0 else -1)
                    lifted[i] -= lift * total / period
            else:
                for b in range(less + 1):
                    fewer[few[i] + i + b] += total * coarser[m * (2 * b + 1) % coarser.size]
    fewer[few[-1] + n :] = row[many[-1] + n :]
    fewer[few[-1] + n : -1] -= lifted
    return fewer, fast


@kernel
def prolong_density(phi: Array, few: Indices, many: Indices, fast: Array) -> Array:
    """phi on many nodes from that on few and coefficients of faster modes."""
    finer = np.zeros(many[-1])
    for i in range(few.size - 1):
        count, less = many[i + 1] - many[i], few[i + 1] - few[i]
        a = fast[many[i] : many[i + 1]].copy()
        a[: min(less, count)] += expansion_coefficients(phi[few[i] : few[i + 1]])[: min(less, count)]
        cosine = _cosines(count)
        quarter = count + 1
        for q in range(count):
            for k in range(count):  # U_k(cos x) sin x = sin((k+1) x), and sin x = cos(x - pi/2)
                angle = 2 * (q + 1) * (k + 1) - quarter
                finer[many[i] + q] += a[k] * cosine[angle % cosine.size]
            finer[many[i] + q] /= cosine[(2 * (q + 1) - quarter) % cosine.size]
    return finer


def own_density(row: Array, segments: Segments, period: float) -> Array:
    """The change of phi that takes off a residual as if every segment stood alone."""
    none = np.zeros(segments.first_node.size, np.int64)
    return prolong_density(row, none, segments.first_node, restrict(row, none, segments.first_node, period, True)[1])
