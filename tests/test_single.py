"""`weier solve` and `weier plot`: one profile from the command line."""

import json
import sys

import numpy as np
import pytest
import xarray as xr

import weier
from weier import __main__, scene, single

PROFILE = ["-D", "1.25", "--gamma", "5", "-m", "2", "--phase", "1"]


@pytest.fixture
def run(monkeypatch, capsys):
    """The command as a shell sees it: exit code, output and errors."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["weier", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            __main__.main()
        answer = capsys.readouterr()
        return stopped.value.code or 0, answer.out, answer.err

    return run


def test_json_is_what_solve_gives(run):
    code, out, err = run("solve", *PROFILE, "--loads", "0.1,1", "--method", "demelio", "--method", "bem")
    assert code == 0
    assert "D = 1.25, gamma = 5, m = 2" in err
    found = json.loads(out)
    assert found["mean_pressure"] == [0.1, 1.0]
    profile = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)
    for method in ("demelio", "bem"):
        curve = weier.solve(profile, [0.1, 1.0], method)
        assert found["methods"][method]["resistance"] == curve.resistance.values.tolist()
    assert "contact_fraction" not in found["methods"]["demelio"]
    assert found["methods"]["bem"]["seconds"] > 0
    assert found["units"]["resistance"] == "g_0/p_0*"


def test_json_tells_what_a_plan_took_of_the_plan_alone(run):
    _, out, _ = run("solve", *PROFILE, "--loads", "0.1,20", "--method", "demelio", "--method", "planned")
    methods = json.loads(out)["methods"]
    assert methods["planned"]["planned_method"] == ["bem", "full contact"]
    assert methods["planned"]["planned_terms"] == [2.0, 2.0]
    assert methods["planned"]["planned_points"][1] is None
    assert "planned_terms" not in methods["demelio"]


def test_json_has_no_nan_and_no_infinity(run):
    code, out, _ = run("solve", "-D", "1.25", "--gamma", "5/2", "-m", "inf", "--method", "demelio", "--loads", "0.1")
    assert code == 0
    assert json.loads(out, parse_constant=lambda name: pytest.fail(name))["m"] == "inf"


@pytest.mark.parametrize("phases", [["--phases", "0.5,1"], ["--seed", "3"], []])
def test_a_file_carries_the_scene_that_makes_it(run, tmp_path, phases):
    path = tmp_path / "a folder" / "curves.nc"
    series = ["-D", "1.5", "--gamma", "5/2", "-m", "2"]
    code, out, _ = run("solve", *series, *phases, "--loads", "0.1:1:3", "--method", "demelio", "-o", path)
    assert (code, out) == (0, "")
    with xr.open_dataset(path) as data:
        assert np.allclose(data.mean_pressure, np.geomspace(0.1, 1, 3))
        (tmp_path / "again.yaml").write_text(data.attrs["scene"])
        again = scene.load(tmp_path / "again.yaml").studies["one"][0].profile
        assert again.phase == pytest.approx(data.phase.values[0])


def test_settings_reach_the_method(run):
    code, out, _ = run("solve", *PROFILE, "--loads", "1", "--set", "bem.points=40")
    assert code == 0
    assert json.loads(out)["methods"]["bem"]["points"] == 40


def test_plot_leaves_three_files(run, tmp_path):
    methods = ["--method", "demelio", "--method", "layer"]
    code, _, _ = run("plot", *PROFILE, *methods, "--quantity", "resistance", tmp_path / "x.png")
    assert code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"x.png", "x.pdf", "x.svg"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-D", "2.5", "--gamma", "5", "-m", "2"], "D must lie in (1, 2), got 2.5"),
        (["-D", "1.5", "--gamma", "5", "-m", "nan"], "m must be a whole number"),
        (["-D", "1.5", "--gamma", "1000000.5", "-m", "2"], "gamma must be at most 1000000, got 1000000.5"),
        (["-D", "1.5", "--gamma", "1e4000", "-m", "2"], "gamma must be at most 1000000, got about 1e4000"),
        ([*PROFILE, "--loads", "1:0.1:5"], "mean_pressure must increase"),
        ([*PROFILE, "--loads", "-1"], "mean_pressure must be positive, got -1.0"),
        ([*PROFILE, "--loads", "1:2"], 'loads must read "0.1,1" or "first:last:count", got \'1:2\''),
        ([*PROFILE, "--loads", "1:2:99999999999"], "must lie in [2, 10000], got 99999999999"),
        ([*PROFILE, "--seed", "1"], "one of --phase, --phases and --seed"),
        ([*PROFILE, "--set", "bem"], 'must read "method.name=value"'),
        ([*PROFILE, "--set", "layer.points=3"], "'layer', which is not among the methods bem"),
        ([*PROFILE, "--set", "bem.points=!!python/name:os.system"], "must be a number or a word"),
        ([*PROFILE, "--method", "westergaard"], "'westergaard' says nothing about this profile"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_1(run, arguments, message):
    code, out, err = run("solve", *arguments)
    last = err.splitlines()[-1]
    assert (code, out) == (1, "")
    assert last.startswith("weier: ")
    assert message in last


def test_wrong_usage_is_exit_code_2(run):
    code, _, err = run("solve", "-D", "1.25", "--method", "bme")
    assert code == 2
    assert "bme" in err


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
        ([*PROFILE, "--loads", ""], "loads must read"),
        (["-D", "1.5", "--gamma", "3", "-m", "1e9"], "m must be at most 1000"),
        (["-D", "1.95", "--gamma", "2", "-m", "inf"], "tolerance must be larger, or the series shorter, got 0.001"),
    ],
)
def test_a_plan_out_of_range_is_one_sentence(run, arguments, message):
    code, out, err = run("plan", *arguments)
    assert (code, out) == (1, "")
    assert err.startswith(f"weier: {message}")
    assert err.count("\n") == 1


def test_help_teaches_by_example(run):
    for command in ("solve", "plot", "plan"):
        code, out, _ = run(command, "--help")
        examples = [line.split() for line in out.splitlines() if line.strip().startswith(f"weier {command}")]
        assert code == 0
        assert len(examples) >= 2
    assert "Exit codes" in run("--help")[1]


def test_the_shell_completes_commands_and_options(run, monkeypatch):
    monkeypatch.setenv("_WEIER_COMPLETE", "bash_source")
    assert "complete -o nosort" in run()[1]
    monkeypatch.setenv("_WEIER_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", "weier solve --me")
    monkeypatch.setenv("COMP_CWORD", "2")
    assert "--method" in run()[1]


def test_loads_in_equal_ratios():
    assert single.parsed_loads("0.01:1:3") == pytest.approx([0.01, 0.1, 1])
