"""Pressure and gap at many points, by closed forms of each segment and by fast sums."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import Profile
from weier.methods import patches
from weier.methods.patches import fields
from weier.methods.patches.fields import segment_at

LONG_PERIOD = Profile(1.5, "5/2", 4, (0.0, 1.0, 2.0, 3.0))


@pytest.mark.parametrize(
    ("profile", "share", "dual"), [(THREE_WAVES, 0.1, False), (LONG_PERIOD, 0.1, False), (LONG_PERIOD, 0.9, True)]
)
def test_fast_sums_are_the_closed_forms(profile, share, dual, monkeypatch):
    """Far from the segments, near them, and as near as 1e-9 of their width to an edge."""
    solution = patches.solve_load(profile, share * patches.solve_load(profile, 1.0).surface.full_contact_load)
    assert solution.state.dual == dual
    left, right = solution.edges.T
    off = np.array([1e-9, 1e-3, 0.3])[:, None] * (right - left)
    near = np.concatenate([left - off, right + off]).ravel()
    x = np.concatenate([np.random.default_rng(0).uniform(-1, 2, 300) * profile.period, near])
    values = []
    for limit in (0, 10**9):
        monkeypatch.setattr(fields, "MIN_SEGMENTS", limit)
        values.append((solution.pressure(x), solution.gap(x)))
    (pressure, gap), (closed_pressure, closed_gap) = values
    force = solution.mean_pressure * profile.period
    np.testing.assert_allclose(gap, closed_gap, rtol=0, atol=1e-12 * force)  # of polynomials of 15 points
    ends = np.concatenate([left, right])
    distance = np.abs((x[:, None] - ends + profile.period / 2) % profile.period - profile.period / 2).min(axis=1)
    rounding = pressure * np.finfo(float).eps * profile.period / distance  # of a position, beside the root at an edge
    assert np.all(np.abs(pressure - closed_pressure) <= 1e-11 * pressure.max() + 2 * rounding)
    assert 20 < np.count_nonzero(gap > 0) < x.size - 20


def test_the_segment_at_a_point():
    solution = patches.solve_load(LONG_PERIOD, 0.5)
    segments, period = solution.state.segments, LONG_PERIOD.period
    assert not solution.state.dual
    centre = segments.origin + segments.centre
    for turn in (-period, 0.0, period):
        for j in range(centre.size):
            for t in (-0.999, 0.0, 0.999):
                found, coordinate = segment_at(segments, period, centre[j] + turn, t * segments.half_width[j])
                assert found == j
                assert coordinate == pytest.approx(t, abs=1e-9)  # a position of 8 is rounded to 1e-15
            assert segment_at(segments, period, centre[j] + turn, 1.001 * segments.half_width[j])[0] == -1
