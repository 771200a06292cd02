"""Archard's recursion against its plain sum in mpmath, its limit, and what any compliance obeys."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from weier import archard, westergaard
from weier.profile import leading_amplitude, tail_amplitude

EPS = np.finfo(float).eps
TINY = np.finfo(float).tiny
ACCURACY = 1e-12


def plain_sum(p, D, gamma, m):
    """Compliance and resistance of m terms, one after the other; for m = inf until nothing changes in 40 digits.

    An endless run of flattened terms, and one of terms at the fixed point, are geometric series.
    """
    with mp.workdps(60):
        zeta, slope, D, gamma = mp.mpf(p), mp.mpf(1), mp.mpf(D), mp.mpf(gamma)
        g, falls, down = mp.mpf(1), gamma ** (D - 2), gamma ** (1 - D)
        h = R = mp.mpf(0)
        before, n = mp.inf, 0
        while n < m:
            if m == mp.inf and (
                (zeta >= 1 and 2 * down >= 1) or (zeta < 1 and abs(zeta - before) < mp.mpf(10) ** -40 * zeta)
            ):
                return h + term(zeta) * g / (1 - falls), R
            before = zeta
            h += g * term(zeta)
            if zeta >= 1:
                zeta, slope = down * (1 + zeta), down * slope
            else:
                R -= g * mp.log(zeta) * slope
                zeta, slope = 2 * down * mp.sqrt(zeta), down * slope / mp.sqrt(zeta)
            g *= falls
            n += 1
        return h, R


def term(zeta):
    return mp.mpf(1) if zeta >= 1 else zeta * (1 - mp.log(zeta))


def conditioning(oracle, part, p, D, gamma, m):
    """What half a unit in the last place of each input, and of the result, changes in the result, relative to it."""
    exact, total = oracle(p, D, gamma, m)[part], mp.mpf(EPS)
    with mp.workdps(60):
        step = mp.mpf(10) ** -25
        for i in range(3):
            nudged = [mp.mpf(p), mp.mpf(D), mp.mpf(gamma)]
            nudged[i] *= 1 + step
            total += EPS / 2 * abs(oracle(*nudged, m)[part] / exact - 1) / step
    return float(total)


def assert_accurate(computed, oracle, part, case):
    exact = oracle(*case)[part]
    if exact < TINY:
        assert 0 <= computed <= TINY  # doubles have no digits left
        return
    error = float(abs(mp.mpf(float(computed)) / exact - 1))
    if error > ACCURACY:
        # No double can do better than the rounding of its inputs: R near full contact is the logarithm of
        # nearly 1, and its slope with p, D and gamma is then what bounds the error.
        assert error <= conditioning(oracle, part, *case), case


def extreme_cases(seed, count, terms):
    """Draws that crowd at the ends of every range: D -> 1, 2; gamma -> 1, 1e6; p from 1e-300 to 1e300."""
    rng = np.random.default_rng(seed)
    near = 10 ** rng.uniform(-9, 0, count)
    D = np.choose(rng.integers(0, 3, count), [1 + near, 2 - near, rng.uniform(1, 2, count)])
    D = np.clip(D, 1 + 1e-9, 2 - 1e-9)
    gamma = np.where(rng.integers(0, 2, count), 10 ** rng.uniform(0, 6, count), 1 + 10 ** rng.uniform(-6, 0, count))
    reach = np.choose(rng.integers(0, 3, count), [300.0, 3.0, 0.01])
    p = 10 ** (reach * rng.uniform(-1, 1, count))
    return list(zip(p, D, gamma, rng.choice(terms, count), strict=True))


CORNERS = [
    (p, D, gamma, m)
    for p in (1e-300, 1e-9, 0.5, 1.0, 1 + EPS, 2.0, 1e300)
    for D in (1 + 1e-9, 1.5, 2 - 1e-9)
    for gamma in (1 + 1e-6, 2.0, 4.0, 1e6)  # D = 1.5, gamma = 4: the fixed point lies at zeta = 1
    for m in (1, 7, 1000, np.inf)
    if m != 1000 or D == 1.5
]


@pytest.mark.parametrize(("seed", "terms"), [(1, [1, 2, 3, 12, 13, 100]), (2, [1000]), (3, [np.inf])])
def test_both_follow_the_plain_sum(seed, terms):
    cases = extreme_cases(seed, 60 if terms == [1000] else 300, terms)
    h, R = archard.compliance(*np.transpose(cases)), archard.resistance(*np.transpose(cases))
    for case, compliance, resistance in zip(cases, h, R, strict=True):
        assert_accurate(compliance, plain_sum, 0, case)
        assert_accurate(resistance, plain_sum, 1, case)


def test_both_follow_the_plain_sum_in_every_corner():
    h, R = archard.compliance(*np.transpose(CORNERS)), archard.resistance(*np.transpose(CORNERS))
    for case, compliance, resistance in zip(CORNERS, h, R, strict=True):
        assert_accurate(compliance, plain_sum, 0, case)
        assert_accurate(resistance, plain_sum, 1, case)


def test_resistance_is_the_derivative_of_compliance():
    for case in extreme_cases(4, 20, [1, 5, 30]):
        with mp.workdps(60):
            p, step = mp.mpf(case[0]), mp.mpf(case[0]) * mp.mpf(10) ** -20
            rise = plain_sum(p + step, *case[1:])[0] - plain_sum(p - step, *case[1:])[0]
            slope = float(rise / (2 * step))
        # The chord over 1e-20 p is exact to 1e-40; where R is nearly 0 its inputs leave it fewer digits.
        assert archard.resistance(*case) == pytest.approx(slope, rel=1e-10, abs=TINY)


def test_one_term_is_westergaard():
    p = np.geomspace(1e-300, 10, 1000)
    np.testing.assert_allclose(archard.compliance(p, 1.3, 5, 1), westergaard.compliance(p), rtol=4 * EPS)
    np.testing.assert_allclose(archard.resistance(p, 1.3, 5, 1), westergaard.resistance(p), rtol=4 * EPS)


def test_full_contact_is_the_sum_of_amplitudes_without_resistance():
    m = np.array([1, 2, 5, 40])
    flat = np.array([1e300, 1e290, 1e280, 1e260])
    np.testing.assert_array_equal(archard.compliance(flat, 1.5, 5, m), leading_amplitude(m, 1.5, 5))
    np.testing.assert_array_equal(archard.resistance(flat, 1.5, 5, m), 0)


def test_endless_series_is_flat_above_the_first_pressure_where_gamma_is_small():
    # gamma^(D-1) <= 2: the peak pressure of each wave exceeds p* of the next.
    np.testing.assert_array_equal(archard.compliance(1.01, 1.5, 3.9, np.inf), tail_amplitude(0, 1.5, 3.9))
    assert archard.resistance(1.01, 1.5, 3.9, np.inf) == 0


def test_longer_series_tend_to_the_limit():
    p = np.geomspace(1e-12, 1e3, 40)
    m = np.array([5, 10, 20, 40])[:, None]
    error = np.abs(archard.compliance(p, 1.25, 5, m) - archard.compliance(p, 1.25, 5, np.inf))
    assert np.all(error <= tail_amplitude(m, 1.25, 5) * (1 + 1e-12) + 4 * EPS)


def test_all_arguments_broadcast():
    p = np.geomspace(1e-6, 100, 5)[:, None, None, None]
    D, gamma, m = np.array([1.1, 1.9])[:, None, None], np.array([1.5, 5, 50.0])[:, None], [1, 4, 30, np.inf]
    for function in (archard.compliance, archard.resistance):
        together = function(p, D, gamma, m)
        assert together.shape == (5, 2, 3, 4)
        apart = np.vectorize(function)(p, D, gamma, m)
        np.testing.assert_array_equal(together, apart)


@pytest.mark.parametrize("load", [0.0, -1.0, np.nan])
def test_loads_that_mean_nothing_give_nan(load):
    assert np.isnan(archard.compliance(load, 1.5, 5, [1, 20, np.inf])).all()
    assert np.isnan(archard.resistance(load, 1.5, 5, [1, 20, np.inf])).all()


@settings(max_examples=200, deadline=None, derandomize=True)
@given(
    st.floats(1e-9, 1 - 1e-9),
    st.floats(-6, 6),
    st.sampled_from([1, 3, 20, 300, np.inf]),
    st.lists(st.floats(-300, 300), min_size=3, max_size=20),
)
def test_compliance_rises_along_a_concave_curve_between_none_and_all(a, size, m, exponents):
    gamma = 1 + 10.0**size
    p = np.unique(10.0 ** np.array(exponents))
    h, R = archard.compliance(p, 1 + a, gamma, m), archard.resistance(p, 1 + a, gamma, m)
    assert np.all(h > 0)
    assert np.all(h <= leading_amplitude(m, 1 + a, gamma) * (1 + ACCURACY))
    assert np.all(R >= 0)
    assert np.all(np.diff(h) >= -ACCURACY * h[1:])
    assert np.all(np.diff(R) <= ACCURACY * R[:-1])
    chord = np.diff(h) / np.diff(p)
    slack = 2 * ACCURACY * h[1:] / np.diff(p)
    assert np.all(chord <= R[:-1] * (1 + ACCURACY) + slack)
    assert np.all(chord >= R[1:] * (1 - ACCURACY) - slack)
