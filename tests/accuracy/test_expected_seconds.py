"""Seconds over those expected."""

import pytest

from weier.accuracy import expected_seconds
from weier.methods.registry import find_method


def test_surfaces_have_at_most_as_many_waves_or_infinitely_many():
    finite = [profile for name, profile in expected_seconds.surfaces(100) if "inf" not in name]
    assert [profile.waves_per_period[-1] for profile in finite] == [25, 64, 81, 100, 100]


@pytest.mark.parametrize(("method", "m"), [("bem", "3"), ("layer", "inf"), ("hybrid", "inf")])
def test_expected_seconds_stand_beside_those_measured(method, m):
    name = f"D = 1.25, gamma = 5, m = {m}"
    surface = dict(expected_seconds.surfaces(25))[name]
    what, waves, by, seconds, ratio = expected_seconds.row(name, surface, find_method(method))
    assert (what, waves, by) == (name, {"3": "25", "inf": "inf"}[m], method)
    assert all(float(value) >= 0 for value in seconds.split(" / "))
    assert float(ratio) > 0
