"""Births and merges against the contacts around them, and against symmetry."""

import numpy as np
import pytest
import scipy.optimize

from tests.methods.patches.test_thin_gaps import HEAVY, HEAVY_MERGER
from tests.methods.patches.westergaard_states import OneWave
from tests.profiles import THREE_WAVES, TWIN_CRESTS
from weier import ConvergenceError, Profile, Trace
from weier.accuracy.cosines import Cosines
from weier.methods import patches
from weier.methods.patches import event_search, stages
from weier.methods.patches.start import Starts


def test_minima_of_gap_and_pressure_are_those_of_one_wave(period, dual):
    """The gap at its right edge, and the pressure at its left one, since both are largest in the middle."""
    wave = OneWave(period, 0.2 * period, 0.2 * period)
    state, series, a = wave.state(dual), wave.series(dual), wave.half_width
    for birth, left, right in ((True, 1.5 * a, 3 * a), (False, -0.5 * a, 0.4 * a)):
        event = event_search._Event(birth, wave.crest, left, right)
        y, value = event_search._minimum(state, series, event)
        ends = wave.gap(np.array([left, right])) if birth else wave.pressure(np.array([left, right]))
        assert y == pytest.approx([left, right][int(np.argmin(ends))], abs=0.1 * (right - left))
        exact = wave.gap(np.array([y])) if birth else wave.pressure(np.array([y]))
        assert value == pytest.approx(float(exact[0]), abs=1e-9)


@pytest.mark.parametrize("at", [-0.99, -0.95, 0.3, 0.6])
@pytest.mark.parametrize("higher", [0.0, 20.0])
def test_a_minimum_is_located_that_is_no_parabola(monkeypatch, at, higher):
    """A parabola through the first samples, 0.15 apart, leaves its value 1e-3 off."""

    def values(state, series, event, y):
        return (y - at) ** 2 * (1 + higher * (y - at) ** 2 + 0.4 * (y - at)) - 0.1

    monkeypatch.setattr(event_search, "_values", values)
    y, value = event_search._minimum(None, None, event_search._Event(True, 0.0, -1.0, 1.0))
    assert y == pytest.approx(at, abs=1e-6)
    assert value == pytest.approx(-0.1, abs=1e-12)


def test_rounding_does_not_lower_a_minimum(monkeypatch):
    """In an interval that is so narrow that the samples differ by rounding alone."""
    random = np.random.default_rng(1)
    monkeypatch.setattr(
        event_search, "_values", lambda state, series, event, y: 1 + 1e-13 * random.normal(size=y.size)
    )
    for _ in range(100):
        _, value = event_search._minimum(None, None, event_search._Event(True, 0.0, -1e-9, 1e-9))
        assert value == pytest.approx(1, abs=2e-12)


@pytest.mark.parametrize("scale", [1.0, 3e-15, 1e-15, 1e-20])
def test_contacts_are_assigned_to_those_that_contain_them(scale):
    """Also those that are too small for positions along the period, and, if not, those counted from other periods."""
    random, period = np.random.default_rng(2), 3.0
    for count in 10 * [1, 2, 9]:
        at = np.sort(random.random(count)) * period
        room = 0.4 * np.min(np.diff(at, append=at[0] + period))
        left, right = -scale * room * random.random(count), scale * room * random.random(count)
        parts = np.sort(random.random((count, 3, 2)).reshape(count, 6), axis=1).reshape(count, 3, 2)
        inside = (left[:, None, None] + (right - left)[:, None, None] * parts).reshape(-1, 2)
        owner = np.repeat(np.arange(count), 3)
        kept = np.flatnonzero(random.random(owner.size) < 0.7)
        turned = np.roll(kept, 1)
        turns = random.integers(-1, 2, kept.size) if scale == 1 else 0
        smaller = at[owner[turned]] + period * turns, *inside[turned].T
        within, start, end, order = event_search._sort_into((at, left, right), smaller, period)
        np.testing.assert_array_equal(within, owner[kept])
        np.testing.assert_array_equal(turned[order], kept)
        np.testing.assert_allclose([start, end], inside[kept].T, atol=4e-15 if scale == 1 else 1e-5 * scale)


def test_an_edge_that_advances_farther_than_the_load_explains_has_jumped(period, dual):
    """On one wave dp/da = k_1/(2 B) is the derivative of sin^2(pi a/L)/L, and nearly linear over the advance."""
    search = event_search._Search(Starts(Profile(1.5, 2, 1), 1e-10))
    heights = OneWave(period, 0.1 * period, 0.2 * period).series(False)
    search.starts.surface = search.starts.surface._replace(heights=heights, tensions=heights)
    low, high = (OneWave(period, part * period, 0.2 * period) for part in (0.1, 0.12))
    per_advance = np.pi / period**2 * np.sin(2 * low.alpha)
    np.testing.assert_allclose(event_search._loads_per_advance(low.state(dual), period), per_advance, rtol=1e-8)
    for share, expected in ((1.0, True), (0.85, True), (0.82, False)):
        load = low.load + share * (high.load - low.load)
        assert search._changes(low.state(dual), high.state(dual)._replace(load=load)) == ([], expected)


def test_an_edge_from_a_birth_or_to_a_merger_has_jumped_if_the_load_explains_too_little_of_its_way():
    """p - p_b = c a^2 from a Hertzian birth, of half-width a, with dp/da = 2 c a; gaps that close are the same."""
    search = event_search._Search(Starts(Profile(1.5, 2, 1), 1e-10))
    low, high = (OneWave(1.0, 0.1, 0.0).state(False)._replace(load=load) for load in (1.0, 2.0))
    for c, a, expected in (
        (100, 0.1, True),
        (100, 0.109, True),
        (100, 0.11, False),
        (1, 0.49, True),
        (1, 0.51, False),
    ):
        assert search._is_direct(np.array([a]), np.array([2 * c * a]), low, high) == [expected]


def test_events_are_expected_where_the_contact_of_hertz_begins_and_ends():
    """p - p_b = c a^2, with dp/da = 2 c a at both edges."""
    low, high = (OneWave(1.0, 0.1, 0.0).state(False)._replace(load=load) for load in (1.0, 2.0))
    a, c = 0.1, 30.0
    for birth, load in ((True, 2.0 - c * a**2), (False, 1.0 + c * a**2)):
        event = event_search._Event(birth, 0.0, -a, a, (2 * c * a, 2 * c * a))
        assert event_search._expected_load(low, high, event) == pytest.approx(load)


def test_roots_of_smooth_functions_by_inverse_interpolation():
    loads = [1.0, 1.1, 1.3, 1.2]
    for order, cube in ((4, 1), (2, 0)):
        values = [scipy.optimize.brentq(lambda v, p=p, c=cube: 1.05 + v - c * v**3 - p, -0.5, 0.5) for p in loads]
        assert event_search._root(loads[:order], values[:order]) == pytest.approx(1.05, rel=1e-11)
    assert not np.any(np.isfinite(event_search._root([1.0, 2.0], [0.5, 0.5])))


def test_more_nodes_change_no_load_of_an_event(monkeypatch):
    """With those of the default tolerance, the least pressure of a trace's contacts left a load 8e-9 off."""
    random, k = np.random.default_rng(4), np.arange(1, 33)
    wave = k**-1.8 * random.normal(size=32) * np.exp(2j * np.pi * random.random(32))
    heights = np.fft.irfft(np.concatenate([[0], wave, np.zeros(31)]), 128)
    trace = Trace(1e-8 * heights / np.std(heights), 127e-6, unit="m", ends="periodic")
    found = patches.events(trace, 0.01, 1.0)
    usual = stages.make_guess
    monkeypatch.setattr(stages, "make_guess", lambda problem, old, tolerance: usual(problem, old, 1e-24))
    np.testing.assert_allclose(found.mean_pressure, patches.events(trace, 0.01, 1.0).mean_pressure, rtol=1e-11)


def test_contacts_are_interpolated_with_their_slope(dual):
    """Each state, and the slope at the first one, is a condition on the square of the half-width."""
    followed = [OneWave(1.0, a, 0.2).state(dual) for a in (0.1, 0.12, 0.11)]
    wave = OneWave(1.0, 0.105, 0.2)
    exact = wave.state(dual).segments
    for count, error in ((1, 5e-4), (2, 6e-5), (3, 4e-6)):
        guess = event_search._interpolate_contacts(followed[:count], wave.load).segments
        np.testing.assert_allclose(guess.half_width, exact.half_width, rtol=error)
        np.testing.assert_allclose(guess.centre, exact.centre, rtol=0, atol=1e-15)
    moved = followed[0]._replace(tangent_strength=followed[0].tangent_strength * [[1.0, 2.0]])
    shift = event_search._interpolate_contacts([moved], wave.load).segments.centre - exact.centre
    step = (wave.load - moved.load) / np.pi / np.sin(2 * np.pi * 0.1)  # of the edge whose strength is not changed
    np.testing.assert_allclose(shift, -0.5 * step if dual else 0.5 * step, rtol=1e-6)


def test_contacts_that_are_extrapolated_do_not_vanish():
    state = OneWave(1.0, 0.1, 0.2).state(False)
    assert event_search._interpolate_contacts([state], 0.0).segments.half_width == [0.05]


def test_a_search_that_stays_uncertain_ends(monkeypatch):
    monkeypatch.setattr(event_search._Search, "_changes", lambda self, low, high: ([], False))
    with pytest.raises(ConvergenceError, match="remain uncertain after 101 divisions"):
        patches.events(Profile(1.25, 2, 2), 1e-3, 2.0)


@pytest.mark.parametrize(("waves", "finest"), [(40, 1e-6), (40, 1e-12), (90, 1e-6)])
def test_edges_pass_any_number_of_waves(waves, finest):
    """One contact that grows over tens of waves, which need some 3 intervals each, and has no event."""
    surface, shares = Cosines(np.array([1.0, finest]), [1, waves]), []
    events = patches.events(surface, 0.1, 0.95, report=shares.append)
    assert events.mean_pressure.size == 0
    assert np.all(patches.curve(surface, np.geomspace(0.1, 0.95, 50)).patch_count == 1)
    assert 0.5 * waves < len(shares) < 5 * waves
    assert 0 < shares[0] < 0.05
    assert np.all(np.diff(shares) > 0)
    assert shares[-1] == 1


def test_events_of_symmetric_profiles_come_in_pairs():
    events = patches.events(Profile(1.25, 2, 2), 1e-3, 2.0)
    np.testing.assert_array_equal(events.birth, [True, False, False])
    np.testing.assert_array_equal(events.patch_count, [2, 0, 0])  # the last two at one load
    assert events.x[0] == pytest.approx(0.5, abs=1e-6)
    assert events.x[1] + events.x[2] == pytest.approx(1)
    merge = patches.events(TWIN_CRESTS, 1e-3, 1.0)
    np.testing.assert_array_equal(merge.birth, [False])


def test_a_search_may_begin_and_end_at_an_event():
    profile = Profile(1.25, 5, 2, 1.0)
    whole = patches.events(profile, 1e-3, 3.0)
    for number, load in enumerate(whole.mean_pressure):
        for low, high, found in ((load, 3.0, whole.birth[number + 1 :]), (1e-3, load, whole.birth[:number])):
            birth = patches.events(profile, low, high).birth
            assert birth.size - found.size in (0, 1)  # the event at the end itself, to rounding
            inside = birth[-found.size :] if low == load else birth[: found.size]
            np.testing.assert_array_equal(inside if found.size else birth[:0], found)


def test_events_of_nearly_one_load_are_told_apart():
    """A phase separates the symmetric births and mergers in proportion to itself."""
    apart = []
    for phase in (1e-7, 1e-6):
        load = patches.events(Profile(1.25, 3, 2, (0.0, phase)), 1e-6, 10.0).mean_pressure
        apart.append(load[[1, 3]] / load[[0, 2]] - 1)
    np.testing.assert_allclose(apart[0], (6.5e-8, 5.9e-8), rtol=0.1)
    np.testing.assert_allclose(apart[1], 10 * apart[0], rtol=0.05)


@pytest.mark.parametrize("phase", [0.0, np.pi])
def test_events_of_one_load_are_found_together(phase):
    """z is even: whatever happens beside the axis happens on both sides at once."""
    events = patches.events(Profile(1.5, 3, 3, (0.0, phase, phase)), 0.1, 1.45)
    beside = np.minimum(np.abs(events.x % 0.5), 0.5 - events.x % 0.5) > 1e-6
    load, x = events.mean_pressure[beside], events.x[beside]
    assert load.size >= 4
    np.testing.assert_allclose(load[::2], load[1::2], rtol=1e-9)
    np.testing.assert_allclose(x[::2] + x[1::2], 1, atol=1e-6)


RIPPLED = [Cosines(np.array([1.0, ripple]), [1, 10], np.array([0.0, 1.0])) for ripple in (8e-3, 1e-2)]
RIPPLED_BY_THREE = Cosines(
    np.array([1.0, 0.10551569672190313, 0.004210554884115263, 0.007702497867011909]),
    [1, 6, 14, 15],
    np.array([5.819914989032046, 2.5054863788263426, 1.8440242343708586, 2.0762753548524846]),
)
GAUSSIAN = np.exp(-((np.pi * 0.03 * np.arange(1, 61)) ** 2)) * (-1.0) ** np.arange(1, 61)
BUMPS = [Cosines(sign * GAUSSIAN, [*range(1, 61)]) for sign in (1, -1)]  # a bump, and a groove
SOON_MERGED = (4.481869815049773, 4.983182800916742, 2.601251739364986)
RANDOM, TERMS = np.random.default_rng(48), np.arange(1, 25)
ROUGH = Cosines(TERMS**-2.1 * RANDOM.normal(size=24), TERMS.tolist(), RANDOM.uniform(0, 2 * np.pi, 24))
# surface, first and last load over p_0*, and whether contacts are born or merge, where the order matters
SEARCHES = [
    (THREE_WAVES, 0.3, 10.0, None),
    (Profile(1.25, 2, 5, (np.pi,) * 5), 2.0, 3.0, None),  # contacts that live for 4 % of a load
    # an edge passes a wave between two loads, and another contact is born beside it
    (ROUGH, 1e-3 * ROUGH.full_contact_load, 1.2 * ROUGH.full_contact_load, None),
    (Profile(1.5, "5/2", 3, (0.0, 1.0, 2.0)), 0.2, 1.0, None),
    (Profile(1.02, 5, 2, (np.pi, np.pi)), 1e-3, 1.0, None),  # contacts in mirror images
    (Profile(1.25, 5, 4, np.arange(4.0)), 1.0, 1.1, None),  # among many
    # a contact that merges soon with the neighbour beside which it is born
    (Profile(1.9336359298628136, "6/5", 3, SOON_MERGED), 0.699, 0.7015, None),
    # one that is born and merges as an edge passes ripples: an interval of several of them would show none
    *((surface, 0.05 * surface.full_contact_load, 0.95 * surface.full_contact_load, "bm") for surface in RIPPLED),
    # the contact passes half of the waves
    *((surface, 1e-3 * surface.full_contact_load, 0.9 * surface.full_contact_load, None) for surface in BUMPS),
    # from just below a merger, whose gap is a crack
    *((HEAVY, HEAVY_MERGER * (1 - below), HEAVY_MERGER * 1.02, None) for below in (1e-8, 1e-9)),
    # from the birth of a contact that merges while the gap is nearly a wave wide
    (RIPPLED_BY_THREE, 0.5254327282248655, 1.17, None),
    # contacts that are followed past a birth go on over it, with tension behind the edge
    (Profile(1.5249731126076087, "3/2", 4, (0.0, -0.0006318142317016926, 0.0, 0.0)), 0.01, 0.014, "bbm"),
    (Profile(1.25, 2, 2, (1e-7, np.pi)), 1e-12, 1e-3, "b"),  # two crests of nearly one height, which stand apart
    # edges that coincide in double precision, as positions along the period
    *((Profile(1.25, 5, 2, (0.0, 1.0)), low, high, "") for low, high in ((1e-31, 1e-30), (1e-100, 1e-3))),
]


@pytest.mark.parametrize(("surface", "low", "high", "births"), SEARCHES)
def test_no_event_is_missed(surface, low, high, births):
    """The contacts beside each event, and at 20 loads, are those that the events leave."""
    events = patches.events(surface, low, high)
    if births is not None:
        assert "".join("b" if birth else "m" for birth in events.birth) == births
    beside = events.mean_pressure[:, None] * np.array([1 - 3e-5, 1 + 3e-5])
    loads = np.unique(np.append(np.geomspace(low, high, 20), beside[(beside > low) & (beside < high)]))
    counts = patches.curve(surface, loads).patch_count
    after = np.append(counts[0], events.patch_count)[np.searchsorted(events.mean_pressure, loads)]
    np.testing.assert_array_equal(after, counts)
    assert counts[-1] - counts[0] == np.where(events.birth, 1, -1).sum()


def test_events_are_at_roots_which_take_few_loads(monkeypatch):
    """Without them each interval would be divided some thirty times; no root outside of it is taken for one."""
    solved, real = [], event_search.solve_state
    monkeypatch.setattr(event_search, "solve_state", lambda starts, load: solved.append(load) or real(starts, load))
    events = patches.events(THREE_WAVES, 0.3, 3.0)
    assert 0 < len(solved) < 2 * events.birth.size
    for outside in (0.29, 3.1):
        monkeypatch.setattr(event_search, "_root", lambda loads, values, load=outside: load)
        search = event_search._Search(Starts(THREE_WAVES, 1e-10))
        low, high = (search.state(load) for load in (0.3, 3.0))
        assert search._locate(low, high, search._changes(low, high)[0][:1]) is None
