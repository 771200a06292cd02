"""Jobs solve what is missing, and keep what they have solved. Code that changes meanwhile: test_freshness."""

import signal
import subprocess
import sys

import pytest
import xarray as xr

from tests.scenes import curves_in, scene_in, solve_scene
from weier.api import batch
from weier.pipeline import jobs
from weier.pipeline.gather import read_study

SCENE = {
    "title": "t",
    "loads": [0.1, 1.0],
    "methods": ["archard", "bem", "demelio"],
    "studies": {"one": {"product": {"D": [1.25, 1.5], "gamma": 2, "m": [1, 2, float("inf")], "phases": [0, 1.0]}}},
}


def lacking(curves):
    """What the store lacks now, as another process finds it."""
    again = curves_in(curves.scene, curves.store.folder)
    return again.store.lacking(again.parts_for())


@pytest.fixture
def curves(tmp_path):
    return curves_in(scene_in(tmp_path, SCENE), tmp_path / "curves")


def test_curves_of_jobs_are_those_of_cases_solved_one_by_one(curves):
    """Closed forms too, which are stored without phases; the status says why a curve is missing."""
    found = read_study(solve_scene(curves.scene, curves.store.folder, jobs=3), "one")
    assert lacking(curves) == []
    with pytest.warns(UserWarning, match="m = inf has no finest wave"):
        expected = batch.solve_batch(curves.scene.studies["one"], curves.scene.loads)
    for name in expected.data_vars.keys() - {"seconds"}:
        xr.testing.assert_equal(found[name].drop_vars("key"), expected[name].drop_vars("key"))


def test_an_error_of_one_curve_fails_the_job_once_the_others_are_solved(curves, monkeypatch):
    """Even one that no solver raises."""
    row, said = jobs._row, []

    def fails(kind, case, say):
        if kind.method == "archard" and case.parameters["D"] == 1.25:
            raise ZeroDivisionError
        return row(kind, case, say)

    monkeypatch.setattr(jobs, "_row", fails)
    with pytest.raises(ZeroDivisionError):
        jobs.solve(lacking(curves), curves.store, "test", said.append)
    assert {(part.kind.method, len(part.keys)) for part in lacking(curves)} == {("archard", 3)}
    assert any("bem: m = inf has no finest wave" in line for line in said)


SLOW = """
import sys, time
from weier.__main__ import run
from weier.pipeline import jobs
own = jobs._row
def slow(*given):
    print("solved", flush=True)
    time.sleep(0.1)
    return own(*given)
jobs._row, jobs.APPEND_SECONDS = slow, float(sys.argv.pop(1))
run()
"""


def test_jobs_that_are_stopped_keep_their_curves_and_the_next_one_solves_the_rest(tmp_path, ctrl_c):
    curves = curves_in(scene_in(tmp_path, SCENE | {"methods": ["archard", "demelio"]}), tmp_path / "curves")
    of = [
        "curves",
        "scene/all.products",
        "0-of-1",
        curves.store.numerics,
        curves.store.folder,
        tmp_path / "scene.yaml",
    ]
    left = [sum(len(part.keys) for part in lacking(curves))]
    for stop, seconds in ((signal.SIGKILL, 0), (signal.SIGTERM, 60), (signal.SIGINT, 60)):
        job = subprocess.Popen([sys.executable, "-c", SLOW, str(seconds), *of], stdout=-1, stderr=-1, text=True)
        for _ in range(6):
            assert job.stdout.readline() == "solved\n"
        job.send_signal(stop)
        _, said = job.communicate(timeout=60)
        assert job.returncode != 0
        assert "Traceback" not in said
        left.append(sum(len(part.keys) for part in lacking(curves)))
        assert left[-1] <= left[-2] - 5
    assert left[-1] > 0
    subprocess.run([sys.executable, "-m", "weier", *of], check=True, capture_output=True)
    assert lacking(curves) == []
