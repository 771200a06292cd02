"""The pipeline on a copy of the checkout: what runs, what runs again, and what a killed run leaves."""

import os
import re
import shutil
import subprocess

import pytest

from weier.data import dataset
from weier.kernels.sources import PACKAGE

SCENE = """
title: test
loads: [0.01, 0.1, 1.0]
methods: [demelio, bem]
batch: 1
studies:
  short: {product: {D: 1.25, gamma: 5, m: 1}}
  long: {product: {D: 1.25, gamma: 5, m: 2}}
figures:
  one: {draw: compliance, studies: [short]}
  two: {draw: resistance, studies: [long]}
"""


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    folder = tmp_path_factory.mktemp("checkout")
    shutil.copy("Snakefile", folder)
    for name in ("config", "rules"):
        shutil.copytree(name, folder / name)
    shutil.copytree(PACKAGE, folder / "weier")
    (folder / "config/scenes/test.yaml").write_text(SCENE)
    return folder


def run(checkout, *arguments):
    # Plain Python takes seconds for these few loads, compiling in a new folder would take a minute.
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    command = ["snakemake", "--cores", "2", *arguments, "--config", "scenes=test"]
    done = subprocess.run(command, cwd=checkout, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def planned(checkout, *arguments):
    """How often each rule would run."""
    text = run(checkout, "--dry-run", *arguments)
    table = text.partition("Job stats:")[2].partition("total")[0]
    return {rule: int(count) for rule, count in re.findall(r"^(\w+) +(\d+)$", table, re.M)}


def touch(path, text="# changed\n"):
    path.write_text(path.read_text() + text)


def test_one_figure_needs_only_its_cases(checkout):
    jobs = planned(checkout, "results/test/figures/one.png")
    assert jobs == {"compile": 1, "solve": 1, "gather": 1, "bounds": 1, "figure": 1}


@pytest.fixture(scope="module")
def finished(checkout):
    run(checkout)
    return checkout


def test_a_run_leaves_every_product(finished):
    results = finished / "results/test"
    made = {path.name for path in (results / "figures").iterdir()}
    assert made == {f"{figure}.{kind}" for figure in ("one", "two") for kind in ("pdf", "svg", "png")}
    data = dataset.read(results / "contact.nc")
    assert data.m.values.tolist() == [1, 2]
    assert not list(results.rglob(".*.nc*"))


def test_nothing_runs_twice(finished):
    assert planned(finished) == {}


def test_a_changed_figure_is_drawn_alone(finished):
    touch(finished / "weier/figures/compliance.py")
    assert planned(finished) == {"all": 1, "figure": 1}
    run(finished)


def test_a_changed_kernel_runs_all_that_depends_on_it(finished):
    touch(finished / "weier/methods/bem/fft.py")
    jobs = planned(finished)
    assert jobs["compile"] == 1
    assert jobs["solve"] == 2
    before = (finished / "results/test/contact.nc").read_bytes()
    run(finished)
    assert (finished / "results/test/contact.nc").read_bytes() == before


def test_a_study_more_solves_only_its_own_cases(finished):
    path = finished / "config/scenes/test.yaml"
    rough = "  rough: {product: {D: 1.5, gamma: 5, m: 3}, methods: [archard]}"  # longer, and by another method
    path.write_text(SCENE.replace("figures:", f"{rough}\nfigures:"))
    assert planned(finished)["solve"] == 1
    path.write_text(SCENE)


def test_a_bad_scene_stops_before_anything_runs(finished):
    path = finished / "config/scenes/test.yaml"
    path.write_text(SCENE.replace("loads", "lods"))
    command = ["snakemake", "--dry-run", "--config", "scenes=test"]
    done = subprocess.run(command, cwd=finished, capture_output=True, text=True)
    path.write_text(SCENE)
    assert done.returncode != 0
    assert "config/scenes/test.yaml: the top level" in done.stdout + done.stderr
