"""Constants of the closed forms and estimates that set the cost or a range: other values change no result."""

import math

import numpy as np
import pytest

from weier import Profile
from weier.methods import archard, cascade, flattened, persson
from weier.methods.registry import find_method

# another value, and the relative difference of h and R, or of the contact fraction, that it may make
CONSTANTS = [
    ("archard", archard, "TERMS", 24, 1e-13),  # the expansion ends below rounding
    ("archard", flattened, "INFINITE_TERMS", 1e200, 0.0),
    ("demelio", flattened, "INFINITE_TERMS", 1e200, 0.0),
    ("persson", persson, "MAX_VALUES", 100, 1e-15),  # loads in many arrays
    ("cascade", cascade, "MAX_LOG_LOAD", math.log(1e8), 1e-4),
]


@pytest.mark.parametrize(("method", "owner", "name", "other", "accuracy"), CONSTANTS)
@pytest.mark.parametrize("m", [4, math.inf])
def test_another_value_changes_no_result(method, owner, name, other, accuracy, m, monkeypatch):
    # gamma^(D-1) > 2: Archard's recursion has a fixed point below full contact, about which it is expanded.
    loads = np.geomspace(1e-9, 1e7, 40)
    usual = find_method(method).solve(Profile(1.6, 5, m), loads).values()
    monkeypatch.setattr(owner, name, other)
    changed = find_method(method).solve(Profile(1.6, 5, m), loads).values()
    for quantity, values in usual.items():
        np.testing.assert_allclose(changed[quantity], values, rtol=accuracy, atol=1e-15, err_msg=quantity)
