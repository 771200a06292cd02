"""What a solve is expected to take before it is begun."""

import pytest

from tests.scenes import scene_in
from weier.pipeline.forecast import LONG, forecast_scene


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
