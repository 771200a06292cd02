"""The plans of all cases of a scene."""

import re

import numpy as np
import pytest

import weier
from tests.scenes import scene_in
from weier import plan, scene
from weier.data import dataset
from weier.methods import patches
from weier.pipeline import batch

SCENE = """
title: planned
loads: [0.01, 0.1, 20]
tolerance: 1.0e-3
studies:
  one: {product: {D: [1.25, 1.5], gamma: 5, m: 2, phases: 1.0}}
"""


def test_a_scene_with_a_tolerance_runs_its_plan(tmp_path):
    loaded = scene_in(tmp_path, SCENE)
    found = weier.plan(loaded)
    assert len(re.findall(r"^  2 +0.01 +0.1 +bem +2 +points [0-9]+ ", str(found), re.M)) == 2
    assert found._repr_html_().count('<td style="text-align: left">bem</td>') == 2
    assert "2 of 2 cases can be solved" in str(found)
    assert found.seconds == sum(plan.seconds for plan in found.plans)
    assert "D = 1.5, gamma = 5, m = 2, phase 1: compliance within 0.001" in str(found)
    assert "patches" in [part.method for part in weier.plan(loaded, tolerance=1e-9).plans[0].parts]
    data = batch.solve_batch(loaded.studies["one"], loaded.loads)
    assert data.solution_method.values.tolist() == ["planned"]
    for case in range(2):
        exact = patches.curve(loaded.studies["one"][case].profile, loaded.loads).compliance
        error = np.abs(data.compliance.values[case, 0] - exact)
        assert np.all(error <= data.compliance_error.values[case, 0])
        assert 0 < data.compliance_error.values[case, 0, 0] <= 1e-3
    # Which method was taken at each load is in the file.
    dataset.write(data, tmp_path / "data.nc", "planned")
    again = dataset.read(tmp_path / "data.nc")
    assert again["planned_method"].values[1].tolist() == ["bem", "bem", "full contact"]
    assert again["planned_terms"].values[1].tolist() == [2, 2, 2]
    points = plan(loaded.studies["one"][1].profile, loaded.loads).parts[0].settings["points"]
    np.testing.assert_array_equal(again["planned_points"].values[1], [points, points, np.nan])


def test_a_scene_plan_tells_its_cases_apart_and_lists_those_without_a_plan(tmp_path):
    product = "{D: [1.25, 1.9], gamma: 2, m: .inf, seed: [3, 4]}"
    loaded = scene_in(tmp_path, SCENE.replace("{D: [1.25, 1.5], gamma: 5, m: 2, phases: 1.0}", product))
    lines = str(weier.plan(loaded, tolerance=0.1)).splitlines()
    heads = [line for line in lines if line and not line.startswith(" ")]
    assert heads[0].startswith("D = 1.25, gamma = 2, m = inf, seed 3: compliance within 0.1")
    assert heads[1].startswith("D = 1.25, gamma = 2, m = inf, seed 4: ")
    assert heads[2].startswith("2 of 4 cases can be solved")
    assert heads[3] == "not the others:"
    assert ["seed 3" in lines[-2], "seed 4" in lines[-1]] == [True, True]


@pytest.mark.parametrize(
    ("old", "new"), [("tolerance: 1.0e-3\n", ""), ("1.0e-3", "0"), ("tolerance: 1.0e-3", "quantity: compliance")]
)
def test_a_scene_needs_methods_or_a_tolerance(tmp_path, old, new):
    with pytest.raises(scene.SceneError):
        scene_in(tmp_path, SCENE.replace(old, new))
