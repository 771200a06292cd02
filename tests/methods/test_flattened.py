"""Archard's and Demelio's approximations against sums in mpmath, their limits, and what any compliance obeys."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.extreme_series import ACCURACY, CORNERS, EPS, TINY, assert_sums, extreme_cases
from weier.methods import archard, demelio, westergaard
from weier.methods import multiprecision as exact
from weier.theory.series import full_contact_pressure, leading_amplitude, tail_amplitude

either = pytest.mark.parametrize("estimate", [archard, demelio])


against_sums = pytest.mark.parametrize(("estimate", "oracle"), [(archard, exact.archard), (demelio, exact.demelio)])


@against_sums
@pytest.mark.parametrize(("seed", "terms"), [(1, [1, 2, 3, 12, 13, 100]), (2, [1000]), (3, [np.inf])])
def test_both_follow_the_plain_sum(estimate, oracle, seed, terms):
    assert_sums(estimate, oracle, extreme_cases(seed, 60 if terms == [1000] else 300, terms))


@against_sums
def test_both_follow_the_plain_sum_in_every_corner(estimate, oracle):
    assert_sums(estimate, oracle, CORNERS)


@either
def test_full_contact_is_the_sum_of_amplitudes_without_resistance(estimate):
    m, heavy = np.array([1, 2, 5, 40]), np.array([1e300, 1e290, 1e280, 1e260])
    np.testing.assert_array_equal(estimate.compliance(heavy, 1.5, 5, m), leading_amplitude(m, 1.5, 5))
    np.testing.assert_array_equal(estimate.resistance(heavy, 1.5, 5, m), 0)


def test_demelio_flattens_the_last_wave_at_its_pressure():
    m = np.array([1, 2, 5, 40])
    flat = 5 ** (0.5 * (m - 1)) * 1.001  # just beyond p* of the last term
    np.testing.assert_array_equal(demelio.compliance(flat, 1.5, 5, m), leading_amplitude(m, 1.5, 5))
    np.testing.assert_array_equal(demelio.resistance(flat, 1.5, 5, m), 0)
    assert np.all(demelio.resistance(flat / 1.01, 1.5, 5, m) > 0)


def test_archard_flattens_all_waves_above_the_first_pressure_where_gamma_is_small():
    # gamma^(D-1) <= 2: the peak pressure of each wave exceeds p* of the next.
    np.testing.assert_array_equal(archard.compliance(1.01, 1.5, 3.9, np.inf), tail_amplitude(0, 1.5, 3.9))
    assert archard.resistance(1.01, 1.5, 3.9, np.inf) == 0


def test_archard_is_the_upper_estimate():
    # Archard loads every wave with the peak, not the mean, of the coarser one (Section 4.1).
    p = np.geomspace(1e-9, 10, 50)[:, None]
    m = [2, 3, 10, np.inf]
    assert np.all(archard.compliance(p, 1.25, 5, m) >= demelio.compliance(p, 1.25, 5, m) * (1 - 4 * EPS))


@against_sums
def test_resistance_is_the_derivative_of_compliance(estimate, oracle):
    for case in extreme_cases(4, 20, [1, 5, 30]):
        with mp.workdps(60):
            p, step = mp.mpf(case[0]), mp.mpf(case[0]) * mp.mpf(10) ** -20
            rise = oracle(p + step, *case[1:])[0] - oracle(p - step, *case[1:])[0]
            slope = float(rise / (2 * step))
        # The chord over 1e-20 p is exact to 1e-30; where R is nearly 0 its inputs leave it fewer digits.
        assert estimate.resistance(*case) == pytest.approx(slope, rel=1e-10, abs=TINY)


@either
def test_one_term_is_westergaard(estimate):
    p = np.geomspace(1e-300, 10, 1000)
    np.testing.assert_allclose(estimate.compliance(p, 1.3, 5, 1), westergaard.compliance(p), rtol=4 * EPS)
    np.testing.assert_allclose(estimate.resistance(p, 1.3, 5, 1), westergaard.resistance(p), rtol=4 * EPS)


@either
def test_longer_series_tend_to_the_limit(estimate):
    p = np.geomspace(1e-12, 1e3, 40)
    m = np.array([5, 10, 20, 40])[:, None]
    error = np.abs(estimate.compliance(p, 1.25, 5, m) - estimate.compliance(p, 1.25, 5, np.inf))
    assert np.all(error <= tail_amplitude(m, 1.25, 5) * (1 + 1e-12) + 4 * EPS)


@either
@pytest.mark.parametrize(
    "shapes",
    [
        [(), (), (), ()],
        [(7,), (), (), ()],
        [(), (7,), (), ()],
        [(7,), (3, 1), (), (3, 1)],
        [(7, 1), (3,), (), ()],
        [(7, 3), (3,), (), ()],
        [(2, 7, 1), (2, 1, 3), (3,), (1,)],
        [(7,), (7,), (7,), (7,)],
        [(0,), (), (), ()],
        [(3, 1), (0,), (), ()],
        [(0, 3), (3,), (), ()],
    ],
    ids=str,
)
def test_loads_and_series_of_any_shape(estimate, shapes):
    rng = np.random.default_rng(5)
    ends = [(-9, 9), (1.1, 1.9), (1.2, 50), (1, 9)]
    exponent, D, gamma, m = (rng.uniform(*end, shape) for end, shape in zip(ends, shapes, strict=True))
    p = np.broadcast_to(10**exponent, np.shape(exponent))  # not to be written to
    m = np.where(m > 8, np.inf, np.ceil(m))
    for function in (estimate.compliance, estimate.resistance):
        together = function(p, D, gamma, m)
        assert together.shape == np.broadcast_shapes(*shapes)
        for place in np.ndindex(together.shape):
            assert together[place] == function(*(each[place] for each in np.broadcast_arrays(p, D, gamma, m)))


@either
@pytest.mark.parametrize(("D", "gamma"), [(1.3, 5.0), (1.5, 4.0), (1.9, 2.5), (1.01, 1.3)])
def test_estimates_join_where_another_wave_is_pressed_flat(estimate, D, gamma):
    # p_n* in Demelio's approximation; in Archard's a load like any other.
    edge = full_contact_pressure(np.arange(1, 6), D, gamma)
    below, above = (estimate.compliance(edge * (1 + 1e-10 * side), D, gamma, 7) for side in (-1, 1))
    rise = 2e-10 * edge * estimate.resistance(edge, D, gamma, 7)
    np.testing.assert_allclose(above - below, rise, atol=8 * EPS * above.max(), rtol=1e-6)


@either
@pytest.mark.parametrize("load", [0.0, -1.0, np.nan])
def test_loads_that_mean_nothing_give_nan(estimate, load):
    for function in (estimate.compliance, estimate.resistance):
        assert np.isnan(function(load, 1.5, 5, [1, 20, np.inf])).all()
        among = function([0.1, load, 0.2, 30.0, load], 1.5, 5, 4)
        np.testing.assert_array_equal(np.isnan(among), [False, True, False, False, True])


@either
def test_a_load_without_end_presses_all_flat(estimate):
    np.testing.assert_allclose(estimate.compliance(np.inf, 1.5, 4, [1, 3, np.inf]), [1, 1.75, 2], rtol=2 * EPS)
    np.testing.assert_array_equal(estimate.resistance(np.inf, 1.5, 4, [1, 3, np.inf]), 0)


@either
@settings(max_examples=200, deadline=None, derandomize=True)
@given(
    st.floats(1e-9, 1 - 1e-9),
    st.floats(-6, 6),
    st.sampled_from([1, 3, 20, 300, np.inf]),
    st.lists(st.floats(-300, 300), min_size=3, max_size=20),
)
def test_compliance_rises_along_a_concave_curve_between_none_and_all(estimate, a, size, m, exponents):
    gamma = 1 + 10.0**size
    p = np.unique(10.0 ** np.array(exponents))
    h, R = estimate.compliance(p, 1 + a, gamma, m), estimate.resistance(p, 1 + a, gamma, m)
    assert np.all(h > 0)
    assert np.all(h <= leading_amplitude(m, 1 + a, gamma) * (1 + ACCURACY))
    assert np.all(R >= 0)
    assert np.all(np.diff(h) >= -ACCURACY * h[1:])
    assert np.all(np.diff(R) <= ACCURACY * R[:-1])
    chord = np.diff(h) / np.diff(p)
    slack = 2 * ACCURACY * h[1:] / np.diff(p)
    assert np.all(chord <= R[:-1] * (1 + ACCURACY) + slack)
    assert np.all(chord >= R[1:] * (1 - ACCURACY) - slack)
