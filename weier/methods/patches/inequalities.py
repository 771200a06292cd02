"""The inequalities of contact, no tension on contacts and no overlap outside them, and their violations.

docs/patches.md derives the formulas: "Inequalities" for the search and the width of new segments, and "Thin gaps" for
the opening of a crack.

The equations on the segments do not imply the inequalities, so that violations are searched:

- Between the segments, the gap or the pressure has a negative minimum where one is missing. `minima_between` finds
  lower bounds in cells, which `_divide` divides until `_lower_bound` is positive or close to a minimum.
- On the segments, the pressure or the gap is negative where a segment must be cut: `find_negative_intervals`.
Remaining violations enter the bound on the error (`certificate`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices, Records, record_type
from weier.kernels.jit import kernel
from weier.methods.chebyshev import derivative_expansion, evaluate_expansion
from weier.methods.patches.edge_iteration import ContactProblem, NewtonStep
from weier.methods.patches.kind import EPS, FIELD_ROUNDING
from weier.methods.patches.pressure_and_gap import at_point, residuals_in_order, smooth_part
from weier.methods.patches.segments import MINIMUM, ContactState
from weier.methods.patches.surface import (
    CosineSeries,
    Extent,
    Local,
    distances_between,
    evaluate_series,
    nearest_crest,
)

SAMPLES_PER_NODE = 2  # samples per node in the search for sign changes within a segment
# least number of cells in an interval between segments, so that those at both ends have four points beside them, and
# parts of a cell that is divided: both set the cost
MIN_CELLS, PARTS = 8, 4
RESOLUTION = 0.1  # largest distance of a minimum from its lower bound, relative to that or to rounding

# A point between segments: its interval, position, in lambda_0, residual, and series with two derivatives, or NaN
POINT = record_type(("interval", np.int64, ()), ("x residual series slope curvature", np.float64, ()))
Unknown = tuple[Indices, Indices, Array, Array]  # of points without a residual: index, crest, its place, distance

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
def _first_points(extent: Extent, period: float, crest: Array, local: Local) -> tuple[Records, Unknown]:
    """Return equidistant points in each interval between segments, and its ends, where the residual is 0."""
    length, (origin, centre, half_width) = distances_between(*extent, period), extent
    divided = np.where(length > 0, np.minimum(length, period), 0.0)
    cells = np.maximum(MIN_CELLS, np.ceil(divided / local[3])).astype(np.int64)
    points, last = np.empty((cells + 1).sum(), POINT), 0
    for j in range(length.size):
        for i in range(cells[j] + 1 if length[j] > 0 else 0):  # segments may overlap
            point, at_end = points[last], i == 0 or i == cells[j]
            point.interval, point.x = j, origin[j] + (centre[j] + half_width[j]) + length[j] * i / cells[j]
            point.residual, point.series = 0.0 if at_end else np.nan, np.nan
            last += 1
    return points[:last], _unknown(points[:last], period, crest, local)


@kernel
def _unknown(points: Records, period: float, crest: Array, local: Local) -> Unknown:
    """Evaluate the series at new points; return the points without a residual, their crests, origins and offsets."""
    new, of, count = np.empty(points.size, np.int64), np.empty(points.size, np.int64), 0
    origin, y = np.empty((2, points.size))
    for i in range(points.size):
        point = points[i]
        if np.isnan(point.series):
            nearest, offset = nearest_crest(crest, period, point.x)
            point.series, point.slope, point.curvature = evaluate_series(local, nearest, offset)
            if np.isnan(point.residual):
                new[count], of[count], y[count] = i, nearest, offset
                origin[count] = crest[nearest] + period * np.rint((point.x - offset - crest[nearest]) / period)
                count += 1
    return new[:count], of[:count], origin[:count], y[:count]


@kernel
def _mean_slope(points: Records, i: int) -> float:
    """Return the mean slope of the field, the sum of residual and series, between point i and the next one."""
    here, after = points[i], points[i + 1]
    return (after.residual - here.residual + (after.series - here.series)) / (after.x - here.x)


@kernel
def _least_curvature(points: Records, i: int, side: int) -> float:
    """Return a lower bound of the curvature of the field at point i and beyond it on the other side, 0 if unknown.

    It is known if the curvature decreases from this point over the next three on this side, +1 or -1.
    """
    end, nearest = i + 3 * side, min(i, i + 2 * side)
    if end < 0 or end >= points.size or points[end].interval != points[i].interval:
        return 0.0
    curvature = np.empty(2)
    for q in range(2):
        k = nearest + q * side
        curvature[q] = (_mean_slope(points, k + 1) - _mean_slope(points, k)) / (points[k + 2].x - points[k].x)
    return max(2 * curvature[0], 0.0) if curvature[1] <= curvature[0] else 0.0


@kernel
def _lower_bound(points: Records, i: int, fourth: float, is_slope: bool) -> float:
    """Return a lower bound of the residual between points i and i + 1, from one of the series' fourth derivative."""
    here, after, depth = points[i], points[i + 1], 0.0
    width, rise = after.x - here.x, after.residual - here.residual
    lowest = min(here.curvature, after.curvature) - fourth * width**2 / 8
    highest = max(here.curvature, after.curvature) + fourth * width**2 / 8
    if not is_slope:
        slope, before, behind, width_before, width_behind = _mean_slope(points, i), here.slope, after.slope, 0.0, 0.0
        if i > 0 and points[i - 1].interval == here.interval:
            before, width_before = _mean_slope(points, i - 1), here.x - points[i - 1].x
        if i + 2 < points.size and points[i + 2].interval == here.interval:
            behind, width_behind = _mean_slope(points, i + 1), points[i + 2].x - after.x
        curvature = _least_curvature(points, i + 1, 1) if highest > 0 else 0.0
        if curvature >= highest and before + 0.5 * curvature * width_before >= here.slope:
            return here.residual
        curvature = _least_curvature(points, i, -1) if highest > 0 else 0.0
        if curvature >= highest and behind - 0.5 * curvature * width_behind <= after.slope:
            return after.residual
        depth = max(slope - before, 0.0) * max(behind - slope, 0.0) / max(behind - before, 1e-300) * width
    bend = max(-lowest, 0.0)
    s = min(max(0.5 * width - rise / (width * bend), 0.0), width) if bend > 0 else (width if rise < 0 else 0.0)
    return here.residual + rise * (s / width) - 0.5 * bend * s * (width - s) - depth


@kernel
def _minima(points: Records, bounds: Array, margin: float) -> Records:
    """Return the minima among points between which the bounds are below the margin, with the least bound there."""
    found, count, i = np.empty(points.size, MINIMUM), 0, 0
    while i < points.size - 1:
        k, bound, rises = i, np.inf, False
        while bounds[i] < margin and not (rises and points[i + 1].residual <= points[i].residual):
            rises, bound = points[i + 1].residual > points[i].residual, min(bound, bounds[i])
            k, i = k if rises else i + 1, i + 1
        if bound == np.inf:
            i += 1
            continue
        here, found[count].interval, found[count].value = points[k], points[k].interval, bound
        found[count].position, found[count].curvature = here.x, 0.0
        if 0 < k < points.size - 1 and points[k - 1].interval == points[k + 1].interval:
            left, right = here.x - points[k - 1].x, points[k + 1].x - here.x
            fall, rise = points[k - 1].residual - here.residual, points[k + 1].residual - here.residual
            fall, rise = fall / left, rise / right
            found[count].curvature = 2 * (fall + rise) / (left + right)
            found[count].position += 0.5 * (fall * right - rise * left) / max(fall + rise, 1e-300)
            count += 1
        elif bound < 0:
            count += 1
    return found[:count]


@kernel
def _divide(
    points: Records,
    period: float,
    crest: Array,
    local: Local,
    fourth: Array,
    is_slope: bool,
    rounding: float,
    margin: float,
) -> tuple[Records, Unknown, Records]:
    """Return the points with new ones where a minimum may be lower than its samples, and minima of the old ones."""
    bounds, count, step, nodes = np.full(points.size, np.inf), points.size, local[3], fourth.size
    divided = np.zeros(points.size, np.bool_)
    for i in range(points.size - 1):
        here, after, most = points[i], points[i + 1], 0.0
        if here.interval == after.interval:
            for node in range(np.int64(np.rint(here.x / step)), np.int64(np.rint(after.x / step)) + 1):
                most = max(most, fourth[node % nodes])
            bounds[i] = _lower_bound(points, i, most, is_slope)
            fall = min(here.residual, after.residual) - bounds[i]
            is_certain = fall <= RESOLUTION * max(abs(bounds[i]), rounding) or after.x - here.x < 8 * EPS * period
            divided[i] = bounds[i] < margin and not is_certain
            count += (PARTS - 1) * divided[i]
    more, last = np.empty(count, POINT), 0
    for i in range(points.size):
        more[last] = points[i]
        last += 1
        for part in range(1, PARTS if divided[i] else 0):
            more[last].interval, more[last].residual, more[last].series = points[i].interval, np.nan, np.nan
            more[last].x = points[i].x + (points[i + 1].x - points[i].x) * part / PARTS
            last += 1
    return more, _unknown(more, period, crest, local), _minima(points, bounds, margin)


def minima_between(state: ContactState, series: CosineSeries, rounding: float, margin: float) -> Records:
    """Return minima of the gap between contacts, or of the pressure between gaps, that are below a margin.

    Their values are lower bounds, up to the residual at edges, at most a tenth of themselves or of rounding too low.
    """
    line = series.period, series.crest_position, series.local
    points, unknown = _first_points(state.segments.extent, *line)
    while True:
        points["residual"][unknown[0]] = residuals_in_order(state, series, *unknown[1:])
        points, unknown, minima = _divide(points, *line, series.fourth, state.kind.is_slope, rounding, margin)
        if unknown[0].size == 0:
            return minima


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


def find_missing(
    problem: ContactProblem, step: NewtonStep, state: ContactState, tolerance: float, margin: float, opening: float
) -> tuple[NDArray[np.float64], Records]:
    """Return edges of new segments where the gap or pressure has a minimum below -tolerance, shape (missing, 2).

    Also return all minima below the margin, including these. The width of a new segment is `new_outside`
    times that of the interval in which the parabola is negative. A new gap opens by more than `opening`, in g_0.
    """
    kind, series = problem.kind, problem.series
    height = FIELD_ROUNDING * min(problem.load * series.period, 1.0)
    rounding = kind.limit_outside(problem.load, height, FIELD_ROUNDING)
    found = minima_between(state, series, rounding, margin)
    if found.size == 0:
        return np.empty((0, 2)), found
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
