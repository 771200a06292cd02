"""Jobs solve what is missing with the code of the plan alone, and keep what they have solved."""

import signal
import subprocess
import sys

import pytest
import xarray as xr

from tests.scenes import curves_in, scene_in, solve_scene
from weier.api import batch
from weier.pipeline import jobs
from weier.pipeline.gather import read_study
from weier.pipeline.jobs import solve

SCENE = {
    "title": "t",
    "loads": [0.1, 1.0],
    "methods": ["archard", "bem", "demelio"],
    "studies": {"one": {"product": {"D": [1.25, 1.5], "gamma": 2, "m": [1, 2, float("inf")], "phases": [0, 1.0]}}},
}


def lacking(curves):
    return curves.store.lacking(curves.parts_for())


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
    with pytest.warns(UserWarning, match="m = inf has no finest wave"):
        expected = batch.solve_batch(curves.scene.studies["one"], curves.scene.loads)
    for name in expected.data_vars.keys() - {"seconds"}:
        xr.testing.assert_equal(found[name].drop_vars("key"), expected[name].drop_vars("key"))
    shared = solve_scene(curves.scene, tmp_path / "shared", jobs=3)
    again = read_study(shared, "one")
    xr.testing.assert_equal(found.drop_vars("seconds"), again.drop_vars("seconds"))


def test_an_error_of_one_curve_fails_the_job_once_the_others_are_solved(curves, monkeypatch):
    """Even one that no solver raises."""
    row = jobs._row

    def fails(kind, case, say):
        if kind.method == "archard" and case.parameters["D"] == 1.25:
            raise ZeroDivisionError
        return row(kind, case, say)

    monkeypatch.setattr(jobs, "_row", fails)
    with pytest.raises(ZeroDivisionError):
        solve_all(curves)
    again = curves_in(curves.scene, curves.store.folder)
    assert {(part.kind.method, len(part.keys)) for part in lacking(again)} == {("archard", 3)}


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


def test_jobs_that_are_stopped_keep_their_curves_and_the_next_one_solves_the_rest(tmp_path, ctrl_c):
    curves = curves_in(scene_in(tmp_path, SCENE | {"methods": ["archard", "demelio"]}), tmp_path / "curves")
    arguments = [
        "curves",
        "scene/all.products",
        "0-of-1",
        curves.store.numerics,
        curves.store.folder,
        tmp_path / "scene.yaml",
    ]
    left = [sum(len(part.keys) for part in lacking(curves))]
    for stop in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT):
        job = subprocess.Popen(
            [sys.executable, "-c", SLOW, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        for _ in range(6):
            assert job.stdout.readline() == "solved\n"
        job.send_signal(stop)
        _, said = job.communicate(timeout=60)
        assert job.returncode != 0
        assert "Traceback" not in said
        left.append(sum(len(part.keys) for part in lacking(curves_in(curves.scene, curves.store.folder))))
        assert left[-1] <= left[-2] - 5
    assert left[-1] > 0
    done = subprocess.run([sys.executable, "-m", "weier", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert lacking(curves_in(curves.scene, curves.store.folder)) == []
