"""Curves solved by several processes: the same bits and reasons, and an end with the process that started them."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import weier
from weier.api.batch import LOST, solve_curves
from weier.api.progress import Progress
from weier.api.task import CurveTask
from weier.data.variables import Status

LOADS = np.array([0.01, 0.1, 1.0])
LONG_PERIOD = weier.Profile(1.5, "6/5", 4, 1.0)  # rounding is above 1e-13 g_0 at heavy loads
SERIES = [weier.Profile(1.25, 5, 3, weier.random_phases(seed)) for seed in range(3)]


@pytest.mark.second_attempt
def test_curves_of_another_process_have_the_same_bits():
    """So have the edges of contact, and the reasons why there is no curve are the same."""
    trace = weier.Trace(1e-6 * np.sin(np.arange(64) * 2 * np.pi / 64) ** 3, length=1e-3, unit="m")
    methods, strict = ["demelio", "bem", "patches"], {"tolerance": 1e-13}
    found = []
    for count in (1, 2):
        with pytest.warns(UserWarning, match="patches: |trace") as warned:
            solved = weier.solve(
                [SERIES[0], LONG_PERIOD, trace],
                LOADS[1:],
                methods,
                contact_edges=True,
                workers=count,
                patches=strict,
            )
        found.append((solved.drop_vars("seconds"), [str(warning.message) for warning in warned]))
    assert set(np.unique(found[0][0].status)) == {Status.solved, Status.not_applicable, Status.not_converged}
    xr.testing.assert_identical(found[0][0], found[1][0])
    assert found[0][1] == found[1][1]


def test_progress_counts_the_loads_of_all_processes():
    progress = Progress(9, "9 loads", 0.0, print)
    outcomes = solve_curves([CurveTask(profile, "demelio", {}, LOADS) for profile in SERIES], 2, progress)
    assert [progress.done for _ in outcomes] == [0, 3, 6]
    assert progress.done == 9


def test_a_count_of_workers_that_cannot_be_is_refused():
    for profile in (SERIES, SERIES[0]):
        with pytest.raises(ValueError, match="whole number, at least 1, or -1 for all cores, got 0"):
            weier.solve(profile, LOADS, "demelio", workers=0)


SCRIPT = """
import weier
profiles = [weier.Profile(1.25, 5, 5, weier.random_phases(seed)) for seed in range({count})]
{guard}weier.solve(profiles, [0.01, 0.1, 1.0, 3.0], ["patches"], workers=2)
"""


def test_a_script_without_a_guard_gives_a_message(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(count=2, guard=""))
    done = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert done.returncode == 1
    assert f"ChildProcessError: {LOST}" in done.stderr


@pytest.mark.usefixtures("ctrl_c")
@pytest.mark.parametrize(("kill", "sent"), [(os.killpg, signal.SIGINT), (os.kill, signal.SIGKILL)])
def test_all_processes_end_with_the_first(tmp_path, kill, sent):
    """By Ctrl-C, which a terminal sends to all of them, and where the first one is killed."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(count=3000, guard="if __name__ == '__main__': "))
    process = subprocess.Popen([sys.executable, script], stderr=subprocess.PIPE, text=True, start_new_session=True)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while len(children.read_text().split()) < 2:
        time.sleep(0.1)
    time.sleep(1)  # The others have started, but are far from done.
    kill(process.pid, sent)
    _, output = process.communicate(timeout=10)  # which waits for all that hold the pipe
    assert process.returncode == -sent
    assert ("KeyboardInterrupt" in output) == (sent == signal.SIGINT)
