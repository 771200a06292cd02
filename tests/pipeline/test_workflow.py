"""The plan of a run: what is missing, who solves it, and messages that end a run. Planning writes nothing."""

import re
import signal
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.scenes import solve_scene
from weier.figures.checks import load_by_name
from weier.pipeline import workflow
from weier.pipeline.curves import CLOSED
from weier.pipeline.workflow import Plan, check_packages, ending_in_one_sentence, kernels_file

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
    return Plan(names or ("test",), partial(load_by_name, folder="config/scenes"), slots)


def of(**wildcards):
    return SimpleNamespace(**{"scene": "test"} | wildcards)


def change(folder, old, new):
    path = folder / "config/scenes/test.yaml"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_everything_is_the_files_of_the_products_and_their_stamps(folder):
    files = plan().all_files(of())
    made = [path.removeprefix("results/test/") for path in files if "/.made_of/" not in path]
    drawn = [f"figures/{name}.{suffix}" for name in ("one", "two") for suffix in ("png", "pdf", "svg", "csv")]
    assert made == ["contact.nc", "claims.md", *drawn, "page.html"]
    assert [Path(path).parent.name for path in files if "/.made_of/" in path] == [
        "contact.nc",
        "one",
        "two",
        "page.html",
    ]
    assert not (folder / "results").exists()


def jobs(found):
    """Groups of jobs, with what they are of."""
    return [(Path(path).parents[2].name, Path(path).name) for path in found]


def test_a_product_needs_the_jobs_that_solve_its_curves(folder):
    """Those of all scenes where all is made; and its own if it is named alone."""
    alone = plan()
    assert jobs(alone.solved(of(product="one"))) == [
        ("test~one", f"{CLOSED}.0-of-1"),
        ("test~one", "bem.0-of-1"),
    ]
    together = plan()
    together.all_files(of())
    found = [together.solved(of(product=product)) for product in ("one", "two", "contact.nc")]
    assert found[0] == found[1] == found[2]
    assert jobs(found[0]) == [("all", f"{CLOSED}.0-of-1"), ("all", "bem.0-of-1")]
    solve_scene(alone.scene("test"), Path("results/curves"))
    assert plan().solved(of(product="contact.nc")) == []


def test_a_job_of_many_solves_what_a_product_needs_of_its_share(folder, monkeypatch):
    monkeypatch.setattr(workflow, "number_of_jobs", lambda seconds, curves, most: 5)
    change(folder, "[2, 3]", "{from: 2, to: 4, count: 3}, seed: {from: 1, to: 20, count: 20}")
    change(folder, "studies: [long], facet: m", "studies: [long], facet: m, median over: seed")
    all_of = plan()
    all_of.all_files(of())
    of_one, everything = (set(all_of.solved(of(product=name))) for name in ("one", "contact.nc"))
    assert of_one < everything
    assert len(everything) == 10
    shares = [all_of._of_job(of(what="all", group="bem", number=n, jobs=5)) for n in range(5)]
    assert sum(len(each.numbers) for share in shares for each in share) == 2 + 60


def test_a_figure_of_no_study_needs_no_curves(folder):
    change(folder, "figures:", "figures:\n  three: {draw: borodich_galanov}")
    assert plan().solved(of(product="three")) == []


def test_memory_and_minutes_grow_with_curves_and_attempts(folder):
    now, job = plan(), {"what": "all", "group": "bem", "number": "0", "jobs": "1"}
    assert now.job_memory(of(**job), attempt=2) == pytest.approx(2 * now.job_memory(of(**job), attempt=1), abs=1)
    assert now.job_minutes(of(**job), attempt=1) == 5
    assert now.memory(of(), attempt=3) > now.memory(of(), attempt=1) >= 500
    assert now.minutes(of(), attempt=3) == 30


def test_no_rule_makes_a_stamp_that_is_there(folder):
    stamps = folder / "results/test/.made_of/one"
    stamps.mkdir(parents=True)
    (stamps / "00aa.11").touch()
    pattern = plan().new_digests
    assert [bool(re.fullmatch(pattern, name)) for name in ("00aa.11", "00aa", "00aa.112", "x")] == [
        False,
        True,
        True,
        False,
    ]


def test_a_wrong_scene_ends_in_one_sentence(folder):
    change(folder, "1.25, gamma: 5, m: [1", "2.25, gamma: 5, m: [1")
    for function in (lambda: plan().all_files(of()), lambda: plan().solved(of(product="one"))):
        with pytest.raises(SystemExit, match=r"^weier: config/scenes/test.yaml.*D must lie in \(1, 2\)"):
            function()
    with pytest.raises(SystemExit, match=r"^weier: there is no scene 'tset'.*did you mean 'test'"):
        plan().solved(of(scene="tset", product="one"))
    change(folder, "2.25, gamma", "1.25, gamma")
    with pytest.raises(SystemExit, match=r"^weier: scene test has no figure 'three', only one, two$"):
        plan().solved(of(product="three"))


def test_a_scene_above_its_limit_is_refused(folder, capsys):
    change(folder, "title", "max_seconds: 1.0e-6\ntitle")
    with pytest.raises(SystemExit, match=r"^weier: test: 6 curves to solve, in .*, longer than 1e-06 s: set max_sec"):
        plan().all_files(of())
    assert not (folder / "results").exists()


@pytest.mark.parametrize(
    ("given", "expected"),
    [("test, 2024", ["test", "2024"]), (2024, ["2024"]), (815, ["0815"]), (100000.0, ["1e5"]), (True, ["True"])],
)
def test_scenes_are_named_by_what_snakemake_makes_of_words(tmp_path, given, expected):
    for name in ("test", "2024", "0815", "1e5", "True", "07", "7"):
        (tmp_path / f"{name}.yaml").touch()
    assert workflow.names_of_scenes({"scenes": given}, tmp_path) == expected
    with pytest.raises(SystemExit, match=r"got 7: quote one of 07, 7, as in --config \"scenes='07'\"$"):
        workflow.names_of_scenes({"scenes": 7}, tmp_path)
    for wrong in (5, None, "", [1]):
        with pytest.raises(SystemExit, match=r"^weier: scenes must name some of 07, .*, got (5|None|''|\[1\])$"):
            workflow.names_of_scenes({"scenes": wrong}, tmp_path)
    with pytest.raises(SystemExit, match=r"^weier: there is no key 'scens' .*: did you mean 'scenes'\?$"):
        workflow.names_of_scenes({"scens": given}, tmp_path)


def test_kernels_are_compiled_for_the_methods_that_have_some(tmp_path, monkeypatch):
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    monkeypatch.setattr(workflow, "cache_folder", lambda: tmp_path / "cache")
    kernels = plan().kernels
    assert kernels(of(group="bem")) == [kernels_file("bem")] == [str(tmp_path / "cache/compiled/bem")]
    assert kernels(of(group=CLOSED)) == []
    (tmp_path / "cache").touch()  # takes no files
    assert kernels(of(group="bem")) == []

    def homeless():
        raise OSError("there is no home directory for the cache")

    monkeypatch.setattr(workflow, "cache_folder", homeless)
    assert kernels(of(group="bem")) == []
    assert kernels_file("{method}") == "results/compiled/{method}"  # the name of an output all the same
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    assert kernels(of(group="bem")) == []


def test_missing_packages_are_named_with_how_to_get_them():
    check_packages("numpy")
    with pytest.raises(SystemExit, match=r"needs nonsense: pip install --require-hashes -r requirements/dev.txt"):
        check_packages("numpy", "nonsense")


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_ends_the_run_whatever_an_event_loop_makes_of_it():
    noted = []
    signal.signal(signal.SIGINT, lambda *_: noted.append("later"))
    with pytest.raises(SystemExit, match=r"^weier: stopped by Ctrl-C$"), ending_in_one_sentence():
        signal.raise_signal(signal.SIGINT)
    signal.raise_signal(signal.SIGINT)
    assert noted == ["later"]
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with ending_in_one_sentence():
        signal.raise_signal(signal.SIGINT)
