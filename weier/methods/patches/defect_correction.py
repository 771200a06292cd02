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
from weier.methods.patches.chebyshev import advance, expansion_coefficients, sines
from weier.methods.patches.collocation import (
    Factors,
    NewtonResult,
    angle_between_centres,
    apply_step,
    back_substitute,
    collocation_points,
    log_potentials,
    relative_step,
)
from weier.methods.patches.segments import Segments, are_resolved, make_segments
from weier.methods.patches.surface import CosineSeries, evaluate_series

MAX_STEPS = 12
MAX_RATIO = 0.5  # of a step over the one before: with more, the slow modes need more nodes
MAX_ROUNDING_STEP = 1e-5  # steps below this that no longer shrink are rounding, as in a contact just born
SENSITIVITY_TOLERANCE = 1e-11  # of the resistance, that further corrections would change
MAX_RESISTANCE_ERROR = 1e-8  # of it, where rounding ends them


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


@kernel
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
            potential, total = log_potentials(segments, i, period)[0], 0.0
            for q in range(phi.size):
                total += potential[q] * phi[q]
            row[heights + i] = (approach + value + 2 * total) / segments.half_width[i]
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
    """The change of int rho ln|2 sin(pi (x-s)/L)| ds at the centre of segment i, which moves along."""
    total, own = 0.0, segments.half_width[i] * change.centre[i]
    potential, dln_dx, dln_dr = log_potentials(segments, i, period)
    for j in range(segments.centre.size):
        r, wider = segments.half_width[j], change.half_width[j]
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            moved = dln_dx[q] * (own - r * change.centre[j]) + dln_dr[q] * wider
            total += potential[q] * (change.phi[q] + phi[q] * wider) + r * segments.weight[q] * phi[q] * moved
    return total


class Refined(NamedTuple):
    """Solution and sensitivity on many nodes.

    steps : corrections of both
    segments, phi, approach, coefficient, sensitivity : as in `ContactState`
    resolved : whether the density is, on all segments
    step_size : of the last correction; inf if the corrections do not shrink
    resistance_error : relative, that the corrections of the sensitivity leave
    """

    steps: int
    segments: Segments
    phi: Array
    approach: float
    coefficient: Array
    sensitivity: Array
    resolved: bool
    step_size: float
    resistance_error: float


def refine(
    coarse: NewtonResult, node_count: Indices, series: CosineSeries, load: float, dual: bool, tolerance: float
) -> Refined:
    """Solve on so many nodes of each segment, from the solution on few.

    ConvergenceError is raised unless the corrections fall below the tolerance, or to rounding.
    """
    refined = _refine(coarse, node_count, series, load, dual, tolerance)
    if not refined.step_size < np.inf:
        raise ConvergenceError(f"the density does not converge under the mean pressure {load:.6g} p_0*")
    if not refined.resistance_error <= MAX_RESISTANCE_ERROR:
        raise ConvergenceError(f"the resistance does not converge under the mean pressure {load:.6g} p_0*")
    return refined


@kernel
def _refine(
    coarse: NewtonResult, node_count: Indices, series: CosineSeries, load: float, dual: bool, tolerance: float
) -> Refined:
    few = coarse.segments
    segments = make_segments(few.crest, few.origin, few.centre, few.half_width, node_count, series.period)
    phi = prolong_density(coarse.phi, few.first_node, segments.first_node, np.zeros(segments.node.size))
    approach, N, found = coarse.approach, segments.node.size, coarse.sensitivity
    step_size, steps, more, resistance_error, is_stuck, is_small = np.inf, 0, 0, np.inf, False, False
    while steps < MAX_STEPS and not (is_stuck or is_small):
        steps += 1
        row = residuals(segments, phi, approach, series, load, dual)
        step = -_correction(row, coarse.factors, few, segments, series.period, dual)
        previous, step_size = step_size, relative_step(segments, phi, step)
        is_stuck = not step_size < 1.0 or step_size > MAX_RATIO * previous
        if not is_stuck:
            phi, approach = phi + step[:N], approach + step[-1]
            segments = apply_step(segments, step[N:], series.period)
        ratio = step_size / previous if previous < np.inf else 1.0
        is_small = step_size < MAX_ROUNDING_STEP if is_stuck else step_size * ratio < tolerance
    if is_small:
        found, more, resistance_error = _sensitivity(coarse, segments, phi, series, load, dual)
    else:
        step_size = np.inf
    coefficient = expand(segments, phi)
    resolved = bool(are_resolved(segments, coefficient, tolerance).all())
    return Refined(steps + more, segments, phi, approach, coefficient, found, resolved, step_size, resistance_error)


@kernel
def expand(segments: Segments, phi: Array) -> Array:
    """Coefficients of phi in U_k, segment by segment, shape (nodes,)."""
    a = np.empty(phi.size)
    for j in range(segments.centre.size):
        here = slice(segments.first_node[j], segments.first_node[j + 1])
        a[here] = expansion_coefficients(phi[here])
    return a


@kernel
def _sensitivity(
    coarse: NewtonResult, segments: Segments, phi: Array, series: CosineSeries, load: float, dual: bool
) -> tuple[Array, int, float]:
    """The derivatives of the unknowns in the mean pressure, the corrections, and the resistance's error."""
    few, n, N = coarse.segments, segments.centre.size, phi.size
    forcing, found = np.zeros(N + 2 * n + 1), np.empty(N + 2 * n + 1)
    if dual:
        forcing[: N + n] = -2 * np.pi * series.period
    else:
        forcing[-1] = series.period / segments.half_width.max()
    found[:N] = prolong_density(coarse.sensitivity, few.first_node, segments.first_node, np.zeros(N))
    found[N:] = coarse.sensitivity[few.node.size :]
    previous, resistance_error = np.inf, np.inf
    for step in range(1, MAX_STEPS + 1):
        left = forcing - products(segments, phi, series, dual, change_of(found, n))
        change = _correction(left, coarse.factors, few, segments, series.period, dual)
        found = found + change
        size, resistance_error = relative_step(segments, phi, load * change), abs(change[-1] / found[-1])
        ratio, previous = size / previous, size
        if step > 1 and resistance_error * ratio < SENSITIVITY_TOLERANCE:
            resistance_error *= ratio
            break
        if ratio > MAX_RATIO:
            break
    return found, step, resistance_error


@kernel
def _correction(row: Array, factors: Factors, few: Segments, many: Segments, period: float, dual: bool) -> Array:
    """What makes up for a residual on many nodes: the slow modes by few nodes, the others by themselves."""
    fewer, fast = restrict(row, few.first_node, many.first_node, period, dual)
    slow, N = back_substitute(factors, fewer), many.node.size
    change = np.empty(row.size)
    change[:N] = prolong_density(slow, few.first_node, many.first_node, fast)
    change[N:] = slow[few.node.size :]
    return change


@kernel
def _cosines(count: int) -> Array:
    """cos(j pi/(2 (count+1))) over one period."""
    quarter = count + 1
    cosine = np.empty(4 * quarter)
    for j in range(quarter):
        cosine[j] = np.cos(j * (np.pi / (2 * quarter)))
        cosine[2 * quarter - j] = cosine[2 * quarter + j] = -cosine[j]
        if j > 0:
            cosine[4 * quarter - j] = cosine[j]
    cosine[quarter] = cosine[3 * quarter] = 0.0
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
            total, angle = 0.0, m
            for a in range(count + 1):  # at the angle m (2 a + 1)
                total += row[many[i] + i + a] * cosine[angle]
                angle = advance(angle, 2 * m, cosine.size)
            total *= (2 if m > 0 else 1) / (count + 1)
            if m > less:
                fast[many[i] + m - 1] = total / period
                if m % 2 == 1 and not dual and m > 1:
                    lift = np.pi * (1 / (m - 1) + 1 / (m + 1)) * (1 if (m - 1) % 4 == 0 else -1)
                    lifted[i] -= lift * total / period
            else:
                angle = m
                for b in range(less + 1):
                    fewer[few[i] + i + b] += total * coarser[angle]
                    angle = advance(angle, 2 * m, coarser.size)
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
        sine = sines(count)
        for q in range(count):
            angle = 0
            for k in range(count):  # U_k(cos x) sin x = sin((k+1) x)
                angle = advance(angle, q + 1, sine.size)
                finer[many[i] + q] += a[k] * sine[angle]
            finer[many[i] + q] /= sine[q + 1]
    return finer


@kernel
def own_density(row: Array, segments: Segments, period: float) -> Array:
    """The change of phi that takes off a residual as if every segment stood alone."""
    none = np.zeros(segments.first_node.size, np.int64)
    return prolong_density(row, none, segments.first_node, restrict(row, none, segments.first_node, period, True)[1])
