"""The commands of the pipeline: one sentence and a non-zero exit for what is wrong, and nothing written."""

import re
import signal

import pytest

from weier import scene
from weier.digests import numerics
from weier.pipeline.needed_curves import Curves
from weier.pipeline.products import made_of
from weier.pipeline.store import Store
from weier.pipeline.workflow import ALL

SCENE = """
title: test
loads: [0.1]
methods: [demelio]
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2}}
"""


@pytest.fixture(autouse=True)
def sigterm():
    """A job of curves handles SIGTERM as Ctrl-C."""
    before = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, before)


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "test.yaml"
    path.write_text(SCENE)
    return path


def curves(scene_file, plan=None):
    """The arguments of the job of all curves."""
    return ["curves", ALL, "0-of-1", plan or numerics(), scene_file.parent / "curves", scene_file]


def make(scene_file):
    """The arguments of the job that makes the dataset."""
    made = made_of(Curves(scene.load(scene_file), Store(scene_file.parent / "curves", numerics())), "contact.nc")
    return ["make", scene_file, scene_file.parent / "curves", scene_file.parent / "job", f"contact.nc/{made}"]


def test_a_product_without_curves_or_of_another_scene_is_named(run, scene_file):
    for edit, message in (
        ("m: 2", r"weier: contact.nc cannot be made: \d curves by .* are not solved: run snakemake again"),
        ("m: 3", "weier: contact.nc cannot be made: test or weier has changed since the plan: run snakemake again"),
    ):
        planned = make(scene_file)
        scene_file.write_text(SCENE.replace("m: 2", edit))
        code, _, err = run(*planned)
        assert (code, bool(re.match(message, err.splitlines()[-1]))) == (1, True)
        assert [path.name for path in scene_file.parent.iterdir()] == ["test.yaml"]


def test_adopting_names_how_many_kinds_were_compared(run, scene_file):
    assert run(*curves(scene_file))[0] == 0
    folder = scene_file.parent / "curves"
    assert run("adopt", scene_file, "--curves", folder)[1].startswith("0 kinds of curves of other code")
    for path in folder.glob("*/*/"):
        path.rename(path.with_name("old"))
    code, out, _ = run("adopt", scene_file, "--curves", folder)
    assert (code, out.count("the same bits: adopted")) == (0, 2)
    assert out.splitlines()[-1] == f"2 kinds of curves of other code were compared with that of {numerics()}"


@pytest.mark.parametrize("text", [SCENE.replace("loads: [0.1]", "loads: [0]"), SCENE.replace("1.25", "2.25"), "{"])
def test_a_bad_scene_is_one_sentence(run, scene_file, tmp_path, text):
    scene_file.write_text(text)
    code, _, err = run("make", scene_file, tmp_path, tmp_path / "job", "page.html/0")
    assert (code, err.count("\n")) == (1, 1)
    assert err.startswith(f"weier: {scene_file}")
    assert [path.name for path in tmp_path.iterdir()] == ["test.yaml"]
