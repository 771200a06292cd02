"""Pressure and gap at many points, by closed forms of each segment and by fast sums."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import Profile
from weier.methods import patches
from weier.methods.patches import fields
from weier.methods.patches.surface import evaluate_series

LONG_PERIOD = Profile(1.5, "5/2", 4, (0.0, 1.0, 2.0, 3.0))


@pytest.mark.parametrize("load", [1e-20, 1e-32])
def test_gap_beside_a_tiny_contact_has_all_digits(load):
    """Hertz's gap, kappa a^2/2 (t (t^2-1)^(1/2) - ln(t + (t^2-1)^(1/2))), near and far from the contact's nodes."""
    solution = patches.solve_load(Profile(1.25, 2, 2, (1.0, 2.0)), load)
    state, series = solution.state, solution.surface.heights
    segments, crest = state.segments, state.segments.crest[0]
    assert segments.centre.size == 1
    assert abs(series.crest_position[crest]) > 0.01  # at x = 0 no digit can be lost
    curvature = -evaluate_series(series, crest, 0.0)[2]
    for t in np.cosh(fields.FAR_FIELD_EXPONENT / (segments.node.size + 1)) * np.array([0.5, 0.95, 1.05, 2.0, 5.0]):
        root = np.sqrt(t * t - 1)
        expected = 0.5 * curvature * segments.half_width[0] ** 2 * (t * root - np.log(t + root))
        y = segments.centre[0] + segments.half_width[0] * t
        gap = fields.complementary_residuals(state, series, np.array([crest]), np.array([y]))
        assert gap == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("profile", "fraction", "dual"), [(THREE_WAVES, 0.1, False), (LONG_PERIOD, 0.1, False), (LONG_PERIOD, 0.9, True)]
)
def test_fast_sums_are_the_closed_forms(profile, fraction, dual, monkeypatch):
    """Far from the segments, near them, and as near as 1e-9 of their width to an edge."""
    solution = patches.solve_load(profile, fraction * patches.solve_load(profile, 1.0).surface.full_contact_load)
    assert solution.state.dual == dual
    left, right = solution.edges.T
    distance = np.array([1e-9, 1e-3, 0.3])[:, None] * (right - left)
    near = np.concatenate([left - distance, right + distance]).ravel()
    x = np.concatenate([np.random.default_rng(0).uniform(-1, 2, 300) * profile.period, near])
    values = []
    for limit in (0, 10**9):
        monkeypatch.setattr(fields, "MIN_SUM_SEGMENTS", limit)
        monkeypatch.setattr(fields, "MIN_SUM_POINTS", min(limit, 1))
        values.append((solution.pressure(x), solution.gap(x)))
    (pressure, gap), (closed_pressure, closed_gap) = values
    force = solution.mean_pressure * profile.period
    np.testing.assert_allclose(gap, closed_gap, rtol=0, atol=1e-12 * force)  # of polynomials of 15 points
    ends = np.concatenate([left, right])
    distance = np.abs((x[:, None] - ends + profile.period / 2) % profile.period - profile.period / 2).min(axis=1)
    rounding = pressure * np.finfo(float).eps * profile.period / distance  # of a position, beside the root at an edge
    assert np.all(np.abs(pressure - closed_pressure) <= 1e-11 * pressure.max() + 2 * rounding)
    assert 20 < np.count_nonzero(gap > 0) < x.size - 20
