"""Other segments where a solution has a wrong sign, or where they vanish or meet: added, cut, dropped and joined."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.methods.errors import ConvergenceError
from weier.methods.patches.fields import State
from weier.methods.patches.guess import Guess, carried_over
from weier.methods.patches.hertz import hertz
from weier.methods.patches.segments import Segments, spaces
from weier.methods.patches.signs import violations_inside, violations_outside
from weier.methods.patches.surface import Surface

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

# Of the pressure, left where two contacts have nearly merged: it shifts dh/dp by less, h by its square.
TENSION = 1e-9
CUT_WIDENING = 0.2  # at each end of a cut, so that it is sqrt(2) times the stretch of wrong sign
SHORTEST_PIECE = 1e-3  # of a segment, that survives a cut


def corrected(surface: Surface, state: State, tolerance: float) -> Guess | None:
    """A guess with segments added, cut or dropped where a sign is wrong; None if all are right."""
    waves = surface.of(state.dual)
    tension = max(tolerance, TENSION)
    if state.dual:
        births, cuts = violations_outside(state, waves, tension * state.load), violations_inside(state, tolerance)
    else:
        births = violations_outside(state, waves, tolerance * abs(state.approach))
        cuts = violations_inside(state, tension)
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
    """Summits, centres and half-widths of what is left of each segment without the stretches of wrong sign."""
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
