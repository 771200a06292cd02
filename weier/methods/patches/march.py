"""From load to load: the first solution, the predictor, and what to do when a step fails."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from weier.methods.errors import ConvergenceError
from weier.methods.patches.fields import State
from weier.methods.patches.guess import Guess, as_state, resampled
from weier.methods.patches.nodes import TAIL, adjusted_nodes, tails
from weier.methods.patches.segments import Segments, make_segments, moved, spaces
from weier.methods.patches.settle import TooLargeError, settle
from weier.methods.patches.start import CELLS_PER_WAVE, coarse_start, hertz_start
from weier.methods.patches.surface import Surface
from weier.methods.patches.topology import without_cramped
from weier.theory.profile import Profile

Array = NDArray[np.float64]

DEEPEST = 8  # halvings of a step in ln(p)
COARSE_EVERY = 3  # of these, boundary elements are tried
FAR_STEP = 2.0  # in load, from which on boundary elements are tried before the tangent
NEARLY_FULL = 1 - 1e-5  # of the load of full contact: a gap shrinks by more than a tangent foresees
LIGHTER = 4.0  # factor to lighter loads, until a single contact is enough
MOST_LIGHTER = 30
CLOSED = 0.5  # of a space, to which the tangent takes it: its square falls like the load, so that it will be gone
NARROWEST = 0.01  # of a half-width squared, kept by the predictor
FINE_TAIL = 1e-3  # over the tail to aim at: nodes enough to take some away


def solutions(
    profile: Profile, surface: Surface, mean_pressure: Array, tolerance: float
) -> Iterator[tuple[State | None, int]]:
    """The solution and the Newton steps of each load, in rising order; None in full contact.

    Raises
    ------
    ConvergenceError
        If a load cannot be reached.
    """
    state: State | None = None
    for load in mean_pressure:
        if load >= surface.full_load:
            yield None, 0
            continue
        if state is None:
            state, steps = first(profile, surface, float(load), tolerance)
        else:
            state, steps = following(profile, surface, state, float(load), tolerance)
        yield state, steps


def first(profile: Profile, surface: Surface, load: float, tolerance: float) -> tuple[State, int]:
    """A solution with no neighbour: from Hertz or boundary elements, else by way of lighter loads."""
    direct = _directly(profile, surface, load, tolerance)
    return _by_lighter_loads(profile, surface, load, tolerance) if direct is None else direct


def _directly(profile: Profile, surface: Surface, load: float, tolerance: float) -> tuple[State, int] | None:
    """The solution from Hertz or boundary elements; None if neither leads to it."""
    tiny = _narrowest(hertz_start(surface, load, False).segments, profile) < 1
    for hertzian in (tiny, not tiny):  # boundary elements do not see a tiny contact
        try:
            guess = hertz_start(surface, load, False) if hertzian else coarse_start(profile, surface, load)
            return settle(surface, guess, load, tolerance)
        except TooLargeError:
            if not hertzian:
                raise
        except ConvergenceError:
            continue
    return None


def _by_lighter_loads(profile: Profile, surface: Surface, load: float, tolerance: float) -> tuple[State, int]:
    """The solution by way of the heaviest lighter load that Hertz leads to.

    Raises
    ------
    ConvergenceError
        If there is none.
    """
    lighter = load
    for _ in range(MOST_LIGHTER):
        lighter /= LIGHTER
        try:
            state, steps = settle(surface, hertz_start(surface, lighter, False), lighter, tolerance)
        except ConvergenceError:
            continue
        state, more = following(profile, surface, state, load, tolerance)
        return state, steps + more
    raise ConvergenceError(f"no solution to start from below the mean pressure {load:.6g} p_0*")


def following(
    profile: Profile, surface: Surface, state: State, load: float, tolerance: float, depth: int = 0
) -> tuple[State, int]:
    """The solution of the next load; where the step fails, through loads in between."""
    for start in _starts(profile, surface, state, load, tolerance, depth):
        try:
            return settle(surface, start(), load, tolerance)
        except TooLargeError:
            if start.func is coarse_start:
                raise
        except ConvergenceError:
            if depth == DEEPEST:
                raise
    between = float(np.sqrt(state.load) * np.sqrt(load))
    middle, steps = following(profile, surface, state, between, tolerance, depth + 1)
    end, more = following(profile, surface, middle, load, tolerance, depth + 1)
    return end, steps + more


def _starts(
    profile: Profile, surface: Surface, state: State, load: float, tolerance: float, depth: int
) -> tuple[partial[Guess], ...]:
    """What to start from, in this order: the tangent, boundary elements, or the last gaps before full contact."""
    tangent = partial(predicted, surface, state, load, tolerance)
    coarse = partial(coarse_start, profile, surface, load)
    if load > NEARLY_FULL * surface.full_load:
        return partial(hertz_start, surface, load, True), tangent
    ratio = load / state.load
    if depth == 0 and ratio > FAR_STEP and _narrowest(state.segments, profile) * np.sqrt(ratio) > 1:
        return coarse, tangent
    return (tangent, coarse) if depth % COARSE_EVERY == 0 else (tangent,)


def _narrowest(contacts: Segments, profile: Profile) -> float:
    """Half-width of the narrowest segment in cells of the coarse grid."""
    return float(contacts.half_width.min()) * CELLS_PER_WAVE * profile.wavenumber[-1] / profile.period


def predicted(surface: Surface, state: State, load: float, tolerance: float) -> Guess:
    """Half-widths squared, and densities over half-widths, along the tangent: exact for Hertz's contact."""
    change = load - state.load
    old, period = state.segments, surface.heights.period
    n, N = old.centre.size, state.phi.size
    rate = state.sensitivity[N + n : N + 2 * n]
    growth = np.sqrt(np.maximum(1 + 2 * rate * change, NARROWEST))
    half_width = old.half_width * growth
    most = np.maximum(old.half_width, half_width)  # of a shift: a contact grows round its old place, a gap shrinks
    shift = state.sensitivity[N : N + n] * old.half_width * change
    placed = moved(old, old.centre + np.clip(shift, -most, most), half_width, period)
    closing = spaces(placed, period) <= CLOSED * spaces(old, period)
    if np.all(closing):
        return Guess(state.dual, old, state.phi, state.approach)
    if np.any(closing):
        return without_cramped(surface, state, closing, np.zeros(n, np.bool_))
    count, power = np.diff(old.first), 2 if state.dual else 1
    slope = state.sensitivity[:N] - power * state.phi * np.repeat(rate, count)
    phi = (state.phi + slope * change) * np.repeat(growth, count) ** power
    approach = state.approach + state.sensitivity[-1] * change
    return _with_nodes(surface, Guess(state.dual, placed, phi, approach), tails(state), load, tolerance)


def _with_nodes(surface: Surface, guess: Guess, tail: Array, load: float, tolerance: float) -> Guess:
    """The guess with as many nodes as the last solution would have needed, by its tails."""
    placed: Segments = guess.segments
    aim, count = TAIL * tolerance, np.diff(placed.first)
    new_count = adjusted_nodes(count, tail, aim, (tail > aim) | (tail < FINE_TAIL * aim))
    if np.array_equal(new_count, count):
        return guess
    waves = surface.of(guess.dual)
    new = make_segments(placed.summit, placed.origin, placed.centre, placed.half_width, new_count, waves.period)
    phi = resampled(as_state(guess, load), waves, new, False)
    return Guess(guess.dual, new, phi, guess.approach)
