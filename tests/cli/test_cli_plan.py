"""`weier plan`: of one profile, or of the cases of a scene."""

import numpy as np

import weier
from weier import scene

PROFILE = ["-D", "1.25", "--gamma", "5", "-m", "2", "--phases", "1"]


def test_a_plan_of_one_profile_is_that_of_the_library(run):
    wanted = ["--loads", "0.01:20:5", "--tolerance", "1e-4", "--quantity", "resistance"]
    code, out, _ = run("plan", *PROFILE, *wanted)
    profile = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)
    assert code == 0
    assert out == f"{weier.plan(profile, np.geomspace(0.01, 20, 5), 1e-4, 'resistance')}\n"


def test_a_plan_has_each_load_once_and_increasing(run):
    series = ["-D", "1.25", "--gamma", "5", "-m", "2"]
    _, sorted_loads, _ = run("plan", *series, "--loads", "0.1,1")
    code, out, _ = run("plan", *series, "--loads", "1,0.1,1")
    assert (code, out) == (0, sorted_loads)
    profile = weier.Profile(1.25, 5, 2)
    assert str(weier.plan(profile, [1.0, 0.1, 0.1])) == str(weier.plan(profile, [0.1, 1.0]))


def test_a_plan_of_one_profile_has_defaults(run):
    code, out, _ = run("plan", "-D", "1.5", "--gamma", "2", "-m", "inf", "--tolerance", "0.5")
    assert code == 0
    assert out == f"{weier.plan(weier.Profile(D=1.5, gamma=2, m=np.inf), np.geomspace(1e-3, 4, 40), 0.5)}\n"


def test_a_plan_of_a_scene_follows_the_scene_unless_options_are_given(run, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(
        "{title: t, loads: [0.1, 1], tolerance: 0.01, studies: {one: {product: {D: 1.5, gamma: 3, m: [1, 2]}}}}"
    )
    assert run("plan", path)[1] == f"{weier.plan(scene.load(path))}\n"
    plan = weier.plan(scene.load(path), [0.2], 1e-4, "resistance")
    arguments = ["--loads", "0.2", "--tolerance", "1e-4", "--quantity", "resistance"]
    assert run("plan", path, *arguments)[1] == f"{plan}\n"
