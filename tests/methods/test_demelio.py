"""Demelio's closed form against its plain sum in mpmath, its limit, and what any compliance obeys."""

import numpy as np
import pytest

from tests.extreme_series import CORNERS, EPS, assert_sums, extreme_cases
from weier.methods import archard, demelio
from weier.methods import multiprecision as exact
from weier.theory.series import leading_amplitude


@pytest.mark.parametrize(("seed", "terms"), [(1, [1, 2, 3, 12, 100]), (2, [1000]), (3, [np.inf])])
def test_both_follow_the_plain_sum(seed, terms):
    assert_sums(demelio, exact.demelio, extreme_cases(seed, 40 if terms == [1000] else 300, terms))


def test_both_follow_the_plain_sum_in_every_corner():
    assert_sums(demelio, exact.demelio, CORNERS)


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
