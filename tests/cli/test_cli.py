"""The command line as a whole: help whose examples run, wrong usage and bad input, exit codes, impossible files."""

import math
import os
import re
import shlex
import shutil
import sys

import pytest

from weier import __main__ as program
from weier.cli import cli

PROFILE = ["-D", "1.25", "--gamma", "5", "-m", "2"]
FEW = ["--loads", "0.1,1"]
BODIES = "mu_1: 80e9\nnu_1: 0.3\nrho_1: 1.4e-7\nmu_2: 80e9\nnu_2: 0.3\nrho_2: 1.4e-7\n"
COMMANDS = [None, *cli.commands]


def examples(text):
    """The commands of a help text, without the words beside them."""
    return [shlex.split(re.split(r"\s{2,}", line.strip())[0]) for line in text.splitlines() if "  weier " in line]


def described(command):
    return (cli if command is None else cli.commands[command]).help


EXAMPLES = list(dict.fromkeys(shlex.join(found) for name in COMMANDS for found in examples(described(name))))
# Those of `weier table` need a file of curves.
EXAMPLES = [found for found in EXAMPLES if not found.startswith("weier table")]


@pytest.mark.second_attempt  # under some loads of the trace of these examples
@pytest.mark.parametrize("example", EXAMPLES)
def test_every_example_of_the_help_runs(run, example, tmp_path, monkeypatch):
    shutil.copytree("config/scenes", tmp_path / "config/scenes")
    for name, phase in (("shaft.csv", 0), ("bush.csv", 1)):
        (tmp_path / name).write_text(
            "x (mm)\tz (um)\n" + "\n".join(f"{x / 1000} {math.cos(x / 30 + phase)}" for x in range(1000))
        )
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab.txt").write_text(
        "Laboratory\n" * 12 + "\n".join(f"{x}\t0\t{math.cos(x / 30):.6f}".replace(".", ",") for x in range(1000))
    )
    (tmp_path / "bodies.yaml").write_text(BODIES)
    _, *arguments = shlex.split(example.replace("'shaft*.csv'", "shaft.csv"))
    if "--pressures" not in arguments:
        place = arguments.index("--loads") if "--loads" in arguments else len(arguments)
        arguments[place : place + 2] = FEW
    code, out, err = run(*arguments)
    assert code == 0, err
    files = [word for word in arguments if re.search(r"\.(nc|csv|png|pdf)$", word) and word != "shaft.csv"]
    assert all((tmp_path / name).stat().st_size > 0 for name in files)
    assert files or out


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("/dev/null/x.nc", "Not a directory"),
        ("folder", "it is a folder"),
    ],
)
@pytest.mark.parametrize("command", [["solve", *PROFILE, "-o"], ["plot", *PROFILE]])
def test_an_impossible_file_is_reported_before_anything_is_solved(run, tmp_path, monkeypatch, command, path, why):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    code, out, err = run(*command, path)
    assert (code, out) == (1, "")
    assert re.fullmatch(rf"weier: .* cannot be written \(.*{why}\): name another file, .*\n", err)
    assert {path.name for path in tmp_path.iterdir()} == {"folder"}


def test_ctrl_c_ends_a_command_in_a_line_with_the_exit_code_of_shells(monkeypatch, capsys):
    def stopped(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("weier.cli.call.solve_under", stopped)
    monkeypatch.setattr(sys, "argv", ["weier", "solve", *PROFILE, *FEW])
    monkeypatch.setattr(os, "_exit", sys.exit)
    with pytest.raises(SystemExit) as ended:
        program.run()
    assert (ended.value.code, capsys.readouterr().err.strip()) == (130, program.STOPPED)


SOLVE = ["solve", *PROFILE]


WRONG_USAGE = [
    (["solve", "--trace", "shaft.csv", "-D", "1.5"], "take a series, or --trace with its options, got both: D"),
    ([*SOLVE, "--length", "1e-3"], "take a series, or --trace with its options, got both: D, gamma, m, length"),
    (["solve", "--length", "1e-3"], "a profile takes -D, --gamma and -m, or --trace with a file"),
    ([*SOLVE, "--set", "bem"], "Invalid value for '--set': it must read \"method.name=value\""),
    ([*SOLVE, "--phases", "0,x"], "it must be numbers with commas between, such as 0,2, got '0,x'"),
    ([*SOLVE, "--loads", "1", "--pressures", "1MPa"], "loads are given once, got --pressures and --loads"),
    (["plot", *PROFILE, "--loads", "1", "x.png"], "a figure takes at least 2 loads, got 1"),
    (["plot", *PROFILE, "x.txt"], "the name must end in one of .pdf, .svg, .png, got x.txt"),
    ([*SOLVE, "--pressures", "1MPa"], "--pressures are in Pa: name the two bodies by --si"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG_USAGE)
def test_wrong_usage_is_exit_code_2(run, arguments, message):
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert message in err.splitlines()[-1]


BAD_INPUT = [
    ([*SOLVE, "--loads", "-1"], "loads must be positive, got -1.0"),
    ([*SOLVE, "--loads", ""], 'loads must read "1,10 p_0*" or "first:last:count p_0*", got \'\''),
    ([*SOLVE, "--workers", "0"], "workers must be a whole number, at least 1, or -1 for all cores, got 0"),
    ([*SOLVE, "--phases", "1", "--seed", "1"], "phases must be left out where there is a seed, got 1.0"),
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
