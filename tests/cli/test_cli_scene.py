"""The commands of the pipeline: one sentence and a non-zero exit for what is wrong, and nothing written."""

import re
import subprocess
import sys

import pytest

from weier.data import dataset

SCENE = """
title: test
loads: [0.1]
methods: [demelio]
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2}}
"""


def weier(*arguments):
    return subprocess.run([sys.executable, "-m", "weier", *map(str, arguments)], capture_output=True, text=True)


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "test.yaml"
    path.write_text(SCENE)
    return path


def test_a_batch_becomes_two_files(scene_file, tmp_path):
    done = weier("batch", scene_file, "one-0", tmp_path / "data.nc", tmp_path / "cost.nc")
    assert done.returncode == 0
    said = [line for line in done.stderr.splitlines() if not line.startswith("compiling")]
    assert len(said) == 1
    assert re.fullmatch(r"solve test one-0: \d+\.\d s", said[0])
    assert {path.name for path in tmp_path.iterdir()} == {"test.yaml", "data.nc", "cost.nc"}


@pytest.mark.parametrize("text", [SCENE.replace("loads: [0.1]", "loads: [0]"), SCENE.replace("1.25", "2.25"), "{"])
def test_a_bad_scene_is_one_sentence(scene_file, tmp_path, text):
    scene_file.write_text(text)
    done = weier("batch", scene_file, "one-0", tmp_path / "data.nc", tmp_path / "cost.nc")
    assert done.returncode == 1
    assert done.stderr.startswith(f"weier: {scene_file}")
    assert done.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["test.yaml"]


def test_a_truncated_file_is_one_sentence(scene_file, tmp_path):
    whole, contact, table = tmp_path / "one-0.nc", tmp_path / "contact.nc", tmp_path / "claims.md"
    weier("batch", scene_file, "one-0", whole, tmp_path / "cost.nc")
    whole.write_bytes(whole.read_bytes()[:3000])
    done = weier("claims", scene_file, contact, table, tmp_path)
    assert done.returncode == 1
    assert "not a whole netCDF file: if weier made it, delete it" in done.stderr
    assert done.stderr.count("\n") == 1
    assert not contact.exists()
    assert not table.exists()


def test_an_unknown_batch_is_refused(scene_file, tmp_path):
    done = weier("batch", scene_file, "two-0", tmp_path / "data.nc", tmp_path / "cost.nc")
    assert done.returncode == 1
    assert "no batch 'two-0'" in done.stderr


def test_an_unknown_figure_is_refused(scene_file):
    done = weier("figure", scene_file, "two", "a.png", ".")
    assert done.returncode == 1
    assert "has no figure 'two'" in done.stderr


@pytest.fixture
def solved(run, scene_file, tmp_path):
    run("batch", scene_file, "one-0", tmp_path / "data.nc", tmp_path / "cost.nc")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["claims", "test.yaml", "x.nc", "x.md", "none"], 1, "there is no file none/one-0.nc: make it first"),
        (["claims", "test.yaml", "x.nc", "x.md"], 2, "Missing argument 'BATCHES'"),
        (["draw", "work_precision", "x.png"], 1, "drawn from one file, that of `weier tradeoff`"),
        (["draw", "work_precision", "x.png", "data.nc"], 1, "drawn from one file, that of `weier tradeoff`"),
        (["draw", "extremes", "x.png", "data.nc"], 1, "drawn from one file, that of `weier extremes`"),
        (["draw", "../x", "x.png", "data.nc"], 1, "there is no figure '../x': choose from"),
        (["page", "test.yaml", "x.html", "data.nc", "none.png"], 1, "has no figure 'none'"),
        (["page", "test.yaml", "x.html", "data.nc", "data.nc"], 1, "data.nc has no seconds: take the file of costs"),
        (["convergence", "test.yaml", "x.nc", "--terms", "0"], 2, "0 is not in the range"),
        (["batch", "test.yaml", "one-0", "x.nc", "y.nc", "--threads", "0"], 2, "0 is not in the range"),
    ],
)
def test_a_file_of_another_kind_is_one_sentence(run, solved, monkeypatch, arguments, code, message):
    monkeypatch.chdir(solved)
    stopped, out, err = run(*arguments)
    assert (stopped, out) == (code, "")
    assert message in err.splitlines()[-1]
    assert {path.name for path in solved.iterdir()} == {"test.yaml", "data.nc", "cost.nc"}


def test_numbers_that_yaml_takes_for_words_are_numbers(run, scene_file, tmp_path):
    text = SCENE.replace(
        "[demelio]", "[bem, layer]\nsettings: {bem: {residual_tolerance: VALUE}, layer: {accuracy: VALUE}}"
    )
    found = []
    for value in ("1e-9", "1.0e-9"):
        scene_file.write_text(text.replace("VALUE", value))
        code, _, err = run("batch", scene_file, "one-0", tmp_path / "data.nc", tmp_path / "cost.nc")
        assert code == 0, err
        with dataset.reading(tmp_path / "data.nc") as data:
            found.append((data["key"].values.tolist(), data["settings"].values.tolist()))
    assert found[0] == found[1]
    assert all("1e-09" in settings for settings in found[0][1][0])
