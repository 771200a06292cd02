"""Deviation, digits, and who is on the front."""

import mpmath as mp
import numpy as np
import pytest
import xarray as xr

from weier.accuracy.metrics import STATED, deviation, digits, pareto, worst_over_loads


def test_correct_digits_run_from_none_to_all_that_a_double_has():
    values = np.array([1.0, 1.001, 2.0, np.nan, 0.0, 1e-320, 1e-3])
    right = [mp.mpf(1), mp.mpf(1), mp.mpf(1), mp.mpf(1), mp.mpf(0), mp.mpf(10) ** -400, mp.mpf(0)]
    np.testing.assert_allclose(digits(values, right), [16, 3, 0, np.nan, 16, 16, 0], atol=1e-12)


def test_deviation_is_from_all_digits_of_what_is_right():
    third = mp.mpf(1) / 3
    with mp.workdps(50):
        assert deviation(np.array([1 / 3, np.nan]), [mp.mpf(1) / 3, third])[0] == pytest.approx(2**-54 / 3, rel=1e-10)
    assert np.isnan(deviation(np.array([np.nan, 1.0]), [third, mp.nan])).all()
    assert deviation(np.array([1.5]), np.array([1.0])).tolist() == [0.5]


@pytest.mark.parametrize(
    ("cost", "error", "front"),
    [
        ([1, 2, 3], [3, 2, 1], [0, 1, 2]),
        ([1, 2, 3], [1, 2, 0.5], [0, 2]),
        ([3, 2, 1], [1, 1, 1], [2]),
        ([1, np.nan, 2], [2, 0, np.nan], [0]),
        ([1, 1], [2, 1], [1]),
    ],
)
def test_the_front_is_what_nothing_beats(cost, error, front):
    assert pareto(np.array(cost, float), np.array(error, float)) == front


def test_errors_of_the_resistance_are_relative_to_the_larger_of_itself_and_one():
    rows = ("case", "variant", "mean_pressure")
    data = xr.Dataset(
        {
            "resistance_deviation": (rows, [[[0.2, 0.1, 0.0], [2.0, np.nan, 0.0], [np.nan, np.nan, np.nan]]]),
            "resistance_error": (rows, [[[0.4, 0.2, 0.0], [np.nan, np.nan, np.nan], [np.nan, np.nan, np.nan]]]),
            "reference_resistance": (("case", "mean_pressure"), [[4.0, 0.5, 0.0]]),
        }
    )
    assert worst_over_loads(data, "resistance")[0] == pytest.approx([0.1, 0.5, np.nan], nan_ok=True)
    assert worst_over_loads(data, "resistance", STATED)[0] == pytest.approx([0.2, np.nan, np.nan], nan_ok=True)
