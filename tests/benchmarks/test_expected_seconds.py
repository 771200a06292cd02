"""Seconds over those expected, and the constants that fit them."""

import numpy as np
import pytest

from benchmarks import expected_seconds
from benchmarks.expected_seconds import CONSTANTS, FRACTIONS, MANY
from weier.accuracy.variants import Variant, by_default, variants_of
from weier.methods.registry import find_method


def test_surfaces_have_at_most_as_many_waves_or_infinitely_many():
    finite = [profile for name, profile in expected_seconds.surfaces(100) if "inf" not in name]
    assert [profile.waves_per_period[-1] for profile in finite] == [25, 64, 81, 100, 100]


@pytest.fixture
def solved(monkeypatch):
    """Curves that are not solved: as many seconds as there are loads, or none where terms exceed those of a test."""

    def seconds(variant, profile, loads):
        return float(loads.size) if variant.settings.get("terms", 0) < 6 else np.nan

    monkeypatch.setattr(expected_seconds, "seconds_of", seconds)


@pytest.mark.usefixtures("solved")
def test_few_waves_are_solved_under_single_and_many_loads_by_each_variant():
    surfaces, method = dict(expected_seconds.surfaces(400)), find_method("bem")
    few = surfaces["D = 1.25, gamma = 5, m = 3"]
    found = list(expected_seconds.measurements("m = 3", few, method))
    variants = [by_default("bem"), *variants_of(method, few)]
    assert len(variants) > 3
    assert [each.variant for each in found[::2]] == variants
    assert [[each.size for each in one.loads] for one in found] == len(variants) * [[1] * len(FRACTIONS), [MANY.size]]
    (long,) = expected_seconds.measurements("trace", surfaces["trace, H = 0.3"], find_method("bem"))
    assert [loads.size for loads in long.loads] == [1] * len(FRACTIONS)


@pytest.mark.usefixtures("solved")
@pytest.mark.parametrize("name", CONSTANTS)
def test_a_fit_finds_the_constants_of_seconds_that_follow_the_formula(name):
    method, usual = find_method(name), np.array(CONSTANTS[name])
    constants = tuple((usual * np.linspace(1.2, 0.9, usual.size)).tolist())
    taken = [surface for surface in expected_seconds.surfaces(400) if method.takes(surface[1])]
    found = [each for surface in taken for each in expected_seconds.measurements(*surface, method)]
    solved = [each for each in found if np.isfinite(each.seconds).any()]
    follow = [each._replace(seconds=each.seconds / each.ratio(constants)) for each in solved]
    assert expected_seconds.fitted(follow) == pytest.approx(constants, rel=1e-3)
    assert expected_seconds.row_of_fit(follow)[-1] == "1.00 to 1.00"


def test_seconds_of_a_curve_that_is_not_solved_are_nan():
    surface = dict(expected_seconds.surfaces(25))["D = 1.25, gamma = 5, m = inf"]
    assert np.isnan(expected_seconds.seconds_of(Variant("bem", "bem", {}), surface, np.ones(1)))


@pytest.mark.parametrize(("method", "m"), [("bem", "3"), ("layer", "inf")])
def test_expected_seconds_stand_beside_those_measured(method, m):
    name = f"D = 1.25, gamma = 5, m = {m}"
    surface = dict(expected_seconds.surfaces(25))[name]
    measured = next(expected_seconds.measurements(name, surface, find_method(method)))
    what, waves, by, loads, seconds, ratio = expected_seconds.row(measured)
    assert (what, waves, by, loads) == (name, {"3": "25", "inf": "inf"}[m], method, "1")
    assert all(float(value) >= 0 for value in seconds.split(" / "))
    assert float(ratio) > 0


def test_a_process_and_a_closed_form_take_processor_time():
    """The process is another one, whose time the caller does not spend."""
    assert expected_seconds.seconds_of_start() > 0
    assert expected_seconds.seconds_of_case(20) > 0
