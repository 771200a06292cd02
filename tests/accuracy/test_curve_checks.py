"""Each check passes on Westergaard's curve, and fails on what it is there to find."""

import numpy as np
import pytest

from weier import Profile
from weier.accuracy.curve_checks import check, within_stated_error
from weier.methods import westergaard

ONE, LOADS = Profile(1.25, 5, 1), np.geomspace(1e-6, 10, 30)
H, R = westergaard.compliance(LOADS), westergaard.resistance(LOADS)
DENTED = np.where(np.arange(30) == 12, H - 1e-3, H)
FALLING = np.where(np.arange(30) == 29, H[28] - 1e-3, H)
ALL = {"within_band", "monotone", "concave"}


def passed(h, slope, h_error=0.0, R_error=0.0):
    stated = np.stack([np.full(30, h_error), np.full(30, R_error)])
    return {name for name, holds in check("bem", ONE, LOADS, np.stack([h, slope]), stated).items() if holds}


@pytest.mark.parametrize(
    ("h", "slope", "expected"),
    [
        (H, R, ALL),
        (FALLING, R, set()),
        (DENTED, R, {"monotone"}),
        (H, R * 1.3, {"monotone"}),
        (H, R + 1, {"monotone"}),
    ],
)
def test_each_check_can_fail(h, slope, expected):
    assert passed(h, slope) == expected


def test_what_a_solution_is_off_is_allowed():
    assert passed(DENTED, R, 2e-3) == passed(FALLING, R, 2e-3) == ALL
    assert "concave" in passed(H, R * 1.3, R_error=0.4 * R.max())


def test_a_deviation_within_what_is_stated():
    deviation, stated, uncertainty = np.array([0.1, np.nan, 0.3]), np.array([0.1, 0.1, 0.2]), np.array([0, 0, 0.1])
    assert within_stated_error(deviation, stated, uncertainty)
    assert within_stated_error(deviation, stated, 0.9 * uncertainty) is False
    assert within_stated_error(deviation, stated * np.nan, uncertainty) is None
    assert within_stated_error(deviation * np.nan, stated, uncertainty) is None
