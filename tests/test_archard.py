"""Archard's recursion against its plain sum in mpmath, its limit, and what any compliance obeys."""

import mpmath as mp
import numpy as np
import pytest

from tests.closed_forms import CORNERS, assert_accurate, extreme_cases
from weier import archard
from weier.profile import leading_amplitude, tail_amplitude


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


def test_full_contact_is_the_sum_of_amplitudes_without_resistance():
    m = np.array([1, 2, 5, 40])
    flat = np.array([1e300, 1e290, 1e280, 1e260])
    np.testing.assert_array_equal(archard.compliance(flat, 1.5, 5, m), leading_amplitude(m, 1.5, 5))
    np.testing.assert_array_equal(archard.resistance(flat, 1.5, 5, m), 0)


def test_endless_series_is_flat_above_the_first_pressure_where_gamma_is_small():
    # gamma^(D-1) <= 2: the peak pressure of each wave exceeds p* of the next.
    np.testing.assert_array_equal(archard.compliance(1.01, 1.5, 3.9, np.inf), tail_amplitude(0, 1.5, 3.9))
    assert archard.resistance(1.01, 1.5, 3.9, np.inf) == 0
