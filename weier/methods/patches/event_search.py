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
import scipy  # its modules are imported on first use, a tenth of a second each

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.blas import one_thread
from weier.methods.errors import ConvergenceError
from weier.methods.patches import stages
from weier.methods.patches.fields import density_integrals, residuals_one_by_one, values_on_segments
from weier.methods.patches.inequalities import find_negative_intervals, minima_outside
from weier.methods.patches.kind import EPS
from weier.methods.patches.segments import ContactState, contact_pieces
from weier.methods.patches.solver import MIN_LOAD, check_loads, curve, solve_state
from weier.methods.patches.stages import TARGET
from weier.methods.patches.start import TOLERANCE, Starts
from weier.methods.patches.surface import (
    CosineSeries,
    Sides,
    Surface,
    evaluate_at,
    intervals_between,
    nearest_crests,
    surface_of,
)
from weier.surface.waves import Waves

# largest advance of an edge, in finest waves: beyond it, the edge may have passed a minimum and a maximum of the gap
# between two of the `SAMPLES` samples of the slope
MAX_ADVANCE = 0.15
# least increment of the load over its trapezoidal rule (`_needed_load`): above the 2/3 of an edge that has just
# jumped over a contact, and below the 1 of rates that are linear (docs/patches.md, "Births and mergers")
MIN_SHARE_OF_LOAD = 0.7
# largest interval of ln(p) for root-finding: over longer ones it may not be possible to follow the contacts
MAX_ROOT_INTERVAL = 0.1
# difference of expected loads, over the interval, below which events may have one root, as symmetric ones do; events
# farther apart are separated first, which changes no result
SAME_LOAD = 1e-4
MIN_INTERVAL = 1e-9  # in ln(p); closer events count as one load
# largest tension over the largest pressure of a contact, and overlap over the load, at an event: the located minimum
# leaves far less, and an edge that has passed a crest far more
MAX_VIOLATION = 1e-7
# divisions per event of intervals over which no edge advances farther than `MAX_ADVANCE`, three times those from a
# decade to `MIN_INTERVAL`, log2(ln(10)/1e-9) = 31
MAX_SPLITS = 100
# loads solved up to full contact, for each of the finest waves and for each crest of height or tension: 1.0 to 1.1 of
# those of seven surfaces of 5 to 40 waves, up to 2.4 of those of symmetric ones
LOADS_PER_WAVE, LOADS_PER_CREST = 5, 5
# samples of the slope of the gap where an edge has advanced or a contact is new, and of the gap or pressure whose
# minimum is located
SAMPLES = 12


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
    """A contact that is born, or a gap that closes, in [origin + left, origin + right], in lambda_0.

    An interval over which an edge advances counts as a gap that closes in part.

    load_per_advance : k_1/(2 B) at the left and right edges, of the new contact or of the gap
    """

    birth: bool
    origin: float
    left: float
    right: float
    load_per_advance: tuple[float, float] = (0.0, 0.0)


_Located = tuple[_Event, ContactState]  # an event, and the state under its load


def expected_loads(profile: Waves, low: float, high: float) -> int:
    """Return the expected number of loads to solve for the events between two mean pressures.

    It is proportional to the length that comes into contact.
    """
    surface = surface_of(profile)
    light, heavy = curve(profile, [max(low, MIN_LOAD), high]).values()["contact_fraction"]
    crests = surface.heights.crest_position.size + surface.tensions.crest_position.size
    return int((heavy - light) * (LOADS_PER_WAVE * profile.waves_per_period[-1] + LOADS_PER_CREST * crests))


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
        if state is None:
            raise ConvergenceError(f"contact is full under the mean pressure {load:.6g} p_0*")
        return state

    def between(
        self, lightest: ContactState, heaviest: ContactState, report: Callable[[float], object]
    ) -> list[tuple[float, _Event]]:
        """Return the events between two states, each with its load.

        Intervals over which edges advance too far are divided as often as the waves that they pass require.
        ConvergenceError is raised if others remain uncertain after `MAX_SPLITS` splits per event.
        """
        period = self.starts.surface.heights.period
        start, end = (float(contact_pieces(state, period)[0][2].sum()) for state in (lightest, heaviest))
        located: list[tuple[float, _Event]] = []
        pending, splits = [(lightest, heaviest)], 0
        while pending:
            low, high = pending.pop()
            changes, is_certain, is_long = self._changes(low, high)
            found, split = self._finish(low, high, changes, is_certain)
            if found is not None:
                located += found
                length = float(contact_pieces(high, period)[0][2].sum())
                report((length - start) / max(end - start, EPS))
                continue
            splits += not is_long
            if splits > MAX_SPLITS * (1 + len(located)):
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
        are finished when certainly no contact has changed, or when all changes have one root and the contacts there
        satisfy the inequalities.
        """
        width, middle = float(np.log(high.load / low.load)), float(np.sqrt(low.load) * np.sqrt(high.load))
        if width < MIN_INTERVAL:
            return [(high.load, event) for event in changes], middle
        if is_certain and not changes:
            return [], middle
        if not is_certain or width >= MAX_ROOT_INTERVAL:
            return None, middle
        expected = np.sort([_expected_load(low, high, change) for change in changes])
        apart, margin = np.diff(expected, prepend=expected[0]), 0.1 * (high.load - low.load)
        widest = int(apart.argmax())
        if apart[widest] > SAME_LOAD * (high.load - low.load):
            split = 0.5 * (expected[widest - 1] + expected[widest])
            return None, float(np.clip(split, low.load + margin, high.load - margin))
        located = self._locate(low, high, changes)
        is_direct = all(_is_direct(low, high, *pair) for pair in zip(changes, located, strict=False))
        if located and is_direct and self._is_in_contact(located[0][1]):
            return [(state.load, event) for event, state in located], middle
        return None, middle

    def _changes(self, low: ContactState, high: ContactState) -> tuple[list[_Event], bool, bool]:
        """Return contacts of `high` without one of `low` and gaps of `low` closed by it.

        Also return whether these are certain, and whether an edge has advanced too far for that.
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
        is_direct = _needed_load(length, np.array(expected)) < high.load - low.load
        is_long = bool(np.any(length >= MAX_ADVANCE * finest))
        is_certain = not is_long and bool(np.all(is_direct))
        return changes, is_certain and self._has_no_more_minima(low, changes + advances), is_long

    def _has_no_more_minima(self, low: ContactState, changes: list[_Event]) -> bool:
        """Return whether the gap of a state has at most one minimum where a contact is born, and none elsewhere.

        The changes are births, gaps that close, and intervals over which edges advance. If an edge has passed a
        minimum of the gap, a contact was born there before.
        """
        table = [change[:4] for change in changes if change.right > change.left]
        if not table:
            return True
        births, origin, left, right = np.transpose(table)
        minima = _minima_of_gap(low, self.starts.surface.series(low.dual), origin, left, right)
        return bool(np.all(minima <= births))

    def _locate(self, low: ContactState, high: ContactState, changes: list[_Event]) -> list[_Located]:
        """Return position and state at which the minimum of the gap (births) or of the pressure (mergers) vanishes.

        Contacts are followed from the load where that minimum is positive, the lighter one for births and the
        heavier one for mergers, to the other, where it is negative. Each state starts from the nearest one in load.
        Without result if the changes are of both kinds, have no root, or have different ones.
        """
        first, surface = changes[0], self.starts.surface
        start = low if first.birth else high
        followed, values = [start], dict[float, float]()

        def nearest(load: float) -> ContactState:
            return min(followed, key=lambda state: abs(state.load - load))

        def minimum(state: ContactState, event: _Event) -> tuple[float, float]:
            return _minimum(state, surface.series(state.dual), event)

        def first_minimum(load: float) -> float:
            followed.insert(0, self._follow(nearest(load), load))
            values[load] = minimum(followed[0], first)[1]
            return values[load]

        relative = TARGET * TOLERANCE  # of the residual
        accuracy = {"xtol": relative * low.load, "rtol": relative}
        try:
            root = nearest(scipy.optimize.brentq(first_minimum, low.load, high.load, **accuracy))
        except (ValueError, ConvergenceError):  # no root between the ends, or the contacts could not be followed
            return []
        rate = abs(values[high.load] - values[low.load]) / (high.load - low.load)
        located: list[_Located] = []
        for event in changes:
            y, value = minimum(root, event)
            if event.birth != first.birth or not abs(value) <= rate * MIN_INTERVAL * root.load:
                return []
            located.append((event._replace(left=y, right=y), root))
        return located

    def _is_in_contact(self, state: ContactState) -> bool:
        """Return whether the contacts followed to an event satisfy the inequalities at its load.

        They do not if another event comes first: an edge may have passed a crest that touches earlier, which leaves
        tension behind it.
        """
        minima = minima_outside(state, self.starts.surface.series(state.dual), 0.0)
        overlap = -float(minima["value"].min(initial=0.0))
        height = MAX_VIOLATION * state.load * self.starts.surface.heights.period
        limit = state.kind.limit_outside(state.load, height, MAX_VIOLATION)
        return overlap <= limit and bool(np.all(find_negative_intervals(state)["relative"] >= -MAX_VIOLATION))

    def _follow(self, start: ContactState, load: float) -> ContactState:
        """Follow the contacts of `start` to another load, without births and mergers."""
        return start if load == start.load else stages.follow_contacts(self.starts.surface, start, load)


def _intervals(state: ContactState, gaps: bool, period: float) -> tuple[Array, Array, Array]:
    """Return the contacts of a state, or its gaps: from origin + left to origin + right."""
    contacts = contact_pieces(state, period)[0]
    origin, centre, half_width = intervals_between(contacts, period) if gaps else contacts
    return origin, centre - half_width, centre + half_width


def _loads_per_advance(state: ContactState, period: float) -> Sides:
    """Return k_1/(2 B) at the edges of contacts, the derivative of the load with respect to their advance."""
    _, strength, tangent = contact_pieces(state, period)
    return strength / (2 * tangent)


def _needed_load(length: Array, load_per_advance: Array) -> Array:
    """Return the least increment of the load by which edges advance over these lengths without a jump.

    load_per_advance : the sum of its values at both ends, of which one is 0 at a birth or merger
    """
    return MIN_SHARE_OF_LOAD * 0.5 * load_per_advance * length


def _expected_load(low: ContactState, high: ContactState, change: _Event) -> float:
    """Return the load of an event if its edges advance at a rate that is linear in their distance from it."""
    passed = 0.125 * sum(change.load_per_advance) * (change.right - change.left)
    return high.load - passed if change.birth else low.load + passed


def _is_direct(low: ContactState, high: ContactState, change: _Event, located: _Located) -> bool:
    """Return whether the edges of a new contact or of a gap have moved from or to its event without a jump."""
    event, state = located
    passed = high.load - state.load if event.birth else state.load - low.load
    length = np.array([event.left - change.left, change.right - event.left])
    return bool(np.all(_needed_load(length, np.array(change.load_per_advance)) < passed))


def _minima_of_gap(state: ContactState, series: CosineSeries, origin: Array, left: Array, right: Array) -> Indices:
    """Return the number of minima of the gap between origin + left and origin + right, shape (intervals,)."""
    angle = (np.arange(SAMPLES) + 0.5) * (np.pi / SAMPLES)
    fraction = 0.5 * (1 - np.cos(angle))  # closer together at the ends
    y = left[:, None] + (right - left)[:, None] * fraction
    sign = np.sign(_gap_slopes(state, series, np.repeat(origin, SAMPLES), y.ravel())).reshape(y.shape)
    for i in range(1, SAMPLES):
        sign[:, i] = np.where(sign[:, i] == 0, sign[:, i - 1], sign[:, i])
    return np.asarray(np.sum((sign[:, :-1] < 0) & (sign[:, 1:] > 0), axis=1))


def _minimum(state: ContactState, series: CosineSeries, event: _Event) -> tuple[float, float]:
    """Return the minimum between the ends of an event, of the gap before a birth or of the pressure after a merger.

    Its distance from the event's origin and its value, which may be negative.
    """
    y = np.linspace(event.left, event.right, SAMPLES + 2)[1:-1]
    lowest = int(np.argmin(_gaps_or_pressures(state, series, event.birth, event.origin, y)))
    step = y[1] - y[0]
    minimum = scipy.optimize.minimize_scalar(
        lambda position: _gaps_or_pressures(state, series, event.birth, event.origin, np.full(1, position))[0],
        bounds=(y[lowest] - step, y[lowest] + step),
        method="bounded",
        options={"xatol": np.sqrt(EPS) * step},  # The value has an error of second order.
    )
    return float(minimum.x), float(minimum.fun)


def _gaps_or_pressures(state: ContactState, series: CosineSeries, is_gap: bool, origin: float, y: Array) -> Array:
    """Return gaps at points origin + y outside the contacts, or pressures at points on them; any may be negative.

    On segments they follow from the density, the pressure of contacts or (integrated) the gap in gaps; elsewhere they
    are the complementary residual.
    """
    at = np.full(y.size, origin)
    if is_gap != state.dual:
        return residuals_one_by_one(state, series, *_crest_coordinates(series, at, y))
    return values_on_segments(state, series.period, at, y, is_gap)[1]


def _gap_slopes(state: ContactState, series: CosineSeries, origin: Array, y: Array) -> Array:
    """Return the slope of the gap at points origin + y off the contacts: -(2 pi/L) int p cot(pi (x-s)/L) ds - z'."""
    if state.dual:
        return values_on_segments(state, series.period, origin, y, False)[1]
    crest, y = _crest_coordinates(series, origin, y)
    integral = density_integrals(state, series.period, series.crest_position[crest], y, True)
    return np.asarray(-2 * np.pi / series.period * integral - evaluate_at(series, crest, y, 1))


def _crest_coordinates(series: CosineSeries, origin: Array, y: Array) -> tuple[Indices, Array]:
    """Return the crests nearest to origin + y and the distances from them, exact if the origin is the crest."""
    crest, _ = nearest_crests(series, origin + y)
    apart = origin - series.crest_position[crest]
    return crest, apart - series.period * np.rint((apart + y) / series.period) + y
