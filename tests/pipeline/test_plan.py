"""The plan of a run: what is missing, who makes it, and messages that end a run."""

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
methods: [demelio, bem, patches]
studies:
  short: {product: {D: 1.25, gamma: 5, m: [1, 2]}}
  long: {product: {D: 1.25, gamma: 5, m: [2, 3]}}
figures:
  one: {draw: compliance, studies: [short], facet: m}
  two: {draw: resistance, studies: [long], facet: m}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Where Snakemake runs. Planning writes nothing."""
    (tmp_path / "config/scenes").mkdir(parents=True)
    for name in ("test", "other"):
        (tmp_path / f"config/scenes/{name}.yaml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    yield
    assert [path.name for path in tmp_path.iterdir()] == ["config"]


def plan(*names, slots=2):
    """As the rules have it, in a new run."""
    return Plan(names or ("test",), load_by_name, "config/scenes", slots)


def of(**wildcards):
    return SimpleNamespace(**{"scene": "test"} | wildcards)


def solved(plan, product, scene="test"):
    """The jobs that solve curves for the job that makes a product."""
    return plan.solved(of(scene=scene, what=Path(plan.job(scene, product)[0]).stem))


def test_products_of_all_scenes_wait_for_the_same_jobs_and_a_named_one_for_its_own(folder):
    """Scenes may share curves, which would be solved once for each of them."""
    together, beside = plan("test", "other"), plan("test")
    together.all_files(of()), beside.all_files(of())
    found = [solved(together, product, scene) for scene in ("test", "other") for product in ("one", "contact.nc")]
    assert found == [found[0]] * 4
    assert found[0][0].startswith("results/curves/.solved/test/other/all.products/")
    for own in (plan("test", "other"), beside):
        assert all(path.startswith("results/curves/.solved/other/one/") for path in solved(own, "one", "other"))


def test_missing_curves_are_shared_among_as_many_jobs_as_can_run_and_none_that_is_short(folder, monkeypatch):
    for seconds, slots, expected in ((1.0, 9, 1), (90.0, 3, 3), (1e4, 99, 8)):
        monkeypatch.setattr(workflow.Part, "seconds", np.array([seconds]))  # of each part
        found = [Path(path).name for path in solved(plan(slots=slots), "one")]
        assert found == [f"{number}-of-{expected}" for number in range(expected)]
    own, job = plan(), of(what="test/one", share="0-of-4")
    assert own.seconds(job) == 4 * 1e4 / 4  # of four parts
    assert [own.minutes(job, attempt) for attempt in (1, 2)] == [838, 1677]


def test_kernels_of_numerical_methods_are_compiled_in_shares_before_their_curves(folder, monkeypatch):
    for disabled, expected in (("0", ["bem.curves", "patches.curves", "patches.others"]), ("1", [])):
        monkeypatch.setenv("NUMBA_DISABLE_JIT", disabled)
        assert [Path(kernels).name for kernels in plan().kernels(of(what="test/one"))] == expected


@pytest.mark.parametrize(
    ("planned", "message"),
    [
        (lambda: solved(plan(), "three"), "a figure of test must be one of one, two, got 'three'"),
        (lambda: workflow.names_of_scenes({"scenes": 815}), "scenes must be names"),
        (lambda: workflow.names_of_scenes({"scenes": " "}), "scenes must be names"),
        (lambda: workflow.names_of_scenes({"scenes": "test", "scene": "other"}), "a key of --config must be"),
    ],
)
def test_a_wrong_scene_or_name_ends_in_one_sentence(folder, planned, message):
    with pytest.raises(SystemExit, match=f"^weier: {message}"):
        planned()
    assert workflow.names_of_scenes({"scenes": "test, 2024,test"}) == ["test", "2024"]
