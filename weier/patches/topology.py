"""Is the contact where a solution says: signs inside and outside every segment, and what corrects them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.errors import ConvergenceError
from weier.jit import kernel
from weier.patches.chebyshev import partial_integral, series
from weier.patches.collocation import Segments, spaces
from weier.patches.fields import State, clearance
from weier.patches.guess import Guess, Surface, carried_over, hertz
from weier.patches.waves import Waves, nearest_summit, offset

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

FEWEST_PROBES = 12  # in the space between two segments, gathered at its ends as the cosine
PROBES_PER_WAVE = 8
SEARCH_STEPS = 40  # of golden sections and bisections: to 1e-9 of a bracket or less
GOLDEN = 0.6180339887498949
CURVATURE_STEP = 1 / 64  # of the finest wave
SIGN_POINTS = 2  # per node, to look for a change of sign within a segment
CONTACT_WIDTH = 0.5  # of a new contact over the overlap that it replaces
GAP_WIDTH = np.sqrt(2.0)  # of a new gap over the stretch of tension: exact for a small one
CUT_WIDENING = 0.2  # at each end of a cut, so that it is sqrt(2) times the stretch of wrong sign
SHORTEST_PIECE = 1e-3  # of a segment, that survives a cut


class Births(NamedTuple):
    """Where segments are missing: distance y from a summit, half-width to start from, curvature there."""

    summit: Indices
    y: Array
    half_width: Array
    curvature: Array


@kernel
def violations_outside(state: State, waves: Waves, tolerance: float) -> Births:
    """Minima of the clearance below -tolerance."""
    room = 64 + 2 * waves.place.size
    births = Births(np.zeros(room, np.int64), np.zeros(room), np.zeros(room), np.zeros(room))
    found = 0
    segments = state.segments
    space = spaces(segments, waves.period)
    for j in range(space.size):
        left = segments.origin[j] + (segments.centre[j] + segments.half_width[j])
        x = _probes(waves, left, space[j])
        v = np.empty(x.size)
        for i in range(x.size):
            summit = nearest_summit(waves, x[i])
            v[i] = clearance(state, waves, summit, offset(waves, summit, x[i]))
        for i in range(x.size):
            before, after = (v[i - 1] if i > 0 else 0.0), (v[i + 1] if i + 1 < x.size else 0.0)
            if v[i] > before or v[i] > after or v[i] > 0.5 * (max(before, after) - v[i]):
                continue  # no minimum, or one that no parabola takes below 0
            low = (x[i - 1] if i > 0 else left) - x[i]
            high = (x[i + 1] if i + 1 < x.size else left + space[j]) - x[i]
            summit = nearest_summit(waves, x[i])
            y = offset(waves, summit, x[i])
            where, least = _least_clearance(state, waves, summit, y, v[i], low, high)
            if least < -tolerance and found < room:
                moved = x[i] - left + (where - y)
                _note(births, found, state, waves, summit, where, least, min(moved, space[j] - moved))
                found += 1
    return Births(births.summit[:found], births.y[:found], births.half_width[:found], births.curvature[:found])


@kernel
def _probes(waves: Waves, left: float, space: float) -> Array:
    # Gathered at both ends, everywhere finer than the finest wave, and every summit in between; in order.
    finest = 2 * np.pi / waves.frequency[-1]
    count = FEWEST_PROBES + int(np.ceil(0.5 * np.pi * PROBES_PER_WAVE * space / finest))
    x = np.empty(count + waves.place.size)
    for i in range(count):
        x[i] = left + space * 0.5 * (1 - np.cos((i + 0.5) * (np.pi / count)))
    for place in waves.place:
        top = place + waves.period * np.ceil((left - place) / waves.period)
        if left < top < left + space:
            i = count
            while i > 0 and x[i - 1] > top:
                x[i] = x[i - 1]
                i -= 1
            x[i] = top
            count += 1
    return x[:count]


@kernel
def _least_clearance(
    state: State, waves: Waves, summit: int, y: float, value: float, low: float, high: float
) -> tuple[float, float]:
    # Golden section between y + low and y + high; y itself is kept if nothing is lower.
    a, b = y + low, y + high
    c, d = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    at_c, at_d = clearance(state, waves, summit, c), clearance(state, waves, summit, d)
    for _ in range(SEARCH_STEPS):
        if at_c < at_d:
            b, d, at_d = d, c, at_c
            c = b - GOLDEN * (b - a)
            at_c = clearance(state, waves, summit, c)
        else:
            a, c, at_c = c, d, at_d
            d = a + GOLDEN * (b - a)
            at_d = clearance(state, waves, summit, d)
    if at_c < min(at_d, value):
        return c, at_c
    if at_d < value:
        return d, at_d
    return y, value


@kernel
def _note(
    births: Births,
    number: int,
    state: State,
    waves: Waves,
    summit: int,
    y: float,
    value: float,
    reach: float,
) -> None:
    # A segment as wide as its depth and curvature ask for, within reach of the neighbours.
    h = min(CURVATURE_STEP * 2 * np.pi / waves.frequency[-1], 0.5 * reach)
    sides = clearance(state, waves, summit, y - h) + clearance(state, waves, summit, y + h)
    curvature = max((sides - 2 * value) / (h * h), -value / (reach * reach))
    widening = GAP_WIDTH if state.dual else CONTACT_WIDTH
    births.summit[number] = summit
    births.y[number] = y
    births.half_width[number] = min(widening * np.sqrt(-2 * value / curvature), 0.4 * reach)
    births.curvature[number] = curvature


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
    # Samples denser than the nodes; a least one that may hide a change of sign is moved to the minimum.
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
    # phi, or the gap over (1-t^2)^(3/2), whose limits at the ends are -+phi/3.
    if not dual:
        return series(a, t)
    if abs(t) > 1 - 1e-6:
        return -np.sign(t) * series(a, np.sign(t)) / 3
    return partial_integral(a, t) / ((1 - t) * (1 + t)) ** 1.5


@kernel
def _crossing(dual: bool, a: Array, below: float, above: float) -> float:
    # Change of sign between a negative and a positive sample.
    for _ in range(SEARCH_STEPS):
        middle = 0.5 * (below + above)
        if _positive(dual, a, middle) < 0:
            below = middle
        else:
            above = middle
    return above


def corrected(surface: Surface, state: State, tolerance: float) -> Guess | None:
    """A guess with segments added, cut or dropped where a sign is wrong; None if all are right."""
    waves = surface.of(state.dual)
    births = violations_outside(state, waves, tolerance * (state.load if state.dual else abs(state.approach)))
    cuts = violations_inside(state, tolerance)
    if births.y.size == 0 and cuts[0].size == 0:
        return None
    summit, centre, half_width = _cut(state.segments, *cuts)
    kept = summit.size
    summit = np.concatenate([summit, births.summit])
    centre = np.concatenate([centre, births.y])
    half_width = np.concatenate([half_width, births.half_width])
    guess, order = carried_over(surface, state, summit, centre, half_width)
    for j in np.flatnonzero(order >= kept):
        here = slice(guess.segments.first[j], guess.segments.first[j + 1])
        curvature = births.curvature[order[j] - kept]
        guess.phi[here] = hertz(state.dual, curvature, guess.segments.half_width[j], here.stop - here.start)
    return guess


def _cut(old: Segments, segment: Indices, start: Array, end: Array) -> tuple[Indices, Array, Array]:
    # What is left of each segment without the stretches of wrong sign.
    summit, centre, half_width = [], [], []
    for j in range(old.centre.size):
        left = -1.0
        pieces = []
        for a, b in zip(start[segment == j], end[segment == j], strict=True):
            widening = CUT_WIDENING * (b - a) if a > -1 and b < 1 else 0.0
            pieces.append((left, a - widening))
            left = b + widening
        for a, b in [*pieces, (left, 1.0)]:
            if b - a > SHORTEST_PIECE:
                summit.append(old.summit[j])
                centre.append(old.centre[j] + old.half_width[j] * 0.5 * (a + b))
                half_width.append(old.half_width[j] * 0.5 * (b - a))
    return np.array(summit, np.int64), np.array(centre), np.array(half_width)


def without_cramped(surface: Surface, state: State, closing: Flags, vanishing: Flags) -> Guess:
    """A guess without the segments that vanish or, if none does, with those joined that meet.

    `closing` names the segment on the left of each pair.

    Raises
    ------
    ConvergenceError
        If nothing would be left, or nothing between.
    """
    old = state.segments
    if np.all(vanishing) or np.all(closing):
        raise ConvergenceError(f"all contacts or all gaps vanish under the mean pressure {state.load:.6g} p_0*")
    if np.any(vanishing):
        keep = ~vanishing
        return carried_over(surface, state, old.summit[keep], old.centre[keep], old.half_width[keep])[0]
    n = old.centre.size
    space = spaces(old, surface.heights.period)
    starts = np.flatnonzero(~np.roll(closing, 1))
    half_width = np.empty(starts.size)
    for i, j in enumerate(starts):
        length = 2 * old.half_width[j]
        while closing[j % n]:
            length += space[j % n] + 2 * old.half_width[(j + 1) % n]
            j += 1
        half_width[i] = 0.5 * length
    centre = old.centre[starts] + (half_width - old.half_width[starts])
    return carried_over(surface, state, old.summit[starts], centre, half_width)[0]
