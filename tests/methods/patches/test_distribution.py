"""Distributions of pressure and gap against closed forms, samples, and their moments."""

import numpy as np
import pytest

from weier import Profile
from weier.methods.patches import distribution, solve_load
from weier.methods.patches.distribution import fraction_above

WAVE = Profile(1.5, 2, 1)
SERIES = Profile(1.5, 5, 3, (0.0, 1.0, 2.0))


@pytest.mark.parametrize("load", [1e-300, 1e-6, 0.3, 0.9, 0.999])
def test_the_pressures_of_one_wave_are_westergaards(load):
    """(10) solved for sin^2, p^2 = 4 (1 - S) (load - S); by contacts and by gaps."""
    limits, above = fraction_above(solve_load(WAVE, load), False)
    assert limits[-1] == pytest.approx(2 * np.sqrt(load), rel=1e-12)
    squared = (load - limits**2 / 4) * 2 / (1 + load + np.hypot(1 - load, limits))
    exact = 2 / np.pi * np.arcsin(np.sqrt(np.maximum(squared, 0)))
    assert above[:-1] == pytest.approx(exact[:-1], rel=1e-11)
    assert above[-1] == pytest.approx(0, abs=1e-7 * exact[0])


def test_full_contact_of_one_wave_has_the_arcsine_law():
    limits = np.array([0.4, 0.5, 0.7, 1.5, 2.4, 2.5, 9.0])
    _, above = fraction_above(solve_load(WAVE, 1.5), False, limits)
    assert above == pytest.approx(np.arccos(np.clip(limits - 1.5, -1, 1)) / np.pi, abs=1e-7)
    assert np.all(fraction_above(solve_load(WAVE, 1.5), True, limits)[1] == 0)


@pytest.mark.parametrize("load", [1e-3, 0.3, 3.5, 5.0])
def test_moments_and_samples_of_a_series(load):
    """Contacts, gaps and full contact; the mean of a value is the integral of the fraction above it."""
    solution = solve_load(SERIES, load)
    x = (np.arange(60_003) + 0.5) / 60_003 * SERIES.period
    for of_gap, mean, sampled in ((False, load, solution.pressure(x)), (True, solution.mean_gap, solution.gap(x))):
        coarse = fraction_above(solution, of_gap)[0][[0, 10, 50, 90, 99]]
        _, above = fraction_above(solution, of_gap, coarse)
        assert above == pytest.approx((sampled[:, None] > coarse).mean(axis=0), abs=6e-4)
        fine = np.linspace(0, sampled.max() * 1.01, 1_001)
        _, above = fraction_above(solution, of_gap, fine)
        assert np.trapezoid(above, fine) == pytest.approx(mean, abs=3e-5 * sampled.max() + 1e-15)
        full = solution.state is None
        covered = 1.0 if full else 2 * solution.half_width.sum() / SERIES.period
        assert above[0] == pytest.approx(1 - covered if of_gap else covered, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("of_gap", [False, True])
def test_values_at_edges_that_are_0_only_the_first_time_hide_no_root(monkeypatch, of_gap):
    """The rounding of a value depends on the others that are evaluated with it."""
    solution, real, rounding = solve_load(SERIES, 0.3), distribution.values_at, iter([0.0])
    monkeypatch.setattr(distribution, "values_at", lambda *given: real(*given) + next(rounding, 1e-15))
    covered = 2 * solution.half_width.sum() / SERIES.period
    _, above = fraction_above(solution, of_gap)
    assert above[[0, -1]] == pytest.approx([1 - covered if of_gap else covered, 0], abs=1e-6)
