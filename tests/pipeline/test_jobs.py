"""Jobs solve what is missing with the code of the plan alone, and keep what they have solved."""

import shutil
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from tests.scenes import curves_in, scene_in, solve_scene
from weier import digests
from weier.api import batch
from weier.digests import PACKAGE, numerics
from weier.pipeline import jobs
from weier.pipeline.curves import CLOSED
from weier.pipeline.gather import read_study
from weier.pipeline.jobs import solve
from weier.pipeline.store import Store

SCENE = {
    "title": "t",
    "loads": [0.1, 1.0],
    "methods": ["archard", "bem", "demelio"],
    "studies": {"one": {"product": {"D": [1.25, 1.5], "gamma": 2, "m": [1, 2, float("inf")], "phases": [0, 1.0]}}},
}


def lacking(curves):
    return curves.store.lacking(curves.of_studies())


def solve_all(curves, said=None):
    solve(lacking(curves), curves.store, "test", (lambda line: None) if said is None else said.append)


@pytest.fixture
def curves(tmp_path):
    return curves_in(scene_in(tmp_path, SCENE), tmp_path / "curves")


def test_curves_of_jobs_are_those_of_cases_solved_one_by_one(curves, tmp_path):
    """Closed forms too, which are stored without phases; the status says why a curve is missing."""
    said = []
    solve_all(curves, said)
    assert lacking(curves) == []
    assert any("bem: m = inf has no finest wave" in line for line in said)
    found = read_study(curves_in(curves.scene, curves.store.folder), "one")
    expected = batch.solve_batch(curves.scene.studies["one"], curves.scene.loads, failed=lambda line: None)
    for name in expected.data_vars.keys() - {"seconds"}:
        xr.testing.assert_equal(found[name].drop_vars(("key", "surface_key")), expected[name].drop_vars("key"))
    shared = solve_scene(curves.scene, tmp_path / "shared", jobs=3)
    again = read_study(shared, "one")
    xr.testing.assert_equal(found.drop_vars("seconds"), again.drop_vars("seconds"))


REFUSED = "the code of weier has changed since {}: run snakemake again, which plans with the new code"


def test_a_job_whose_code_is_not_that_of_the_plan_solves_nothing(curves, monkeypatch):
    """As after an edit, or with another Python that has other packages, or another weier."""
    other = Store(curves.store.folder, "another")
    with pytest.raises(ValueError, match=REFUSED.format("the plan")):
        solve(lacking(curves), other, "test", print)
    monkeypatch.setattr(digests, "versions", lambda: "numpy 0")
    with pytest.raises(ValueError, match=REFUSED.format("the plan")):
        solve_all(curves)
    assert not curves.store.folder.exists()


@pytest.mark.parametrize("module", ["methods/demelio.py", "scene/case.py", "api/rows.py", "pipeline/store.py"])
def test_code_that_changes_while_a_job_works_is_no_code_of_its_curves(curves, tmp_path, monkeypatch, module):
    """What was appended before stays, and an undone edit leaves nothing of the edited code behind."""
    package = shutil.copytree(PACKAGE, tmp_path / "weier", ignore=shutil.ignore_patterns("__pycache__", "figures"))
    monkeypatch.setattr(digests, "PACKAGE", package)
    monkeypatch.setattr(jobs, "APPEND_SECONDS", 0)
    whole, own, done = (package / module).read_text(), jobs._row, []

    def edited(*given):
        if len(done) == 5:
            (package / module).write_text(f"{whole}\nMORE = 1\n")
        done.append(given)
        return own(*given)

    with monkeypatch.context() as patch:
        patch.setattr(jobs, "_row", edited)
        with pytest.raises(ValueError, match=REFUSED.format("this job began")):
            solve_all(curves)
    (package / module).write_text(whole)
    again = curves_in(curves.scene, curves.store.folder)
    assert sum(len(again.store.index(part.kind.name).keys) for part in (*again.surfaces, *again.parts)) == 5
    with monkeypatch.context() as patch:
        patch.setattr(jobs, "_row", lambda *given: done.append(given) or own(*given))
        solve_all(again)
    assert len(done) == 6 + 36 - 5


def test_words_in_a_module_that_change_while_a_job_works_do_not_stop_it(curves, tmp_path, monkeypatch):
    package = shutil.copytree(PACKAGE, tmp_path / "weier", ignore=shutil.ignore_patterns("__pycache__", "figures"))
    monkeypatch.setattr(digests, "PACKAGE", package)
    own = jobs._row

    def edited(*given):
        with (package / "methods/demelio.py").open("a") as file:
            file.write("# A comment.\n")
        return own(*given)

    monkeypatch.setattr(jobs, "_row", edited)
    solve_all(curves)
    assert lacking(curves_in(curves.scene, curves.store.folder)) == []


# Edits that change a number. If the module were not in the digest, old curves would count as those of the new code.
EDITS = {
    "Case.profile with another seed": ("scene/case.py", 'random_phases(p["seed"])', 'random_phases(p["seed"] + 1)'),
    "other loads": ("api/task.py", "self.profile, self.loads", "self.profile, 2 * self.loads"),
    "other loads of a kind": (
        "pipeline/curves.py",
        "loads = np.array(self.loads)",
        "loads = 2 * np.array(self.loads)",
    ),
    "the order of phases": (
        "surface/profile.py",
        "self.seed).uniform(0, 2 * np.pi, m)",
        "self.seed).uniform(0, 2 * np.pi, m)[::-1]",
    ),
    "a default of a setting": (
        "methods/bem/method.py",
        "points_per_wave: int | None = None",
        "points_per_wave: int = 32",
    ),
    "a closed form": ("methods/demelio.py", "return", "return 2 *"),
    "bounds of a row": ("api/rows.py", "solution.compliance, solution", "2 * solution.compliance, solution"),
    "what is stored of a row": ("pipeline/store.py", "column[row, ...]", "column[~row, ...]"),
    "numbers of a scene": ("scene/yaml.py", "return checked_number", "return 2 * checked_number"),
}


@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_that_changes_a_number_changes_the_digest_of_the_code(curves, tmp_path, monkeypatch, edit):
    module, old, new = EDITS[edit]
    package = shutil.copytree(PACKAGE, tmp_path / "weier", ignore=shutil.ignore_patterns("__pycache__", "figures"))
    text = (package / module).read_text()
    assert old in text
    monkeypatch.setattr(digests, "PACKAGE", package)
    before = numerics().name
    (package / module).write_text(text.replace(old, new, 1))
    assert numerics().name != before


def test_curves_are_appended_after_some_seconds_and_at_the_end(curves, monkeypatch):
    """And before rows fill memory. A job that is killed loses what it solved in ten seconds."""
    now, appended = [0.0], []

    def row(*given):
        now[0] += 1.999
        return {}

    def append(kind, rows, origin):
        appended.append(len(rows))

    monkeypatch.setattr(jobs, "monotonic", lambda: now[0])
    monkeypatch.setattr(jobs, "check_code", lambda *given: None)
    monkeypatch.setattr(jobs, "_row", row)
    monkeypatch.setattr(curves.store, "append", append)
    solve_all(curves)
    assert sum(appended) == 36
    assert max(appended) == 6
    monkeypatch.setattr(jobs, "MAX_ROWS", 4)
    solve_all(curves)
    assert max(appended[-8:]) == 4


SLOW = """
import sys, time
from weier.__main__ import run
from weier.pipeline import jobs
own = jobs._row
def slow(*given):
    print("solved", flush=True)
    time.sleep(0.1)
    return own(*given)
jobs._row, jobs.APPEND_SECONDS = slow, 0
sys.argv[:] = ["weier", *sys.argv[1:]]
run()
"""


@pytest.mark.parametrize("stop", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_job_that_is_stopped_keeps_its_curves_and_the_next_one_solves_the_rest(curves, tmp_path, stop, ctrl_c):
    arguments = [
        "curves",
        "all",
        CLOSED,
        "0",
        "1",
        curves.store.numerics,
        curves.store.folder,
        tmp_path / "scene.yaml",
    ]
    command = [sys.executable, "-c", SLOW, *arguments]
    job = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(6):
        assert job.stdout.readline() == "solved\n"
    job.send_signal(stop)
    _, said = job.communicate(timeout=60)
    assert job.returncode != 0
    assert "Traceback" not in said
    again = curves_in(curves.scene, curves.store.folder)
    left = sum(len(part.keys) for part in lacking(again))
    assert left <= sum(len(part.keys) for part in lacking(curves_in(curves.scene, tmp_path / "none"))) - 5
    start = time.monotonic()
    done = subprocess.run([sys.executable, "-m", "weier", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert time.monotonic() - start < 60
    rest = lacking(curves_in(curves.scene, curves.store.folder))
    assert {part.kind.method for part in rest} == {"bem"}
