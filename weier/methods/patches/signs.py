"""Is the contact where a solution says: the signs inside and outside every segment."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are used: a tenth of a second each, that few jobs need
from numpy.typing import NDArray

from weier.kernels.jit import kernel
from weier.methods.patches.chebyshev import partial_integral, series
from weier.methods.patches.fields import State, clearance_slopes, clearances
from weier.methods.patches.segments import spaces
from weier.methods.patches.waves import Waves, from_summits

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

FEWEST_PROBES = 12  # in the space between two segments, gathered at its ends as the cosine
PROBES_PER_WAVE = 5
PLACE = 1e-9  # of a minimum between two probes, over their distance
SEARCH_STEPS = 40  # of golden sections and bisections: to 1e-9 of a bracket or less
GOLDEN = 0.6180339887498949
SIGN_POINTS = 2  # per node, to look for a change of sign within a segment
CONTACT_WIDTH = 0.5  # of a new contact over the overlap that it replaces
GAP_WIDTH = np.sqrt(2.0)  # of a new gap over the stretch of tension: exact for a small one
ROOM = 0.4  # for a new segment's half-width, of the way to its nearest neighbour: two born side by side stay apart
END = 1e-6  # from an end of a gap: dividing by (1-t^2)^(3/2) leaves 7 digits there, and the limit is as exact


class Births(NamedTuple):
    """Where segments are missing, each of shape (births,).

    summit : index of the nearest
    y : distance from it, in lambda_0
    half_width : to start from, in lambda_0
    curvature : second derivative of the clearance there, in g_0/lambda_0^2 or (dual) p_0*/lambda_0^2
    """

    summit: Indices
    y: Array
    half_width: Array
    curvature: Array


def violations_outside(state: State, waves: Waves, tolerance: float) -> Births:
    """Minima of the clearance below -tolerance."""
    space, segments = spaces(state.segments, waves.period), state.segments
    edge = segments.origin + (segments.centre + segments.half_width)
    x, where = _probes(waves, edge, space)
    slope = clearance_slopes(state, waves, x)
    i = np.flatnonzero((slope[:-1] < 0) & (slope[1:] >= 0) & (where[:-1] == where[1:]))
    width, rise = x[i + 1] - x[i], slope[i + 1] - slope[i]
    near = x[i] - slope[i] / rise * width
    most = np.abs(clearance_slopes(state, waves, near)) * width  # that the minimum lies below a place near it
    suspect = i[clearances(state, waves, near) - most < -tolerance]
    place = np.array([_lowest(state, waves, x[j], x[j + 1]) for j in suspect])
    value = clearances(state, waves, place)
    wrong = value < -tolerance
    place, value, j = place[wrong], value[wrong], suspect[wrong]
    left, right = edge[where[j]], edge[where[j]] + space[where[j]]
    between = 0.5 * (place[1:] + place[:-1])  # two in one space share it
    reach = np.minimum(
        place - np.maximum(left, np.append(-np.inf, between)), np.minimum(right, np.append(between, np.inf)) - place
    )
    curvature = np.maximum((slope[j + 1] - slope[j]) / (x[j + 1] - x[j]), -value / reach**2)
    widening = GAP_WIDTH if state.dual else CONTACT_WIDTH
    half_width = np.minimum(widening * np.sqrt(-2 * value / curvature), ROOM * reach)
    return Births(*from_summits(waves, place), half_width, curvature)


def _lowest(state: State, waves: Waves, low: float, high: float) -> float:
    """The place between two probes where the clearance is least: its slope is 0."""

    def slope(x: float) -> float:
        return float(clearance_slopes(state, waves, np.array([x]))[0])

    return float(scipy.optimize.brentq(slope, low, high, xtol=PLACE * (high - low)))


def _probes(waves: Waves, left: Array, space: Array) -> tuple[Array, Indices]:
    """Places (1 - cos)/2 along each space, everywhere closer than the finest wave; and the space that each is in."""
    finest = 2 * np.pi / waves.frequency[-1]
    count = FEWEST_PROBES + np.ceil(0.5 * np.pi * PROBES_PER_WAVE * space / finest).astype(np.int64)
    where = np.repeat(np.arange(space.size), count)
    turn = (np.arange(where.size) - np.repeat(np.cumsum(count) - count, count) + 0.5) * (np.pi / count[where])
    return left[where] + space[where] * 0.5 * (1 - np.cos(turn)), where


@kernel
def violations_inside(state: State, tolerance: float) -> tuple[Indices, Array, Array]:
    """Stretches t1..t2 of segments on which the pressure (primal) or the gap (dual) is negative."""
    first = state.segments.first
    room = SIGN_POINTS * first[-1] + 2 * first.size
    segment, start, end = np.zeros(room, np.int64), np.zeros(room), np.zeros(room)
    found = 0
    for j in range(first.size - 1):
        a = state.coefficient[first[j] : first[j + 1]]
        t, value = _signs(state.dual, a)
        most = 0.0
        for v in value:
            most = max(most, abs(v))
        least = -tolerance * most
        i = 0
        while i < t.size:
            if value[i] < least:
                k = i
                while k + 1 < t.size and value[k + 1] < 0:
                    k += 1
                while i > 0 and value[i - 1] < 0:
                    i -= 1
                segment[found] = j
                start[found] = _crossing(state.dual, a, t[i], t[i - 1]) if i > 0 else -1.0
                end[found] = _crossing(state.dual, a, t[k], t[k + 1]) if k + 1 < t.size else 1.0
                found += 1
                i = k
            i += 1
    return segment[:found], start[:found], end[:found]


@kernel
def _signs(dual: bool, a: Array) -> tuple[Array, Array]:
    """Places t, denser than the nodes, and values; a least one that may hide a sign change moves to the minimum."""
    count = SIGN_POINTS * a.size + 1
    t, samples = np.empty(count + 1), np.empty(count + 1)
    for i in range(count + 1):
        t[i] = -np.cos(i * (np.pi / count))
        samples[i] = _positive(dual, a, t[i])
    value = samples.copy()
    for i in range(1, count):
        rise = max(samples[i - 1], samples[i + 1]) - samples[i]
        if samples[i] > min(samples[i - 1], samples[i + 1]) or not 0 <= samples[i] <= rise:
            continue
        low, high = t[i - 1], t[i + 1]
        for _ in range(SEARCH_STEPS):
            c, d = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
            if _positive(dual, a, c) < _positive(dual, a, d):
                high = d
            else:
                low = c
        t[i] = 0.5 * (low + high)
        value[i] = _positive(dual, a, t[i])
    return t, value


@kernel
def _positive(dual: bool, a: Array, t: float) -> float:
    """phi, or (dual) the gap over r (1-t^2)^(3/2), whose limits at the ends are -+phi/3: positive if all is right."""
    if not dual:
        return series(a, t)
    if abs(t) > 1 - END:
        return -np.sign(t) * series(a, np.sign(t)) / 3
    return partial_integral(a, t) / ((1 - t) * (1 + t)) ** 1.5


@kernel
def _crossing(dual: bool, a: Array, below: float, above: float) -> float:
    """The place between a negative and a positive sample where the sign changes, by bisection."""
    for _ in range(SEARCH_STEPS):
        middle = 0.5 * (below + above)
        if _positive(dual, a, middle) < 0:
            below = middle
        else:
            above = middle
    return above
