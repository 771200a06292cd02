"""Loads that cannot be, and those that are probably in another unit."""

import numpy as np
import pytest

from weier import Profile
from weier.surface.loads import check_range, checked_load, checked_loads, listed_loads, unit_doubt

TWO_WAVES = Profile(1.25, 5, 2, 1.0)  # in full contact under 1 + 5^(1/4) = 2.495 p_0* at most


@pytest.mark.parametrize(
    ("loads", "message"),
    [
        ([], r"list of loads, got an array of shape \(0,\)"),
        ([[0.1, 0.2]], r"list of loads, got an array of shape \(1, 2\)"),
        ([0.0, 1.0], "positive, got 0.0 at position 0"),
        ([0.1, np.nan], "finite, got nan at position 1"),
        ([0.2, 0.1], "increase, got 0.2 before 0.1: sort the loads"),
        ([0.1, 0.1], "got 0.1 at positions 0 and 1: give each load once"),
    ],
)
def test_bad_loads_are_refused(loads, message):
    with pytest.raises(ValueError, match=message):
        checked_loads(loads)


def test_loads_in_any_order_are_listed_once():
    loads, position = listed_loads([1.0, 0.1, 1.0, 0.3])
    assert (loads.tolist(), position.tolist()) == ([0.1, 0.3, 1.0], [2, 0, 2, 1])


def test_one_load_is_positive_and_finite():
    assert checked_load(1e-300) == 1e-300
    for load in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(ValueError, match="must be one load, positive and finite"):
            checked_load(load)


@pytest.mark.parametrize(
    ("loads", "is_doubted"),
    [([250.0, 1e7], True), ([249.0, 1e7], False), ([1e7], True), ([1e13], True), ([2e13], False)],
)
def test_loads_from_a_hundred_times_full_contact_on_are_probably_in_pascal(loads, is_doubted):
    assert ("which takes 2.5 p_0* at most" in unit_doubt(TWO_WAVES, np.array(loads))) == is_doubted
    assert unit_doubt(Profile(1.25, 5, np.inf), np.array(loads)) == ""
    for in_pascal, remedy in ((False, "weier.Interface converts them"), (True, "is the unit right of the pressures")):
        assert (remedy in unit_doubt(TWO_WAVES, np.array(loads), in_pascal)) == is_doubted


def test_scenes_have_loads_of_which_rounding_leaves_digits():
    check_range(np.array([1e-12, 1e12]))
    check_range(np.array([1e-13, 1e13]), "Pa")
    for wrong, unit in (([9e-13, 1.0], "p_0*"), ([1.0, 1.1e12], "p_0*"), ([1.1e13], "Pa")):
        with pytest.raises(ValueError, match="loads must lie in"):
            check_range(np.array(wrong), unit)
