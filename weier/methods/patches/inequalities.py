"""The inequalities of contact: no tension on the contacts, no overlap outside them.

The equations on the segments say nothing of either. Both are checked between the nodes, too: a violation outside
shows that a segment is missing there, and one inside that the segment must be cut.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.patches.chebyshev import evaluate_expansion, partial_integral
from weier.methods.patches.fields import (
    ContactState,
    complementary_residual_slope,
    complementary_residual_slopes,
    complementary_residuals,
)
from weier.methods.patches.segments import distances_to_next
from weier.methods.patches.surface import CosineSeries, nearest_crest

MIN_PROBES = 12  # between two segments, denser at both ends, as the cosine is
PROBES_PER_WAVE = 5
SEARCH_STEPS = 40  # of golden sections and bisections: to 1e-9 of a bracket or less
GOLDEN_SECTION = 0.6180339887498949
SAMPLES_PER_NODE = 2  # to look for a change of sign within a segment
END_DISTANCE = 1e-6  # from the end of a gap: dividing by (1-t^2)^(3/2) leaves 7 digits here, as many as the limit has


class NegativeIntervals(NamedTuple):
    """Where on segments the pressure (primal) or the gap (dual) is negative, each of shape (intervals,).

    segment : index of the segment
    start, end : in its coordinate t, -1..1
    """

    segment: Indices
    start: Array
    end: Array


def lowest_outside(state: ContactState, series: CosineSeries, limit: float) -> float:
    """The lowest minimum of the complementary residual outside the segments, if it is below -limit; else 0 or above.

    Below 0, a segment is missing.
    """
    segments, distance = state.segments, distances_to_next(state.segments, series.period)
    edge = segments.origin + (segments.centre + segments.half_width)
    probe, interval = _probe_points(series, edge, distance)
    slope = complementary_residual_slopes(state, series, probe)
    bracket = np.flatnonzero((slope[:-1] < 0) & (slope[1:] >= 0) & (interval[:-1] == interval[1:]))
    bracket = _possibly_negative(state, series, limit, probe, slope, bracket)
    x = _minima(state, series, probe[bracket], probe[bracket + 1])
    return float(complementary_residuals(state, series, x).min(initial=0.0))


def _probe_points(series: CosineSeries, left: Array, distance: Array) -> tuple[Array, Indices]:
    """Points at shares (1 - cos)/2 of each interval, closer than the finest wave; and the interval of each point."""
    finest = 2 * np.pi / series.wavenumber[-1]
    count = MIN_PROBES + np.ceil(0.5 * np.pi * PROBES_PER_WAVE * distance / finest).astype(np.int64)
    interval = np.repeat(np.arange(distance.size), count)
    number = np.arange(interval.size) - np.repeat(np.cumsum(count) - count, count)
    angle = (number + 0.5) * (np.pi / count[interval])
    return left[interval] + distance[interval] * 0.5 * (1 - np.cos(angle)), interval


def _possibly_negative(
    state: ContactState, series: CosineSeries, tolerance: float, probe: Array, slope: Array, bracket: Indices
) -> Indices:
    """The brackets probe[i]..probe[i+1] whose minimum may lie below -tolerance, by a secant step towards it."""
    width, rise = probe[bracket + 1] - probe[bracket], slope[bracket + 1] - slope[bracket]
    near = probe[bracket] - slope[bracket] / rise * width
    max_drop = np.abs(complementary_residual_slopes(state, series, near)) * width
    return bracket[complementary_residuals(state, series, near) - max_drop < -tolerance]


@kernel
def _minima(state: ContactState, series: CosineSeries, low: Array, high: Array) -> Array:
    """The positions of minima between probes: where the slope of the complementary residual is 0, by bisection."""
    x = np.empty(low.size)
    for i in range(low.size):
        left, right = low[i], high[i]
        for _ in range(SEARCH_STEPS):
            x[i] = 0.5 * (left + right)
            crest, y = nearest_crest(series, x[i])
            if complementary_residual_slope(state, series, crest, y) < 0:
                left = x[i]
            else:
                right = x[i]
    return x


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
