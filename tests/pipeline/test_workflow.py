"""Functions of scenes for rules, without Snakemake: files, digests, and messages that end a run."""

import os
import signal
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest

from weier.figures.checks import load_by_name
from weier.methods import registry
from weier.methods.registry import find_method
from weier.pipeline import workflow
from weier.pipeline.batches import read_batch
from weier.pipeline.workflow import Scenes, check_packages, ending_in_one_sentence, kernels_file, kernels_of

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
    return tmp_path


def scenes(*names, cores=2):
    """As the rules have them, in a new run."""
    return Scenes(names or ("test",), partial(load_by_name, folder="config/scenes"), Path("config"), cores)


def of(**wildcards):
    return SimpleNamespace(**{"scene": "test"} | wildcards)


def change(folder, old, new):
    path = folder / "config/scenes/test.yaml"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_the_products_are_data_claims_and_all_figures(folder):
    made = scenes().products(of())
    assert made[:2] == ["results/test/contact.nc", "results/test/claims.md"]
    assert made[2:] == scenes().figures(of()) == scenes().figures_of("test")
    assert len(made) == 2 + 2 * 3


def test_data_that_are_cut_short_are_found(folder):
    path = folder / "results/test/contact.nc"
    path.parent.mkdir(parents=True)
    path.write_bytes(b"\x89HDF")
    with pytest.raises(SystemExit, match=r"^weier: results/test/contact.nc is not a whole netCDF file"):
        scenes().products(of())


@pytest.mark.parametrize(("order", "count"), [(["all", "one", "two"], 1), (["one", "two", "all"], 2)])
def test_each_case_is_in_one_batch_whoever_asks_first(folder, order, count):
    in_order = scenes(cores=1)
    found = {
        name: in_order.batches(of()) if name == "all" else in_order.batches_of_figure(of(figure=name))
        for name in order
    }
    assert sorted({*found["one"], *found["two"]}) == sorted(found["all"])
    assert len(found["all"]) == count  # the two cases of the first figure, and one more of the second
    described = [read_batch(Path(path).with_suffix(".json")) for path in found["all"]]
    assert sum(len(batch.cases) for batch in described) == 3


def test_a_figure_of_no_study_needs_no_curves(folder):
    change(folder, "figures:", "figures:\n  three: {draw: borodich_galanov}")
    assert scenes().batches_of_figure(of(figure="three")) == []


def test_a_batch_says_what_it_holds_and_takes(folder):
    (path,) = scenes(cores=1).batches(of())
    assert scenes().batch_label(of(batch=Path(path).stem)) == "3 cases from short to long, in about 1 s"


def test_digests_change_with_what_they_are_of(folder):
    def digests():
        now = scenes()
        figures = [now.figure_digest(of(figure=name)) for name in ("one", "two")]
        return (*figures, now.page_digest(of()), now.claims_digest(of()))

    first = digests()
    assert digests() == first
    change(folder, "resistance,", "resistance, x: linear,")  # the second figure
    assert [old == new for old, new in zip(first, digests(), strict=True)] == [True, False, False, False]
    change(folder, ", x: linear", "")
    change(folder, "[1, 2]", "[1, 4]")  # cases of the first
    assert [old == new for old, new in zip(first, digests(), strict=True)] == [False, False, False, False]
    change(folder, "[1, 4]", "[1, 2]")
    assert digests() == first
    change(folder, "[0.1, 1.0]", "[0.1, 4.0]")
    assert not set(first) & set(digests())


def test_a_wrong_scene_ends_in_one_sentence(folder):
    change(folder, "1.25, gamma: 5, m: [1", "2.25, gamma: 5, m: [1")
    for function in (scenes().products, scenes().batches, partial(scenes().figure_digest)):
        with pytest.raises(SystemExit, match=r"^weier: config/scenes/test.yaml.*D must lie in \(1, 2\)"):
            function(of(figure="one"))
    with pytest.raises(SystemExit, match=r"^weier: there is no scene 'tset'.*did you mean 'test'"):
        scenes().batches(of(scene="tset"))


def test_an_unknown_figure_ends_in_one_sentence(folder):
    with pytest.raises(SystemExit, match=r"^weier: scene test has no figure 'three', only one, two$"):
        scenes().batches_of_figure(of(figure="three"))


def test_the_cost_of_a_scene_with_a_limit_is_reported_once_and_excess_is_refused(folder, capsys):
    change(folder, "title", "max_seconds: 1.0e-6\ntitle")
    slow = scenes()
    for _ in range(2):
        slow.batches(of())
    forecast, refusal = capsys.readouterr().err.splitlines()
    assert forecast.startswith("test: 3 cases to solve, in about ")
    assert refusal.startswith("test: it would take longer than 1e-06 s: set max_seconds: ")
    with pytest.raises(SystemExit, match=r"^weier: test: it would take longer than 1e-06 s"):
        slow.begin()


def test_a_run_begins_with_order_and_ends_with_where_the_curves_are(folder, capsys):
    left = folder / f"results/test/.contact.nc.{os.uname().nodename.partition('.')[0]}.999999999"
    left.parent.mkdir(parents=True)
    left.touch()
    run = scenes()
    run.begin()
    assert not left.exists()
    run.finish()
    assert capsys.readouterr().err == ""
    (described,) = run.batches(of())
    (folder / "results/test/contact.nc").touch()
    run.finish()
    assert not Path(described).with_suffix(".json").exists()  # it was never solved
    assert "pages --config scenes=test` makes a page of them" in capsys.readouterr().err
    (folder / "results/test/page.html").touch()
    run.finish()
    assert capsys.readouterr().err == (
        "test: the curves are in results/test/contact.nc, results/test/page.html shows them\n"
    )


def test_kernels_are_compiled_for_the_numerical_methods_of_a_scene(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(workflow, "DISABLED", False)
    monkeypatch.setattr(workflow, "cache_folder", lambda: tmp_path / "cache")
    assert scenes().kernels(of()) == [kernels_file("bem")] == [str(tmp_path / "cache/compiled/bem")]
    change(folder, "methods: [demelio, bem]", "methods: [demelio, auto]\ntolerance: 0.1")
    assert scenes().kernels(of()) == kernels_of(registry.METHODS)  # whichever of them is chosen
    (tmp_path / "cache").touch()  # takes no files
    assert kernels_of([find_method("bem")]) == []


def test_there_is_nothing_to_compile_where_nothing_is_compiled_or_kept(monkeypatch):
    monkeypatch.setattr(workflow, "DISABLED", True)
    assert kernels_of(registry.METHODS) == []

    def homeless():
        raise OSError("there is no home directory for the cache")

    monkeypatch.setattr(workflow, "DISABLED", False)
    monkeypatch.setattr(workflow, "cache_folder", homeless)
    assert kernels_of(registry.METHODS) == []
    assert kernels_file("{method}") == "results/compiled/{method}"  # the name of an output all the same


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
