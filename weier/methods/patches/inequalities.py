"""The inequalities of contact, no tension on contacts and no overlap outside them, and their violations.

docs/patches.md derives the formulas: "Inequalities" for the search and the width of new segments, and "Thin gaps" for
the opening of a crack.

The equations on the segments do not imply the inequalities, so that violations are searched:

- Off the segments, the gap between contacts or the pressure between gaps has a negative minimum where a
  segment is missing. `_minima_between` evaluates it at `_probe_points` and divides it by its power of the distances
from both edges; `_brackets` selects the probes next to which a minimum may be negative, and `_negative_minima` finds
it. `find_missing` uses forces at nodes while the set is corrected, `minima_outside` the densities of a solution.
- On the segments, the pressure or the gap is negative where a segment must be cut: `find_negative_intervals`.
Remaining violations enter the bound on the error (`certificate`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices, Records, record_type
from weier.kernels.jit import kernel
from weier.methods.chebyshev import derivative_expansion, evaluate_expansion
from weier.methods.patches.edge_iteration import ContactProblem, NewtonStep
from weier.methods.patches.given_edges import force_field
from weier.methods.patches.kind import EPS, Kind
from weier.methods.patches.pressure_and_gap import (
    at_point,
    complementary_residuals,
    smooth_part,
)
from weier.methods.patches.segments import MINIMUM, ContactState, Segments, edge_strengths
from weier.methods.patches.surface import CosineSeries, distances_between, evaluate_near, first_from, nearest_crests

# probes per finest wave in an interval between segments, and of a shorter interval; an eighth of a wave from a crest,
# a cosine differs from its parabola by 5 %
PROBES_PER_WAVE = 8
SAMPLES_PER_NODE = 2  # samples per node in the search for sign changes within a segment
# width of the stencil of Newton's method on differences over the bracket, and its ratio in each refinement; a stencil
# h misplaces a minimum by h^2 relative to the wave, 1e-9 for the last one, 3e-5
STENCIL_RATIO, REFINEMENTS = 1 / 5, 6
# largest ratio of the depth of a minimum below the lowest of three probes to its depth on the parabola through them:
# a safety factor for other functions
MAX_FALL = 3


Residual = Callable[[Array], Array]  # function of positions
EdgeFactor = Callable[[Array, Indices], Array]  # function of positions and the intervals in which these lie
# For each bracket: left end, minimum, right end and interval, each of shape (brackets,).
Brackets = tuple[Array, Array, Array, Indices]


# An interval on a segment where the pressure of a contact, or the gap, is negative:
#
# segment : its index
# start, end : in its coordinate t, -1..1
# value : lowest pressure, in p_0*, or gap, in g_0
# relative : the lowest value of sqrt(1-t^2) times the `smooth_part`, over the largest value of that on the segment;
#     so rounding at an end, where neither a pressure nor a gap can be large, counts for little
# height : opening of the gap in the interval of tension, or the overlap, in g_0
NEGATIVE = record_type(("segment", np.int64, ()), ("start end value relative height", np.float64, ()))


@kernel
def _probe_points(
    origin: Array, centre: Array, half_width: Array, crest: Array, period: float, finest: float
) -> tuple[Array, Indices]:
    """Return ascending points in the intervals between segments, and the interval of each point.

    They are closer together at the ends, and contain the crests of the series and the midpoints between them.
    """
    n, length = 2 * crest.size, distances_between(origin, centre, half_width, period)
    turning, count, total = np.empty(n), np.empty(length.size, np.int64), n
    for k in range(crest.size):
        following = crest[k + 1] if k + 1 < crest.size else crest[0] + period
        turning[2 * k], turning[2 * k + 1] = crest[k], 0.5 * (crest[k] + following)
    per_length = PROBES_PER_WAVE * finest / (2 * np.pi)
    least = np.sqrt(EPS) / per_length  # At closer probes, second differences of a parabola are rounding.
    for j in range(length.size):
        waves = per_length * min(length[j], period) if length[j] > 0 else 0.0  # segments may overlap
        count[j] = PROBES_PER_WAVE + np.int64(np.ceil(waves))
        total += count[j]
    point, interval, last = np.empty(total), np.empty(total, np.int64), -1
    for j in range(length.size):
        left = origin[j] + (centre[j] + half_width[j])
        turns = np.floor((left - crest[0]) / period)
        i, k = 0, first_from(turning, left - period * turns)
        for _ in range(count[j] + n + 1):
            fraction = 0.5 * (1 - np.cos((i + 0.5) * np.pi / count[j])) if i < count[j] else 1.0
            probe, turn = left + fraction * length[j], turning[k % n] + period * (turns + k // n)
            x = min(probe, turn)
            if not x < left + length[j] or last + 1 == total:
                break
            i, k = i + (probe == x), k + (turn == x)
            if last < 0 or interval[last] < j or x - point[last] > least:
                last += 1
                point[last], interval[last] = x, j
    return point[: last + 1], interval[: last + 1]


@kernel
def _edge_factor(
    x: Array, interval: Indices, origin: Array, centre: Array, half_width: Array, period: float, power: float
) -> Array:
    """Return (u (1-u))^power at points x, with u from 0 to 1 in the interval of each point between segments."""
    length, factor = distances_between(origin, centre, half_width, period), np.empty(x.size)
    for i in range(x.size):
        j = interval[i]
        u = (x[i] - (origin[j] + (centre[j] + half_width[j]))) / length[j]
        factor[i] = max(abs(u * (1 - u)), EPS) ** power
    return factor


def _minima_between(
    kind: Kind,
    segments: Segments,
    coefficient: Array,
    is_regular: bool,
    series: CosineSeries,
    residual: Residual,
    limit: float,
    margin: float,
) -> Records:
    """Return negative minima of a residual less a margin between segments: of a gap, or of a pressure.

    Minima above the limit are excluded without refinement. At edges that are not regular the strength is unknown.
    """
    extent, period, power = segments.extent, series.period, kind.residual_power

    def edge_factor(x: Array, interval: Indices) -> Array:
        return _edge_factor(x, interval, *extent, period, power)

    x, interval = _probe_points(*extent, series.crest_position, period, float(series.wavenumber[-1]))
    at_edge = kind.residual_strength if is_regular else -np.inf
    first = segments.first_node
    ends, which = _brackets(
        x, interval, residual(x), limit, margin, *extent, period, first, coefficient, at_edge, power
    )
    low, middle, high = ends
    return _negative_minima((low, middle, high, which), residual, edge_factor)


def find_negative_intervals(state: ContactState) -> Records:
    """Return intervals on segments with a negative pressure (on contacts) or gap, as `NEGATIVE`."""
    segments = state.segments
    found, _ = _negative_intervals(segments.first_node, segments.half_width, state.coefficient, state.kind.is_slope)
    if found.size > 0:
        width = (found["end"] - found["start"]) * segments.half_width[found["segment"]]
        found["height"] *= state.kind.violation_height(width)
    return found


@kernel
def _negative_intervals(
    first: Indices, half_width: Array, coefficient: Array, is_gap: bool
) -> tuple[Records, NDArray[np.float64]]:
    """Return the intervals of `find_negative_intervals`, with the value in the middle as `height`, and all samples.

    The samples are, as rows, points t of all segments, 2 K + 2 on K nodes, and the pressures or gaps there.
    """
    found, count = np.empty(SAMPLES_PER_NODE * first[-1] + 2 * first.size, NEGATIVE), 0
    samples, last = np.empty((2, SAMPLES_PER_NODE * first[-1] + 2 * half_width.size)), 0
    points, values = samples
    for j in range(first.size - 1):
        r, a = half_width[j], smooth_part(coefficient[first[j] : first[j + 1]], is_gap)
        t, value = _sample_expansion(a)
        largest, i = 0.0, 0
        for k in range(value.size):
            largest = max(largest, abs(value[k]))
            points[last], values[last] = t[k], at_point(value[k], t[k], r, is_gap)
            last += 1
        while i < t.size:
            if value[i] < 0:
                here = found[count]
                here.segment, here.start, here.end = j, _find_zero(a, t[i], t[i - 1]) if i > 0 else -1.0, 1.0
                here.value = here.relative = 0.0
                while i < t.size and value[i] < 0:
                    here.relative = min(here.relative, value[i] * np.sqrt((1 - t[i]) * (1 + t[i])) / largest)
                    here.value = min(here.value, values[last - t.size + i])
                    i += 1
                if i < t.size:
                    here.end = _find_zero(a, t[i - 1], t[i])
                middle = 0.5 * (here.start + here.end)
                here.height = abs(at_point(evaluate_expansion(a, middle), middle, r, is_gap))
                count += 1
            i += 1
    return found[:count], samples


@kernel
def _sample_expansion(a: Array) -> tuple[Array, Array]:
    """Return points t, denser than the nodes, and the values of an expansion there.

    A positive sample below both neighbours is moved to the minimum, which may be negative.
    """
    count = SAMPLES_PER_NODE * a.size + 1
    t, sample = np.empty(count + 1), np.empty(count + 1)
    for i in range(count + 1):
        t[i] = -np.cos(i * (np.pi / count))
        sample[i] = evaluate_expansion(a, t[i])
    value = sample.copy()
    for i in range(1, count):
        rise = max(sample[i - 1], sample[i + 1]) - sample[i]
        # The minimum is positive if the sample is not the lowest of three, or exceeds the rise to its neighbours.
        if sample[i] > min(sample[i - 1], sample[i + 1]) or not 0 <= sample[i] <= rise:
            continue
        t[i] = _find_zero(derivative_expansion(a), t[i - 1], t[i + 1])
        value[i] = evaluate_expansion(a, t[i])
    return t, value


@kernel
def _find_zero(a: Array, negative: float, positive: float) -> float:
    """Return the point between a negative and a positive value at which the sign changes, by bisection."""
    while abs(positive - negative) > EPS:
        middle = 0.5 * (negative + positive)
        if evaluate_expansion(a, middle) < 0:
            negative = middle
        else:
            positive = middle
    return positive


def minima_outside(state: ContactState, series: CosineSeries, margin: float) -> Records:
    """Return minima of the gap between contacts, or of the pressure between gaps, that are below a margin."""

    def residual(x: Array) -> Array:
        return complementary_residuals(state, series, *nearest_crests(series, x)) - margin

    minima = _minima_between(state.kind, state.segments, state.coefficient, True, series, residual, 0.0, margin)
    minima["value"] += margin
    return minima


def gap_minima(state: ContactState) -> Records:
    """Return minima of the gap within gaps, as `MINIMUM`: samples, exact where a gap nearly closes."""
    segments = state.segments
    _, (t, value) = _negative_intervals(segments.first_node, segments.half_width, state.coefficient, True)
    at = np.flatnonzero((value[1:-1] <= value[:-2]) & (value[1:-1] < value[2:])) + 1
    at = at[np.abs(t[at]) < 1]  # a gap always closes at its ends
    minima = np.empty(at.size, MINIMUM)
    if at.size > 0:
        before = (value[at - 1] - value[at]) / (t[at] - t[at - 1])
        after = (value[at + 1] - value[at]) / (t[at + 1] - t[at])
        of = np.repeat(np.arange(segments.half_width.size), SAMPLES_PER_NODE * segments.node_count + 2)[at]
        r = segments.half_width[of]
        minima["interval"], minima["position"], minima["value"] = of, segments.middle[of] + r * t[at], value[at]
        minima["curvature"] = 2 * (before + after) / ((t[at + 1] - t[at - 1]) * r**2)
    return minima


@kernel
def _brackets(
    x: Array,
    interval: Indices,
    value: Array,
    limit: float,
    margin: float,
    origin: Array,
    centre: Array,
    r: Array,
    period: float,
    first_node: Indices,
    coefficient: Array,
    at_edge: float,
    power: float,
) -> tuple[NDArray[np.float64], Indices]:
    """Return left end, minimum and right end of brackets that may hold a minimum below the limit, and the intervals.

    value : at the probes, ascending in each interval; the quotient by the edge factor is smooth
    margin : margin subtracted from the values
    at_edge : the quotient at the edges over l^power |k_1|
    """
    length, ends = distances_between(origin, centre, r, period), edge_strengths(first_node, r, coefficient, 1.0)
    found, which, count = np.empty((3, x.size)), np.empty(x.size, np.int64), 0
    low, middle, high = found
    factor = _edge_factor(x, interval, origin, centre, r, period, power)
    for i in range(x.size):
        j, here, edges = interval[i], value[i] / factor[i], at_edge * length[interval[i]] ** power
        start = origin[j] + (centre[j] + r[j])
        if i > 0 and interval[i - 1] == j:
            low[count], before = x[i - 1], value[i - 1] / factor[i - 1] - here
        else:
            low[count], before = start, edges * abs(ends[j, 1]) - margin / factor[i] - here
        if i + 1 < x.size and interval[i + 1] == j:
            high[count], after = x[i + 1], value[i + 1] / factor[i + 1] - here
        else:
            k = (j + 1) % r.size
            high[count] = start + length[j]
            after = edges * abs(ends[k, 0]) - margin / factor[i] - here
        left, right = x[i] - low[count], high[count] - x[i]
        if before >= 0 and after >= 0 and before + after < np.inf and left > 0 and right > 0:
            bend = 2 * (after / right + before / left) / (left + right)
            if here < 0.5 * MAX_FALL * bend * (0.5 * max(left, right)) ** 2 + limit / factor[i]:
                middle[count], which[count] = x[i], j
                count += 1
    return found[:, :count], which[:count]


def _negative_minima(brackets: Brackets, residual: Residual, edge_factor: EdgeFactor) -> Records:
    """Return negative minima of a function in brackets, by Newton's method on differences in all of them at once.

    The first half of the steps finds the minimum of the quotient by the edge factor, the other half the minimum of
    the function. The result is the lowest value evaluated, since differences across two crests may miss both.
    """
    low, middle, high, interval = brackets
    if middle.size == 0:
        return np.empty(0, MINIMUM)
    within = np.minimum(high - middle, middle - low)
    stencil, lowest = 0.5 * np.minimum(STENCIL_RATIO * (high - low), within), np.full((3, middle.size), np.inf)
    for refinement in range(1, REFINEMENTS + 1):
        if middle.size == 0:
            break
        points = np.stack([middle - stencil, middle, middle + stencil])
        order, value = np.argsort(points, axis=None), np.empty(points.size)
        value[order] = residual(points.ravel()[order])
        value = value.reshape(points.shape)
        curvature = _curvature(value, stencil)
        lowest = np.where(value[1] < lowest[1], [middle, value[1], curvature], lowest)
        if refinement <= REFINEMENTS // 2:
            value /= edge_factor(points.ravel(), np.tile(interval, 3)).reshape(points.shape)
            curvature = _curvature(value, stencil)
        slope, is_convex = (value[2] - value[0]) / (2 * stencil), curvature > 0
        newton = middle - slope / np.where(is_convex, curvature, np.inf)
        # The next stencil must stay within the bracket; of the last one only the middle is used.
        inner_end = 1.01 * STENCIL_RATIO * stencil * (refinement < REFINEMENTS - 1)
        newton = np.clip(newton, low + inner_end, high - inner_end)
        # Beyond an inflection Newton's method does not lead to the minimum, but bisection downhill does.
        halfway = 0.5 * (middle + np.where(slope > 0, low, high))
        shift = np.where(is_convex, newton, halfway) - middle
        # The position may be wrong by the width of the stencil, and the minimum lower by the fall over it.
        fall = 0.5 * MAX_FALL * np.maximum(curvature, 0) * (np.abs(shift) + stencil) ** 2
        some = np.minimum(value[1] - fall, lowest[1]) < 0
        some = some | ~is_convex if refinement < REFINEMENTS else lowest[1] < 0
        low, middle, high, interval = low[some], (middle + shift)[some], high[some], interval[some]
        stencil, lowest = STENCIL_RATIO * stencil[some], lowest[:, some]
    minima = np.empty(middle.size, MINIMUM)
    minima["position"], minima["value"], minima["curvature"], minima["interval"] = *lowest, interval
    return minima


def _curvature(value: Array, stencil: Array) -> Array:
    """Return second derivatives from values at three points, shape (3, brackets), at these distances."""
    return np.asarray((value[0] - 2 * value[1] + value[2]) / stencil**2)


def find_missing(
    problem: ContactProblem, step: NewtonStep, tolerance: float, margin: float, opening: float
) -> tuple[NDArray[np.float64], Records]:
    """Return edges of new segments where the gap or pressure has a minimum below -tolerance, shape (missing, 2).

    Also return all minima below the margin, including these. The width of a new segment is `new_outside`
    times that of the interval in which the parabola is negative. A new gap opens by more than `opening`, in g_0.
    """
    punches, kind, series = step.punches, problem.kind, problem.series
    highest = kind.uniform(step.forces.plane) - problem.highest - margin

    # The gap d - z - 2 sum f ln|2 sin|, or the pressure p_full - sum f/(2 L^2 sin^2), less the margin.
    def residual(x: Array) -> Array:
        total = force_field(punches, step.forces.force, x)
        total -= evaluate_near(series.local, series.crest_position, series.period, x)
        total += highest
        return total

    limit = tolerance + margin
    is_regular = step.largest < opening
    found = _minima_between(kind, punches.segments, step.a, is_regular, series, residual, limit, margin)
    if found.size == 0:
        return np.empty((0, 2)), found
    found["value"] += margin
    minima = found[found["value"] < -tolerance]
    finest = float(series.wavenumber[-1])
    minima = minima[kind.deserve_segments(minima, _room(step, minima), finest, opening)]
    depth, room = -minima["value"], _room(step, minima)
    # Between adjacent crests the curvature by differences may vanish: the floor keeps the width finite.
    reach = np.sqrt(2 * depth / np.maximum(minima["curvature"], depth / room**2))
    half_width = np.minimum(kind.new_outside * reach, 0.5 * room)  # a segment reaches at most halfway to others
    return np.stack([minima["position"] - half_width, minima["position"] + half_width], axis=1), found


def _room(step: NewtonStep, minima: Records) -> Array:
    """Return the distance of each new segment to the nearest old one or half that to a new one, the smaller."""
    to_left = minima["position"] - step.punches.segments.right[minima["interval"]]
    to_right = step.punches.gap[minima["interval"]] - to_left
    halfway = 0.5 * np.diff(minima["position"])
    none = np.full(min(to_left.size, 1), np.inf)
    return np.minimum(np.minimum(to_left, np.append(none, halfway)), np.minimum(to_right, np.append(halfway, none)))
