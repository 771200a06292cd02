"""Persson's theory against its sums in mpmath, its energy, its diffusion equation, and one wave."""

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad

from tests.extreme_series import CORNERS, assert_accurate, extreme_cases
from weier import NotApplicableError, Profile, solve
from weier.methods import cascade, persson, westergaard
from weier.surface.series import MAX_TERMS, leading_amplitude

DIGITS = 50
SERIES = [(1.25, 5.0, 1), (1.25, 5.0, 3), (1.5, 2.0, 6), (1.75, 2.0, 40), (1.5, 5.0, np.inf)]


def sums(p, D, gamma, m):
    """Compliance and resistance, term by term; an infinite series to where the rest is below the last digit."""
    with mp.workdps(DIGITS):
        p, falls, grows = mp.mpf(p), mp.mpf(gamma) ** (mp.mpf(D) - 2), mp.mpf(gamma) ** (mp.mpf(D) - 1)
        g, pressure, variance, h, R, n = mp.mpf(1), mp.mpf(1), mp.mpf(0), mp.mpf(0), mp.mpf(0), 0
        total = (1 - falls**m) / (1 - falls) if m < np.inf else 1 / (1 - falls)
        while n < m:
            variance += pressure**2
            x, weight = p**2 / variance, g * pressure / mp.sqrt(variance)
            h, R = h + weight * mp.e1(x), R + weight * mp.exp(-x)
            n, g, pressure = n + 1, g * falls, pressure * grows
            if m == np.inf and x < 1 and weight * (1 - mp.log(x)) < mp.mpf(10) ** -(DIGITS // 2) * R:
                break
        return total - h / (4 * mp.sqrt(mp.pi)), R / (2 * mp.sqrt(mp.pi) * p)


def assert_sums(case):
    p, D, gamma, m = case
    exact = sums(*case)
    total = leading_amplitude(m, D, gamma)
    # h is a difference of the amplitudes and a sum: its error is relative to the larger of both.
    scale = max(total, abs(float(exact[0])))
    assert persson.compliance(p, D, gamma, m) == pytest.approx(float(exact[0]), abs=1e-12 * scale), case
    assert_accurate(persson.resistance(p, D, gamma, m), exact[1], sums, 1, case)


def in_reach(case):
    """Whether the sums in mpmath end after a hundred terms."""
    p, D, gamma, m = case
    pressed = 2 * max(np.log(p), 0) / (2 * (D - 1) * np.log(gamma))
    return min(m, 60 / ((2 - D) * np.log(gamma)) + pressed) <= 100


@pytest.mark.parametrize(("seed", "terms"), [(1, [1, 2, 3, 12, 13, 100]), (3, [np.inf])])
def test_compliance_and_resistance_are_their_sums_in_50_digits(seed, terms):
    cases = [case for case in extreme_cases(seed, 80, terms) if in_reach(case)]
    assert len(cases) > 15
    for case in cases:
        assert_sums(case)


def test_they_are_their_sums_at_the_ends_of_all_ranges():
    for case in [*filter(in_reach, CORNERS), (0.1, 1.99, 2.0, 400)]:  # most terms of the last one are a geometric sum
        assert_sums(case)


@pytest.mark.parametrize("series", SERIES[:-1])
def test_the_load_does_the_work_of_pressing_all_waves_flat(series):
    """The work of the load, int p dh, is the energy of full contact, sum g_n p_n*/4; for one wave Westergaard's."""
    D, gamma, m = series
    energy = (gamma ** ((2 * D - 3) * np.arange(m))).sum() / 4

    def integrand(log_p):
        return np.exp(2 * log_p) * float(persson.resistance(np.exp(log_p), *series))

    work, _ = quad(integrand, -25, (D - 1) * m * np.log(gamma) + 3, limit=400, epsabs=0)
    assert work == pytest.approx(energy, rel=1e-7)
    exact, _ = quad(lambda xi: xi * float(westergaard.resistance(xi)), 0, 1)
    assert exact == pytest.approx(0.25, rel=1e-9)


@pytest.mark.parametrize("p", [0.05, 0.5, 2.0])
def test_contact_fraction_solves_the_diffusion_equation(p):
    """Explicit steps of dP/ds = (V'/2) d2P/dsigma2 on a grid, absorbed at no pressure: what remains is in contact."""
    D, gamma, m = 1.5, 2.0, 4
    variance = (gamma ** (2 * (D - 1) * np.arange(m))).sum() / 2
    sigma, step = np.linspace(0, p + 8 * np.sqrt(variance), 1201, retstep=True)
    density = np.zeros(sigma.size)
    place = round(p / step)
    density[place] = 1 / step
    for _ in range(count := int(np.ceil(variance / (0.8 * step**2)))):
        density[1:-1] += variance / (2 * count * step**2) * np.diff(density, 2)
        density[[0, -1]] = 0
    assert persson.contact_fraction(sigma[place], D, gamma, m) == pytest.approx(density.sum() * step, abs=2e-4)


def test_area_is_full_under_heavy_loads_and_none_for_the_infinite_series():
    assert persson.contact_fraction(1e3, 1.25, 5, 3) == 1
    np.testing.assert_array_equal(persson.contact_fraction([0.1, 1e300], 1.25, 5, np.inf), 0)


def test_ensembles_by_contact_patches_agree_as_the_documentation_says():
    """D = 1.25, gamma = 5, m = 3, mean of 12 phases, from 0.1 to 2 p_0*: docs/persson.md and docs/cascade.md."""
    loads, solved = [0.1, 0.3, 0.6, 1.0, 2.0], []
    for seed in range(12):
        curve = solve(Profile(1.25, 5, 3, seed=seed), loads, method="patches", tolerance=1e-6)
        solved.append([curve.compliance.values, curve.resistance.values, curve.contact_fraction.values])
    h, R, area = np.mean(solved, axis=0)
    p = np.array(loads), 1.25, 5, 3
    np.testing.assert_allclose(persson.compliance(*p) - h, [0.0165, 0.0357, -0.0089, 0.0050, 0.0021], atol=1e-4)
    np.testing.assert_allclose(persson.resistance(*p) / R - 1, [0.26, -0.12, -0.04, 0.13, -0.19], atol=5e-3)
    np.testing.assert_allclose(
        persson.contact_fraction(*p) / area - 1, [-0.23, -0.17, -0.14, -0.10, -0.05], atol=5e-3
    )
    np.testing.assert_allclose(R / persson.resistance(*p), [0.79, 1.14, 1.04, 0.89, 1.24], atol=6e-3)
    of_2000 = [-0.16, -0.10, -0.08, -0.05, -0.02]
    np.testing.assert_allclose(cascade.contact_fraction(*p) / area - 1, of_2000, atol=6e-3)


def test_sums_without_an_end_in_reach_are_refused():
    near_one = Profile(1.5, "1000001/1000000", np.inf)
    with pytest.raises(NotApplicableError, match=f"more than {MAX_TERMS}: take a larger gamma"):
        solve(near_one, [0.1], method="persson")
    finite = solve(Profile(1.5, "1000001/1000000", 1000), [0.1, 1e4], method="persson")
    assert np.isfinite(finite.compliance).all()
