"""Each check passes on Westergaard's curve, and fails on what it is there to find."""

import numpy as np
import pytest

from weier import Profile
from weier.accuracy.extremes import curve_checks
from weier.methods import westergaard

ONE, LOADS = Profile(1.25, 5, 1), np.geomspace(1e-6, 10, 30)
NONE = curve_checks.Stated(np.zeros(30), np.zeros(30))


@pytest.fixture
def curve():
    return westergaard.compliance(LOADS), westergaard.resistance(LOADS)


def test_westergaards_curve_passes(curve):
    assert curve_checks.monotone(curve[0], 1e-12, NONE)
    assert curve_checks.concave(LOADS, *curve, curve_checks.ROUNDING, 1.0, NONE)
    assert curve_checks.within_band(ONE, LOADS, *curve, curve_checks.ROUNDING, NONE)


def test_each_check_can_fail(curve):
    h, R = curve
    dented = np.where(np.arange(30) == 12, h - 1e-3, h)
    assert not curve_checks.monotone(np.where(np.arange(30) == 29, 0.9, h), 1e-12, NONE)
    assert not curve_checks.concave(LOADS, dented, R, curve_checks.ROUNDING, 1.0, NONE)
    assert not curve_checks.concave(LOADS, h, R * 1.3, curve_checks.ROUNDING, 1.0, NONE)
    assert not curve_checks.within_band(ONE, LOADS, dented, R, curve_checks.ROUNDING, NONE)
    assert not curve_checks.within_band(ONE, LOADS, h, R + 1, curve_checks.ROUNDING, NONE)


def test_what_a_solution_is_off_is_allowed(curve):
    dented = np.where(np.arange(30) == 12, curve[0] - 1e-3, curve[0])
    stated = curve_checks.Stated(np.full(30, 2e-3), np.zeros(30))
    assert curve_checks.within_band(ONE, LOADS, dented, curve[1], curve_checks.ROUNDING, NONE, 2e-3)
    assert curve_checks.monotone(np.where(np.arange(30) == 29, curve[0][28] - 1e-3, curve[0]), 1e-12, stated)
    assert curve_checks.concave(LOADS, dented, curve[1], curve_checks.ROUNDING, 1.0, stated)
    of_slope = curve_checks.Stated(np.zeros(30), 0.4 * curve[1])
    assert curve_checks.concave(LOADS, curve[0], curve[1] * 1.3, curve_checks.ROUNDING, 1.0, of_slope)


def test_a_deviation_within_what_is_stated():
    deviation, stated, uncertainty = np.array([0.1, np.nan, 0.3]), np.array([0.1, 0.1, 0.2]), np.array([0, 0, 0.1])
    assert curve_checks.within_stated_error(deviation, stated, uncertainty)
    assert curve_checks.within_stated_error(deviation, stated, 0.9 * uncertainty) is False
    assert curve_checks.within_stated_error(deviation, stated * np.nan, uncertainty) is None
    assert curve_checks.within_stated_error(deviation * np.nan, stated, uncertainty) is None
