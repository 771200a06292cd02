"""Estimates and bounds of the infinite series by the number of terms resolved."""

import numpy as np
import pytest

from weier import Profile, random_phases
from weier.accuracy import convergence

LOADS = np.geomspace(3e-3, 3, 7)
PROFILE = Profile(1.25, 2, np.inf, random_phases(2))


@pytest.fixture(scope="module")
def resolved():
    return [*convergence.measure(PROFILE, LOADS, 6)]


def test_estimates_lie_within_all_bounds_and_close_in(resolved):
    assert [one.terms for one in resolved] == [1, 2, 3, 4, 5, 6]
    *estimates, last = (one.bounds.mean(axis=0) for one in resolved)
    mesh = np.pi**2 / 2 / 32**2  # dx^2/8 times the curvature of one wave, on the grid of the estimate, in g_0
    for one in resolved:
        # The last estimate lies within the bounds of every shorter series: they are about the same infinite one.
        low, high = one.bounds
        assert np.all((low - mesh <= last) & (last <= high + mesh))
        assert np.all(high <= PROFILE.total_amplitude)
    deviation = [np.abs(estimate - last).max() for estimate in estimates]
    assert deviation[-1] < deviation[0] / 3
    # Far better than the certificate, which is half as wide as the bounds.
    widths = (np.ptp(one.bounds, axis=0).max() / 2 for one in resolved)
    assert all(own < 0.75 * width for own, width in zip(deviation, widths, strict=False))


def test_rows_tell_seeds_apart_and_the_last_estimate_has_no_error():
    one, two = (Profile(1.25, 2, np.inf, seed=seed) for seed in (1, 2))
    heights = np.array([[0.1, 0.4], [0.3, 0.8]])
    found = [
        convergence.Resolved(terms, 12 * terms, np.stack([heights - 0.1 / terms, heights + 0.1])) for terms in (1, 2)
    ]
    assert [*convergence.rows(one, found)] == [
        ["D = 1.25, gamma = 2, m = inf, seed = 1", "1", "12", "1.0e-01", "2.5e-02"],
        ["D = 1.25, gamma = 2, m = inf, seed = 1", "2", "24", "7.5e-02", ""],
    ]
    assert next(convergence.rows(two, found))[0].endswith("seed = 2")
