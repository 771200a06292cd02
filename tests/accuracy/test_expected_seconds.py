"""Seconds over those expected."""

from weier.accuracy import expected_seconds
from weier.methods.registry import find_method


def test_expected_seconds_stand_beside_those_of_few_waves():
    surfaces = list(expected_seconds.surfaces(100))
    assert [profile.waves_per_period[-1] for _, profile in surfaces] == [25, 64, 81, 100, 100]
    name, waves, method, seconds, ratio = expected_seconds.row(*surfaces[0], find_method("bem"))
    assert (name, waves, method) == ("D = 1.25, gamma = 5, m = 3", "25", "bem")
    assert all(float(value) >= 0 for value in seconds.split(" / "))
    assert float(ratio) > 0
