"""What a solve is expected to take before it is begun."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.scenes import scene_in
from weier import scene
from weier.methods import registry
from weier.methods.registry import find_method
from weier.pipeline.batches import Solutions
from weier.pipeline.curves import CASE_SECONDS
from weier.pipeline.forecast import LONG, MAX_SECONDS, forecast, forecast_scene
from weier.scene import Case
from weier.surface.profile import Profile

LOADS = np.geomspace(1e-3, 4, 40)


def case(method, m, settings=None):
    return Case({"D": 1.25, "gamma": 5, "m": m}, (method,), settings or {})


@pytest.fixture
def seconds(monkeypatch):
    """The expected seconds of contact patches, replaced by a given value."""

    def expect(value):
        changed = replace(find_method("patches"), seconds=lambda profile, loads, **settings: value)
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
    assert line == (
        "patches takes about 20 s: choose archard, demelio, persson, layer, bem, auto, fewer loads, or fewer terms "
        "or waves (within 0.001 g_0)"
    )


@pytest.mark.parametrize("settings", [None, {"patches": {"tolerance": 1e-6}}])
def test_what_would_take_a_day_is_refused(seconds, settings):
    seconds(2 * MAX_SECONDS)
    with pytest.raises(ValueError, match=r"got 'patches', which may take 2e\+05 s for D = 1\.25.* choose archard, "):
        forecast(case("patches", 3, settings), LOADS)


def forecast_of(folder, cores=1, **changes):
    """The forecast of three cases, and what the descriptions of their batches expect."""
    product = {"D": [1.1, 1.25, 1.5], "gamma": 2, "m": 2}
    content = {"title": "t", "loads": [0.1, 1.0], "methods": ["patches"], "studies": {"one": {"product": product}}}
    solutions = Solutions(scene_in(folder, content | changes), folder)
    expected = [solutions.store.batch(path.stem).seconds for path in solutions.files(cores=cores)]
    return forecast_scene(solutions.scene, solutions.to_solve, cores), expected


def test_a_short_scene_says_nothing_unless_it_has_a_limit(tmp_path, seconds):
    seconds(LONG / 6)
    (lines, refusal), expected = forecast_of(tmp_path)
    assert (lines, refusal) == ([], "")
    assert sum(expected) == pytest.approx(LONG / 2 + 3 * CASE_SECONDS)
    assert forecast_of(tmp_path, max_seconds=100)[0] == (["scene: 3 curves to solve, in about 5 s on 1 core"], "")


def test_a_scene_above_its_limit_asks_for_a_key_that_allows_it(tmp_path, seconds):
    seconds(400 - CASE_SECONDS)
    lines, refusal = forecast_of(tmp_path, max_seconds=600)[0]
    assert lines == ["scene: 3 curves to solve, in about 1200 s on 1 core"]
    assert "it would take longer than 600 s: set max_seconds: 1400 in the scene" in refusal
    assert not forecast_of(tmp_path, max_seconds=1400)[0][1]
    lines, refusal = forecast_of(tmp_path, cores=3, max_seconds=600)[0]
    assert lines[0].endswith("in about 400 s on 3 cores")  # as the longest of its batches
    assert not refusal


def test_auto_is_not_proposed_where_its_tolerance_is_out_of_reach():
    assert find_method("auto").seconds(Profile(1.9, 2, math.inf), LOADS) == math.inf
    assert find_method("auto").seconds(Profile(1.25, 5, math.inf), LOADS) < math.inf


def test_a_scene_that_is_solved_says_nothing(tmp_path):
    forecast_of(tmp_path)
    with_limit = replace(scene.load(tmp_path / "scene.yaml"), max_seconds=1e-3)
    assert forecast_scene(with_limit, [], cores=1) == ([], "")
