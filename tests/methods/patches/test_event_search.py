"""Births and merges against the contacts around them, and against symmetry."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES, TWIN_CRESTS
from weier import Profile
from weier.methods import patches
from weier.methods.patches import event_search, fields


def test_events_are_where_the_contacts_change():
    events = patches.events(THREE_WAVES, 0.3, 10.0)
    assert events.patch_count[-1] == 0
    assert np.all(np.diff(events.mean_pressure) >= 0)
    each = list(zip(events.mean_pressure, events.patch_count, events.birth, strict=True))
    for load, count, birth in each[:-1:4]:
        around = patches.curve(THREE_WAVES, load * np.array([1 - 1e-5, 1 + 1e-5])).patch_count
        assert around[1] == count
        assert around[1] - around[0] == (1 if birth else -1)


def test_events_of_symmetric_profiles_come_in_pairs():
    events = patches.events(Profile(1.25, 2, 2), 1e-3, 2.0)
    np.testing.assert_array_equal(events.birth, [True, False, False])
    np.testing.assert_array_equal(events.patch_count, [2, 0, 0])  # the last two at one load
    assert events.x[0] == pytest.approx(0.5, abs=1e-6)
    assert events.x[1] + events.x[2] == pytest.approx(1)
    merge = patches.events(TWIN_CRESTS, 1e-3, 1.0)
    np.testing.assert_array_equal(merge.birth, [False])


@pytest.mark.parametrize("phase", [0.0, np.pi])
def test_events_of_one_load_are_found_together(phase):
    """z is even: whatever happens beside the axis happens on both sides at once."""
    events = patches.events(Profile(1.5, 3, 3, (0.0, phase, phase)), 0.1, 1.45)
    beside = np.minimum(np.abs(events.x % 0.5), 0.5 - events.x % 0.5) > 1e-6
    load, x = events.mean_pressure[beside], events.x[beside]
    assert load.size >= 4
    np.testing.assert_allclose(load[::2], load[1::2], rtol=1e-9)
    np.testing.assert_allclose(x[::2] + x[1::2], 1, atol=1e-6)


@pytest.mark.parametrize(
    ("profile", "low", "high"),
    [
        (Profile(1.25, 2, 5, (np.pi,) * 5), 2.0, 3.0),  # contacts that live for 4 % of a load
        (Profile(1.5, "5/2", 3, (0.0, 1.0, 2.0)), 0.2, 1.0),
        (Profile(1.02, 5, 2, (np.pi, np.pi)), 1e-3, 1.0),  # contacts in mirror images
    ],
)
def test_no_event_is_missed(profile, low, high):
    """Counts at 60 loads are those that the events leave."""
    events = patches.events(profile, low, high)
    loads = np.geomspace(low, high, 60)
    counts = patches.curve(profile, loads).patch_count
    last = np.searchsorted(events.mean_pressure, loads[1:]) - 1
    np.testing.assert_array_equal(np.where(last < 0, counts[0], events.patch_count[last]), counts[1:])
    if profile.m == 5:
        np.testing.assert_array_equal(events.birth, [True, True, False, False])


def test_light_loads_have_no_false_events():
    """Edges coincide in double precision there, as positions along the period."""
    for low, high in ((1e-31, 1e-30), (1e-100, 1e-3)):
        assert patches.events(Profile(1.25, 5, 2, (0.0, 1.0)), low, high).birth.size == 0


def test_two_crests_of_nearly_one_height():
    """The lower one is touched where Hertz's contact on the other has sunk in so far, and both stand apart."""
    profile = Profile(1.25, 2, 2, (1e-7, np.pi))
    event = patches.events(profile, 1e-12, 1e-3)
    np.testing.assert_array_equal(event.birth, [True])
    around = patches.curve(
        Profile(1.25, 2, 2, (1e-7, np.pi)), event.mean_pressure[0] * np.array([1 - 1e-6, 1 + 1e-6])
    )
    np.testing.assert_array_equal(around.patch_count, [1, 2])


@pytest.mark.parametrize(("sums", "rounding"), [(False, 1e-12), (True, 1e-12), (True, 1e-6)])
def test_no_minimum_of_the_gap_is_hidden_by_rounding(sums, rounding, monkeypatch):
    """The interval is so narrow that the gap rises by less than its rounding; beside contacts is no minimum."""
    if sums:
        for module, name in (
            (fields, "MIN_SUM_SEGMENTS"),
            (fields, "MIN_SUM_POINTS"),
            (event_search, "MIN_SUM_SEGMENTS"),
        ):
            monkeypatch.setattr(module, name, 1)
    monkeypatch.setattr(event_search, "GAP_ROUNDING", rounding)
    born = patches.events(THREE_WAVES, 0.3, 1.0)
    load, x = born.mean_pressure[born.birth][0], born.x[born.birth][0]
    solution = patches.solve_load(THREE_WAVES, load * (1 - 1e-9))
    state, series = solution.state, solution.surface.heights
    assert not state.dual
    edge = solution.centre + solution.half_width
    for width in np.geomspace(1e-6, 1e-2, 9):
        around = np.array([x]), np.array([-0.93 * width]), np.array([width])
        np.testing.assert_array_equal(event_search._minima_of_gap(state, series, *around), 1)
        beside = edge, np.full(edge.size, 1e-3 * width), np.full(edge.size, 1e-2 * width)
        np.testing.assert_array_equal(event_search._minima_of_gap(state, series, *beside), 0)


def test_events_among_hundreds_of_contacts():
    profile, low, high = Profile(1.25, 5, 5, np.arange(5.0)), 1.0, 1.02
    events = patches.events(profile, low, high)
    load, sides = events.mean_pressure, np.array([[1 - 1e-6], [1 + 1e-6]])
    below, above = (patches.curve(profile, side * load).patch_count for side in sides)
    np.testing.assert_array_equal(above, events.patch_count)
    np.testing.assert_array_equal(above - below, np.where(events.birth, 1, -1))
    np.testing.assert_array_equal(below[1:], above[:-1])  # none is missed in between
    np.testing.assert_array_equal(patches.curve(profile, [low, high]).patch_count, [below[0], above[-1]])
