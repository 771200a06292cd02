"""The highest crest: of few by looking at all, of more than a computer holds wave by wave, in bounded memory."""

import tracemalloc

import numpy as np
import pytest

from weier import Profile
from weier.surface import crests
from weier.surface.crests import find_crests, highest_crest, sample
from weier.surface.expansions import expand, phase_angle


def heights_and_tensions(profile):
    """The heights, whose waves shrink, and the tensions of full contact, whose waves grow."""
    waves = profile.waves_per_period, profile.phase, profile.period
    return [(profile.amplitude, *waves), (-profile.full_contact_pressure, *waves)]


@pytest.mark.parametrize("D", [1.0001, 1.1, 1.5, 1.9, 1.9999])
@pytest.mark.parametrize(("gamma", "m"), [(2, 10), (3, 7), (5, 5), ("5/2", 7), ("7/5", 5), (90, 3)])
def test_the_search_wave_by_wave_finds_the_crest_that_looking_at_all_finds(D, gamma, m, monkeypatch):
    for series in heights_and_tensions(Profile(D, gamma, m, np.random.default_rng(m).uniform(0, 2 * np.pi, m))):
        monkeypatch.setattr(crests, "countable", lambda _: True)
        x, z = highest_crest(*series)
        monkeypatch.setattr(crests, "countable", lambda _: False)
        found_x, found_z = highest_crest(*series)
        assert found_z == pytest.approx(z, abs=1e-14 * np.abs(series[0]).sum())
        assert found_x == pytest.approx(x % series[3], abs=1e-8)


@pytest.mark.parametrize(("D", "gamma", "m"), [(1.5, 20, 6), (1.5, 1000, 6), (1.5, 2, 40), (1.9, "5/2", 20)])
def test_very_many_waves_take_little_memory(D, gamma, m):
    profile = Profile(D, gamma, m, np.random.default_rng(1).uniform(0, 2 * np.pi, m))
    tracemalloc.start()
    (_, top), full = profile.crest, profile.full_contact_load
    memory = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert memory < 5e8
    assert profile.truncated(3).crest[1] - profile.amplitude_beyond(3) < top < profile.total_amplitude
    assert 0 < full < profile.full_contact_pressure.sum()


@pytest.mark.parametrize(
    ("gamma", "m", "match"),
    [(np.pi, 4, "highest crest of these 4 waves is not found"), (2.5, 300, "in at most 64 terms")],
)
def test_a_crest_that_cannot_be_found_is_refused(gamma, m, match):
    profile = Profile(1.5, gamma, m)
    with pytest.raises(ValueError, match=match):
        _ = profile.crest
    with pytest.raises(ValueError, match=match):
        _ = profile.full_contact_load


TRIBONACCI = np.roots([1, -1, -1, -1])[0].real  # t^3 = t^2 + t + 1


@pytest.mark.parametrize(("steeper", "count"), [(0.0, 1), (-1e-4, 1), (1e-4, 2), (1e-6, 2)])
def test_crests_are_found_where_the_curvature_vanishes(steeper, count):
    """At x = 0 the waves cancel in z'' where gamma^D solves this, and for larger D two crests stand side by side."""
    profile = Profile(np.log(TRIBONACCI) / np.log(5 / 3) + steeper, "5/3", 4, (0, 0, 0, np.pi))
    expansion = expand(profile.amplitude, profile.waves_per_period, profile.phase)
    crests = find_crests(profile.amplitude, profile.waves_per_period, expansion)
    x = (crests.node + crests.offset) * (profile.period / len(expansion))
    assert np.sum(np.abs(x - profile.period * np.rint(x / profile.period)) < 0.01) == count
    kappa = 2 * np.pi / len(expansion) * np.array(profile.waves_per_period)
    angle = [phase_angle(k, crests.node, len(expansion)) for k in profile.waves_per_period]
    theta = np.stack(angle, axis=-1) + crests.offset[:, None] * kappa + profile.phase
    assert np.abs(np.sin(theta) @ (kappa * profile.amplitude)).max() < 1e-14 * kappa @ profile.amplitude


def test_all_crests_of_a_rough_trace():
    """As many as the sign of the slope changes at on a grid that is far finer, each between the same two points."""
    random, waves = np.random.default_rng(4), np.arange(1, 301)
    amplitude, phase = waves**-1.5, random.uniform(0, 2 * np.pi, waves.size)
    expansion = expand(amplitude, waves.tolist(), phase)
    crests = find_crests(amplitude, waves.tolist(), expansion)
    points = 2**17
    slope = -sample(amplitude * waves, waves.tolist(), phase - np.pi / 2, points)
    changes = np.flatnonzero((slope > 0) & (np.roll(slope, -1) <= 0))
    x = np.sort((crests.node + crests.offset) / len(expansion) % 1)
    np.testing.assert_array_equal(np.floor(x * points), changes)
