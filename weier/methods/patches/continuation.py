"""From load to load: the first state, the tangent predictor, and intermediate loads where a step fails."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.patches.active_set import TooLargeError, remove_or_merge, solve_active_set
from weier.methods.patches.fields import ContactState
from weier.methods.patches.initial_guess import (
    CELLS_PER_WAVE,
    InitialGuess,
    coarse_grid_guess,
    hertz_guess,
    sample_density,
    state_of_guess,
)
from weier.methods.patches.many_contacts import solve_if_many
from weier.methods.patches.segments import (
    TARGET_TAIL,
    Segments,
    adapt_node_count,
    coefficient_tails,
    distances_to_next,
    make_segments,
    move_segments,
)
from weier.methods.patches.surface import Surface
from weier.theory.profile import Profile

MAX_HALVINGS = 8  # of a step in ln(p)
HALVINGS_PER_GRID = 3  # at every third one, a coarse grid is tried, too
MAX_TANGENT_RATIO = 2.0  # of loads: for larger steps a coarse grid is tried before the tangent
# Share of the load of full contact from which on a gap shrinks by more than a tangent foresees.
MIN_SHARE_NEARLY_FULL = 1 - 1e-5
LIGHTER_LOAD_FACTOR = 4.0  # to go to lighter loads until a single contact is enough
MAX_LIGHTER_LOADS = 30
# Share of a distance that the tangent must leave. A gap's width squared falls like the load, so that one which would
# lose half its width to first order is about to close.
MIN_DISTANCE_LEFT = 0.5
MIN_SQUARE_LEFT = 0.01  # share of a half-width squared that the predictor leaves
MIN_TAIL_RATIO = 1e-3  # over the tail to aim at: with less, there are nodes to spare


def states_over_loads(
    profile: Profile, surface: Surface, mean_pressure: Array, tolerance: float
) -> Iterator[tuple[ContactState | None, int]]:
    """The state and the Newton steps for each of increasing loads; the state is None in full contact."""
    state: ContactState | None = None
    for load in mean_pressure:
        if load >= surface.full_contact_load:
            yield None, 0
            continue
        if (solved := solve_if_many(profile, surface, float(load), tolerance)) is not None:
            yield solved
            state = None
            continue
        if state is None:
            state, steps = first_state(profile, surface, float(load), tolerance)
        else:
            state, steps = next_state(profile, surface, state, float(load), tolerance)
        yield state, steps


def first_state(profile: Profile, surface: Surface, load: float, tolerance: float) -> tuple[ContactState, int]:
    """A state and its Newton steps without a previous one: from an initial guess, or by way of lighter loads."""
    direct = _state_from_guess(profile, surface, load, tolerance)
    return _state_from_lighter_load(profile, surface, load, tolerance) if direct is None else direct


def _state_from_guess(
    profile: Profile, surface: Surface, load: float, tolerance: float
) -> tuple[ContactState, int] | None:
    """The state from Hertz's contacts or those of a coarse grid; None if neither leads to it."""
    tiny = _narrowest_in_cells(hertz_guess(surface, load, False).segments, profile) < 1
    for hertzian in (tiny, not tiny):  # a coarse grid does not show a tiny contact
        try:
            guess = hertz_guess(surface, load, False) if hertzian else coarse_grid_guess(profile, surface, load)
            return solve_active_set(surface, guess, load, tolerance)
        except TooLargeError:
            if not hertzian:
                raise
        except ConvergenceError:
            continue
    return None


def _state_from_lighter_load(
    profile: Profile, surface: Surface, load: float, tolerance: float
) -> tuple[ContactState, int]:
    """The state by way of the heaviest lighter load to which Hertz's contacts lead."""
    lighter = load
    for _ in range(MAX_LIGHTER_LOADS):
        lighter /= LIGHTER_LOAD_FACTOR
        try:
            state, steps = solve_active_set(surface, hertz_guess(surface, lighter, False), lighter, tolerance)
        except ConvergenceError:
            continue
        state, more_steps = next_state(profile, surface, state, load, tolerance)
        return state, steps + more_steps
    raise ConvergenceError(f"no load below {load:.6g} p_0* could be solved to start from")


def next_state(
    profile: Profile, surface: Surface, state: ContactState, load: float, tolerance: float, halvings: int = 0
) -> tuple[ContactState, int]:
    """The state under the next load and the Newton steps to it; where the step fails, it is halved in ln(p)."""
    for guess in _guesses(profile, surface, state, load, tolerance, halvings):
        try:
            return solve_active_set(surface, guess(), load, tolerance)
        except TooLargeError:
            if guess.func is coarse_grid_guess:
                raise
        except ConvergenceError:
            if halvings == MAX_HALVINGS:
                raise
    middle_load = float(np.sqrt(state.load) * np.sqrt(load))
    middle, steps = next_state(profile, surface, state, middle_load, tolerance, halvings + 1)
    end, more_steps = next_state(profile, surface, middle, load, tolerance, halvings + 1)
    return end, steps + more_steps


def _guesses(
    profile: Profile, surface: Surface, state: ContactState, load: float, tolerance: float, halvings: int
) -> tuple[partial[InitialGuess], ...]:
    """What to start from, in this order: the tangent, a coarse grid, or the last gaps before full contact."""
    tangent = partial(predict, surface, state, load, tolerance)
    grid = partial(coarse_grid_guess, profile, surface, load)
    if load > MIN_SHARE_NEARLY_FULL * surface.full_contact_load:
        return partial(hertz_guess, surface, load, True), tangent
    ratio = load / state.load
    far = halvings == 0 and ratio > MAX_TANGENT_RATIO
    if far and _narrowest_in_cells(state.segments, profile) * np.sqrt(ratio) > 1:
        return grid, tangent
    return (tangent, grid) if halvings % HALVINGS_PER_GRID == 0 else (tangent,)


def _narrowest_in_cells(segments: Segments, profile: Profile) -> float:
    """Half-width of the narrowest segment in cells of the coarse grid."""
    return float(segments.half_width.min()) * CELLS_PER_WAVE * profile.waves_per_period[-1] / profile.period


def predict(surface: Surface, state: ContactState, load: float, tolerance: float) -> InitialGuess:
    """The tangent of half-widths squared, and of densities over half-widths: exact for Hertz's contact."""
    change = load - state.load
    old, period = state.segments, surface.heights.period
    n, N = old.centre.size, state.phi.size
    rate = state.sensitivity[N + n : N + 2 * n]
    growth = np.sqrt(np.maximum(1 + 2 * rate * change, MIN_SQUARE_LEFT))
    half_width = old.half_width * growth
    max_shift = np.maximum(old.half_width, half_width)  # a contact grows where it was, and a gap shrinks there
    shift = state.sensitivity[N : N + n] * old.half_width * change
    segments = move_segments(old, old.centre + np.clip(shift, -max_shift, max_shift), half_width, period)
    meeting = distances_to_next(segments, period) <= MIN_DISTANCE_LEFT * distances_to_next(old, period)
    if np.all(meeting):
        return InitialGuess(state.dual, old, state.phi, state.approach)
    if np.any(meeting):
        return remove_or_merge(surface, state, meeting, np.zeros(n, np.bool_))
    count, power = np.diff(old.first_node), 2 if state.dual else 1
    slope = state.sensitivity[:N] - power * state.phi * np.repeat(rate, count)
    phi = (state.phi + slope * change) * np.repeat(growth, count) ** power
    approach = state.approach + state.sensitivity[-1] * change
    tail = coefficient_tails(old, state.coefficient)
    return _adapt_nodes(surface, InitialGuess(state.dual, segments, phi, approach), tail, load, tolerance)


def _adapt_nodes(surface: Surface, guess: InitialGuess, tail: Array, load: float, tolerance: float) -> InitialGuess:
    """The guess with as many nodes as the previous state would have needed, by its tails."""
    old: Segments = guess.segments
    target, count = TARGET_TAIL * tolerance, np.diff(old.first_node)
    new_count = adapt_node_count(count, tail, target, (tail > target) | (tail < MIN_TAIL_RATIO * target))
    if np.array_equal(new_count, count):
        return guess
    series = surface.series(guess.dual)
    new = make_segments(old.crest, old.origin, old.centre, old.half_width, new_count, series.period)
    phi = sample_density(state_of_guess(guess, load), series, new, False)
    return InitialGuess(guess.dual, new, phi, guess.approach)
