"""Curves solved by several processes: the same bits, told as by one, and ended with the process that started them."""

import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

import weier
from weier.__main__ import INTERRUPTED, STOPPED
from weier.data.variables import Status
from weier.pipeline import workers
from weier.pipeline.workers import LOST, Curve, solve_curves
from weier.theory import arguments

LOADS = np.array([0.01, 0.1, 1.0])
SERIES = [weier.Profile(1.25, 5, 3, weier.random_phases(seed)) for seed in range(3)]


@pytest.fixture
def idle(monkeypatch):
    """Let the first process solve nothing, so that another one solves all."""
    monkeypatch.setattr(workers, "_solve_next", lambda *_: ())


@pytest.mark.usefixtures("idle")
def test_curves_of_another_process_have_the_same_bits():
    """So have the edges of contact, and the reasons why there is no curve are the same."""
    trace = weier.Trace(1e-6 * np.sin(np.arange(64) * 2 * np.pi / 64) ** 3, length=1e-3, unit="m")
    methods, strict = ["demelio", "layer", "bem", "patches"], {"tolerance": 1e-13}
    found = []
    for count in (1, 2):
        with pytest.warns(UserWarning, match="patches: |trace") as told:
            solved = weier.solve(
                [*SERIES, weier.Profile(1.25, 5, 4, 1.0), trace],
                LOADS,
                methods,
                contact_edges=True,
                workers=count,
                patches=strict,
            )
        found.append((solved.drop_vars("seconds"), [str(warning.message) for warning in told]))
    assert set(np.unique(found[0][0].status)) == {Status.solved, Status.not_applicable, Status.not_converged}
    xr.testing.assert_identical(found[0][0], found[1][0])
    assert found[0][1] == found[1][1]


@pytest.mark.usefixtures("idle")
def test_loads_of_another_process_are_told_one_by_one():
    said = []
    loads = np.geomspace(1e-3, 1, 100)
    outcomes = solve_curves([Curve(each, "bem", {}) for each in SERIES], loads, 2, 1e-3, said.append)
    assert len(list(outcomes)) == len(SERIES)
    done = [int(re.match(r"(\d+) of 300 loads, about \d+ s left", line)[1]) for line in said]
    assert done == sorted(done)
    assert any(number % loads.size for number in done)


def test_more_workers_than_curves_are_none_too_many():
    solved = [weier.solve(SERIES[:2], LOADS, "demelio", workers=count) for count in (1, 50)]
    assert np.array_equal(*(each.compliance for each in solved))


@pytest.mark.parametrize(
    ("count", "came"),
    [(0, "0"), (-2, "-2"), (1.5, "1.5"), (np.inf, "inf"), (np.nan, "nan"), (True, "True"), ("2", "the text '2'")],
)
def test_a_count_of_workers_that_cannot_be_is_refused(count, came):
    for profile in (SERIES, SERIES[0]):
        with pytest.raises(
            ValueError, match=f"^workers must be a whole number, at least 1, or -1 for all cores, got {came}$"
        ):
            weier.solve(profile, LOADS, "demelio", workers=count)


def test_all_cores_are_those_that_the_process_may_use(monkeypatch):
    monkeypatch.setattr(arguments.os, "sched_getaffinity", lambda process: {0, 2, 5}, raising=False)
    assert arguments.checked_workers(-1) == 3
    assert arguments.checked_workers(np.int64(4)) == 4


# So many profiles and loads that they take minutes.
MANY = """
import weier
profiles = [weier.Profile(1.25, 5, 3, weier.random_phases(seed)) for seed in range(3000)]
loads = [0.02 * (number + 1) for number in range(100)]
"""
CALL = "weier.solve(profiles, loads, ['patches'], workers=3)"
AT_ONCE = 10  # seconds, on a busy machine


def test_a_script_without_a_guard_is_told_so_in_a_sentence(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(MANY + CALL)
    done = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == f"ChildProcessError: {LOST}"
    assert done.stderr.count("Traceback") == 1


def test_a_prompt_or_notebook_needs_no_guard():
    """The program is no file there."""
    program = MANY + CALL.replace("profiles", "profiles[:3]").replace("loads", "loads[:3]")
    subprocess.run([sys.executable, "-c", program], check=True)


def processes_of(group):
    """The processes of a group that are not over."""
    listed = subprocess.run(["ps", "-eo", "pgid=,stat=,pid="], capture_output=True, text=True, check=True).stdout
    rows = [line.split() for line in listed.splitlines()]
    return [int(process) for its, state, process in rows if int(its) == group and not state.startswith("Z")]


def wait_for(condition, seconds=60):
    """Wait until something holds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.mark.usefixtures("ctrl_c")
@pytest.mark.parametrize(
    ("kill", "sent"),
    [
        pytest.param(os.killpg, signal.SIGINT, id="Ctrl-C in a terminal"),
        pytest.param(os.kill, signal.SIGINT, id="Ctrl-C in a notebook"),
        pytest.param(os.kill, signal.SIGKILL, id="killed"),
    ],
)
@pytest.mark.parametrize("starting", [True, False])
def test_all_processes_end_at_once_with_the_first_one(tmp_path, kill, sent, starting):
    """Whether the others solve already or are about to start."""
    weier.solve(SERIES[0], LOADS, "patches")  # compiles: Ctrl-C waits for LLVM
    script, log = tmp_path / "script.py", tmp_path / "log"
    script.write_text(
        f"if __name__ == '__main__':\n    {MANY.strip().replace(chr(10), chr(10) + '    ')}\n    {CALL}\n"
    )
    with log.open("w") as file:
        process = subprocess.Popen([sys.executable, script], stderr=file, start_new_session=True)
    wait_for(lambda: len(processes_of(process.pid)) >= 4)  # two others, and one of Python's that tidies up after them
    time.sleep(0 if starting else 3)
    kill(process.pid, sent)
    assert process.wait(AT_ONCE) == -sent
    wait_for(lambda: not processes_of(process.pid), seconds=AT_ONCE)
    told = log.read_text()
    assert told.count("Traceback") == (sent == signal.SIGINT)
    assert told.endswith("\nKeyboardInterrupt\n") == (sent == signal.SIGINT)


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_ends_a_command_with_all_its_processes_in_a_line():
    series = ["-D", "1.4", "--gamma", "5", "-m", "6", "--loads", "1e-3:1:400"]
    methods = ["--method", "bem", "--method", "patches", "--workers", "2"]
    command = [sys.executable, "-m", "weier", "solve", *series, *methods]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True)
    wait_for(lambda: len(processes_of(process.pid)) >= 3)
    time.sleep(1)
    os.killpg(process.pid, signal.SIGINT)
    _, told = process.communicate(timeout=AT_ONCE)
    assert process.returncode == INTERRUPTED
    assert told.splitlines()[-1] == STOPPED
    wait_for(lambda: not processes_of(process.pid), seconds=AT_ONCE)
