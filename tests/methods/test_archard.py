"""Archard's recursion against its plain sum in mpmath, its limit, and what any compliance obeys."""

import numpy as np
import pytest

from tests.extreme_series import CORNERS, assert_sums, extreme_cases
from weier.methods import archard
from weier.methods import multiprecision as exact
from weier.theory.series import leading_amplitude, tail_amplitude


@pytest.mark.parametrize(("seed", "terms"), [(1, [1, 2, 3, 12, 13, 100]), (2, [1000]), (3, [np.inf])])
def test_both_follow_the_plain_sum(seed, terms):
    assert_sums(archard, exact.archard, extreme_cases(seed, 60 if terms == [1000] else 300, terms))


def test_both_follow_the_plain_sum_in_every_corner():
    assert_sums(archard, exact.archard, CORNERS)


def test_full_contact_is_the_sum_of_amplitudes_without_resistance():
    m = np.array([1, 2, 5, 40])
    heavy = np.array([1e300, 1e290, 1e280, 1e260])
    np.testing.assert_array_equal(archard.compliance(heavy, 1.5, 5, m), leading_amplitude(m, 1.5, 5))
    np.testing.assert_array_equal(archard.resistance(heavy, 1.5, 5, m), 0)


def test_the_infinite_series_is_flat_above_the_first_pressure_where_gamma_is_small():
    # gamma^(D-1) <= 2: the peak pressure of each wave exceeds p* of the next.
    np.testing.assert_array_equal(archard.compliance(1.01, 1.5, 3.9, np.inf), tail_amplitude(0, 1.5, 3.9))
    assert archard.resistance(1.01, 1.5, 3.9, np.inf) == 0
