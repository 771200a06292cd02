"""The commands of the pipeline: one sentence and a non-zero exit for what is wrong, and nothing written."""

import re
import shutil
import signal
import subprocess
import sys

import pytest
import xarray as xr

from weier import scene
from weier.api import workers
from weier.data import dataset, netcdf
from weier.pipeline.batches import Solutions

SCENE = """
title: test
loads: [0.1]
methods: [demelio]
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2}}
"""


@pytest.fixture(autouse=True)
def sigterm():
    """A batch handles SIGTERM as Ctrl-C."""
    before = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, before)


def weier(*arguments):
    return subprocess.run([sys.executable, "-m", "weier", *map(str, arguments)], capture_output=True, text=True)


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "test.yaml"
    path.write_text(SCENE)
    return path


@pytest.fixture
def description(scene_file, tmp_path):
    solutions = Solutions(scene.load(scene_file), tmp_path / "batches")
    (path,) = solutions.files()
    solutions.store.write()
    return path.with_suffix(".json")


@pytest.fixture
def solved(run, description):
    """The folder of the batches of a scene that is solved."""
    assert run("batch", description, description.with_suffix(".nc"))[0] == 0
    return description.parent


def test_a_batch_becomes_a_file(description, tmp_path):
    done = weier("batch", description, tmp_path / "data.nc")
    assert done.returncode == 0
    said = [line for line in done.stderr.splitlines() if not line.startswith("compiling")]
    assert len(said) == 1
    assert re.fullmatch(r"solve 1 case of one by \w+: \d+\.\d s", said[0])
    assert {path.name for path in tmp_path.iterdir()} == {"test.yaml", "batches", "data.nc"}


def test_an_interrupted_batch_goes_on_from_what_it_has_solved(run, scene_file, tmp_path, monkeypatch):
    scene_file.write_text(SCENE.replace("m: 2", "m: 2, seed: [1, 2, 3, 4, 5]"))
    solutions = Solutions(scene.load(scene_file), tmp_path / "batches")
    (path,) = solutions.files()
    solutions.store.write()
    description, part = path.with_suffix(".json"), path.with_suffix(".part")
    assert run("batch", description, tmp_path / "whole.nc")[0] == 0
    solved, own = [], workers.Solver.__call__

    def interrupted(solver, curve):
        if len(solved) == 2:
            raise KeyboardInterrupt
        solved.append(curve)
        return own(solver, curve)

    with monkeypatch.context() as patch:
        patch.setattr(workers.Solver, "__call__", interrupted)
        with pytest.raises(KeyboardInterrupt):
            run("batch", description, path)
    assert (part.exists(), path.exists()) == (True, False)
    solved.clear()
    with monkeypatch.context() as patch:
        patch.setattr(workers.Solver, "__call__", lambda solver, curve: solved.append(curve) or own(solver, curve))
        assert run("batch", description, path)[0] == 0
    assert (len(solved), part.exists()) == (3, False)
    whole, found = (dataset.read(file).drop_vars("seconds") for file in (tmp_path / "whole.nc", path))
    xr.testing.assert_identical(whole.drop_attrs(), found.drop_attrs())


def test_a_job_solves_the_batches_that_its_last_one_names(run, scene_file, tmp_path, monkeypatch):
    """And those that are there stay as they are."""
    scene_file.write_text(SCENE.replace("[demelio]", "[archard, demelio, persson]"))
    solutions = Solutions(scene.load(scene_file), tmp_path / "batches")
    (path,) = solutions.files()
    solutions.store.write()
    code, _, err = run("batch", path.with_suffix(".json"), path)
    assert (code, err.count("\n")) == (0, 1)
    assert err.startswith("solve 3 curves by archard, demelio, persson: ")
    for batch in solutions.store.job(path.stem):
        found = dataset.read(path.with_name(f"{batch.name}.nc"))
        assert found.solution_method.values.tolist() == [batch.kind.method]
    first, *_ = sorted(path.parent.glob("archard*.nc"))
    date = first.stat().st_mtime_ns
    path.unlink()
    assert run("batch", path.with_suffix(".json"), path)[0] == 0
    assert (first.stat().st_mtime_ns, path.exists()) == (date, True)


def test_the_part_of_another_batch_is_refused(run, description, solved):
    path = description.with_suffix(".nc")
    shutil.copy(path, path.with_suffix(".part"))
    netcdf.seal(path.with_suffix(".part"), "another")
    code, _, err = run("batch", description, path)
    assert (code, "another file than its name says: delete it" in err) == (1, True)


@pytest.mark.parametrize("text", [SCENE.replace("loads: [0.1]", "loads: [0]"), SCENE.replace("1.25", "2.25"), "{"])
def test_a_bad_scene_is_one_sentence(scene_file, tmp_path, text):
    scene_file.write_text(text)
    done = weier("products", scene_file, tmp_path, tmp_path / "page.html")
    assert done.returncode == 1
    assert done.stderr.startswith(f"weier: {scene_file}")
    assert done.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["test.yaml"]


def test_an_explorer_without_curves_is_removed_and_named(run, scene_file, tmp_path):
    (tmp_path / "page.html").touch()
    code, _, err = run("products", scene_file, tmp_path / "none", tmp_path / "page.html")
    first, why, last = err.splitlines()
    assert (code, first) == (0, "make test: page.html")
    assert re.match(
        r"weier: page.html cannot be drawn: D = 1.25.* is not solved by demelio in .*/none: run snake", why
    )
    assert last.startswith("products test page.html: ")
    assert not (tmp_path / "page.html").exists()


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["products", "test.yaml", "none", "contact.nc"], 1, "is not solved by demelio in none: run snake"),
        (["products", "test.yaml", "none", "x/two.png"], 1, "two.png is no file of the scene: choose from cont"),
        (["batch", "test.json", "x.nc"], 1, "test.json does not describe a batch: delete it"),
        (["draw", "work_precision", "x.png"], 1, "drawn from the file of `python -m weier.accuracy tradeoff`"),
        (
            ["draw", "work_precision", "x.png", "DATA"],
            1,
            "drawn from the file of `python -m weier.accuracy tradeoff`",
        ),
        (["draw", "extremes", "x.png", "DATA"], 1, "drawn from the file of `python -m weier.accuracy extremes`"),
        (["draw", "../x", "x.png", "DATA"], 1, "there is no figure '../x': choose from"),
    ],
)
def test_a_file_of_another_kind_is_one_sentence(run, solved, tmp_path, monkeypatch, arguments, code, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "test.json").write_text(SCENE)
    (data,) = solved.glob("*.nc")
    stopped, out, err = run(*(data if argument == "DATA" else argument for argument in arguments))
    assert (stopped, out) == (code, "")
    assert message in err.splitlines()[-1]
    assert {path.name for path in tmp_path.iterdir()} == {"test.yaml", "test.json", "batches"}
