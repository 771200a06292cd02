"""Search for the loads at which contacts are born or merge (docs/patches.md, "Births and mergers").

Contacts never split or vanish as the load increases, so that a contact at a heavier load contains two contacts of the
lighter one (a merger) or none (a birth): `_Search._changes`. `_Search.between` divides the interval until the
changes are certain (`_Search._has_no_more_minima`, `_needed_load`) and expected under one load; `_Search._locate`
then finds the root of the minimum of the gap before a birth, or of the pressure after a merger.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.blas import one_thread
from weier.methods.errors import ConvergenceError
from weier.methods.patches import stages
from weier.methods.patches.kind import EPS
from weier.methods.patches.pressure_and_gap import cotangent_integrals, values_at, values_on_segments
from weier.methods.patches.segments import ContactState, contact_extent, contact_pieces
from weier.methods.patches.solver import MIN_LOAD, check_loads, solve_state
from weier.methods.patches.start import TOLERANCE, Starts
from weier.methods.patches.surface import (
    CosineSeries,
    Sides,
    Surface,
    evaluate_at,
    intervals_between,
    nearest_crests,
)
from weier.surface.waves import Waves

# largest advance of an edge, in finest waves: half a wave has one dip of k_1 at most, so that `MIN_LOAD_FRACTION`
# tells of a jump; with 1 the same events are found in fewer loads (docs/patches.md, "Births and mergers")
MAX_ADVANCE = 0.5
# least increment of the load over its trapezoidal rule: half-way between the 2/3 of an edge that has just jumped over
# a contact and the 1 of rates that are linear (docs/patches.md, "Births and mergers")
MIN_LOAD_FRACTION = 5 / 6
# largest interval of ln(p) for root-finding: inverse interpolation through loads decades apart ends 4e-9 from a birth
# on a crest that is lower by a phase of 1e-7 (tests/methods/patches/test_event_search.py)
MAX_ROOT_INTERVAL = 0.1
# difference of expected loads, over the interval, below which events may have one root, as symmetric ones do; events
# farther apart are separated first, which changes no result
SAME_LOAD = 1e-4
# in ln(p): closer events count as one load, and the search for a root ends at a shorter step
MIN_INTERVAL = 1e-9
ROOT_ERROR = 1e-11  # relative difference of two interpolations, of which the better one is right to 1e-12
MAX_ROOT_LOADS = 8  # loads per root search, then the interval is divided; 3 are usual
# divisions for each finished interval, three times those from a decade to `MIN_INTERVAL`, log2(ln(10)/1e-9) = 31
MAX_SPLITS = 100
# samples of the slope of the gap where an edge has advanced or a contact is new, and of the gap or pressure whose
# minimum is located: `ZOOMS` times, each in 2/13 of the last interval, so that a parabola is exact to 1e-12
SAMPLES, ZOOMS = 12, 4


class Events(NamedTuple):
    """Births and merges in order of increasing load, each of shape (events,).

    mean_pressure : load, in p_0*
    birth : whether a contact is born; else two contacts merge
    x : position, in lambda_0, in [0, period)
    patch_count : contacts in one period just above the load; 0 once contact is full
    """

    mean_pressure: Array
    birth: Flags
    x: Array
    patch_count: Indices


class _Event(NamedTuple):
    """A contact that is born, or a gap that closes, in [origin + left, origin + right], in lambda_0.

    An interval over which an edge advances counts as a gap that closes in part.

    load_per_advance : k_1/(2 B) at the left and right edges, of the new contact or of the gap
    """

    birth: bool
    origin: float
    left: float
    right: float
    load_per_advance: tuple[float, float] = (0.0, 0.0)


@one_thread
def events(
    profile: Waves,
    low: float,
    high: float,
    tolerance: float = TOLERANCE,
    report: Callable[[float], object] = lambda share: None,
) -> Events:
    """Return all births and mergers of contacts between two mean pressures.

    Parameters
    ----------
    profile : Profile
        With a finite number of terms.
    low, high : float
        Positive and increasing, in p_0*. Contacts that exist at `low` are not reported; beyond full contact there is
        nothing to report.
    tolerance : float
        As in `curve`.
    report : callable
        Called with the share of the search that is done, by the length that has come into contact.

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
    patch_count = state.segments.centre.size + state.cracks.contact.size
    heaviest = search.state(float(last))
    located = search.between(state, heaviest, report)
    if high >= surface.full_contact_load:
        located += _last_events(surface, heaviest)
    return _sort_events(located, patch_count, surface)


def _last_events(surface: Surface, state: ContactState) -> list[tuple[float, _Event]]:
    """Return the mergers at the load of full contact, where all remaining gaps close."""
    gaps = _intervals(state, True, surface.heights.period)
    return [(surface.full_contact_load, _Event(False, *gap)) for gap in zip(*gaps, strict=True)]


def _sort_events(located: list[tuple[float, _Event]], patch_count: int, surface: Surface) -> Events:
    """Return events in order of load, with the number of contacts after each load."""
    located = sorted(located, key=lambda item: item[0])
    load = np.array([load for load, _ in located])
    birth = np.array([event.birth for _, event in located], bool)
    middle = np.array([event.origin + 0.5 * (event.left + event.right) for _, event in located])
    after = patch_count + np.cumsum(np.where(birth, 1, -1), dtype=np.int64)
    last_of_load = np.searchsorted(load, load * (1 + MIN_INTERVAL), side="right") - 1
    period = surface.heights.period
    return Events(load, birth, middle - period * np.floor(middle / period), after[last_of_load])


class _Search(NamedTuple):
    """Division of the interval until each part contains the events of one load, then root-finding.

    starts : guesses of the contacts under any load of the surface
    """

    starts: Starts

    def state(self, load: float) -> ContactState:
        """Return the state under a load of partial contact."""
        state, _ = solve_state(self.starts, load)
        assert state is not None
        return state

    def between(
        self, lightest: ContactState, heaviest: ContactState, report: Callable[[float], object]
    ) -> list[tuple[float, _Event]]:
        """Return the events between two states, each with its load.

        ConvergenceError is raised after `MAX_SPLITS` splits for each finished interval.
        """
        period = self.starts.surface.heights.period
        start, end = (float(contact_extent(state, period)[2].sum()) for state in (lightest, heaviest))
        located: list[tuple[float, _Event]] = []
        pending, splits, finished = [(lightest, heaviest)], 0, 0
        while pending:
            low, high = pending.pop()
            found, split = self._finish(low, high, *self._changes(low, high))
            if found is not None:
                located += found
                finished += high.load > low.load * (1 + MIN_INTERVAL)
                length = float(contact_extent(high, period)[2].sum())
                report((length - start) / max(end - start, EPS))
                continue
            splits += 1
            if splits > MAX_SPLITS * (1 + finished):
                raise ConvergenceError(
                    f"the changes of contacts between the mean pressures {low.load:.10g} and {high.load:.10g} p_0* "
                    f"remain uncertain after {splits} divisions; take a smaller interval of loads"
                )
            between = self.state(split)
            pending += [(between, high), (low, between)]
        return located

    def _finish(
        self, low: ContactState, high: ContactState, changes: list[_Event], is_certain: bool
    ) -> tuple[list[tuple[float, _Event]] | None, float]:
        """Return the events between two states, None if the interval must be divided, and the load that divides it.

        Events in an interval shorter than `MIN_INTERVAL` are assigned the load of the heavier state. Other intervals
        are finished when certainly no contact has changed, or when all changes have one root.
        """
        width, middle = float(np.log(high.load / low.load)), float(np.sqrt(low.load) * np.sqrt(high.load))
        if width < MIN_INTERVAL:
            return [(high.load, event) for event in changes], middle
        if is_certain and not changes:
            return [], middle
        if not is_certain or width >= MAX_ROOT_INTERVAL:
            return None, middle
        expected = np.sort(np.clip([_expected_load(low, high, change) for change in changes], low.load, high.load))
        widest = int(np.diff(expected, prepend=expected[0]).argmax())
        if expected[widest] - expected[widest - 1] > SAME_LOAD * (high.load - low.load):
            return None, float(0.5 * (expected[widest - 1] + expected[widest]))
        return self._locate(low, high, changes), middle

    def _changes(self, low: ContactState, high: ContactState) -> tuple[list[_Event], bool]:
        """Return contacts of `high` without one of `low`, gaps of `low` closed by it, and whether these are certain.

        A contact of `high` contains those of `low` whose midpoints lie within it.
        """
        period = self.starts.surface.heights.period
        origins, lefts, rights = _intervals(low, False, period)
        finest = 2 * np.pi / self.starts.surface.heights.wavenumber[-1]
        before, after = _loads_per_advance(low, period), _loads_per_advance(high, period)
        changes, advances, expected = [], [], []
        for j, (origin, left, right) in enumerate(zip(*_intervals(high, False, period), strict=True)):
            shift = origins - origin
            middle = shift + 0.5 * (lefts + rights)
            turns = np.ceil((left - middle) / period) * period
            inside = np.flatnonzero(middle + turns < right)
            inside = inside[np.argsort((middle + turns)[inside])]
            if inside.size == 0:
                changes.append(_Event(True, origin, left, right, tuple(after[j])))
                continue
            start = lefts[inside] + (shift + turns)[inside]
            end = rights[inside] + (shift + turns)[inside]
            at_edges = before[inside]
            advances += [_Event(False, origin, left, start[0]), _Event(False, origin, end[-1], right)]
            expected += [at_edges[0, 0] + after[j, 0], at_edges[-1, 1] + after[j, 1]]
            gaps = zip(end[:-1], start[1:], zip(at_edges[:-1, 1], at_edges[1:, 0], strict=True), strict=True)
            changes += [_Event(False, origin, *gap) for gap in gaps]
        length = np.array([advance.right - advance.left for advance in advances])
        is_short, is_direct = length < MAX_ADVANCE * finest, _is_direct(length, np.array(expected), low, high)
        is_certain = bool(np.all(is_short & is_direct)) and self._has_no_more_minima(low, changes + advances)
        return changes, is_certain

    def _has_no_more_minima(self, low: ContactState, changes: list[_Event]) -> bool:
        """Return whether the gap of a state has at most one minimum where a contact is born, and none elsewhere.

        The changes are births, gaps that close, and intervals over which edges advance. If an edge has passed a
        minimum of the gap, a contact was born there before.
        """
        table = [change[:4] for change in changes if change.right > change.left]
        if not table:
            return True
        births, origin, left, right = np.transpose(table)
        minima = _count_gap_minima(low, low.kind.series(self.starts.surface), origin, left, right)
        return bool(np.all(minima <= births))

    def _locate(
        self, low: ContactState, high: ContactState, changes: list[_Event]
    ) -> list[tuple[float, _Event]] | None:
        """Return load and position at which the minimum of the gap (births) or of the pressure (mergers) vanishes.

        Contacts are followed from the load where that minimum is positive, the lighter one for births and the
        heavier one for mergers, to the expected load and on by inverse interpolation. Each state starts from
        contacts interpolated in load. Without result if the changes are of both kinds, have no root or different
        ones, or if edges have jumped: then another event comes first.
        """
        first, surface = changes[0], self.starts.surface
        followed = [low if first.birth else high]
        loads, values = [followed[0].load], [_minimum(followed[0], followed[0].kind.series(surface), first)[1]]
        load, uncertain = _expected_load(low, high, first), np.inf
        while not (uncertain <= load and low.load < load < high.load):
            if not low.load < load < high.load or len(loads) > MAX_ROOT_LOADS:
                return None
            try:
                state = stages.follow_contacts(surface, _interpolate_contacts(followed, load), load)
            except ConvergenceError:
                return None
            followed.append(state)
            loads.append(load)
            values.append(_minimum(state, state.kind.series(surface), first)[1])
            load, difference = _root(loads, values)
            uncertain = min(difference / ROOT_ERROR, abs(load - loads[-1]) / MIN_INTERVAL)
        rate = abs((values[-1] - values[0]) / (loads[-1] - loads[0]))
        located: list[tuple[float, _Event]] = []
        for event in changes:
            y, value = _minimum(followed[-1], followed[-1].kind.series(surface), event)
            is_same = event.birth == first.birth and abs(value - values[-1]) <= rate * MIN_INTERVAL * load
            length, rate_of_load = np.array([y - event.left, event.right - y]), np.array(event.load_per_advance)
            lighter, heavier = (followed[-1], high) if event.birth else (low, followed[-1])
            if not (is_same and np.all(_is_direct(length, rate_of_load, lighter, heavier))):
                return None
            located.append((load, event._replace(left=y, right=y)))
        return located


def _intervals(state: ContactState, gaps: bool, period: float) -> tuple[Array, Array, Array]:
    """Return the contacts of a state, or its gaps: from origin + left to origin + right."""
    contacts = contact_extent(state, period)
    origin, centre, half_width = intervals_between(contacts, period) if gaps else contacts
    return origin, centre - half_width, centre + half_width


def _loads_per_advance(state: ContactState, period: float) -> Sides:
    """Return k_1/(2 B) at the edges of contacts, the derivative of the load with respect to their advance."""
    _, strength, tangent = contact_pieces(state, period)
    return strength / (2 * tangent)


def _is_direct(length: Array, load_per_advance: Array, low: ContactState, high: ContactState) -> Flags:
    """Return whether edges have advanced over these lengths between two states without a jump.

    load_per_advance : the sum of its values at both ends, of which one is 0 at a birth or merger
    """
    return np.asarray(MIN_LOAD_FRACTION * 0.5 * load_per_advance * length < high.load - low.load)


def _expected_load(low: ContactState, high: ContactState, change: _Event) -> float:
    """Return the load of an event if its edges advance at a rate that is linear in their distance from it."""
    passed = 0.125 * sum(change.load_per_advance) * (change.right - change.left)
    return high.load - passed if change.birth else low.load + passed


def _count_gap_minima(state: ContactState, series: CosineSeries, origin: Array, left: Array, right: Array) -> Indices:
    """Return the number of minima of the gap between origin + left and origin + right, shape (intervals,)."""
    angle = (np.arange(SAMPLES) + 0.5) * (np.pi / SAMPLES)
    fraction = 0.5 * (1 - np.cos(angle))  # the samples are closer together at the ends
    y = left[:, None] + (right - left)[:, None] * fraction
    sign = np.sign(_gap_slopes(state, series, np.repeat(origin, SAMPLES), y.ravel())).reshape(y.shape)
    for i in range(1, SAMPLES):
        sign[:, i] = np.where(sign[:, i] == 0, sign[:, i - 1], sign[:, i])
    return np.asarray(np.sum((sign[:, :-1] < 0) & (sign[:, 1:] > 0), axis=1))


def _minimum(state: ContactState, series: CosineSeries, event: _Event) -> tuple[float, float]:
    """Return the minimum between the ends of an event, of the gap before a birth or of the pressure after a merger.

    Its distance from the event's origin and its value, which may be negative.
    """
    left, right = event.left, event.right
    for _ in range(ZOOMS):
        y = np.linspace(left, right, SAMPLES + 2)
        at = _crest_coordinates(series, np.full(SAMPLES, event.origin), y[1:-1])
        value = values_at(state, series, *at, event.birth)
        lowest = 1 + int(np.argmin(value))
        left, right = y[lowest - 1], y[lowest + 1]
    if not 1 < lowest < SAMPLES:
        return float(y[lowest]), float(value[lowest - 1])
    before, here, after = map(float, value[lowest - 2 : lowest + 1])
    slope, curvature = 0.5 * (after - before), max(after - 2 * here + before, EPS * abs(here))
    return float(y[lowest] - slope / curvature * (y[1] - y[0])), here - 0.5 * slope**2 / curvature


def _root(loads: list[float], values: list[float]) -> tuple[float, float]:
    """Return the load at which the values vanish, by inverse interpolation, and how far that without the first is."""
    load, value = np.array(loads), np.array(values)
    with np.errstate(divide="ignore", invalid="ignore"):
        for k in range(1, value.size):
            last, load = load[-1], (value[k:] * load[:-1] - value[:-k] * load[1:]) / (value[k:] - value[:-k])
    return float(load[0]), abs(float(load[0] - last))


def _interpolate_contacts(followed: list[ContactState], load: float) -> ContactState:
    """Return a guess under a load: each centre and half-width on its polynomial in load through all states."""
    loads = np.array([state.load for state in followed])
    weight = [np.prod((load - (others := np.delete(loads, i))) / (p - others)) for i, p in enumerate(loads)]
    nearest = followed[int(np.abs(loads - load).argmin())].segments
    centre = np.tensordot(weight, [state.segments.centre for state in followed], 1)
    half_width = np.tensordot(weight, [state.segments.half_width for state in followed], 1)
    half_width = np.maximum(half_width, 0.5 * nearest.half_width)  # an extrapolation may vanish
    return followed[0]._replace(segments=nearest._replace(centre=centre, half_width=half_width))


def _gap_slopes(state: ContactState, series: CosineSeries, origin: Array, y: Array) -> Array:
    """Return the slope of the gap at points origin + y off the contacts: -(2 pi/L) int p cot(pi (x-s)/L) ds - z'."""
    if state.kind.is_slope:
        return values_on_segments(state.segments.arrays, state.coefficient, series.period, origin, y, False)[1]
    crest, y = _crest_coordinates(series, origin, y)
    segments, origin = state.segments.arrays, series.crest_position[crest]
    integral = cotangent_integrals(segments, state.coefficient, series.period, origin, y)
    return np.asarray(-2 * np.pi / series.period * integral - evaluate_at(series.local, crest, y, 1))


def _crest_coordinates(series: CosineSeries, origin: Array, y: Array) -> tuple[Indices, Array]:
    """Return the crests nearest to origin + y and the distances from them, exact if the origin is the crest."""
    crest, _ = nearest_crests(series, origin + y)
    apart = origin - series.crest_position[crest]
    return crest, apart - series.period * np.rint((apart + y) / series.period) + y
