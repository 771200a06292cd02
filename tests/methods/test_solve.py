"""Loads that cannot be, refused by every way to solve."""

from functools import partial

import numpy as np
import pytest

import weier
from weier.methods import bem, patches

PROFILE = weier.Profile(1.25, 5, 2, 1.0)
LOADS = np.array([0.01, 0.1, 1.0])


@pytest.mark.parametrize("curve", [weier.solve, bem.curve, partial(bem.curve, solver="direct"), patches.curve])
@pytest.mark.parametrize(
    ("loads", "message"),
    [
        ([], "list of loads"),
        ([[1.0]], "list of loads"),
        ([0.0, 1.0], "positive, got 0.0 at position 0"),
        ([0.1, np.nan], "finite, got nan at position 1"),
        ([0.1, np.inf], "finite"),
        ([0.2, 0.1], "increase, got 0.2 before 0.1: sort the loads"),
        ([9.0, 0.1], "increase, got 9.0 before 0.1"),  # the one is known without a solver
        ([0.1, 0.1], "got 0.1 at positions 0 and 1: give each load once"),
    ],
)
def test_bad_loads_are_refused(curve, loads, message):
    with pytest.raises(ValueError, match=message):
        curve(PROFILE, loads)
