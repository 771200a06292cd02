"""What is wrong usage, and what is bad input, of any command."""

import math

import pytest

from weier import Profile

PROFILE = ["-D", "1.25", "--gamma", "5", "-m", "2"]
SOLVE = ["solve", *PROFILE]


WRONG_USAGE = [
    ([*SOLVE, "--loads", "1:-0.1:5"], "loads must be 2 to 10000 positive numbers, got '1:-0.1:5'"),
    ([*SOLVE, "--loads", "-1"], "mean_pressure must be positive, got -1.0"),
    ([*SOLVE, "--loads", "1:2"], 'loads must read "1,10 p_0*" or "first:last:count p_0*", got \'1:2\''),
    ([*SOLVE, "--loads", ""], "loads must read"),
    ([*SOLVE, "-D", "1.5"], "-D must be given once, got 2 of it"),
    (["solve", "--trace", "a.csv", "--trace", "b.csv"], "--trace must be given once, got 2 of it"),
    ([*SOLVE, "--loads", "1:2:99999999999"], "loads must be 2 to 10000 positive numbers"),
    ([*SOLVE, "--phases", "0,one"], 'phases must read "1" or "0,1,2", got \'0,one\''),
    ([*SOLVE, "--phases", "1", "--seed", "1"], "--phases or --seed, got both"),
    ([*SOLVE, "--set", "bem"], 'must read "method.name=value"'),
    ([*SOLVE, "--set", "bem.points_per_wave="], 'must read "method.name=value"'),
    ([*SOLVE, "--set", "bem.points_per_wave=!!python/name:os.system"], "must be a number or a word"),
    ([*SOLVE, "--set", f"bem.points_per_wave={'[' * 5000}"], "must be a number or a word"),
    ([*SOLVE, "--method", "bme"], "bme"),
    ([*SOLVE, "--lods", "1"], "No such option"),
    ([*SOLVE, "--workers", "0"], "workers must be a whole number, at least 1, or -1 for all cores, got 0"),
    (["solve", "--trace", "shaft.csv", "-D", "1.5"], "a trace has no D: take --trace or a series"),
    (["solve", "--length", "1e-3"], "--length is of a trace: name its file by --trace"),
    (
        ["solve", "--trace", "map.x3p", "--across", "x"],
        "--across names the axis of a line: give its number by --line",
    ),
    (["solve", "-D", "1.5"], "a profile takes -D, --gamma and -m, or --trace; missing: --gamma, -m"),
    (["table", "curve.nc", "curves.txt"], "the name must end in one of .csv"),
    (["table", "none.nc", "resluts/curves.csv"], "there is no folder resluts: make it first, or name another one"),
    ([*SOLVE, "-o", "resluts/curves.csv"], "there is no folder resluts: make it first, or name another one"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG_USAGE)
def test_wrong_usage_is_exit_code_2(run, arguments, message):
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert message in err.splitlines()[-1]


BAD_INPUT = [
    (["solve", "-D", "2.5", "--gamma", "5", "-m", "2"], "D must lie in (1, 2), got 2.5"),
    (["solve", "-D", "1.25", "--gamma", "1.4142135", "-m", "3"], 'take gamma = "140/99"'),
    (
        [*SOLVE, "--method", "bem", "--set", "bem.points_per_wave=1e9"],
        "points_per_wave of bem must be a whole number, from 1 to 10000000, got 1000",
    ),
    (
        [*SOLVE, "--method", "bem", "--set", "bem.tolerance=nan"],
        "of bem must lie in [1e-13, 1), got the text 'nan'",
    ),
    ([*SOLVE, "--set", "layer.points=3"], "'layer', which is not run"),
    ([*SOLVE, "--method", "layer", "--set", "layer.points=2.5"], "points of layer must be a whole number, got 2.5"),
    ([*SOLVE, "--method", "westergaard"], 'westergaard: method "westergaard" is for one wave'),
    (
        ["solve", "-D", "1.25", "--gamma", "5", "-m", "inf"],
        "a tolerance or a method must be given where m = inf: tolerance=1e-3, or one of",
    ),
    (["solve", *PROFILE, "--tolerance", "0"], "tolerance of auto must lie in [1e-13, 1), got 0.0"),
    (["solve", "-D", "1.95", "--gamma", "2", "-m", "inf", "--tolerance", "1e-3"], "no tolerance is within reach "),
]


@pytest.mark.parametrize(("arguments", "message"), BAD_INPUT)
def test_bad_input_is_one_sentence_and_exit_code_1(run, arguments, message):
    code, out, err = run(*arguments)
    last = err.splitlines()[-1]
    assert (code, out) == (1, "")
    assert last.startswith("weier: ")
    assert message in last


def test_a_word_says_that_there_is_no_last_wave():
    assert Profile(1.25, 5, "inf") == Profile(1.25, 5, math.inf)
    with pytest.raises(ValueError, match="or inf, got the text 'many'"):
        Profile(1.25, 5, "many")
