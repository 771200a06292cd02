"""The pipeline on a copy of the checkout: what runs, what runs again, and what a killed run leaves."""

import json
import os
import re
import shutil
import subprocess
import sys
from base64 import b64encode
from pathlib import Path

import pytest

from tests.snakemakes import snakemake
from weier.data import dataset
from weier.data.provenance import VERSION
from weier.digests import PACKAGE

SCENE = """
title: test
loads: [0.01, 0.1, 1.0]
methods: [demelio, bem]
studies:
  short: {product: {D: 1.25, gamma: 5, m: 1}}
  long: {product: {D: 1.25, gamma: 5, m: 2}}
figures:
  one: {draw: compliance, studies: [short]}
  two: {draw: resistance, studies: [long]}
"""


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    """A folder whose name a shell would take apart."""
    folder = tmp_path_factory.mktemp("checkout") / "o'neil lab (2)"
    folder.mkdir()
    shutil.copy("Snakefile", folder)
    for name in ("config", "rules"):
        shutil.copytree(name, folder / name)
    shutil.copytree(PACKAGE, folder / "weier")
    (folder / "config/scenes/test.yaml").write_text(SCENE)
    return folder


def call(checkout, *arguments, scene="test", cores=("--cores", "2")):
    # Plain Python takes seconds for these few loads, compiling in a new folder would take a minute.
    # One date makes the bytes of two runs the same. Bytecode is kept in the copy, or each run would make it anew.
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "SOURCE_DATE_EPOCH": "1000000000"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    return snakemake(*cores, *arguments, "--config", f"scenes={scene}", cwd=checkout, env=environment)


def run(checkout, *arguments, scene="test"):
    done = call(checkout, *arguments, scene=scene)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def planned(checkout, *arguments, scene="test"):
    """How often each rule would run, but for the one that only collects."""
    text = run(checkout, "--dry-run", *arguments, scene=scene)
    assert "Job stats:" in text or "Nothing to be done" in text  # which a profile may silence
    table = text.partition("Job stats:")[2].partition("total")[0]
    found = {rule: int(count) for rule, count in re.findall(r"^(\w+) +(\d+)$", table, re.M)}
    return {rule: count for rule, count in found.items() if rule != "all"}


def made(said):
    """The products that were made, and the number of curves that were solved."""
    solved = sum(map(int, re.findall(r"^solve (\d+) curves by .*: [\d.]+ s$", said, re.M)))
    return sorted(re.findall(r"^make \w+ (\S+): [\d.]+ s$", said, re.M)), solved


def edit(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_what_runs_no_job_needs_no_number_of_cores_and_writes_nothing(checkout, tmp_path):
    """Nor do mistakes of a scene end a run that does not need it."""
    copy = tmp_path / "copy"
    shutil.copytree(checkout, copy, ignore=shutil.ignore_patterns(".snakemake", "results"))
    (copy / "config/scenes/bad.yaml").write_text(SCENE.replace("D: 1.25", "D: 2.25"))
    for command in (["--dry-run"], ["--summary"], ["--dag"], ["--dry-run", "tradeoff", "--config", "scenes=bad"]):
        done = call(copy, *command, cores=())
        assert done.returncode == 0, done.stderr
        assert done.stdout
    done = call(copy, "--dry-run", scene="bad")
    assert done.returncode == 1
    assert done.stderr.count("D must lie in (1, 2)") == 2
    assert not (copy / "results").exists()


EVERY = ["contact.nc", "one", "page.html", "two"]


@pytest.fixture(scope="module")
def finished(checkout):
    assert made(run(checkout))[0] == EVERY
    return checkout


def test_a_run_leaves_every_product_and_nothing_else(finished):
    results = finished / "results/test"
    drawn = {path.name for path in (results / "figures").iterdir()}
    assert drawn == {f"{figure}.{kind}" for figure in ("one", "two") for kind in ("pdf", "svg", "png", "csv")}
    assert dataset.read(results / "contact.nc").m.values.tolist() == [1, 2]
    left = [
        path
        for path in (finished / "results").rglob(".*")
        if path.name not in (".made_of", ".drafts", ".solved", ".snakemake_timestamp")
    ]
    assert left == []
    assert not any(path.is_file() for path in (finished / "results/curves/.solved").rglob("*"))
    assert planned(finished) == {}


def test_a_copy_of_the_results_alone_makes_nothing_again(finished, tmp_path):
    """Without Snakemake's records, and with files of any dates; and another scene there is made."""
    copy = shutil.copytree(finished, tmp_path / "copy", ignore=shutil.ignore_patterns(".snakemake"))
    for path in (copy / "results").rglob("*"):
        path.touch()
    assert planned(copy) == {}
    assert planned(copy, "results/test/figures/one.png") == {}
    edit(copy / "config/scenes/test.yaml", "resistance,", "resistance, x: linear,")
    assert made(run(copy)) == (["contact.nc", "two"], 0)


def test_edited_and_lost_products_are_made_again_alone(finished):
    """All at once; and a second edit of the same file is seen, too."""
    products = finished / "results/test"
    files = ("figures/one.png", "figures/two.csv", "claims.md", "page.html")
    whole = {file: (products / file).read_bytes() for file in files}
    for name, edited, expected in (
        ("contact.nc", files[:3], ["contact.nc", "one", "two"]),
        ("figures/two.svg", files[1:], ["contact.nc", "page.html", "two"]),
    ):
        (products / name).unlink()
        for file in edited:
            (products / file).write_bytes(whole[file] + b" ")
        assert made(run(finished)) == (expected, 0)
        assert {file: (products / file).read_bytes() for file in files} == whole
    assert planned(finished) == {}


def test_there_and_back_each_product_is_that_of_its_scene(finished):
    path, products = finished / "config/scenes/test.yaml", finished / "results/test"
    first = {file: (products / file).read_bytes() for file in ("contact.nc", "page.html", "figures/two.svg")}
    other = SCENE.replace("title: test", "title: other").replace("resistance,", "resistance, x: linear,")
    for text in (other, SCENE):
        path.write_text(text)
        assert made(run(finished)) == (["contact.nc", "page.html", "two"], 0)
    assert planned(finished) == {}
    assert first == {file: (products / file).read_bytes() for file in first}


def test_what_is_named_is_made_alone_if_it_is_not_up_to_date(finished):
    for file in ("figures/two.png", "claims.md", "page.html"):
        assert planned(finished, f"results/test/{file}") == {}
    (finished / "results/test/figures/two.png").write_text("edited")
    (finished / "results/test/claims.md").write_text("edited")
    assert made(run(finished, "results/test/figures/two.png")) == (["two"], 0)
    assert made(run(finished)) == (["contact.nc"], 0)


def test_figures_beside_one_that_cannot_be_drawn_are_kept(finished):
    module, line = finished / "weier/figures/many_curves.py", "    return figure\n"
    fault = '    if quantity == "resistance":\n        raise ValueError("no ink")\n'
    edit(module, line, fault + line)
    shutil.copytree("profiles/local", finished / "profiles/default")
    killed = finished / "results/test/.drafts/all.0-of-3.abc/contact.nc"
    killed.mkdir(parents=True)
    stamps = sorted((finished / "results/test/.made_of/two").iterdir())
    done = call(finished, "--latency-wait", "1", cores=("--cores", "1"))  # one job, of which the others are kept
    shutil.rmtree(finished / "profiles")  # which says nothing of plans
    assert done.returncode == 1
    assert "weier: two cannot be made: no ink\n" in done.stdout
    assert sorted((finished / "results/test/.made_of/two").iterdir()) == stamps
    assert not killed.exists()
    assert made(done.stdout) == (["one", "page.html"], 0)
    assert planned(finished) == {"make": 1, "made_of": 1, "figure": 1}
    edit(module, fault, "")
    assert made(run(finished)) == (["one", "page.html"], 0)  # two is still that of the code before
    assert planned(finished) == {}


def test_changed_code_of_curves_solves_all_again_and_adopting_solves_nothing(finished):
    """As of other words of an error message, which count as code."""
    edit(finished / "weier/methods/bem/active_set.py", "MAX_STEPS = 1000", "MAX_STEPS = 10 * 100")
    assert planned(finished) == {"solve": 2, "make": 2, "made_of": 4, "data": 1, "figure": 2, "page": 1}
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": "."}
    command = [sys.executable, "-m", "weier", "adopt", "config/scenes/test.yaml"]
    done = subprocess.run(command, cwd=finished, env=environment, capture_output=True, text=True)
    assert done.stdout.count("the same bits: adopted") == 3, done.stdout + done.stderr
    assert made(run(finished)) == (EVERY, 0)


def test_the_report_of_snakemake_has_the_explorer_and_the_figures_with_captions(finished):
    run(finished, "--report", "report.html")
    text = (finished / "report.html").read_text()
    page = (finished / "results/test/page.html").read_bytes()
    assert b'"curve bem"' in page  # the data of a line of the explorer
    assert f";filename=page.html;base64,{b64encode(page).decode()}" in text
    assert "Compliance over mean pressure. All curves of one profile meet at full contact" in text
    assert "What the paper states, whether it holds, does not hold, or is not decided" in text
    assert re.findall(r'<(?:script|link|img)[^>]*(?:src|href)="https?:', text) == []


def test_the_workflow_runs_from_any_folder(finished, tmp_path):
    """With the scenes of the checkout, or with scenes of that folder; and as a module of another workflow there."""

    def said(*more, snakefile=finished / "Snakefile"):
        command = ["-s", snakefile, "-d", tmp_path, "--cores", "2", *more]
        done = snakemake(*command, cwd=tmp_path.parent, env=os.environ | {"NUMBA_DISABLE_JIT": "1"})
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr

    assert "results/extremes/extremes.md" in said("--dry-run", "extremes")
    (tmp_path / "config/scenes").mkdir(parents=True)
    (tmp_path / "config/scenes/own.yaml").write_text(SCENE.replace("demelio, bem", "demelio"))
    said("--config", "scenes=own", "--", "results/own/figures/one.png")
    assert (tmp_path / "results/own/figures/one.png").exists()
    (tmp_path / "Snakefile").write_text(MODULE.format(repr(str(finished / "Snakefile"))).rstrip() + " as weier_*\n")
    planned = said("--dry-run", "--config", "scenes=own", "--", "weier_all", snakefile=tmp_path / "Snakefile")
    assert set(re.findall(r"^weier_(\w+) +\d+$", planned, re.M)) == {
        "all",
        "solve",
        "make",
        "made_of",
        "data",
        "figure",
        "page",
    }


MODULE = """
module weier:
    snakefile: {}
    config: config

use rule * from weier
"""
DEPLOYED = 'configfile: "config/config.yaml"' + MODULE.format(
    'github("someone/weier", path="Snakefile", branch="main")'
)


def commit(folder):
    """Make a repository of all files of a folder."""
    author = ["-c", "user.name=someone", "-c", "user.email=someone@example.org"]
    for command in (["init", "-q", "-b", "main"], ["add", "."], [*author, "commit", "-q", "-m", "Begin"]):
        subprocess.run(["git", *command], cwd=folder, check=True)


def test_with_conda_the_jobs_run_in_the_environment_of_the_rules(checkout, tmp_path, monkeypatch):
    """A program that answers as conda does is enough for a plan."""
    conda = tmp_path / "conda"
    answers = {
        "info": {"conda_prefix": "/", "platform": "linux-64"},
        "config": {"get": {"channel_priority": "strict"}},
    }
    cases = "".join(f"{word}) echo '{json.dumps(answer)}';;\n" for word, answer in answers.items())
    conda.write_text(f"#!/bin/sh\ncase $1 in\n{cases}--version) echo conda 24.7.1;;\nesac\n")
    conda.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    image = run(checkout, "--containerize")
    assert "COPY rules/environment.yaml /conda-envs/" in image
    assert f"weier=={VERSION}" in image
    line = "Conda environment rules/environment.yaml will be created."
    assert line in run(checkout, "--dry-run", "--forceall", "--sdm", "conda")
    assert line not in run(checkout, "--dry-run", "--forceall")


def test_the_workflow_is_fetched_from_a_repository(checkout, tmp_path):
    """Into a folder with the configuration alone, as snakedeploy leaves it; the package is the installed one."""
    repository, folder = tmp_path / "someone/weier", tmp_path / "folder"
    for name in ("rules", "config"):
        shutil.copytree(checkout / name, repository / name)
    shutil.copy(checkout / "Snakefile", repository)
    shutil.copytree(checkout / "config", folder / "config")
    (folder / "config/scenes/test.yaml").write_text(SCENE.replace("demelio, bem", "demelio"))
    (folder / "Snakefile").write_text(DEPLOYED)
    commit(repository)
    instead = {"COUNT": "1", "KEY_0": f"url.{tmp_path}/.insteadOf", "VALUE_0": "https://github.com/"}
    environment = os.environ | {f"GIT_CONFIG_{name}": value for name, value in instead.items()}
    environment |= {"XDG_CACHE_HOME": str(tmp_path / "cache"), "NUMBA_DISABLE_JIT": "1"}

    def said(*arguments):
        done = snakemake(*arguments, "--cores", "2", "--config", "scenes=test", cwd=folder, env=environment)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr

    assert made(said("results/test/figures/one.png")) == (["one"], 2)
    said("--dry-run", "tradeoff", "convergence", "extremes")


def test_the_workflow_imports_neither_xarray_nor_numba(tmp_path):
    """Each run of snakemake waits for what rules import and for what their functions do; it has pandas by itself."""
    command = [sys.executable, "-X", "importtime", "-m", "snakemake", "-s", Path("Snakefile").resolve()]
    command += ["-d", tmp_path, "--dry-run", "--cores", "1", "--config", "scenes=minimal"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    imported = set(re.findall(r"^import time:.*\| +([\w.]+)$", done.stderr, re.M))
    assert {"weier.pipeline.workflow", "weier.pipeline.needed_curves"} <= imported
    assert imported & {"xarray", "numba", "matplotlib", "bokeh"} == set()
