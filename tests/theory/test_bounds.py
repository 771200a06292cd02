"""Barber's bounds: drawn by brute force, and against series of more terms than those bounded."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from weier import Profile
from weier.methods import patches, westergaard
from weier.surface.series import tail_amplitude
from weier.theory.bounds import complete_bounds, first_contact, infinite_series_bounds, resistance_bounds

D, GAMMA = 1.25, 5


def test_an_error_of_the_compliance_widens_27():
    lower, upper = complete_bounds([0.05, 0.5, 1.1], 0.1, 1.2, [0.1, 0.02, 0.02])
    np.testing.assert_allclose(lower, [0.0, 0.48, 1.08], rtol=1e-15)
    np.testing.assert_allclose(upper, [0.35, 0.72, 1.2], rtol=1e-15)


def test_bounds_of_the_infinite_series_hold_and_are_nearly_attained_by_longer_series():
    """Three further terms, of 0.7 of what is left out; phases that leave crests of fine waves to either side."""
    p, nearest = np.geomspace(1e-4, 1.5, 60), np.ones(2)
    for phases in ((0.0,) * 5, (np.pi,) * 5, *np.random.default_rng(1).uniform(0, 2 * np.pi, (6, 5))):
        short, longer = (Profile(1.25, 2, m, tuple(phases[:m])) for m in (2, 5))
        found, exact = patches.curve(short, p), patches.curve(longer, p)
        bounds = infinite_series_bounds(short, p, found.compliance, found.compliance_error)
        rest = longer.tail_amplitude  # of the terms beyond, whose own datum is higher
        low, high = bounds["compliance_lower"], bounds["compliance_upper"]
        assert np.all(low <= exact.compliance + 2 * rest)
        assert np.all(exact.compliance <= high)
        assert np.all(bounds["resistance_lower"] <= exact.resistance * (1 + 1e-9))
        steepest = exact.resistance <= bounds["resistance_upper"]
        assert steepest.mean() > 0.95  # the terms beyond smooth the drops at births
        width = 2 * short.tail_amplitude
        distances = (exact.compliance - low).min() / width, (high - exact.compliance).min() / width
        nearest = np.minimum(nearest, distances)
    assert np.all(nearest < 0.67)


def tangent_lines(p, G):
    """R_min and R_max of one wave at p, over all other loads: two searches in one dimension."""

    def chord(q):
        return (westergaard.compliance(q) - westergaard.compliance(p)) / (q - p)

    fine = {"method": "bounded", "options": {"xatol": 1e-12}}
    below = minimize_scalar(lambda q: chord(q) + 2 * G / (p - q), bounds=(0, p), **fine).fun
    above = -minimize_scalar(lambda q: 2 * G / (q - p) - chord(q), bounds=(p, 5), **fine).fun
    return max(above, 0), min(below, (westergaard.compliance(p) + 2 * G) / p)


@pytest.mark.parametrize("G", [1e-3, 0.03, float(tail_amplitude(1, D, GAMMA))])
def test_fine_tables_reach_the_tangent_lines(G):
    p = np.linspace(1e-4, 3, 3000)
    lower, upper = resistance_bounds(p, westergaard.compliance(p), G, first_contact=0.0)
    from_higher = resistance_bounds(p, westergaard.compliance(p) + 0.2, G, first_contact=0.2)
    np.testing.assert_allclose(from_higher, (lower, upper), atol=1e-11)
    assert upper[0] == pytest.approx((westergaard.compliance(p[0]) + 2 * G) / p[0], rel=1e-15)  # from first contact
    for i in range(20, 1500, 61):
        flattest, steepest = tangent_lines(p[i], G)
        # Bounds from a table are looser, never tighter; the best chord is stationary, so by a squared spacing.
        assert flattest - 1e-2 * flattest <= lower[i] <= flattest + 1e-9
        assert steepest - 1e-9 <= upper[i] <= steepest * (1 + 1e-2)


def test_first_contact_is_where_the_highest_crest_touches():
    profile = Profile(D, GAMMA, 3, (0.0, 1.0, 2.0))
    touching = profile.total_amplitude - profile.sampled_height(10**6).max()
    assert touching > 0.05
    assert first_contact(profile) == pytest.approx(touching, abs=1e-8)


def test_cases_are_bounded_as_if_alone_and_loads_come_in_any_order():
    rng = np.random.default_rng(5)
    p = rng.permutation(np.geomspace(1e-3, 3, 30))
    h = westergaard.compliance(p) * np.array([1.0, 2.0])[:, None]
    G, start = np.array([0.1, 0.3]), np.array([0.0, -0.01])
    together = resistance_bounds(p, h, G, start)
    order = np.argsort(p)
    for i in range(2):
        apart = resistance_bounds(p[order], h[i][order], G[i], start[i])
        for both, one in zip(together, apart, strict=True):
            np.testing.assert_array_equal(both[i][order], one)


def test_missing_loads_stay_missing_and_spoil_no_other():
    p = np.geomspace(1e-3, 3, 20)
    h = westergaard.compliance(p)
    holed = np.where(np.arange(20) == 7, np.nan, h)
    present = np.arange(20) != 7
    both = resistance_bounds(p, holed, 0.1), resistance_bounds(p[present], h[present], 0.1)
    for holed_bound, bound in zip(*both, strict=True):
        assert np.isnan(holed_bound[7])
        np.testing.assert_array_equal(holed_bound[present], bound)
    for bound in (*resistance_bounds(p, np.full(20, np.nan), 0.1), *resistance_bounds(p, h, np.nan)):
        assert np.isnan(bound).all()


@pytest.mark.parametrize("G", [0.0, 1e-300, 1e10, 1e300])
def test_loads_of_any_size_are_bounded_in_silence(G):
    """A bound beyond the largest float is inf; warnings are errors here."""
    p = np.array([1e-300, 1e-20, np.nextafter(1, 0), 1.0, np.nextafter(1, 2), 1e300])
    lower, upper = resistance_bounds(p, westergaard.compliance(p), G, first_contact=0.0)
    slack = np.finfo(float).eps / np.diff(p).min(initial=1, where=p[1:] > 0.5)  # of chords an ulp long
    assert np.all(lower <= westergaard.resistance(p) + slack)
    assert np.all(westergaard.resistance(p) <= upper + slack)
    assert not np.isnan(lower + upper).any()


def test_a_load_that_is_far_off_widens_its_own_bounds_alone():
    """One wave (12), whose curve is known: bounds hold whatever the errors are, and only one of them is wide."""
    p = np.geomspace(1e-3, 1, 30)
    h, error = westergaard.compliance(p), np.full(30, 1e-6)
    error[12] = 0.2
    wrong = h + np.where(np.arange(30) == 12, 0.19, -1e-6)
    lower, upper = resistance_bounds(p, wrong, 0.0, 0.0, error)
    assert np.all(lower <= westergaard.resistance(p))
    assert np.all(upper >= westergaard.resistance(p))
    width, alone = upper - lower, np.subtract(*resistance_bounds(p, h, 0.0, 0.0, 1e-6)[::-1])
    others = np.abs(np.arange(30) - 12) > 1  # the neighbours lose a chord
    assert np.all(width[others] < 1.5 * alone[others])
    assert width[12] > 3 * alone[12]
    everywhere = np.subtract(*resistance_bounds(p, wrong, 0.0, 0.0, 0.2)[::-1])
    assert np.all(width[others] < 0.5 * everywhere[others])
