"""What a solve is expected to take before it is begun."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.scenes import scene_in
from weier.methods import registry
from weier.methods.registry import find_method
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
        "patches takes about 20 s: choose archard, demelio, persson, cascade, layer, bem, auto, fewer loads, or "
        "fewer terms or waves (within 0.001 g_0)"
    )


@pytest.mark.parametrize("settings", [None, {"patches": {"tolerance": 1e-6}}])
def test_what_would_take_a_day_is_refused(seconds, settings):
    seconds(2 * MAX_SECONDS)
    with pytest.raises(ValueError, match=r"got 'patches', which may take 2e\+05 s for D = 1\.25.* choose archard, "):
        forecast(case("patches", 3, settings), LOADS)


@pytest.mark.parametrize(("count", "most"), [(0, None), (3, None), (0, 1e-3)])
def test_a_short_scene_says_nothing_unless_it_has_a_limit(tmp_path, count, most):
    assert forecast_scene(scene_with(tmp_path, most), LONG / 2, count, 1) == []


def test_a_scene_above_its_limit_asks_for_a_key_that_allows_it(tmp_path):
    line = "scene: 3 curves to solve, in about 1200 s on {}"
    assert forecast_scene(scene_with(tmp_path, None), 1200.0, 3, 1) == [line.format("1 core")]
    assert forecast_scene(scene_with(tmp_path, 1400), 1200.0, 3, 2) == [line.format("2 cores")]
    with pytest.raises(ValueError, match=r"1200 s on 1 core, longer than 600 s: set max_seconds: 1400 in the scene"):
        forecast_scene(scene_with(tmp_path, 600), 1200.0, 3, 1)


def scene_with(folder, most):
    studies = {"one": {"product": {"D": [1.1, 1.25, 1.5], "gamma": 2, "m": 2}}}
    content = {"title": "t", "loads": [0.1, 1.0], "methods": ["patches"], "studies": studies}
    return scene_in(folder, content | ({} if most is None else {"max_seconds": most}))


def test_auto_is_not_proposed_where_its_tolerance_is_out_of_reach():
    assert find_method("auto").seconds(Profile(1.9, 2, math.inf), LOADS) == math.inf
    assert find_method("auto").seconds(Profile(1.25, 5, math.inf), LOADS) < math.inf
