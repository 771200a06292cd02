"""The theory of 2000 against one wave, nested integrals, its closed form, the balance of load, and patches."""

import math

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad

from tests import westergaard as fields
from weier import NotApplicableError, Profile, solve
from weier.methods import cascade, westergaard

LOADS = np.array([0.01, 0.1, 1.0])


@pytest.mark.parametrize("xi", [1e-300, 0.1, 0.7, 1.0, 1.3])
def test_one_wave_is_westergaards_solution(xi):
    assert cascade.contact_fraction(xi, 1.5, 2, 1) == pytest.approx(
        2 * westergaard.contact_half_width(xi), rel=1e-14, abs=0
    )
    pressures = fields.pressure((np.arange(10**5) + 0.5) / 10**5, xi)
    for value in (0.05, 0.3, 1.0, 2.2):
        assert cascade.exceedance(value, xi, 1.5, 2, 1) == pytest.approx((pressures > value).mean(), abs=2e-5)


def pressure(y, xi):
    """Eq. (10) in y = pi x, as it is printed, and its continuation to full contact."""
    if xi >= 1:
        return xi + mp.cos(2 * y)
    sine = mp.sqrt(xi)  # of the edge
    return 2 * xi * mp.cos(y) / sine**2 * mp.sqrt(max(sine**2 - mp.sin(y) ** 2, 0))


def nested(xi, shrink, waves):
    """The fraction by nested integrals; they are split where the next wave comes into full contact."""
    if waves == 1:
        return 2 / mp.pi * mp.asin(mp.sqrt(min(xi, 1)))
    edge = mp.asin(mp.sqrt(xi)) if xi < 1 else mp.pi / 2
    splits = []
    if shrink * pressure(mp.mpf(0), xi) > 1 > shrink * pressure(edge, xi):
        splits.append(mp.findroot(lambda y: shrink * pressure(y, xi) - 1, (0, edge), solver="anderson", tol=1e-24))
    return 2 / mp.pi * mp.quad(lambda y: nested(shrink * pressure(y, xi), shrink, waves - 1), [0, *splits, edge])


@pytest.mark.parametrize(("D", "gamma"), [(1.25, 5), (1.5, 2), (1.9, 10)])
@pytest.mark.parametrize("p", [1e-6, 0.1, 0.6, 1.7])
def test_two_waves_are_an_integral_in_mpmath(D, gamma, p):
    exact = nested(mp.mpf(p), mp.mpf(gamma) ** (1 - mp.mpf(D)), 2)
    assert cascade.contact_fraction(p, D, gamma, 2) == pytest.approx(float(exact), rel=1e-9, abs=0)


@pytest.mark.parametrize(("D", "gamma", "p"), [(1.25, 5, 0.1), (1.5, 2, 0.4), (1.5, 2, 0.55), (1.5, 5, 2.0)])
def test_three_waves_are_a_nested_integral(D, gamma, p):
    shrink = gamma ** (1 - D)

    def finer(y):
        return float(cascade.contact_fraction(shrink * float(pressure(y, p)), D, gamma, 2))

    edge = math.asin(math.sqrt(min(p, 1)))
    exact = 2 / math.pi * quad(finer, 0, edge, limit=400, epsrel=1e-8)[0]
    assert cascade.contact_fraction(p, D, gamma, 3) == pytest.approx(exact, rel=2e-5, abs=0)


@pytest.mark.parametrize(("D", "gamma", "m", "p"), [(1.25, 5, 2, 0.05), (1.5, 2, 3, 3.0)])
def test_the_pressures_carry_the_load(D, gamma, m, p):
    """The mean pressure is the integral of the fraction above each pressure."""
    top = p + sum(gamma ** ((D - 1) * n) for n in range(m))
    t = top * np.linspace(0, 1, 120) ** 2
    fractions = [float(cascade.exceedance(value, p, D, gamma, m)) for value in t]
    assert np.all(np.diff(fractions) <= 1e-6)
    assert fractions[0] == cascade.contact_fraction(p, D, gamma, m)
    assert np.trapezoid(fractions, t) == pytest.approx(p, rel=3e-3)  # by the trapezoidal rule


def test_the_area_of_a_long_series_falls_by_gamma_to_the_1_minus_d_a_term():
    m = np.array([40, 41, 80, 10**6])
    found = np.array([cascade.contact_fraction(LOADS, 1.5, 2, terms) for terms in m[:3]])
    np.testing.assert_allclose(found[1] / found[0], 2**-0.5, rtol=1e-4)
    np.testing.assert_allclose(found[2] / found[0], 2**-20.0, rtol=1e-3)
    np.testing.assert_allclose(found[0] / LOADS / found[0][0] * LOADS[0], 1, rtol=1e-3)  # and is linear in the load
    assert cascade.contact_fraction(0.1, 1.5, 2, 10**6) == 0
    np.testing.assert_array_equal(cascade.contact_fraction(LOADS, 1.5, 2, math.inf), 0)


def test_contact_is_full_from_the_sum_of_all_full_contact_pressures_on():
    total = sum(5 ** (0.25 * n) for n in range(4))
    almost, full, heavy = cascade.contact_fraction(np.array([0.99 * total, (1 + 1e-15) * total, 1e300]), 1.25, 5, 4)
    assert 0.99 < almost < 1
    assert (full, heavy) == (1, 1)
    # 50 waves are flat under this load, and the others bear it as a series of their own
    p = 1e4 * 5 ** (0.25 * 50)
    assert cascade.contact_fraction(p, 1.25, 5, 90) == pytest.approx(
        cascade.contact_fraction(1e4, 1.25, 5, 40), rel=1e-4
    )


@pytest.mark.parametrize("series", [(1.25, 5, 3), (1.5, 2, 4), (1.25, 1.5, 4), (1.9, 10, 6), (1.5, 2, 60)])
def test_finer_tables_change_less_than_their_accuracy(series, monkeypatch):
    p = np.geomspace(1e-4, 5e3, 40)
    usual = cascade.contact_fraction(p, *series)
    monkeypatch.setattr(cascade, "SPACING", cascade.SPACING / 2)
    monkeypatch.setattr(cascade, "QUADRATURE", cascade.tanh_sinh(81))
    monkeypatch.setattr(cascade, "KINK_OFFSETS", np.geomspace(1e-8, 0.06, 60))
    monkeypatch.setattr(cascade, "CONVERGENCE_TOLERANCE", 1e-9)
    change = np.abs(cascade.contact_fraction(p, *series) / usual - 1).max()
    assert change < (3e-4 if series[-1] > 10 else 1e-4)


def test_series_that_take_too_many_tables_are_refused():
    near_one = Profile(1.1, "11/10", 10**4)
    with pytest.raises(NotApplicableError, match="more than 200: take fewer terms"):
        solve(near_one, [0.1], "cascade")
    assert solve(Profile(1.5, "101/100", 30), [0.1], "cascade").contact_fraction[0] > 0
    assert solve(Profile(1.5, "101/100", math.inf), [0.1], "cascade").contact_fraction[0] == 0
