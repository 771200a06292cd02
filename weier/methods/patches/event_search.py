"""The loads at which contacts are born or merge, where dh/dp has its kinks.

Contacts never split or vanish as the load grows: an increment of load acts on the contact like a flat punch, whose
pressure is nowhere negative. So the events between two loads follow from their contacts alone.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.blas import one_thread
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.active_set import solve_on_segments
from weier.methods.patches.continuation import first_state, next_state, predict
from weier.methods.patches.fields import ContactState, complementary_residual, density, gap_from_slope
from weier.methods.patches.newton import NewtonStatus
from weier.methods.patches.segments import distances_to_next
from weier.methods.patches.solver import TOLERANCE, check_loads, check_tolerance, make_solution
from weier.methods.patches.surface import CosineSeries, Surface, nearest_crest, surface_of
from weier.theory.profile import Profile

STEPS_PER_DECADE = 16
MAX_ROOT_INTERVAL = 0.02  # of ln(p): in shorter intervals the load of an event is sought by root-finding
MIN_INTERVAL = 1e-9  # of ln(p): events closer than this count as events of one load
LOAD_ACCURACY = 1e-13  # relative
SAMPLES = 32  # between which the minimum of the gap or of the pressure is refined
POSITION_ACCURACY = 1e-8  # of a minimum between two samples, over their distance
MAX_PREDICTION_ERROR = 0.3  # of ln(half-width): if the prediction is further off, something happened in between


class Events(NamedTuple):
    """Births and merges in order of increasing load, each of shape (events,).

    mean_pressure : load, in p_0*
    birth : whether a contact is born; else two contacts merge
    x : where, in lambda_0, in [0, period)
    patch_count : contacts in one period just above the load; 0 once contact is full
    """

    mean_pressure: Array
    birth: Flags
    x: Array
    patch_count: Indices


class _Event(NamedTuple):
    """A contact born, or else a gap closed, somewhere in [left, right], in lambda_0."""

    birth: bool
    left: float
    right: float


@one_thread
def events(profile: Profile, low: float, high: float, tolerance: float = TOLERANCE) -> Events:
    """All births and merges of contacts between two mean pressures.

    Parameters
    ----------
    profile : Profile
        With a finite number of terms.
    low, high : float
        Positive and increasing, in p_0*. Contacts that exist at `low` are not reported; beyond full contact there is
        nothing to report.
    tolerance : float
        As in `curve`.

    Returns
    -------
    Events
        Loads to about 1e-10 of themselves, by root-finding on the load.

    Raises
    ------
    ValueError
        If the loads are not positive and increasing, or the waves too many.
    ConvergenceError
        If a load in between cannot be solved.

    """
    check_loads([low, high])
    check_tolerance(tolerance)
    surface = surface_of(profile)
    last = min(high, surface.full_contact_load * (1 - MIN_INTERVAL))
    if low >= last:
        return _sort_events([], 0, surface)
    count = 2 + int(np.ceil(STEPS_PER_DECADE * np.log10(last / low)))
    search = _Search(profile, surface, tolerance)
    state, _ = first_state(profile, surface, low, tolerance)
    patch_count = state.segments.centre.size
    located: list[tuple[float, _Event]] = []
    for load in np.geomspace(low, last, count)[1:]:
        heavier, _ = next_state(profile, surface, state, float(load), tolerance)
        located += search.between(state, heavier)
        state = heavier
    if high >= surface.full_contact_load:
        located += _last_events(surface, state)
    return _sort_events(located, patch_count, surface)


def _last_events(surface: Surface, state: ContactState) -> list[tuple[float, _Event]]:
    """The merges at the load of full contact: all gaps that are left just below it close."""
    edges, period = make_solution(surface, state, state.load).edges, surface.heights.period
    located = []
    for left, right in zip(edges[:, 1], np.roll(edges[:, 0], -1), strict=True):
        located.append((surface.full_contact_load, _Event(False, left, left + (right - left) % period)))
    return located


def _sort_events(located: list[tuple[float, _Event]], patch_count: int, surface: Surface) -> Events:
    """Events in order of load, from the number of contacts before the first."""
    located = sorted(located, key=lambda item: item[0])
    birth = np.array([event.birth for _, event in located], bool)
    middle = np.array([0.5 * (event.left + event.right) for _, event in located])
    change = np.where(birth, 1, -1)
    return Events(
        np.array([load for load, _ in located]),
        birth,
        middle - surface.heights.period * np.floor(middle / surface.heights.period),
        patch_count + np.cumsum(change, dtype=np.int64),
    )


class _Search(NamedTuple):
    """Bisection on ln(p) until each interval holds the events of one load, and then root-finding."""

    profile: Profile
    surface: Surface
    tolerance: float

    def between(self, low: ContactState, high: ContactState) -> list[tuple[float, _Event]]:
        """The events between two states, each with its load."""
        width = float(np.log(high.load / low.load))
        changes = _changes(self.surface, low, high)
        if not changes and (width < MAX_ROOT_INTERVAL or self._is_predicted(low, high)):
            return []
        if width < MIN_INTERVAL:
            return [(high.load, event) for event in changes]
        if width < MAX_ROOT_INTERVAL:
            located = self._locate_all(low, high, changes)
            loads = [load for load, _ in located]
            if located and max(loads) <= (1 + MIN_INTERVAL) * min(loads):  # one event, or several by symmetry
                return located
        middle_load = float(np.sqrt(low.load) * np.sqrt(high.load))
        middle, _ = next_state(self.profile, self.surface, low, middle_load, self.tolerance)
        return self.between(low, middle) + self.between(middle, high)

    def _is_predicted(self, low: ContactState, high: ContactState) -> bool:
        """Whether the tangent at `low` leads near `high`; if not, two events may have cancelled in between."""
        guess = predict(self.surface, low, high.load, self.tolerance)
        period = self.surface.heights.period
        expected, actual = (
            0.5 * distances_to_next(segments, period) if dual else segments.half_width
            for dual, segments in ((guess.dual, guess.segments), (high.dual, high.segments))
        )
        if expected.size != actual.size:
            return False
        return not bool(np.abs(np.log(np.sort(actual) / np.sort(expected))).max() > MAX_PREDICTION_ERROR)

    def _locate_all(self, low: ContactState, high: ContactState, changes: list[_Event]) -> list[tuple[float, _Event]]:
        """Load and position of each event; none if other events are so near that contacts cannot be followed."""
        try:
            return [self._locate(low, high, event) for event in changes]
        except (ConvergenceError, ValueError):
            return []

    def _locate(self, low: ContactState, high: ContactState, event: _Event) -> tuple[float, _Event]:
        """Load and position at which the gap before a birth, or the pressure after a merge, first touches 0.

        The contacts are followed from the side on which that quantity is positive to the other.
        """
        start = low if event.birth else high

        def minimum(load: float) -> tuple[float, float]:
            state = self._follow(start, load)
            return _minimum(state, self.surface.series(state.dual), event.birth, event.left, event.right)

        def minimum_value(load: float) -> float:
            return minimum(load)[1]

        accuracy = {"xtol": LOAD_ACCURACY * low.load, "rtol": LOAD_ACCURACY}
        load = float(scipy.optimize.brentq(minimum_value, low.load, high.load, **accuracy))
        x, _ = minimum(load)
        return load, _Event(event.birth, x, x)

    def _follow(self, start: ContactState, load: float) -> ContactState:
        """The contacts of `start` under another load, as if none were born or merged in between."""
        guess = predict(self.surface, start, load, self.tolerance)
        state, result = solve_on_segments(self.surface, guess, load, self.tolerance)
        if result.status != NewtonStatus.converged or state.segments.centre.size != start.segments.centre.size:
            raise ConvergenceError(
                f"the contacts under {start.load:.6g} p_0* cannot be followed to {load:.6g} p_0*", result.step_size
            )
        return state


def _changes(surface: Surface, low: ContactState, high: ContactState) -> list[_Event]:
    """Contacts of `high` that hold none of `low`, and gaps of `low` within a contact of `high`."""
    before, after = (make_solution(surface, state, state.load) for state in (low, high))
    period, changes = surface.heights.period, []
    for left, right in after.edges:
        order = np.argsort((before.centre - left) % period)
        inside = order[(before.centre[order] - left) % period < right - left]
        if inside.size == 0:
            changes.append(_Event(True, left, right))
        for i, j in pairwise(inside):
            end = before.centre[i] + before.half_width[i]
            width = (before.centre[j] - before.half_width[j] - end) % period
            changes.append(_Event(False, end, end + width))
    return changes


def _minimum(
    state: ContactState, series: CosineSeries, of_gap: bool, left: float, right: float
) -> tuple[float, float]:
    """Position and value of the minimum of the gap or of the pressure in [left, right], which may be negative."""
    x = np.linspace(left, right, SAMPLES + 2)[1:-1]
    lowest = int(np.argmin([_gap_or_pressure(state, series, of_gap, each) for each in x]))
    step = x[1] - x[0]
    minimum = scipy.optimize.minimize_scalar(
        lambda position: _gap_or_pressure(state, series, of_gap, position),
        bounds=(x[lowest] - step, x[lowest] + step),
        method="bounded",
        options={"xatol": POSITION_ACCURACY * step},
    )
    return float(minimum.x), float(minimum.fun)


@kernel
def _gap_or_pressure(state: ContactState, series: CosineSeries, of_gap: bool, x: float) -> float:
    """The gap, for x off the contacts, or the pressure, for x on them; either may be negative."""
    crest, y = nearest_crest(series, x)
    if of_gap != state.dual:
        return complementary_residual(state, series, crest, y)
    if of_gap:
        return gap_from_slope(state, series.period, series.crest_position[crest], y)
    return density(state, series.period, series.crest_position[crest], y)
