"""Demelio's closed form against its plain sum in mpmath, its limit, and what any compliance obeys."""

import mpmath as mp
import numpy as np
import pytest

from tests.closed_forms import CORNERS, EPS, assert_accurate, extreme_cases
from weier import archard, demelio
from weier.profile import leading_amplitude


def plain_sum(p, D, gamma, m):
    """Compliance and resistance of m terms, one after the other."""
    with mp.workdps(60):
        xi, D, gamma = mp.mpf(p), mp.mpf(D), mp.mpf(gamma)
        weight, g, falls, down = mp.mpf(1), mp.mpf(1), gamma ** (D - 2), gamma ** (1 - D)
        h = R = mp.mpf(0)
        for _ in range(int(m)):
            if xi >= 1:
                h += g
            else:
                h += g * xi * (1 - mp.log(xi))
                R -= weight * mp.log(xi)
            xi, g, weight = xi * down, g * falls, weight / gamma
        return h, R


def endless_sum(p, D, gamma, m=np.inf):
    """(26) in 60 digits, scaled by the first term that is not flattened."""
    with mp.workdps(60):
        p, D, gamma = mp.mpf(p), mp.mpf(D), mp.mpf(gamma)
        before = max(mp.floor(mp.log(p) / ((D - 1) * mp.log(gamma))) + 1, 0)
        g = gamma ** ((D - 2) * before)
        xi = p * gamma ** ((1 - D) * before)
        slope = gamma / (gamma - 1) * (-mp.log(xi) + (D - 1) * mp.log(gamma) / (gamma - 1))
        h = (1 - g) / (1 - gamma ** (D - 2)) + g * xi * (slope + gamma / (gamma - 1))
        return h, gamma**-before * slope


def test_the_oracle_of_the_limit_is_the_limit_of_the_plain_sum():
    for p in (1e-5, 0.9, 1.0, 30.0):
        for limit, total in zip(endless_sum(p, 1.3, 4), plain_sum(p, 1.3, 4, 100), strict=True):
            assert abs(limit / total - 1) < 1e-20


@pytest.mark.parametrize(("seed", "terms"), [(1, [1, 2, 3, 12, 100]), (2, [1000]), (3, [np.inf])])
def test_both_follow_the_plain_sum(seed, terms):
    cases = extreme_cases(seed, 40 if terms == [1000] else 300, terms)
    oracle = endless_sum if terms == [np.inf] else plain_sum
    h, R = demelio.compliance(*np.transpose(cases)), demelio.resistance(*np.transpose(cases))
    for case, compliance, resistance in zip(cases, h, R, strict=True):
        assert_accurate(compliance, oracle, 0, case)
        assert_accurate(resistance, oracle, 1, case)


def test_both_follow_the_plain_sum_in_every_corner():
    h, R = demelio.compliance(*np.transpose(CORNERS)), demelio.resistance(*np.transpose(CORNERS))
    for case, compliance, resistance in zip(CORNERS, h, R, strict=True):
        oracle = endless_sum if case[3] == np.inf else plain_sum
        assert_accurate(compliance, oracle, 0, case)
        assert_accurate(resistance, oracle, 1, case)


def test_full_contact_is_the_sum_of_amplitudes_without_resistance():
    m = np.array([1, 2, 5, 40])
    flat = 5 ** (0.5 * (m - 1)) * 1.001  # just beyond p* of the last term
    np.testing.assert_array_equal(demelio.compliance(flat, 1.5, 5, m), leading_amplitude(m, 1.5, 5))
    np.testing.assert_array_equal(demelio.resistance(flat, 1.5, 5, m), 0)
    assert np.all(demelio.resistance(flat / 1.01, 1.5, 5, m) > 0)


def test_archard_is_the_upper_estimate():
    # Archard loads every wave with the peak, not the mean, of the coarser one (Section 4.1).
    p = np.geomspace(1e-9, 10, 50)[:, None]
    m = [2, 3, 10, np.inf]
    assert np.all(archard.compliance(p, 1.25, 5, m) >= demelio.compliance(p, 1.25, 5, m) * (1 - 4 * EPS))
