"""What a solve is said to cost before it is begun."""

from dataclasses import replace

import numpy as np
import pytest

import weier
from tests.scenes import scene_in
from weier import scene
from weier.methods import registry
from weier.methods.errors import OutOfReachError
from weier.methods.planned.plan import Plan
from weier.methods.registry import find_method
from weier.pipeline.batches import CASE_SECONDS, Solutions, read_batch
from weier.pipeline.forecast import LONG, MAX_SCENE_SECONDS, MAX_SECONDS, forecast, forecast_scene
from weier.scene import Case

LOADS = np.geomspace(1e-3, 4, 40)


def case(method, m, settings=None):
    return Case({"D": 1.25, "gamma": 5, "m": m}, (method,), settings or {})


@pytest.fixture
def seconds(monkeypatch):
    """The cost model of contact patches, replaced by a function that returns a given value."""

    def expect(value):
        changed = replace(find_method("patches"), seconds=lambda profile, loads: value)
        methods = tuple(changed if method.name == "patches" else method for method in registry.METHODS)
        monkeypatch.setattr(registry, "METHODS", methods)

    return expect


@pytest.mark.parametrize(("expected", "m"), [(LONG / 2, 3), (2 * LONG, np.inf)])
def test_what_is_short_or_does_not_apply_is_not_announced(seconds, expected, m):
    seconds(expected)
    assert forecast(case("patches", m), LOADS) == []


def test_long_ones_are_with_seconds_and_what_is_cheaper(seconds):
    seconds(2 * LONG)
    (line,) = forecast(case("patches", 3), LOADS)
    assert line.startswith("patches may take up to 60 s: method 'planned' takes about ")


def test_what_would_take_a_day_is_refused_unless_settings_are_chosen(seconds):
    seconds(2 * MAX_SECONDS)
    with pytest.raises(ValueError, match=r"got 'patches', which may take 2e\+05 s for D = 1\.25.*method 'planned'"):
        forecast(case("patches", 3), LOADS)
    assert forecast(case("patches", 3, {"patches": {"tolerance": 1e-6}}), LOADS) == []


def test_where_no_plan_is_within_reach_the_fast_methods_are_named(seconds, monkeypatch):
    seconds(2 * LONG)

    def refuse(profile, loads):
        raise OutOfReachError("none")

    monkeypatch.setattr("weier.pipeline.forecast.plan", refuse)
    (line,) = forecast(case("patches", 3), LOADS)
    assert line.endswith("choose archard, demelio, persson, layer, bem, fewer terms or fewer loads")


def forecast_of(folder, cores=1, **changes):
    """The forecast of three cases, one of which has no plan, and what the descriptions of their batches expect."""
    product = {"D": [1.1, 1.25, 1.9], "gamma": 2, "m": float("inf")}
    content = {"title": "t", "loads": [0.1, 1.0], "tolerance": 0.1, "studies": {"one": {"product": product}}}
    wanted = {key: value for key, value in (content | changes).items() if value is not None}
    solutions = Solutions(scene_in(folder, wanted), folder)
    expected = [read_batch(path.with_suffix(".json")).seconds for path in solutions.files(cores=cores)]
    return forecast_scene(solutions.scene, solutions.to_solve.values(), cores), expected


@pytest.fixture
def slow_plans(monkeypatch):
    """Each plan takes as long as a scene with plans may."""
    monkeypatch.setattr(Plan, "seconds", property(lambda self: MAX_SCENE_SECONDS - 2 * CASE_SECONDS))


def test_a_scene_with_plans_says_what_they_take_and_whom_they_refuse(tmp_path):
    (lines, refusal), expected = forecast_of(tmp_path)
    found = weier.plan(scene.load(tmp_path / "scene.yaml"))
    assert len(found.plans) == 2
    assert expected == [pytest.approx(found.seconds + 3 * CASE_SECONDS)]
    assert not refusal
    assert lines == [
        f"scene: 3 cases to solve, in about {expected[0]:.2g} s on 1 core",
        "scene: no plan for 1 of them:",
        *(f"  {error}" for error in found.cases.values() if isinstance(error, OutOfReachError)),
    ]


def test_a_scene_above_its_limit_asks_for_a_key_that_allows_it(tmp_path, slow_plans):
    lines, refusal = forecast_of(tmp_path)[0]
    assert lines[0].endswith("in about 1200 s on 1 core")
    assert lines[1] == "scene: no plan for 1 of them:"
    assert "it would take longer than 600 s: add max_seconds: 1400 to the scene" in refusal
    assert not forecast_of(tmp_path, max_seconds=1400)[0][1]
    lines, refusal = forecast_of(tmp_path, cores=3)[0]
    assert lines[0].endswith("in about 600 s on 3 cores")  # as the longest of its batches
    assert not refusal


def test_a_scene_without_plans_says_nothing_unless_it_has_a_limit(tmp_path, seconds):
    study = {"product": {"D": 1.5, "gamma": 2, "m": 2}}
    without = {"tolerance": None, "methods": ["patches"], "studies": {"one": study}}
    seconds(2 * MAX_SCENE_SECONDS)
    assert forecast_of(tmp_path, **without)[0] == ([], "")
    lines, refusal = forecast_of(tmp_path, **without, max_seconds=100)[0]
    assert lines == ["scene: 1 case to solve, in about 1200 s on 1 core"]
    assert "longer than 100 s: add max_seconds: 1400" in refusal


def test_a_scene_that_is_solved_says_nothing(tmp_path):
    forecast_of(tmp_path)
    with_limit = replace(scene.load(tmp_path / "scene.yaml"), max_seconds=1e-3)
    assert forecast_scene(with_limit, [], cores=1) == ([], "")
