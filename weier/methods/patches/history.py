"""The loads at which contacts are born or merge: there dh/dp has its kinks.

The contact only grows with the load (the incremental problem is a flat punch on the contact, whose pressure is
nowhere negative), so contacts are born, grow and merge, and never split or vanish.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are used: a tenth of a second each, that few jobs need
from numpy.typing import NDArray

from weier.kernels.blas import one_thread
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.curve import TOLERANCE, check_tolerance, loads_within_reach
from weier.methods.patches.fields import State, clearance, density, opening
from weier.methods.patches.march import first, following, predicted
from weier.methods.patches.newton import Status
from weier.methods.patches.segments import spaces
from weier.methods.patches.settle import newton_from
from weier.methods.patches.solution import solution
from weier.methods.patches.surface import Surface, surface_of
from weier.methods.patches.waves import Waves, from_summit
from weier.theory.profile import Profile

Array = NDArray[np.float64]

STEPS_PER_DECADE = 16
NARROW = 0.02  # of ln(p): within it events of one load are looked for by secants
NARROWEST = 1e-9  # of ln(p): events closer than this are of one load
ACCURACY = 1e-13  # of the load
SAMPLES = 32  # between which the least gap or pressure is refined
PLACE = 1e-8  # of a minimum between two samples, over their distance
JUMP = 0.3  # of ln(half-width), from prediction to solution: something happened in between


class Events(NamedTuple):
    """Births and merges in rising order of load, each of shape (events,).

    mean_pressure : load, in p_0*
    birth : whether a contact is born; else two contacts merge
    x : where, in lambda_0, in [0, period)
    patch_count : contacts in one period just above the load; 0 once contact is full
    """

    mean_pressure: Array
    birth: NDArray[np.bool_]
    x: Array
    patch_count: NDArray[np.int64]


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
        Positive, in p_0*. What is in contact at `low` already is not reported; beyond full contact nothing is.
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
        If a load on the way cannot be solved.

    """
    loads_within_reach([low, high])
    check_tolerance(tolerance)
    seen = surface_of(profile)
    reach = min(high, seen.full_load * (1 - NARROWEST))
    if low >= reach:
        return _gathered([], 0, seen)
    count = 2 + int(np.ceil(STEPS_PER_DECADE * np.log10(reach / low)))
    search = _Search(profile, seen, tolerance)
    state, _ = first(profile, seen, low, tolerance)
    patches = state.segments.centre.size
    found: list[tuple[float, _Event]] = []
    for load in np.geomspace(low, reach, count)[1:]:
        after, _ = following(profile, seen, state, float(load), tolerance)
        found += search.between(state, after)
        state = after
    if high >= seen.full_load:
        gaps = solution(seen, state, reach).edges
        for left, right in zip(gaps[:, 1], np.roll(gaps[:, 0], -1), strict=True):
            found.append((seen.full_load, _Event(False, left, left + (right - left) % seen.heights.period)))
    return _gathered(found, patches, seen)


def _gathered(found: list[tuple[float, _Event]], patches: int, seen: Surface) -> Events:
    found = sorted(found, key=lambda item: item[0])
    birth = np.array([event.birth for _, event in found], bool)
    middle = np.array([0.5 * (event.left + event.right) for _, event in found])
    change = np.where(birth, 1, -1)
    return Events(
        np.array([load for load, _ in found]),
        birth,
        middle - seen.heights.period * np.floor(middle / seen.heights.period),
        patches + np.cumsum(change, dtype=np.int64),
    )


class _Search(NamedTuple):
    """Bisection on ln(p) until events stand alone, then root-finding."""

    profile: Profile
    seen: Surface
    tolerance: float

    def between(self, low: State, high: State) -> list[tuple[float, _Event]]:
        """Events between two solutions, each with its load."""
        width = float(np.log(high.load / low.load))
        happened = _differences(self.seen, low, high)
        if not happened and (width < NARROW or not self._jumps(low, high)):
            return []
        if width < NARROWEST:
            return [(high.load, event) for event in happened]
        if width < NARROW:
            try:
                found = [self._located(low, high, event) for event in happened]
            except (ConvergenceError, ValueError):
                found = []  # other events are too near for the contacts of one side to be followed to the other
            loads = [load for load, _ in found]
            if found and max(loads) <= (1 + NARROWEST) * min(loads):  # one, or several of one load by symmetry
                return found
        middle, _ = following(
            self.profile, self.seen, low, float(np.sqrt(low.load) * np.sqrt(high.load)), self.tolerance
        )
        return self.between(low, middle) + self.between(middle, high)

    def _jumps(self, low: State, high: State) -> bool:
        guess = predicted(self.seen, low, high.load, self.tolerance)
        period = self.seen.heights.period
        expected, reached = (
            0.5 * spaces(s, period) if dual else s.half_width
            for dual, s in ((guess.dual, guess.segments), (high.dual, high.segments))
        )
        if expected.size != reached.size:
            return True
        return bool(np.abs(np.log(np.sort(reached) / np.sort(expected))).max() > JUMP)

    def _located(self, low: State, high: State, event: _Event) -> tuple[float, _Event]:
        """The load and the place at which the gap before a birth, or the pressure after a merge, touches 0.

        From the side on which it is positive, the contacts are followed to the other.
        """
        start = low if event.birth else high

        def least(load: float) -> tuple[float, float]:
            state = self._followed(start, load)
            return _least(state, self.seen.of(state.dual), event.birth, event.left, event.right)

        def least_value(load: float) -> float:
            return least(load)[1]

        accuracy = {"xtol": ACCURACY * low.load, "rtol": ACCURACY}
        load = float(scipy.optimize.brentq(least_value, low.load, high.load, **accuracy))
        place, _ = least(load)
        return load, _Event(event.birth, place, place)

    def _followed(self, start: State, load: float) -> State:
        """The contacts of `start` under another load, whether or not there are others by then.

        Raises
        ------
        ConvergenceError
            If these are not contacts there any more.
        """
        guess = predicted(self.seen, start, load, self.tolerance)
        state, found = newton_from(self.seen, guess, load, self.tolerance)
        if found.status != Status.converged or state.segments.centre.size != start.segments.centre.size:
            raise ConvergenceError("the contacts change on the way", found.size)
        return state


def _differences(seen: Surface, low: State, high: State) -> list[_Event]:
    """Contacts of `high` that hold none of `low`, and gaps of `low` within a contact of `high`."""
    before, after = (solution(seen, state, state.load) for state in (low, high))
    period, found = seen.heights.period, []
    for left, right in after.edges:
        order = np.argsort((before.centre - left) % period)
        inside = order[(before.centre[order] - left) % period < right - left]
        if inside.size == 0:
            found.append(_Event(True, left, right))
        for i, j in pairwise(inside):
            end = before.centre[i] + before.half_width[i]
            width = (before.centre[j] - before.half_width[j] - end) % period
            found.append(_Event(False, end, end + width))
    return found


def _least(state: State, waves: Waves, of_gap: bool, left: float, right: float) -> tuple[float, float]:
    """Place and value of the least gap or pressure in [left, right], not cut off at 0."""
    x = np.linspace(left, right, SAMPLES + 2)[1:-1]
    low = int(np.argmin([_signed(state, waves, of_gap, place) for place in x]))
    step = x[1] - x[0]
    found = scipy.optimize.minimize_scalar(
        lambda place: _signed(state, waves, of_gap, place),
        bounds=(x[low] - step, x[low] + step),
        method="bounded",
        options={"xatol": PLACE * step},
    )
    return float(found.x), float(found.fun)


@kernel
def _signed(state: State, waves: Waves, of_gap: bool, x: float) -> float:
    """The gap before a birth, which lies off the contacts, or the pressure after a merge, on them; either sign."""
    summit, y = from_summit(waves, x)
    if of_gap != state.dual:
        return clearance(state, waves, summit, y)
    if of_gap:
        return opening(state, waves.period, waves.place[summit], y)
    return density(state, waves.period, waves.place[summit], y)
