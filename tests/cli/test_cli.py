"""The command line as a whole: help whose examples run, exit codes, and files that cannot be written."""

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
# Those that need a file of curves, or of an instrument.
EXAMPLES = [found for found in EXAMPLES if not found.startswith("weier table") and "map.x3p" not in found]


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
    named = re.findall(r"the figure is in (\S+)", err)  # where the example names none
    assert files or out or [name for name in named if (tmp_path / name).stat().st_size > 0]


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("/dev/null/x.nc", "/dev/null is not a folder"),
        ("folder", "it is a folder"),
    ],
)
@pytest.mark.parametrize("command", [["solve", *PROFILE, "-o"], ["plot", *PROFILE]])
def test_an_impossible_file_is_reported_before_anything_is_solved(run, tmp_path, monkeypatch, command, path, why):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    code, out, err = run(*command, path)
    assert (code, out) == (1, "")
    assert re.fullmatch(rf"weier: .* cannot be written \(.*{why}\): name another file, .*\n", err)
    assert {path.name for path in tmp_path.iterdir()} == {"folder", "file"}


def test_ctrl_c_ends_a_command_in_a_line_with_the_exit_code_of_shells(monkeypatch, capsys):
    def stopped(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("weier.cli.call.solve_under", stopped)
    monkeypatch.setattr(sys, "argv", ["weier", "solve", *PROFILE, *FEW])
    monkeypatch.setattr(os, "_exit", sys.exit)
    with pytest.raises(SystemExit) as ended:
        program.run()
    assert (ended.value.code, capsys.readouterr().err.strip()) == (130, program.STOPPED)
