"""Search for the loads at which contacts are born or merge (docs/patches.md, "Births and mergers").

Contacts never split or vanish as the load increases, so that a contact at a heavier load contains two contacts of the
lighter one (a merger) or none (a birth): `_Search._changes`. `_Search.between` divides the interval until the
edges have certainly advanced without a jump (`_Search._is_direct`) and the changes are expected under one load;
`_Search._locate` then finds the root of the minimum of the gap before a birth, or of the pressure after a merger.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each
from numpy.polynomial import Chebyshev

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.blas import one_thread
from weier.methods.errors import ConvergenceError
from weier.methods.patches import stages
from weier.methods.patches.kind import EPS
from weier.methods.patches.pressure_and_gap import values_at
from weier.methods.patches.segments import ContactState, contact_extent, contact_pieces, segment_strengths
from weier.methods.patches.solver import MIN_LOAD, check_loads, solve_state
from weier.methods.patches.start import TOLERANCE, Starts
from weier.methods.patches.surface import (
    CosineSeries,
    Sides,
    Surface,
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
# in ln(p): closer events count as one load, and the search for a root ends at a shorter step, of which the next one
# would be rounding
MIN_INTERVAL = 1e-9
# divisions for each finished interval, a safeguard: three times those from a decade to `MIN_INTERVAL`,
# log2(ln(10)/1e-9) = 31
MAX_SPLITS = 100
# samples of the gap or pressure whose minimum is located, and then Chebyshev points beside the lowest of these: on
# a whole finest wave they leave an error of pi^16/(2^15 16!) = 1e-10, and beside the lowest 1e-25
SAMPLES = 16


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
        Loads to about 1e-10 of themselves, by root-finding on the load. Events closer than 1e-9 have one load.

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
        if not is_certain:
            return None, middle
        expected = np.sort(np.clip([_expected_load(low, high, change) for change in changes], low.load, high.load))
        widest = int(np.diff(expected, prepend=expected[0]).argmax())
        if expected[widest] - expected[widest - 1] > MIN_INTERVAL * high.load:
            return None, float(0.5 * (expected[widest - 1] + expected[widest]))
        return self._locate(low, high, changes), middle

    def _changes(self, low: ContactState, high: ContactState) -> tuple[list[_Event], bool]:
        """Return contacts of `high` without one of `low`, gaps of `low` closed by it, and whether these are certain.

        A contact of `high` contains those of `low` whose midpoints lie within it.
        """
        period = self.starts.surface.heights.period
        origin, left, right = _intervals(high, False, period)
        within, start, end, order = _sort_into((origin, left, right), _intervals(low, False, period), period)
        before, after = _loads_per_advance(low, period)[order], _loads_per_advance(high, period)
        is_first, is_last = np.diff(within, prepend=-1) > 0, np.diff(within, append=left.size) > 0
        old, new = within[is_first], np.delete(np.arange(left.size), within)
        changes = [_Event(True, origin[j], left[j], right[j], tuple(after[j])) for j in new]
        for i in np.flatnonzero(~is_last):
            at_edges = float(before[i, 1]), float(before[i + 1, 0])
            changes.append(_Event(False, origin[within[i]], end[i], start[i + 1], at_edges))
        # the intervals over which left and right edges of contacts of `low` have advanced
        since, until = np.concatenate([left[old], end[is_last]]), np.concatenate([start[is_first], right[old]])
        expected = np.concatenate([before[is_first, 0] + after[old, 0], before[is_last, 1] + after[old, 1]])
        return changes, bool(np.all(self._is_direct(until - since, expected, low, high)))

    def _is_direct(self, length: Array, load_per_advance: Array, low: ContactState, high: ContactState) -> Flags:
        """Return whether edges have advanced over these lengths between two states without a jump.

        Lengths above `MAX_ADVANCE` of the finest wave are refused, since they may have several dips of k_1.

        load_per_advance : the sum of its values at both ends, of which one is 0 at a birth or merger
        """
        furthest = MAX_ADVANCE * 2 * np.pi / self.starts.surface.heights.wavenumber[-1]
        direct = MIN_LOAD_FRACTION * 0.5 * load_per_advance * length < high.load - low.load
        return np.asarray((length < furthest) & direct)

    def _locate(
        self, low: ContactState, high: ContactState, changes: list[_Event]
    ) -> list[tuple[float, _Event]] | None:
        """Return load and position at which the minimum of the gap (births) or of the pressure (mergers) vanishes.

        Contacts are followed from the load where that minimum is positive, the lighter one for births and the
        heavier one for mergers, to the expected load and on by inverse interpolation. Each state starts from
        contacts interpolated in load. The last step is at most `MIN_INTERVAL`, its error of higher order. Without
        result if the changes are of both kinds, have no root or different ones, if steps do not decrease, or if edges
        have jumped: then another event comes first.
        """
        first, surface = changes[0], self.starts.surface
        state = low if first.birth else high
        followed, minima = [state], [_minimum(state, state.kind.series(surface), first)]
        load, step = _expected_load(low, high, first), np.inf
        while not step <= MIN_INTERVAL * load:
            try:
                state = stages.follow_contacts(surface, _interpolate_contacts(followed, load), load)
            except ConvergenceError:
                return None
            followed.append(state)
            minima.append(_minimum(state, state.kind.series(surface), first))
            load, last = _root([state.load for state in followed], [value for _, value in minima]), step
            step, rounding = abs(load - state.load), MIN_INTERVAL * load
            if not (step < last and low.load - rounding < load < high.load + rounding):
                return None
        final, rise, advance = minima[-1][1], minima[1][1] - minima[0][1], followed[1].load - followed[0].load
        located: list[tuple[float, _Event]] = []
        for event in changes:
            y, value = minima[-1] if event is first else _minimum(state, state.kind.series(surface), event)
            is_same = event.birth == first.birth and abs((value - final) * advance) <= abs(rise) * MIN_INTERVAL * load
            length, rate_of_load = np.array([y - event.left, event.right - y]), np.array(event.load_per_advance)
            lighter, heavier = (state, high) if event.birth else (low, state)
            if not (is_same and np.all(self._is_direct(length, rate_of_load, lighter, heavier))):
                return None
            located.append((min(max(load, low.load), high.load), event._replace(left=y, right=y)))
        return located


def _intervals(state: ContactState, gaps: bool, period: float) -> tuple[Array, Array, Array]:
    """Return the contacts of a state, or its gaps: from origin + left to origin + right."""
    contacts = contact_extent(state, period)
    origin, centre, half_width = intervals_between(contacts, period) if gaps else contacts
    return origin, centre - half_width, centre + half_width


def _sort_into(
    contacts: tuple[Array, Array, Array], smaller: tuple[Array, Array, Array], period: float
) -> tuple[Indices, Array, Array, Indices]:
    """Return the contact around the midpoint of each smaller one, its edges from that one's origin, and its index.

    They are ordered from left to right. As the load rises, contacts grow and gaps shrink, so that none lies outside.
    Midpoints are farther from edges than positions along the period are rounded, or are counted from the same origin.
    """
    (origin, left, _), (start, lefts, rights) = contacts, smaller
    middle, base = 0.5 * (lefts + rights), origin[0] + left[0]
    ahead = np.searchsorted((origin + left - base) % period, (start + middle - base) % period, side="right")
    within, shift = ahead - 1, start - origin[ahead - 1]
    shift += np.ceil((left[within] - shift - middle) / period) * period
    order = np.lexsort((middle + shift, within))
    return within[order], (lefts + shift)[order], (rights + shift)[order], order


def _loads_per_advance(state: ContactState, period: float) -> Sides:
    """Return k_1/(2 B) at the edges of contacts, the derivative of the load with respect to their advance."""
    _, strength, tangent = contact_pieces(state, period)
    return strength / (2 * tangent)


def _expected_load(low: ContactState, high: ContactState, change: _Event) -> float:
    """Return the load of an event if its edges advance at a rate that is linear in their distance from it."""
    passed = 0.125 * sum(change.load_per_advance) * (change.right - change.left)
    return high.load - passed if change.birth else low.load + passed


def _minimum(state: ContactState, series: CosineSeries, event: _Event) -> tuple[float, float]:
    """Return the minimum between the ends of an event, of the gap before a birth or of the pressure after a merger.

    Its distance from the event's origin and its value, which may be negative.
    """
    y = np.linspace(event.left, event.right, SAMPLES + 2)
    lowest = 1 + int(np.argmin(_values(state, series, event, y[1:-1])))
    ends = y[lowest - 1], y[lowest + 1]
    fit = Chebyshev.interpolate(lambda at: _values(state, series, event, at), SAMPLES - 1, ends)
    at = np.append(np.clip(fit.deriv().roots().real, *ends), ends)
    value = fit(at)
    lowest = int(np.argmin(value))
    return float(at[lowest]), float(value[lowest])


def _values(state: ContactState, series: CosineSeries, event: _Event, y: Array) -> Array:
    """Return the gap, for a birth, or the pressure at these distances from an event's origin."""
    at = _crest_coordinates(series, np.full(y.size, event.origin), y)
    return values_at(state, series, *at, event.birth)


def _root(loads: list[float], values: list[float]) -> float:
    """Return the load at which the values vanish, by inverse interpolation."""
    load, value = np.array(loads), np.array(values)
    with np.errstate(divide="ignore", invalid="ignore"):
        for k in range(1, value.size):
            load = (value[k:] * load[:-1] - value[:-k] * load[1:]) / (value[k:] - value[:-k])
    return float(load[0])


def _interpolate_contacts(followed: list[ContactState], load: float) -> ContactState:
    """Return a guess under a load: polynomials in load through all states, with the slope at the first one.

    Half-widths are squared, since their squares are smooth at births and mergers. The density is that of the nearest
    state.
    """
    first = followed[0]
    inward = -1 if first.kind.is_slope else 1  # gaps shrink
    advance = inward * 2 * first.tangent_strength / np.maximum(np.abs(segment_strengths(first)), 1e-300)
    places = [np.stack([state.segments.centre, state.segments.half_width**2]) for state in followed]
    slope = np.stack([0.5 * (advance[:, 1] - advance[:, 0]), first.segments.half_width * advance.sum(axis=1)])
    loads = [first.load] + [state.load for state in followed]
    conditions = np.stack([places[0], slope, *places[1:]])  # scipy takes a derivative at a repeated load
    centre, square = scipy.interpolate.KroghInterpolator(loads, conditions)(load)
    nearest = min(followed[1:] or followed, key=lambda state: abs(state.load - load))
    # an extrapolated width may vanish
    half_width = np.sqrt(np.maximum(square, 0.25 * nearest.segments.half_width**2))
    return nearest._replace(segments=nearest.segments._replace(centre=centre, half_width=half_width))


def _crest_coordinates(series: CosineSeries, origin: Array, y: Array) -> tuple[Indices, Array]:
    """Return the crests nearest to origin + y and the distances from them, exact if the origin is the crest."""
    crest, _ = nearest_crests(series, origin + y)
    apart = origin - series.crest_position[crest]
    return crest, apart - series.period * np.rint((apart + y) / series.period) + y
