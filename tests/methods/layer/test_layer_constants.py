"""Constants that decide how tables are found, not what they hold: a factor of two keeps their accuracy."""

import math

import numpy as np
import pytest

from weier import Profile
from weier.methods.layer import curve, fixed_point, scales, scaling_tables, wave

ACCURACY = 1e-5
LOADS = np.geomspace(1e-12, 3, 12)
SERIES = Profile(1.3, 3, math.inf), Profile(1.7, 2, 6)
CONSTANTS = [
    *((name, fixed_point) for name in ("TABLE_FRACTION", "MIN_ESTIMATED_LOAD", "MAX_GUESS_STEP", "MAX_STEP")),
    ("FLAT_MARGIN", fixed_point),
    ("CELL_LENGTH", scaling_tables),
    ("RESIDUAL_FRACTION", scales),
    ("GUESS_HALVINGS", wave),
]


def compliance(accuracy):
    return np.array([curve(series, LOADS, accuracy=accuracy).compliance for series in SERIES])


@pytest.fixture(scope="module")
def expected():
    """The compliance as it is, and on tables of a hundredth of the error."""
    return compliance(ACCURACY), compliance(1e-2 * ACCURACY)


@pytest.mark.parametrize(("name", "module"), CONSTANTS, ids=[name for name, _ in CONSTANTS])
def test_a_factor_of_two_keeps_the_accuracy(name, module, expected, monkeypatch):
    value, (default, exact), changes = getattr(module, name), expected, 0
    for factor in (0.5, 2.0):
        monkeypatch.setattr(module, name, type(value)(factor * value))
        found = compliance(ACCURACY)
        np.testing.assert_allclose(found, exact, rtol=1.01 * ACCURACY)
        changes += np.count_nonzero(found != default)
    assert changes > 0  # in the last digits: the constant is used
