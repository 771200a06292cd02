"""The commands of the pipeline: one sentence and a non-zero exit for what is wrong, and nothing written."""

import re
from functools import partial

import pytest

from weier import scene
from weier.digests import numerics
from weier.figures import make as figures
from weier.pipeline.needed_curves import Curves
from weier.pipeline.products import ALL, DATA, job_of, stamp_of
from weier.pipeline.store import Store

SCENE = """
title: test
loads: [0.1]
methods: [demelio]
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2}}
"""


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "test.yaml"
    path.write_text(SCENE)
    return path


def curves(scene_file):
    """The arguments of the job of all curves."""
    return ["curves", "test/all.products", "0-of-1", numerics(), scene_file.parent / "curves", scene_file.parent]


def make(scene_file, what=DATA):
    """The arguments of the job that makes the dataset, or all products."""
    store, own = scene_file.parent / "curves", scene.load(scene_file)
    job, _ = job_of(own, what, partial(stamp_of, Curves(own, Store(store, numerics())), scene_file.parent))
    return ["make", scene_file, store, scene_file.parent / ".made_of" / job]


def test_a_product_without_curves_or_of_another_plan_is_named(run, scene_file, monkeypatch):
    def refused(planned, message):
        code, _, err = run(*planned)
        assert (code, bool(re.match(f"weier: {message}: run snakemake again", err.splitlines()[-1]))) == (1, True)
        assert [*scene_file.parent.rglob(DATA)] == []

    refused(planned := make(scene_file), r"contact.nc cannot be made: \d curves by .* are not solved")
    scene_file.write_text(SCENE.replace("m: 2", "m: 3"))
    refused(planned, "test or weier has changed since the plan")
    assert run(*curves(scene_file))[0] == 0
    digests = iter("ab")
    monkeypatch.setattr(figures, "made_of", lambda *given: next(digests))
    refused(make(scene_file), "contact.nc cannot be made: weier has changed meanwhile")
    monkeypatch.undo()
    assert run(*make(scene_file))[0] == 0


def fail_first(run, scene_file, monkeypatch, error):
    """Solve a scene of two figures, of which the first will raise an error."""

    def draw(wanted, studies, path, formats):
        if path.name == "first":
            raise error
        path.with_suffix(".png").touch()

    scene_file.write_text(
        SCENE.replace("[0.1]", "[0.1, 1]")
        + "figures: {first: &one {draw: compliance, studies: [one]}, second: *one}\n"
    )
    assert run(*curves(scene_file))[0] == 0
    monkeypatch.setattr(figures.figures, "draw", draw)


def test_a_missing_package_is_named_with_the_command_that_installs_it(run, scene_file, monkeypatch):
    fail_first(run, scene_file, monkeypatch, ModuleNotFoundError("No module named 'bokeh'"))
    code, _, err = run(*make(scene_file, ALL))
    last = err.splitlines()[-1]
    assert (code, last.startswith("weier: No module named 'bokeh': pip install 'weier[pipeline]'")) == (1, True)


@pytest.mark.parametrize("bug", [ValueError("no ink"), KeyError("no ink")])
def test_one_figure_that_cannot_be_drawn_does_not_keep_others_from_being_made(run, scene_file, monkeypatch, bug):
    fail_first(run, scene_file, monkeypatch, bug)
    code, _, err = run(*(arguments := make(scene_file, ALL)))
    assert (code, "weier: first cannot be made: " in err, "no ink" in err) == (0, True, True)
    assert {path.name for path in arguments[-1].iterdir()} == {DATA, "second", "page.html"}


def test_adopting_names_how_many_kinds_were_compared(run, scene_file):
    assert run(*curves(scene_file))[0] == 0
    folder = scene_file.parent / "curves"
    assert run("adopt", scene_file, "--curves", folder)[1].startswith("0 kinds of curves of other code")
    for path in folder.glob("*/*/"):
        path.rename(path.with_name("old"))
    code, out, _ = run("adopt", scene_file, "--curves", folder)
    assert (code, out.count("the same bits: adopted")) == (0, 2)
    assert out.splitlines()[-1] == f"2 kinds of curves of other code were compared with that of {numerics()}"


def test_all_mistakes_of_a_scene_are_named_each_in_a_line(run, scene_file):
    scene_file.write_text(SCENE.replace("1.25", "2.25").replace("[0.1]", "[0]"))
    code, out, err = run("adopt", scene_file)
    head, first, second = err.splitlines()
    assert (code, out, head) == (1, "", f"weier: {scene_file} has 2 mistakes:")
    assert first == "  line 3: loads: mean_pressure must be positive, got 0.0 at position 0"
    assert second == "  line 6: studies.one.product.D: D must lie in (1, 2), got 2.25"
