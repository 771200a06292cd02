"""The plan of a run: what is missing, who solves it, and messages that end a run. Planning writes nothing."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from weier.figures.scene_checks import load_by_name
from weier.pipeline import workflow
from weier.pipeline.workflow import Plan

SCENE = """
title: test
loads: [0.1, 1.0]
methods: [demelio, bem]
studies:
  short: {product: {D: 1.25, gamma: 5, m: [1, 2]}}
  long: {product: {D: 1.25, gamma: 5, m: [2, 3]}}
figures:
  one: {draw: compliance, studies: [short], facet: m}
  two: {draw: resistance, studies: [long], facet: m}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Where Snakemake runs, with one scene."""
    (tmp_path / "config/scenes").mkdir(parents=True)
    (tmp_path / "config/scenes/test.yaml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    assert [path.name for path in tmp_path.iterdir() if path.name not in ("results", ".snakemake")] == ["config"]


def plan(*names, slots=2):
    """As the rules have it, in a new run."""
    return Plan(names or ("test",), load_by_name, "config/scenes", slots)


def of(**wildcards):
    return SimpleNamespace(**{"scene": "test"} | wildcards)


def change(folder, old, new):
    path = folder / "config/scenes/test.yaml"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def solved(plan, product, scene="test"):
    """The jobs that solve curves for the job that makes a product."""
    return plan.solved(of(scene=scene, what=Path(plan.job(scene, product)[0]).stem))


def test_products_of_all_scenes_wait_for_the_same_jobs_and_a_named_one_for_its_own(folder):
    """Scenes may share curves, which would be solved once for each of them."""
    (folder / "config/scenes/other.yaml").write_text(SCENE)
    together = plan("test", "other")
    together.all_files(of())
    found = [solved(together, product, scene) for scene in ("test", "other") for product in ("one", "contact.nc")]
    assert found == [found[0]] * 4
    assert found[0][0].startswith("results/curves/.solved/test/other/all.products/")
    beside = plan("test")
    beside.all_files(of())
    for own in (plan("test", "other"), beside):
        (job,) = solved(own, "one", "other")
        assert job.startswith("results/curves/.solved/other/one/")


def test_missing_curves_are_shared_among_as_many_jobs_as_can_run_and_none_that_is_short(folder, monkeypatch):
    for seconds, slots, expected in ((1.0, 9, 1), (90.0, 3, 3), (1e4, 99, 6)):
        monkeypatch.setattr(workflow.Part, "seconds", np.array([seconds]))  # of each part
        found = solved(plan(slots=slots), "one")
        assert [Path(path).name for path in found] == [f"{number}-of-{expected}" for number in range(expected)]
    own, job = plan(), of(what="test/one", share="0-of-4")
    assert own.seconds(job) == 3 * 1e4 / 4  # of three parts
    assert [own.minutes(job, attempt) for attempt in (1, 2)] == [630, 1260]


def test_kernels_of_numerical_methods_are_compiled_in_shares_before_their_curves(folder, monkeypatch):
    change(folder, "bem]", "bem, patches]")
    for disabled, expected in (("0", ["bem.curves", "patches.curves", "patches.others"]), ("1", [])):
        monkeypatch.setenv("NUMBA_DISABLE_JIT", disabled)
        assert [Path(kernels).name for kernels in plan().kernels(of(what="test/one"))] == expected


def test_a_wrong_scene_ends_in_one_sentence(folder):
    change(folder, "1.25, gamma: 5, m: [1", "2.25, gamma: 5, m: [1")
    for function in (lambda: plan().all_files(of()), lambda: solved(plan(), "one")):
        with pytest.raises(SystemExit, match=r"^weier: config/scenes/test.yaml.*D must lie in \(1, 2\)"):
            function()
    with pytest.raises(SystemExit, match=r"^weier: a scene of .* must be one of .*, got 'tset'"):
        solved(plan(), "one", scene="tset")
    change(folder, "2.25, gamma", "1.25, gamma")
    with pytest.raises(SystemExit, match=r"^weier: a figure of test must be one of one, two, got 'three'"):
        solved(plan(), "three")


def test_scenes_are_named_by_words_with_commas_between():
    assert workflow.names_of_scenes({"scenes": "test, 2024,test"}) == ["test", "2024"]
    for wrong in (815, 1000.0, None, "", [1], True):  # Snakemake reads 0815 as 815, which may be another scene
        with pytest.raises(SystemExit, match=r"^weier: scenes must be names .*, got .*: rename .*, with quotes$"):
            workflow.names_of_scenes({"scenes": wrong})
