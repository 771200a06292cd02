"""The inequalities of contact: no tension on the contacts, no overlap outside them.

The equations on the segments say nothing of either. Both are checked between the nodes, too: a violation outside
shows that a segment is missing there, and one inside that the segment must be cut. What the equations leave is judged
here, too, for both solvers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.chebyshev import evaluate_expansion, partial_integral
from weier.methods.patches.edge_iteration import Problem, Step, distances
from weier.methods.patches.fields import (
    CAUCHY,
    POTENTIAL,
    ContactState,
    complementary_residual,
    complementary_residual_slope,
    density_integral,
    segment_at,
)
from weier.methods.patches.pair_sums import potential
from weier.methods.patches.segments import distances_to_next
from weier.methods.patches.surface import CosineSeries, nearest_crest

PROBES_PER_WAVE, MIN_PROBES = 6, 7  # in each interval between segments, closer at its ends, while segments are added
MIN_PROBE_DISTANCE = 1e-9  # of their mean distance: nearer ones differ by rounding
CHECK_PROBES_PER_WAVE, MIN_CHECK_PROBES = 8, 12  # of a result: nothing comes after it that would see what it misses
SEARCH_STEPS = 40  # of golden sections and bisections: to 1e-9 of a bracket or less
GOLDEN_SECTION = 0.6180339887498949
SAMPLES_PER_NODE = 2  # to look for a change of sign within a segment
END_DISTANCE = 1e-6  # from the end of a gap: dividing by (1-t^2)^(3/2) leaves 7 digits here, as many as the limit has
# Of the distance of probes. A stencil of h finds a minimum to h^2 of the wavenumber, so that the last is within 1e-8.
FIRST_STENCIL, STENCIL_RATIO, REFINEMENTS = 0.1, 1 / 5, 6
NEW_CONTACT_WIDTH = 0.5  # of a new contact, over the overlap that it replaces; with sqrt(2) it would carry nothing
NEW_GAP_WIDTH = np.sqrt(2.0)  # of a new gap, over the interval of tension: exact for a small one
OVERLAP_BESIDE_EDGE = 1.5  # over the move of an edge that is to grow: how far the gap beside it is negative
MAX_NEW_WIDTH = 0.4  # half-width over the distance of the nearest neighbour: two born side by side must not touch
MAX_RESIDUAL = 100  # that is accepted, in units of the tolerance
MAX_FALL = 3  # from a point to the minimum, over what a parabola tells of it
# A polynomial of degree n is at most 1/cos(n pi/(2m)) times its largest value at the zeros of T_m (Ehlich, Zeller):
# twice it, with m = 3n/2. On K nodes, residuals have the degree K + 2, but for what coefficients have decayed to.
SAMPLES_PER_DEGREE, SAMPLED_FACTOR = 1.5, 2.0


@kernel
def sample_count(nodes: int) -> int:
    """Of the zeros of a Chebyshev polynomial that tell the largest residual on a segment within `SAMPLED_FACTOR`."""
    return int(np.ceil(SAMPLES_PER_DEGREE * (nodes + 2)))


class Violations(NamedTuple):
    """How far a state is from the conditions of contact.

    gap : the largest gap on a contact or overlap anywhere, in g_0
    pressure : the largest pressure in a gap or tension anywhere, in p_0*
    """

    gap: float
    pressure: float


def error_bound(state: ContactState, violations: Violations, period: float) -> float:
    """How far the compliance may be off, in g_0, by the conditions of contact that a state violates.

    Let D(P) be the mean gap under the mean pressure P, and g = d - z + u that of a state whose pressure p has this
    mean, where g >= -eps everywhere, |g| <= eps on its contacts, p >= -q everywhere and |p| <= q in its gaps. Then
    D(P + q) - eps <= d <= D(P - q) + eps:

    The exact u_1 and p_1 under P + q differ from u and p. Where u_1 - u is largest, p_1 - p exceeds its mean q by the
    maximum principle, so that p_1 > 0, and this is a contact: u_1 = z - D. Then 0 = mean(u_1 - u) is at most
    u_1 - u = d - D - g <= d - D + eps. Under P - q, where u_1 - u is smallest, p > p_1 + q >= q, so that the state is
    in contact, and 0 >= u_1 - u = g_1 - D - g + d >= d - D - eps.

    To first order, D(P) - D(P + q) is the resistance times q; and so it is for a load that contacts do not carry.
    """
    resistance = float(state.sensitivity[-1])
    return violations.gap + resistance * (violations.pressure + abs(carried_load(state, period) - state.load))


def carried_load(state: ContactState, period: float) -> float:
    """The mean pressure that contacts carry, (pi/2) sum r a_0 / L; gaps are solved for under the load itself."""
    if state.dual:
        return state.load
    force = 0.5 * np.pi * (state.segments.half_width @ state.coefficient[state.segments.first_node[:-1]])
    return float(force) / period


class NegativeIntervals(NamedTuple):
    """Where on segments the pressure (primal) or the gap (dual) is negative, each of shape (intervals,).

    segment : index of the segment
    start, end : in its coordinate t, -1..1
    """

    segment: Indices
    start: Array
    end: Array

    def select(self, which: Flags) -> NegativeIntervals:
        """Some of the intervals."""
        return NegativeIntervals(self.segment[which], self.start[which], self.end[which])


@kernel
def lowest_outside(state: ContactState, series: CosineSeries, limit: float) -> float:
    """The lowest minimum of the complementary residual outside the segments, if it is below -limit; else 0 or above.

    Below 0, a segment is missing.
    """
    segments, distance = state.segments, distances_to_next(state.segments, series.period)
    edge = segments.origin + (segments.centre + segments.half_width)
    probe, interval = _probe_points(edge, distance, series, CHECK_PROBES_PER_WAVE, MIN_CHECK_PROBES)
    slope, doubtful = np.full(probe.size, np.nan), doubtful_cells(state, series)
    bend = np.sum(np.abs(series.amplitude) * series.wavenumber**2)
    lowest, before = 0.0, cell_of(series, probe[0])
    for i in range(probe.size - 1):
        cell, after = before, cell_of(series, probe[i + 1])
        before = after
        is_safe = not (doubtful[cell] or doubtful[after]) and after - cell in (0, 1, 1 - doubtful.size)
        if is_safe or interval[i] != interval[i + 1]:
            continue
        for k in (i, i + 1):
            if np.isnan(slope[k]):
                crest, y = nearest_crest(series, probe[k])
                slope[k] = complementary_residual_slope(state, series, crest, y)
        if slope[i] < 0 and slope[i + 1] >= 0:
            lowest = min(lowest, _minimum_between(state, series, -limit, bend, probe[i], probe[i + 1]))
    return lowest


@kernel
def cell_of(series: CosineSeries, x: float) -> int:
    """Index of the crest between whose valleys a position lies."""
    last = series.valley_position[-1]
    x -= series.period * (np.floor((x - last) / series.period) + 1)
    return min(int(np.searchsorted(series.valley_position, x)), series.valley_position.size - 1)


@kernel
def doubtful_cells(state: ContactState, series: CosineSeries) -> Flags:
    """Whether the gap between contacts may be negative in any cell, from one valley to the next.

    The displacement by the pressure of contacts is convex between these, if that is nowhere negative, which is looked
    at by itself. So it is above its tangent at the crest, and the profile is below the maximum of the cell: where
    their difference is positive, the gap is. A cell with its crest in contact stays doubtful, and so does every cell
    between gaps (dual).
    """
    n, period = series.crest_position.size, series.period
    doubtful = np.ones(n, np.bool_)
    if state.dual:
        return doubtful
    for i in range(n):
        x = series.crest_position[i]
        if segment_at(state.segments, period, x, 0.0)[0] < 0:
            displacement = -2 * density_integral(state, period, x, 0.0, POTENTIAL)
            slope = -2 * np.pi / period * density_integral(state, period, x, 0.0, CAUCHY)
            left, right = series.valley_position[i - 1] - (period if i == 0 else 0.0), series.valley_position[i]
            tangent = displacement + min(slope * (left - x), slope * (right - x))
            doubtful[i] = not tangent - state.approach - series.cell_offset[i] > 0
    return doubtful


@kernel
def _probe_points(
    left: Array, length: Array, series: CosineSeries, per_wave: int, least: int
) -> tuple[Array, Indices]:
    """Points in intervals between segments, and the interval of each; ascending in each.

    They are some for each of the finest waves, and the crests and valleys of the series: two crests that stand side
    by side would else look like one.
    """
    per_length = per_wave * series.wavenumber[-1] / (2 * np.pi)
    count = least + np.ceil(per_length * np.maximum(length, 0.0)).astype(np.int64)  # 0 between segments that overlap
    point, interval, end = np.empty(count.sum()), np.repeat(np.arange(length.size), count), 0
    for j in range(length.size):
        for i in range(count[j]):
            point[end + i] = left[j] + length[j] * 0.5 * (1 - np.cos((i + 0.5) * (np.pi / count[j])))
        end += count[j]
    turning = np.concatenate((series.crest_position, series.valley_position))
    turning -= series.period * np.floor((turning - left[0]) / series.period)
    of = np.searchsorted(left, turning, side="right") - 1
    within = turning < left[of] + length[of]
    point, interval = np.concatenate((point, turning[within])), np.concatenate((interval, of[within]))
    order = np.argsort(point, kind="mergesort")
    order = order[np.argsort(interval[order], kind="mergesort")]
    point, interval = point[order], interval[order]
    apart = np.ones(point.size, np.bool_)
    apart[1:] = (np.diff(point) > MIN_PROBE_DISTANCE / per_length) | (np.diff(interval) > 0)
    return point[apart], interval[apart]


@kernel
def _minimum_between(
    state: ContactState, series: CosineSeries, limit: float, bend: float, left: float, right: float
) -> float:
    """A minimum of the complementary residual between two points, by bisection; 0 if none is below the limit.

    Between segments the displacement by their densities is convex, so that the residual bends down by no more than
    the series: by `bend`, the sum of the sizes of its second derivatives. Parabolas from both points are below it.
    """
    before, falling = _residual_and_slope(state, series, left)
    after, rising = _residual_and_slope(state, series, right)
    for _ in range(SEARCH_STEPS):
        half = 0.5 * (right - left)
        if min(before - abs(falling) * half, after - abs(rising) * half) - 0.5 * bend * half**2 >= limit:
            return 0.0
        value, slope = _residual_and_slope(state, series, left + half)
        if slope < 0:
            left, before, falling = left + half, value, slope
        else:
            right, after, rising = right - half, value, slope
    return min(before, after)


@kernel
def _residual_and_slope(state: ContactState, series: CosineSeries, x: float) -> tuple[float, float]:
    crest, y = nearest_crest(series, x)
    value = complementary_residual(state, series, crest, y)
    return value, complementary_residual_slope(state, series, crest, y)


@kernel
def find_negative_intervals(state: ContactState, tolerance: Array) -> NegativeIntervals:
    """Intervals on segments with a pressure (primal) or gap (dual) below -tolerance, over the segment's largest.

    `tolerance` has the shape (segments,). It is of sqrt(1-t^2) times the function of `_inequality`, so that rounding
    at an end, where neither a pressure nor a gap can be large, counts for little.
    """
    first = state.segments.first_node
    size = SAMPLES_PER_NODE * first[-1] + 2 * first.size
    segment, start, end = np.zeros(size, np.int64), np.zeros(size), np.zeros(size)
    count = 0
    for j in range(first.size - 1):
        a = state.coefficient[first[j] : first[j + 1]]
        t, value = _sample_inequality(state.dual, a)
        largest = 0.0
        for v in value:
            largest = max(largest, abs(v))
        i = 0
        while i < t.size:
            if value[i] * np.sqrt((1 - t[i]) * (1 + t[i])) < -tolerance[j] * largest:
                k = i
                while k + 1 < t.size and value[k + 1] < 0:
                    k += 1
                while i > 0 and value[i - 1] < 0:
                    i -= 1
                segment[count] = j
                start[count] = _find_zero(state.dual, a, t[i], t[i - 1]) if i > 0 else -1.0
                end[count] = _find_zero(state.dual, a, t[k], t[k + 1]) if k + 1 < t.size else 1.0
                count += 1
                i = k
            i += 1
    return NegativeIntervals(segment[:count], start[:count], end[:count])


@kernel
def lowest_inside(state: ContactState) -> float:
    """The lowest pressure or, dual, gap on the segments if it is negative, and else 0."""
    lowest, first = 0.0, state.segments.first_node
    for j in range(first.size - 1):
        t, value = _sample_inequality(state.dual, state.coefficient[first[j] : first[j + 1]])
        for i in range(t.size):
            if value[i] < 0:
                end = (1 - t[i]) * (1 + t[i])
                here = state.segments.half_width[j] * value[i] * end**1.5 if state.dual else value[i] * np.sqrt(end)
                lowest = min(lowest, here)
    return lowest


@kernel
def negative_heights(state: ContactState, negative: NegativeIntervals) -> Array:
    """How far the gap opens in each interval of tension or, dual, how large each overlap is, in g_0.

    A crack of half-width b under the tension p opens by 2 pi b p.
    """
    height = np.empty(negative.segment.size)
    for i in range(height.size):
        j, t = negative.segment[i], 0.5 * (negative.start[i] + negative.end[i])
        r, a = (
            state.segments.half_width[j],
            state.coefficient[state.segments.first_node[j] : state.segments.first_node[j + 1]],
        )
        if state.dual:
            height[i] = abs(r * partial_integral(a, t))
        else:
            b = 0.5 * r * (negative.end[i] - negative.start[i])
            height[i] = 2 * np.pi * b * abs(np.sqrt((1 - t) * (1 + t)) * evaluate_expansion(a, t))
    return height


@kernel
def _sample_inequality(dual: bool, a: Array) -> tuple[Array, Array]:
    """Points t, denser than the nodes, and the inequality's function there.

    A positive sample below both neighbours moves to the minimum between them, which may be negative.
    """
    count = SAMPLES_PER_NODE * a.size + 1
    t, sample = np.empty(count + 1), np.empty(count + 1)
    for i in range(count + 1):
        t[i] = -np.cos(i * (np.pi / count))
        sample[i] = _inequality(dual, a, t[i])
    value = sample.copy()
    for i in range(1, count):
        rise = max(sample[i - 1], sample[i + 1]) - sample[i]
        # The minimum is taken to be positive where it is no lowest sample, or exceeds the rise to its neighbours.
        if sample[i] > min(sample[i - 1], sample[i + 1]) or not 0 <= sample[i] <= rise:
            continue
        t[i] = _find_minimum(dual, a, t[i - 1], t[i + 1])
        value[i] = _inequality(dual, a, t[i])
    return t, value


@kernel
def _find_minimum(dual: bool, a: Array, low: float, high: float) -> float:
    """The position of a minimum between low and high, by golden sections."""
    for _ in range(SEARCH_STEPS):
        c, d = high - GOLDEN_SECTION * (high - low), low + GOLDEN_SECTION * (high - low)
        if _inequality(dual, a, c) < _inequality(dual, a, d):
            high = d
        else:
            low = c
    return 0.5 * (low + high)


@kernel
def _inequality(dual: bool, a: Array, t: float) -> float:
    """A function that is positive up to the ends where the inequality holds: phi, or gap/(r (1-t^2)^(3/2)) (dual).

    The latter has the limits -phi/3 at t = 1 and phi/3 at t = -1.
    """
    if not dual:
        return evaluate_expansion(a, t)
    if abs(t) > 1 - END_DISTANCE:
        return -np.sign(t) * evaluate_expansion(a, np.sign(t)) / 3
    return partial_integral(a, t) / ((1 - t) * (1 + t)) ** 1.5


@kernel
def _find_zero(dual: bool, a: Array, negative: float, positive: float) -> float:
    """The point between a negative and a positive sample at which the sign changes, by bisection."""
    for _ in range(SEARCH_STEPS):
        middle = 0.5 * (negative + positive)
        if _inequality(dual, a, middle) < 0:
            negative = middle
        else:
            positive = middle
    return positive


def certify(state: ContactState, residual: float, period: float, tolerance: float) -> ContactState:
    """The state with its residual, in g_0, if that is small and contacts carry the load."""
    scale = state.load * period if state.dual else state.approach
    relative = residual / scale if scale > 0 else np.inf  # no indentation: all digits were lost on the way
    relative = max(relative, abs(carried_load(state, period) / state.load - 1))
    if not relative <= MAX_RESIDUAL * tolerance:
        raise ConvergenceError(
            f"the contacts under the mean pressure {state.load:.6g} p_0* violate their conditions by {relative:.1e}, "
            f"more than {MAX_RESIDUAL * tolerance:.1e}; take a larger tolerance or boundary elements",
            relative,
        )
    return state._replace(residual=residual)


class _Brackets(NamedTuple):
    """Points low < middle < high with a minimum between them, and the index of the contact on their left."""

    low: Array
    middle: Array
    high: Array
    interval: Indices


def gap_or_pressure(problem: Problem, step: Step, x: Array) -> Array:
    """The gap or, dual, the pressure at ascending points off the segments; negative where a segment is missing."""
    punches, forces, dual = step.punches, step.forces, problem.dual
    total = potential(punches.matrix.tree, forces.force, x, punches.period, dual)
    if dual:
        return np.asarray(-0.5 / punches.period**2 * total - problem.forcing(x))
    return np.asarray(forces.plane - 2 * total - problem.forcing(x))


def find_missing(problem: Problem, step: Step, tolerance: float) -> tuple[NDArray[np.float64], float]:
    """Edges of new segments where the gap or pressure has a minimum below -tolerance, shape (missing, 2).

    And the lowest of all minima, of which those above -tolerance need no segment; 0 if none is negative.
    """
    none = np.empty((0, 2))
    right, gap = _gaps(step)
    x, gap_before = _probe_points(right, gap, problem.series, PROBES_PER_WAVE, MIN_PROBES)
    value = gap_or_pressure(problem, step, x)
    lowest = 1 + np.flatnonzero(
        (value[1:-1] <= value[:-2]) & (value[1:-1] <= value[2:]) & (gap_before[:-2] == gap_before[2:])
    )
    low, middle, high = x[lowest - 1], x[lowest], x[lowest + 1]
    rise = (value[lowest + 1] - value[lowest]) / (high - middle) - (value[lowest] - value[lowest - 1]) / (
        middle - low
    )
    bend, farthest = 2 * np.maximum(rise, 0) / (high - low), 0.5 * np.maximum(high - middle, middle - low)
    some = value[lowest] < 0.5 * MAX_FALL * bend * farthest**2 + tolerance
    if not np.any(some):
        return none, 0.0
    brackets = _Brackets(low[some], middle[some], high[some], gap_before[lowest[some]])
    centre, depth, curvature, interval = _minima(problem, step, brackets)
    deepest = float(depth.min(initial=0.0))
    apart = _is_apart(step, centre, interval) & (depth < -tolerance)
    if not np.any(apart):
        return none, deepest
    centre, depth, curvature, interval = centre[apart], depth[apart], curvature[apart], interval[apart]
    reach = np.sqrt(-2 * depth / np.maximum(curvature, -depth / _room(step, centre, interval) ** 2))
    alone = _is_alone(centre, depth, reach, interval)
    centre, reach, room = centre[alone], reach[alone], _room(step, centre[alone], interval[alone])
    half_width = np.minimum((NEW_GAP_WIDTH if problem.dual else NEW_CONTACT_WIDTH) * reach, MAX_NEW_WIDTH * room)
    return np.stack([centre - half_width, centre + half_width], axis=1), deepest


def _minima(problem: Problem, step: Step, brackets: _Brackets) -> tuple[Array, Array, Array, Indices]:
    """Position, value, curvature and gap of negative minima, by Newton's method on differences.

    Brackets whose minimum is above for certain are left out as soon as that is known. The lowest point that was seen
    counts: where crests stand side by side, differences tell of neither.
    """
    stencil, lowest = FIRST_STENCIL * (brackets.high - brackets.low), np.full((3, brackets.middle.size), np.inf)
    for refinement in range(1, REFINEMENTS + 1):
        low, middle, high, interval = brackets
        points = np.stack([middle - stencil, middle, middle + stencil], axis=1)
        order, value = np.argsort(points, axis=None), np.empty(points.size)
        value[order] = gap_or_pressure(problem, step, points.ravel()[order])
        below, here, above = value.reshape(-1, 3).T
        slope, curvature = (above - below) / (2 * stencil), (below - 2 * here + above) / stencil**2
        lowest = np.where(here < lowest[1], [middle, here, curvature], lowest)
        shift = -slope / np.where(curvature > 0, curvature, np.inf)
        inner = 1.01 * STENCIL_RATIO * stencil * (refinement < REFINEMENTS - 1)  # the last takes its middle
        shift = np.clip(middle + shift, low + inner, high - inner) - middle
        # The stencil tells slopes less well than a minimum must be known: it may be as far off as that is wide.
        margin = 0.5 * MAX_FALL * np.maximum(curvature, 0) * (np.abs(shift) + stencil) ** 2
        some = np.minimum(here - margin, lowest[1]) < 0
        some = some | (curvature <= 0) if refinement < REFINEMENTS else lowest[1] < 0
        brackets = _Brackets(low[some], (middle + shift)[some], high[some], interval[some])
        stencil, lowest = STENCIL_RATIO * stencil[some], lowest[:, some]
        if not np.any(some):
            break
    return lowest[0], lowest[1], lowest[2], brackets.interval


def _is_alone(centre: Array, depth: Array, reach: Array, interval: Indices) -> Flags:
    """Whether no deeper minimum lies within the same overlap, which reaches so far from each."""
    near = (np.diff(centre) < np.maximum(reach[:-1], reach[1:])) & (np.diff(interval) == 0)
    hidden = np.zeros(centre.size, bool)
    hidden[:-1] |= near & (depth[:-1] > depth[1:])
    hidden[1:] |= near & (depth[1:] >= depth[:-1])
    return ~hidden


def _is_apart(step: Step, centre: Array, interval: Indices) -> Flags:
    """Whether a minimum is not merely the overlap beside an edge that is about to grow over it.

    With p = (k_0 + k_1 s)/sqrt(s) within an edge, the gap is negative as far as 3 k_0/k_1 outside, and the edge moves
    out by 2 k_0/k_1.
    """
    right, gap = _gaps(step)
    outward, distance = step.moves.outward, centre - right[interval]
    beyond_left = distance > OVERLAP_BESIDE_EDGE * outward[interval, 1]
    after = (interval + 1) % right.size
    return np.asarray(beyond_left & (gap[interval] - distance > OVERLAP_BESIDE_EDGE * outward[after, 0]))


def _room(step: Step, centre: Array, interval: Indices) -> Array:
    """From each new contact to the ends of its gap, or halfway to another new one."""
    right, gap = _gaps(step)
    halfway = 0.5 * np.diff(centre)
    to_left = np.minimum(centre - right[interval], np.append(np.inf, halfway))
    to_right = np.minimum(right[interval] + gap[interval] - centre, np.append(halfway, np.inf))
    return np.minimum(to_left, to_right)


def _gaps(step: Step) -> tuple[Array, Array]:
    """The left end and the width of the gap on the right of each contact."""
    centre, r = step.punches.centre, step.punches.half_width
    return centre + r, distances(centre - r, centre + r, step.punches.period)
