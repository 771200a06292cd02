"""Loads that cannot be, refused by every way to solve."""

import warnings

import numpy as np
import pytest

import weier
from weier.methods import patches

PROFILE = weier.Profile(1.25, 5, 2, 1.0)


def test_loads_come_back_in_the_order_given_and_are_solved_once():
    """The same bits as those of the loads in order."""
    given = [1.0, 0.1, 1.0, 0.3]
    solved = weier.solve(PROFILE, given, "demelio")
    in_order = weier.solve(PROFILE, [0.1, 0.3, 1.0], "demelio")
    assert solved.mean_pressure.values.tolist() == given
    assert solved.compliance.values.tolist() == in_order.compliance.sel(mean_pressure=given).values.tolist()
    several = weier.solve([PROFILE], given, ["demelio", "archard"])
    assert several.compliance.values[0, 0].tolist() == solved.compliance.values.tolist()


def test_loads_in_pa_and_phases_in_degrees_are_doubted():
    with pytest.warns(UserWarning, match=r"all loads lie far beyond full contact, which takes .* p_0\*"):
        weier.solve(PROFILE, [1e7], "demelio")
    for phases in ((0, 5, 180), (0, 90, 1), (1, -360, 0), 7.0, (7200, 0, 7200)):
        with pytest.warns(UserWarning, match="exceed 2 pi, got .*: phases are in radians"):
            weier.Profile(1.25, 5, 3, phases)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        weier.solve(PROFILE, [1e-3, 1e7], "demelio")  # one load that shows full contact
        weier.Profile(1.25, 5, 3, (0, 7, 1))
        weier.Profile(1.25, 5, 3, (0, 0.5 - 20 * np.pi, 1))
        weier.Profile(1.25, 5, 3, (0, 2 * np.pi, -2 * np.pi))
        weier.Profile(1.25, 5, 3, np.radians([0, 360, 180]))


@pytest.mark.parametrize(
    ("loads", "message"),
    [
        ([], "list of loads"),
        ([0.0, 1.0], "positive, got 0.0 at position 0"),
        ([0.1, np.nan], "finite, got nan at position 1"),
        ([0.2, 0.1], "increase, got 0.2 before 0.1: sort the loads"),
        ([0.1, 0.1], "got 0.1 at positions 0 and 1: give each load once"),
    ],
)
def test_bad_loads_are_refused(loads, message):
    with pytest.raises(ValueError, match=message):
        patches.curve(PROFILE, loads)
