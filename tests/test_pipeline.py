"""The pipeline on a copy of the checkout, in one order: what runs, what runs again, and where it runs."""

import os
import re
import shlex
import shutil
import subprocess
import sys

import pytest

from tests.checkouts import copied, snakemake
from weier.data.provenance import VERSION

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
EVERY = ["contact.nc", "one", "page.html", "two"]


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    """A folder whose name a shell would take apart."""
    return copied(tmp_path_factory.mktemp("checkout") / "o'neil lab (2)", SCENE)


def run(folder, *arguments, cores=1, scene="test", **variables):
    done = snakemake(folder, "--cores", cores, *arguments, "--config", f"scenes={scene}", **variables)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def planned(folder, *arguments):
    """How often each rule would run, but for the one that only collects."""
    text = run(folder, "--dry-run", *arguments)
    assert "Job stats:" in text or "Nothing to be done" in text  # which a profile may silence
    found = re.findall(r"^(\w+) +(\d+)$", text, re.M)
    return {rule: int(count) for rule, count in found if rule not in ("all", "total")}


def made(said):
    """The products that were made, and the number of curves that were solved."""
    solved = sum(map(int, re.findall(r"^solve (\d+) curves\b", said, re.M)))
    return sorted(re.findall(r"^make \w+ ([^\s:]+)", said, re.M)), solved


def edit(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_plans_write_nothing_and_mistakes_end_those_that_need_them_in_a_sentence(checkout):
    """Of a scene, or of a package of another version."""
    (checkout / "config/scenes/bad.yaml").write_text(SCENE.replace("D: 1.25", "D: 2.25"))
    for *command, scene, mistake in (
        ("--summary", "test", ""),
        ("--dry-run", "tradeoff", "bad", ""),
        ("--dry-run", "bad", "config/scenes/bad.yaml has 2 mistakes"),
        ("--dry-run", "test", f"Snakemake needs weier 0.0.1, not {VERSION}, in its own environment: pip install"),
    ):
        if "0.0.1" in mistake:
            edit(checkout / "Snakefile", f'VERSION = "{VERSION}"', 'VERSION = "0.0.1"')
        done = snakemake(checkout, *command, "--config", f"scenes={scene}")
        assert (done.returncode, f"weier: {mistake}" in done.stderr) == (bool(mistake), bool(mistake))
        assert "Traceback" not in done.stderr
    edit(checkout / "Snakefile", 'VERSION = "0.0.1"', f'VERSION = "{VERSION}"')
    assert not (checkout / "results").exists()


@pytest.fixture(scope="module")
def finished(checkout):
    assert made(run(checkout, cores=2))[0] == EVERY
    return checkout


def test_there_and_back_each_product_is_that_of_its_scene_and_edited_files_are_made_again(finished):
    """What is named is made alone, and only if it is not up to date. Data are on disk once."""
    path, products = finished / "config/scenes/test.yaml", finished / "results/test"
    drawn = {f"{figure}.{kind}" for figure in ("one", "two") for kind in ("pdf", "svg", "png", "csv")}
    assert {path.name for path in (products / "figures").iterdir()} == drawn
    first = {file: file.read_bytes() for file in products.glob("**/[!.]*.*") if ".made_of" not in file.parts}
    assert len(first) == 3 + len(drawn)
    for _ in range(2):  # another time, too
        for file in ("claims.md", "figures/one.csv"):
            (products / file).write_text("edited")
        assert made(run(finished, "results/test/page.html", "results/test/figures/one.png")) == (["one"], 0)
    for text in (
        SCENE.replace("title: test", "title: other").replace("resistance,", "resistance, x: linear,"),
        SCENE,
    ):
        path.write_text(text)
        assert made(run(finished)) == (["contact.nc", "page.html", "two"], 0)
    assert first == {file: file.read_bytes() for file in first}
    assert planned(finished) == {}
    (stamped,) = products.glob(".made_of/*/*/*/contact.nc")
    assert stamped.samefile(products / "contact.nc")
    hidden = {path.name for path in (finished / "results").rglob(".*")}
    assert hidden <= {".made_of", ".solved", ".snakemake_timestamp"}
    assert not any(path.is_file() for path in (finished / "results/curves/.solved").rglob("*"))
    run(finished, "--report", "report.html")
    report = (finished / "report.html").read_text()
    assert ";filename=page.html;base64," in report
    assert "results/test/figures/two.png" in report
    assert "All curves of one profile meet at full" in report


MODULE = """
module weier:
    snakefile: {}
    config: config

use rule * from weier
"""


def test_jobs_run_the_python_of_snakemake_or_that_of_their_environment(checkout, tmp_path):
    """In any folder with scenes of its own. A program that answers as conda does is enough for a plan."""
    answer = '{"conda_prefix": "/", "platform": "linux-64", "get": {"channel_priority": "strict"}}'
    conda = tmp_path / "conda"
    conda.write_text(f"#!/bin/sh\n[ $1 = --version ] && echo conda 24.7.1 || echo '{answer}'\n")
    conda.chmod(0o755)
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    image = run(checkout, "--containerize", PATH=path)
    assert "COPY rules/environment.yaml /conda-envs/" in image
    assert f"weier=={VERSION}" in image
    (tmp_path / "config/scenes").mkdir(parents=True)
    (tmp_path / "config/scenes/other.yaml").write_text(SCENE)
    plan = ("-s", checkout / "Snakefile", "-d", tmp_path, "--dry-run", "--printshellcmds", "all", "extremes")
    for software, python in ((), shlex.quote(sys.executable)), (("--sdm", "conda"), "python"):
        said = run(tmp_path.parent, *plan, *software, scene="other", PATH=path)
        assert ("rules/environment.yaml will be created." in said) == bool(software)
        jobs = re.findall(r"^Shell command: (?:[A-Z_]+=1 )*(.*) -P -m (weier\S* \S+)", said, re.M)
        assert sorted(jobs) == [(python, f"weier{job}") for job in (" curves", " make", ".accuracy $(basename")]


def test_the_workflow_is_fetched_from_a_repository(checkout, tmp_path):
    """Into a folder with the configuration alone, as snakedeploy leaves it; the package is the installed one."""
    repository, folder = tmp_path / "someone/weier", tmp_path / "folder"
    for name in ("rules", "config"):
        shutil.copytree(checkout / name, repository / name)
    shutil.copy(checkout / "Snakefile", repository)
    shutil.copytree(checkout / "config", folder / "config")
    (folder / "config/scenes/test.yaml").write_text(SCENE)
    source = 'github("someone/weier", path="Snakefile", branch="main")'
    (folder / "Snakefile").write_text('configfile: "config/config.yaml"' + MODULE.format(source))
    author = ["-c", "user.name=someone", "-c", "user.email=someone@example.org"]
    for command in (["init", "-q", "-b", "main"], ["add", "."], [*author, "commit", "-q", "-m", "Begin"]):
        subprocess.run(["git", *command], cwd=repository, check=True)
    instead = {"COUNT": "1", "KEY_0": f"url.{tmp_path}/.insteadOf", "VALUE_0": "https://github.com/"}
    variables = {f"GIT_CONFIG_{name}": value for name, value in instead.items()}
    said = run(folder, "results/test/figures/one.png", XDG_CACHE_HOME=str(tmp_path / "cache"), **variables)
    assert made(said) == (["one"], 3)


def test_results_without_records_and_of_other_dates_are_not_made_again(finished):
    """As those of a copy, where an edited scene and edited code are seen."""
    shutil.rmtree(finished / ".snakemake")
    for date, pattern in enumerate(("results/**/*", "results/test/.made_of/**/*", "config/scenes/*")):
        for path in finished.glob(pattern):
            os.utime(path, (10**9 + date,) * 2)
    assert planned(finished) == {}
    edit(finished / "config/scenes/test.yaml", "resistance,", "resistance, x: linear,")
    assert planned(finished, "results/test/figures/two.png") == {"make": 1, "figure": 1}
    edit(finished / "config/scenes/test.yaml", "resistance, x: linear,", "resistance,")
    edit(finished / "weier/methods/bem/active_set.py", "MAX_STEPS = 1000", "MAX_STEPS = 10 * 100")
    assert planned(finished) == {"solve": 1, "make": 1, "data": 1, "figure": 2, "page": 1}
    edit(finished / "weier/methods/bem/active_set.py", "MAX_STEPS = 10 * 100", "MAX_STEPS = 1000")


def test_figures_beside_one_that_cannot_be_drawn_are_kept(finished):
    fault = '    if quantity == "resistance":\n        raise ValueError("no ink")\n'
    edit(finished / "weier/figures/many_curves.py", "    return figure\n", f"{fault}    return figure\n")
    stamps = sorted((finished / "results/test/.made_of").glob("*/two/*"))
    done = snakemake(finished, "--latency-wait", "1", "--cores", "1", "--config", "scenes=test")
    assert done.returncode == 1
    assert "weier: two cannot be made: no ink\n" in done.stdout
    assert "weier: results/test/figures/two.png was not made, for the reason in results/logs/test" in done.stdout
    assert sorted((finished / "results/test/.made_of").glob("*/two/*")) == stamps
    assert made(done.stdout) == (EVERY, 0)  # begun
    assert planned(finished) == {"make": 1, "figure": 1}
