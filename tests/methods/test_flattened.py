"""Archard's and Demelio's approximations against sums in mpmath, and at their limits."""

import numpy as np
import pytest

from tests.extreme_series import CORNERS, EPS, assert_sums, extreme_cases
from weier.accuracy import multiprecision as exact
from weier.methods import archard, demelio

either = pytest.mark.parametrize("estimate", [archard, demelio])


against_sums = pytest.mark.parametrize(("estimate", "oracle"), [(archard, exact.archard), (demelio, exact.demelio)])


@against_sums
@pytest.mark.parametrize(("seed", "terms"), [(1, [1, 2, 3, 12, 13, 100]), (2, [1000]), (3, [np.inf])])
def test_both_estimates_are_their_sums_in_50_digits(estimate, oracle, seed, terms):
    assert_sums(estimate, oracle, extreme_cases(seed, 20 if terms == [1000] else 60, terms))


@against_sums
def test_both_estimates_are_their_sums_at_the_ends_of_all_ranges(estimate, oracle):
    assert_sums(estimate, oracle, CORNERS)


@either
def test_loads_and_series_broadcast(estimate):
    arguments = np.geomspace(1e-9, 1e9, 7)[:, None], np.array([1.1, 1.5, 1.9]), 4.0, np.array([[[1]], [[np.inf]]])
    for function in (estimate.compliance, estimate.resistance):
        together = function(*arguments)
        for place in np.ndindex((2, 7, 3)):
            assert together[place] == function(*(argument[place] for argument in np.broadcast_arrays(*arguments)))
        assert function([], 1.5, 4, 3).shape == (0,)


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
