"""The loads at which contacts are born or merge, where dh/dp drops or has a kink.

Contacts never split or vanish as the load grows: an increment of load acts on the contact like a flat punch, whose
pressure is nowhere negative. So the contacts under two loads tell what happened in between, unless one was born and
swallowed. Such a contact would leave a minimum of the gap under the lighter load where there is contact under the
heavier: then a load in between is looked at.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.blas import one_thread
from weier.methods.errors import ConvergenceError
from weier.methods.patches import many_contacts
from weier.methods.patches.fields import CAUCHY, density_integrals, residuals_one_by_one, values_on_segments
from weier.methods.patches.inequalities import find_negative_intervals, minima_outside
from weier.methods.patches.newton import on_few_nodes, solve_on_segments
from weier.methods.patches.segments import ContactState, contacts_of
from weier.methods.patches.solver import MIN_LOAD, TOLERANCE, check_loads, solve_state
from weier.methods.patches.start import Starts
from weier.methods.patches.surface import CosineSeries, Surface, evaluate_at, nearest_crests
from weier.theory.waves import Waves

MAX_DECADES = 1.0  # between two loads at first
MAX_ADVANCE = 0.15  # of an edge between two loads, in the finest waves
MAX_ROOT_INTERVAL = 0.1  # of ln(p): in shorter intervals the load of an event is sought by root-finding
# Events of such an interval. Symmetry makes two of one load common; roots that differ only tell where to halve the
# interval, and each takes several solutions where halving takes one.
MAX_ROOTS = 4
MIN_INTERVAL = 1e-9  # of ln(p): events closer than this count as events of one load
LOAD_ACCURACY = 1e-12  # relative
# At the load of an event: of tension over the largest pressure of a contact, and of overlap over the load; a minimum
# that was sought leaves far less.
MAX_VIOLATION = 1e-7
SLOPES = 12  # of the gap, that are looked at where an edge has advanced or a contact is new
SAMPLES = 32  # between which the minimum of the gap or of the pressure is refined
POSITION_ACCURACY = 1e-8  # of a minimum between two samples, over their distance


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
    """A contact born, or else a gap closed or partly so, in [origin + left, origin + right], in lambda_0."""

    birth: bool
    origin: float
    left: float
    right: float


# An event, and the state in which it happens.
_Located = tuple[_Event, ContactState]


@one_thread
def events(profile: Waves, low: float, high: float, tolerance: float = TOLERANCE) -> Events:
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
    if low < MIN_LOAD:
        raise ValueError(f"low must be at least {MIN_LOAD:g} p_0*, got {low:g}")
    check_loads([low, high])
    starts = Starts(profile, tolerance)
    surface = starts.surface
    last = min(high, surface.full_contact_load * (1 - MIN_INTERVAL))
    if low >= last:
        return _sort_events([], 0, surface)
    search = _Search(starts)
    state = search.state(float(low))
    patch_count = state.extent[0].size
    located: list[tuple[float, _Event]] = []
    for load in np.geomspace(low, last, 2 + int(np.log10(last / low) / MAX_DECADES))[1:]:
        heavier = search.state(float(load))
        located += search.between(state, heavier)
        state = heavier
    if high >= surface.full_contact_load:
        located += _last_events(surface, state)
    return _sort_events(located, patch_count, surface)


def _last_events(surface: Surface, state: ContactState) -> list[tuple[float, _Event]]:
    """The merges at the load of full contact: all gaps that are left just below it close."""
    gaps = _intervals(state, not state.dual, surface.heights.period)
    return [(surface.full_contact_load, _Event(False, *gap)) for gap in zip(*gaps, strict=True)]


def _sort_events(located: list[tuple[float, _Event]], patch_count: int, surface: Surface) -> Events:
    """Events in order of load, from the number of contacts before the first; those of one load leave one number."""
    located = sorted(located, key=lambda item: item[0])
    load = np.array([each for each, _ in located])
    birth = np.array([event.birth for _, event in located], bool)
    middle = np.array([event.origin + 0.5 * (event.left + event.right) for _, event in located])
    after = patch_count + np.cumsum(np.where(birth, 1, -1), dtype=np.int64)
    last_of_load = np.searchsorted(load, load * (1 + MIN_INTERVAL), side="right") - 1
    period = surface.heights.period
    return Events(load, birth, middle - period * np.floor(middle / period), after[last_of_load])


class _Search(NamedTuple):
    """Bisection on ln(p) until each interval holds the events of one load, and then root-finding."""

    starts: Starts

    def state(self, load: float) -> ContactState:
        """The state under a load of partial contact."""
        state, _ = solve_state(self.starts, load)
        if state is None:
            raise ConvergenceError(f"contact is full under the mean pressure {load:.6g} p_0*")
        return state

    def between(self, low: ContactState, high: ContactState) -> list[tuple[float, _Event]]:
        """The events between two states, each with its load."""
        width = float(np.log(high.load / low.load))
        changes, is_certain = self._changes(low, high)
        if width < MIN_INTERVAL:
            return [(high.load, event) for event in changes]
        if is_certain and not changes:
            return []
        middle = float(np.sqrt(low.load) * np.sqrt(high.load))
        if is_certain and width < MAX_ROOT_INTERVAL and len(changes) <= MAX_ROOTS:
            located = self._locate_all(low, high, changes)
            loads = sorted(state.load for _, state in located)
            if loads and loads[-1] <= (1 + MIN_INTERVAL) * loads[0]:  # one event, or several by symmetry
                if self._is_in_contact(located[0][1]):
                    return [(state.load, event) for event, state in located]
            elif loads:
                widest = int(np.argmax(np.diff(loads)))
                middle = 0.5 * (loads[widest] + loads[widest + 1])
        between = self.state(middle)
        return self.between(low, between) + self.between(between, high)

    def _changes(self, low: ContactState, high: ContactState) -> tuple[list[_Event], bool]:
        """Contacts of `high` that hold none of `low`, gaps of `low` that it closes, and whether that is all."""
        period = self.starts.surface.heights.period
        origins, lefts, rights = _intervals(low, low.dual, period)
        finest = 2 * np.pi / self.starts.surface.heights.wavenumber[-1]
        changes, advances = [], []
        for origin, left, right in zip(*_intervals(high, high.dual, period), strict=True):
            shift = origins - origin
            middle = shift + 0.5 * (lefts + rights)
            turns = np.ceil((left - middle) / period) * period
            inside = np.flatnonzero(middle + turns < right)
            inside = inside[np.argsort((middle + turns)[inside])]
            if inside.size == 0:
                changes.append(_Event(True, origin, left, right))
                continue
            start = lefts[inside] + (shift + turns)[inside]
            end = rights[inside] + (shift + turns)[inside]
            advances += [_Event(False, origin, left, start[0]), _Event(False, origin, end[-1], right)]
            changes += [_Event(False, origin, a, b) for a, b in zip(end[:-1], start[1:], strict=True)]
        is_certain = all(each.right - each.left < MAX_ADVANCE * finest for each in advances)
        return changes, is_certain and self._has_no_more_minima(low, np.array(changes + advances))

    def _has_no_more_minima(self, low: ContactState, changes: NDArray[np.float64]) -> bool:
        """Whether the gap of a state has at most one minimum where a contact is born, and none elsewhere.

        The changes, a table with the fields of `_Event`, are births, gaps that close, and what edges advance over. An
        edge that advances over a minimum does so with the help of a contact born there.
        """
        births, origin, left, right = changes[changes[:, 3] > changes[:, 2]].T
        if births.size == 0:
            return True
        minima = _minima_of_gap(low, self.starts.surface.series(low.dual), origin, left, right)
        return bool(np.all(minima <= births))

    def _locate_all(self, low: ContactState, high: ContactState, changes: list[_Event]) -> list[_Located]:
        """All changes, each as if it were alone; empty if one cannot be found."""
        try:
            return [self._locate(low, high, event) for event in changes]
        except (ValueError, ConvergenceError):  # no root between the ends, or the contacts could not be followed
            return []

    def _locate(self, low: ContactState, high: ContactState, event: _Event) -> _Located:
        """Where and in which state the gap before a birth, or the pressure after a merge, first touches 0.

        The contacts are followed from the side on which that quantity is positive to the other.
        """
        followed: list[_Located] = [(event, low if event.birth else high)]

        def nearest(load: float) -> _Located:
            return min(followed, key=lambda located: abs(located[1].load - load))

        def minimum(load: float) -> float:
            state = self._follow(nearest(load)[1], load)
            y, value = _minimum(state, self.starts.surface.series(state.dual), event)
            followed.insert(0, (event._replace(left=y, right=y), state))
            return value

        accuracy = {"xtol": LOAD_ACCURACY * low.load, "rtol": LOAD_ACCURACY}
        return nearest(scipy.optimize.brentq(minimum, low.load, high.load, **accuracy))

    def _is_in_contact(self, state: ContactState) -> bool:
        """Whether the contacts that led to an event meet the conditions of contact at its load.

        An edge may have gone on over a crest that touches by then, so that there is tension behind it.
        """
        minima = minima_outside(state, self.starts.surface.series(state.dual), 0.0)
        overlap = -float(minima["value"].min(initial=0.0))
        limit = MAX_VIOLATION * state.load * (1.0 if state.dual else self.starts.surface.heights.period)
        return overlap <= limit and bool(np.all(find_negative_intervals(state)["share"] >= -MAX_VIOLATION))

    def _follow(self, start: ContactState, load: float) -> ContactState:
        """The contacts of `start` under another load, as if none were born or merged in between."""
        if load == start.load:
            return start
        if start.segments.centre.size >= many_contacts.MIN_CONTACTS:
            return many_contacts.follow_contacts(self.starts.surface, start, load)
        few = on_few_nodes(start, self.starts.surface.series(start.dual))._replace(load=load)
        return solve_on_segments(self.starts.surface, few, self.starts.tolerance)[0]


def _intervals(state: ContactState, between: bool, period: float) -> tuple[Array, Array, Array]:
    """The pieces of segments of a state, or what lies between them: from origin + left to origin + right."""
    origin, centre, half_width = contacts_of(state.extent, between, period)
    return origin, centre - half_width, centre + half_width


def _minima_of_gap(state: ContactState, series: CosineSeries, origin: Array, left: Array, right: Array) -> Indices:
    """How many minima the slopes of the gap show from origin + left to origin + right, each of shape (intervals,)."""
    share = 0.5 * (1 - np.cos((np.arange(SLOPES) + 0.5) * (np.pi / SLOPES)))  # closer at the ends
    y = left[:, None] + (right - left)[:, None] * share
    sign = np.sign(_gap_slopes(state, series, np.repeat(origin, SLOPES), y.ravel())).reshape(y.shape)
    for i in range(1, SLOPES):
        sign[:, i] = np.where(sign[:, i] == 0, sign[:, i - 1], sign[:, i])
    return np.asarray(np.sum((sign[:, :-1] < 0) & (sign[:, 1:] > 0), axis=1))


def _minimum(state: ContactState, series: CosineSeries, event: _Event) -> tuple[float, float]:
    """Distance from the origin and value of the minimum of the gap, or of the pressure, which may be negative."""
    y = np.linspace(event.left, event.right, SAMPLES + 2)[1:-1]
    lowest = int(np.argmin(_gaps_or_pressures(state, series, event.birth, event.origin, y)))
    step = y[1] - y[0]
    minimum = scipy.optimize.minimize_scalar(
        lambda position: _gaps_or_pressures(state, series, event.birth, event.origin, np.full(1, position))[0],
        bounds=(y[lowest] - step, y[lowest] + step),
        method="bounded",
        options={"xatol": POSITION_ACCURACY * step},
    )
    return float(minimum.x), float(minimum.fun)


def _gaps_or_pressures(state: ContactState, series: CosineSeries, of_gaps: bool, origin: float, y: Array) -> Array:
    """Gaps, at points origin + y off the contacts, or pressures, at points on them; any may be negative."""
    at = np.full(y.size, origin)
    if of_gaps != state.dual:
        return residuals_one_by_one(state, series, *_crest_coordinates(series, at, y))
    return values_on_segments(state, series.period, at, y, state.dual)[1]


def _gap_slopes(state: ContactState, series: CosineSeries, origin: Array, y: Array) -> Array:
    """The slope of the gap at points origin + y off the contacts."""
    if state.dual:
        return values_on_segments(state, series.period, origin, y, False)[1]
    crest, y = _crest_coordinates(series, origin, y)
    integral = density_integrals(state, series.period, series.crest_position[crest], y, CAUCHY)
    return np.asarray(-2 * np.pi / series.period * integral - evaluate_at(series, crest, y, 1))


def _crest_coordinates(series: CosineSeries, origin: Array, y: Array) -> tuple[Indices, Array]:
    """The crests nearest to origin + y, and the distances from them: all digits of y, if the origin is the crest."""
    crest, _ = nearest_crests(series, origin + y)
    apart = origin - series.crest_position[crest]
    return crest, apart - series.period * np.rint((apart + y) / series.period) + y
