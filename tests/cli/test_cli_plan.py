"""`weier plan`: of one profile, or of the cases of a scene."""

import numpy as np
import pytest

import weier
from weier import scene

PROFILE = ["-D", "1.25", "--gamma", "5", "-m", "2", "--phases", "1"]


def test_a_plan_of_one_profile_is_that_of_the_library(run):
    wanted = ["--loads", "0.01:20:5", "--tolerance", "1e-4", "--quantity", "resistance"]
    code, out, _ = run("plan", *PROFILE, *wanted)
    profile = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)
    assert code == 0
    assert out == f"{weier.plan(profile, np.geomspace(0.01, 20, 5), 1e-4, 'resistance')}\n"


def test_a_plan_of_one_profile_has_defaults(run):
    code, out, _ = run("plan", "-D", "1.5", "--gamma", "2", "-m", "inf", "--tolerance", "0.5")
    assert code == 0
    assert out == f"{weier.plan(weier.Profile(D=1.5, gamma=2, m=np.inf), np.geomspace(1e-3, 4, 40), 0.5)}\n"


def test_a_plan_of_a_scene_goes_by_the_scene_unless_told(run, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(
        "{title: t, loads: [0.1, 1], tolerance: 0.01, studies: {one: {product: {D: 1.5, gamma: 3, m: [1, 2]}}}}"
    )
    assert run("plan", path)[1] == f"{weier.plan(scene.load(path))}\n"
    told = weier.plan(scene.load(path), [0.2], 1e-4, "resistance")
    arguments = ["--loads", "0.2", "--tolerance", "1e-4", "--quantity", "resistance"]
    assert run("plan", path, *arguments)[1] == f"{told}\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "a plan is of a SCENE or of a profile (-D, --gamma, -m), got neither"),
        (["--tolerance", "1e-3"], "got neither"),
        (["--trace", "shaft.csv"], "plans are for series: take the one that weier.fit finds for the trace"),
        (["scene.yaml", *PROFILE], "a plan is of a SCENE or of a profile (-D, --gamma, -m), got both"),
        (["-D", "1.5"], "a profile takes -D, --gamma and -m, got no --gamma and no -m"),
    ],
)
def test_a_plan_of_neither_or_both_is_wrong_usage(run, arguments, message):
    code, out, err = run("plan", *arguments)
    assert (code, out) == (2, "")
    assert message in err.splitlines()[-1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*PROFILE, "--tolerance", "0"], "tolerance must be positive and finite, got 0.0"),
        (
            ["-D", "1.5", "--gamma", "3", "-m", "1e9"],
            "m must be a whole number of terms, from 1 to 1000000, or inf",
        ),
        (["-D", "1.5", "--gamma", "3", "-m", "1e6"], "m must be at most 1000"),
        (["-D", "1.95", "--gamma", "2", "-m", "inf"], "tolerance must be larger, or the series shorter, got 0.001"),
    ],
)
def test_a_plan_out_of_range_is_one_sentence(run, arguments, message):
    code, out, err = run("plan", *arguments)
    assert (code, out) == (1, "")
    assert err.startswith(f"weier: {message}")
    assert err.count("\n") == 1
