"""What a solve is said to cost before it is begun."""

from dataclasses import replace

import numpy as np
import pytest

from weier.methods import registry
from weier.methods.errors import OutOfReachError
from weier.methods.registry import find_method
from weier.pipeline.forecast import LONG, MAX_SECONDS, forecast
from weier.scene import Case

LOADS = np.geomspace(1e-3, 4, 40)


def case(method, m, settings=None):
    return Case({"D": 1.25, "gamma": 5, "m": m}, (method,), settings or {})


@pytest.fixture
def seconds(monkeypatch):
    """The cost model of contact patches, as a function that says what it is told to."""

    def expect(value):
        changed = replace(find_method("patches"), seconds=lambda profile, loads: value)
        methods = tuple(changed if each.name == "patches" else each for each in registry.METHODS)
        monkeypatch.setattr(registry, "METHODS", methods)

    return expect


def test_short_solves_are_not_announced(seconds):
    seconds(LONG / 2)
    assert forecast(case("patches", 3), LOADS) == []


def test_long_ones_are_with_seconds_memory_and_what_is_cheaper(seconds):
    seconds(2 * LONG)
    (line,) = forecast(case("patches", 3), LOADS)
    assert line.startswith("patches may take up to 60 s and ")
    assert " MB: method 'planned' takes about " in line


def test_what_would_take_a_day_is_refused_unless_settings_are_chosen(seconds):
    seconds(2 * MAX_SECONDS)
    with pytest.raises(ValueError, match=r"got 'patches', which may take 2e\+05 s for D = 1\.25.*method 'planned'"):
        forecast(case("patches", 3), LOADS)
    assert forecast(case("patches", 3, {"patches": {"residual_tolerance": 1e-6}}), LOADS) == []


def test_where_no_plan_is_within_reach_the_fast_methods_are_named(seconds, monkeypatch):
    seconds(2 * LONG)

    def refuse(profile, loads):
        raise OutOfReachError("none")

    monkeypatch.setattr("weier.pipeline.forecast.plan", refuse)
    (line,) = forecast(case("patches", 3), LOADS)
    assert line.endswith("choose archard, demelio, layer, bem, fewer terms or fewer loads")


def test_a_method_that_does_not_apply_is_not_announced(seconds):
    seconds(2 * LONG)
    assert forecast(case("patches", np.inf), LOADS) == []
