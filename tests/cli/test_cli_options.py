"""What is read from the text of options, and what is wrong usage."""

import pytest

from weier.cli import options

SOLVE = ["solve", "-D", "1.25", "--gamma", "5", "-m", "2"]


def test_loads_in_equal_ratios():
    assert options.parse_loads("0.01:1:3") == pytest.approx([0.01, 0.1, 1])


def test_phases():
    assert options.parse_phases("0, 1e-3,-2") == [0.0, 1e-3, -2.0]


def test_settings_by_method():
    assert options.parse_settings(["bem.points=512", "bem.solver=direct", "layer.points=6"]) == {
        "bem": {"points": 512, "solver": "direct"},
        "layer": {"points": 6},
    }


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--loads", "1:0.1:5"], "mean_pressure must increase"),
        (["--loads", "-1"], "mean_pressure must be positive, got -1.0"),
        (["--loads", "1:2"], 'loads must read "0.1,1" or "first:last:count", got \'1:2\''),
        (["--loads", ""], "loads must read"),
        (["--loads", "1:2:99999999999"], "must lie in [2, 10000], got 99999999999"),
        (["--phases", "0,one"], 'phases must read "1" or "0,1,2", got \'0,one\''),
        (["--phases", "1", "--seed", "1"], "--phases or --seed, got both"),
        (["--set", "bem"], 'must read "method.name=value"'),
        (["--set", "bem.points="], 'must read "method.name=value"'),
        (["--set", "bem.points=!!python/name:os.system"], "must be a number or a word"),
        (["--set", f"bem.points={'[' * 5000}"], "must be a number or a word"),
        (["--method", "bme"], "bme"),
        (["--seed", "1.5"], "1.5"),
        (["--loads"], "requires an argument"),
        (["-m"], "requires an argument"),
        (["curves.nc"], "unexpected extra argument"),
        (["--lods", "1"], "No such option"),
    ],
)
def test_wrong_usage_is_exit_code_2(run, arguments, message):
    code, out, err = run(*SOLVE, *arguments)
    assert (code, out) == (2, "")
    assert message in err.splitlines()[-1]
