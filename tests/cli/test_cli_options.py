"""What is wrong usage, and what is bad input, of any command."""

import pytest

PROFILE = ["-D", "1.25", "--gamma", "5", "-m", "2"]
SOLVE = ["solve", *PROFILE]


WRONG_USAGE = [
    ([*SOLVE, "--loads", "-1"], "mean_pressure must be positive, got -1.0"),
    ([*SOLVE, "--set", "bem"], 'must read "method.name=value"'),
    (["solve", "--trace", "shaft.csv", "-D", "1.5"], "a trace has no D: take --trace or a series"),
    (["solve", "--length", "1e-3"], "--length is an option of traces: name a file by --trace"),
    ([*SOLVE, "--pressures", "1MPa"], "--pressures are in Pa: name the two bodies by --si"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG_USAGE)
def test_wrong_usage_is_exit_code_2(run, arguments, message):
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert message in err.splitlines()[-1]


BAD_INPUT = [
    ([*SOLVE, "--phases", "1", "--seed", "1"], "phases must be left out where there is a seed, got 1.0"),
    (["solve", "-D", "2.5", "--gamma", "5", "-m", "2"], "D must lie in (1, 2), got 2.5"),
    (["solve", "-D", "1.25", "--gamma", "1.4142135", "-m", "3"], "no curve could be solved, for the reasons above"),
    (
        ["solve", "-D", "1.25", "--gamma", "5", "-m", "inf"],
        "a tolerance or a method must be given where m = inf: tolerance=1e-3, or one of",
    ),
    (["solve", "-D", "1.95", "--gamma", "2", "-m", "inf", "--tolerance", "1e-3"], "no tolerance is within reach "),
]


@pytest.mark.filterwarnings("default:.*take fewer terms, a gamma")
@pytest.mark.parametrize(("arguments", "message"), BAD_INPUT)
def test_bad_input_is_one_sentence_and_exit_code_1(run, arguments, message):
    code, out, err = run(*arguments)
    last = err.splitlines()[-1]
    assert (code, out) == (1, "")
    assert last.startswith("weier: ")
    assert message in last
