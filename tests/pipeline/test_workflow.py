"""Functions of scenes for rules, without Snakemake: files, digests, and messages that end a run."""

import os
import shutil
import signal
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
import xarray as xr

from tests.scenes import solve_scene
from weier.data import dataset
from weier.figures.checks import load_by_name
from weier.methods import registry
from weier.methods.registry import find_method
from weier.pipeline import workflow
from weier.pipeline.products import mark
from weier.pipeline.workflow import Scenes, check_packages, ending_in_one_sentence, kernels_file, kernels_of, prunes

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


def scenes(*names, cores=2, **options):
    """As the rules have them, in a new run."""
    load = partial(load_by_name, folder="config/scenes")
    return Scenes(names or ("test",), load, Path("config"), cores, **options)


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
    assert made[2:-1] == scenes().files("test", ["one", "two"])
    assert made[-1] == "results/test/page.html"
    assert len(made) == 2 + 2 * 4 + 1


@pytest.mark.parametrize(("count", "beside"), [(1, 0), (4, 0), (5, 0), (6, 1), (50, 23)])
def test_two_jobs_make_each_product_once_and_share_many_figures(folder, count, beside):
    figures = {f"number_{each}": f"  number_{each}: {{draw: profiles, studies: [short]}}\n" for each in range(count)}
    path = folder / "config/scenes/test.yaml"
    path.write_text(SCENE.partition("figures:")[0] + "figures:\n" + "".join(figures.values()))
    made = scenes().makers("test")
    assert [*made] == ["data_of_test", "figures_of_test"]
    assert made["data_of_test"][:2] == ["contact.nc", "page.html"]
    assert made["figures_of_test"] + made["data_of_test"][2:] == [*figures]
    assert len(made["data_of_test"]) == 2 + beside


def test_a_scene_without_figures_has_one_job(folder):
    path = folder / "config/scenes/test.yaml"
    path.write_text(SCENE.partition("figures:")[0])
    assert scenes().makers("test") == {"data_of_test": ["contact.nc", "page.html"]}


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (lambda content: content[:5000], "is not a whole netCDF file"),
        (lambda content: content[:-80], "is not as weier wrote it, but changed by another program: delete it"),
        (
            lambda content: content.replace(b"a line", b"b line"),
            "is not as weier wrote it, but changed by another program or the disk: delete it",
        ),
    ],
)
def test_data_that_are_damaged_are_found(folder, damage, sentence):
    path = folder / "results/test/contact.nc"
    dataset.write(xr.Dataset({"key": ("case", ["a"])}), path, "a line")
    scenes().products(of())
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(SystemExit, match=rf"^weier: results/test/contact.nc {sentence}"):
        scenes().products(of())


@pytest.mark.parametrize(("order", "count"), [(["all", "one", "two"], 2), (["one", "two", "all"], 4)])
def test_each_curve_is_in_one_batch_whoever_asks_first(folder, order, count):
    in_order = scenes(cores=1)
    found = {name: in_order.batches("test") if name == "all" else in_order.batches("test", name) for name in order}
    assert {*found["one"], *found["two"]} == {*found["all"]}
    assert len(found["all"]) == count  # of each method: the two cases of the first figure, and one more of the second
    batches = [in_order.store.batch(Path(path).stem) for path in found["all"]]
    assert sum(len(batch.cases) for batch in batches) == 6


def test_a_figure_of_no_study_needs_no_curves(folder):
    change(folder, "figures:", "figures:\n  three: {draw: borodich_galanov}")
    assert scenes().batches("test", "three") == []


def test_a_batch_says_what_it_holds_and_takes(folder):
    run = scenes(cores=1)
    for path, method in zip(run.batches("test"), ("demelio", "bem"), strict=True):
        batch = of(batch=Path(path).stem)
        label = f"3 cases from short to long by {method}, in about 1 s"
        assert run.batch_label(batch) == scenes().batch_label(batch) == label
        assert scenes().batch_memory(batch, attempt=2) == 2 * scenes().batch_memory(batch, attempt=1) >= 1000
        assert scenes().batch_minutes(batch, attempt=1) == 5
    assert run.memory(of(), attempt=3) > run.memory(of(), attempt=1)
    assert run.minutes(of(), attempt=3) == 30


def test_nothing_is_written_unless_jobs_will_run(folder):
    dry = scenes(runs=lambda: False)
    for path in dry.batches("test"):
        assert dry.batch_label(of(batch=Path(path).stem)).startswith("3 cases")
    dry.products(of())
    dry.outdated("test", ["contact.nc"])
    assert [path.name for path in folder.iterdir()] == ["config"]


PRODUCTS = "one", "two", "page.html", "contact.nc"


def digests(now):
    return [now._inputs("test", name) for name in PRODUCTS]


def test_digests_change_with_what_they_are_of(folder):
    def changed(first):
        return [old != new for old, new in zip(first, digests(scenes()), strict=True)]

    first = digests(scenes())
    assert changed(first) == [False, False, False, False]
    change(folder, "resistance,", "resistance, x: linear,")  # the second figure
    assert changed(first) == [False, True, False, True]
    change(folder, ", x: linear", "")
    change(folder, "[1, 2]", "[1, 4]")  # cases of the first
    assert changed(first) == [True, False, True, True]
    change(folder, "[1, 4]", "[1, 2]")
    assert changed(first) == [False, False, False, False]
    change(folder, "title: test", "title: other")
    assert changed(first) == [False, False, True, True]
    change(folder, "[0.1, 1.0]", "[0.1, 4.0]")
    assert changed(first) == [True, True, True, True]


def test_data_of_another_date_are_other_data(folder, monkeypatch):
    """Figures and the explorer have no dates."""
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    own = digests(scenes())
    for date in ("1000000000", "2000000000"):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
        own, before = digests(scenes()), own
        assert [old == new for old, new in zip(before, own, strict=True)] == [True, True, True, False]


def test_products_that_were_made_of_something_else_are_outdated(folder, capsys):
    made = folder / "results/test"
    (made / "figures").mkdir(parents=True)
    now = scenes()
    one, two, page, inputs_of_data = digests(now)
    for name, inputs in (("one", one), ("two", two)):
        for suffix in ("pdf", "svg", "png"):
            (made / f"figures/{name}.{suffix}").write_text(f"a figure, {mark(inputs)}")
    (made / "page.html").write_text(mark(page))
    (made / "claims.md").write_text(mark(inputs_of_data))
    dataset.write(xr.Dataset(), made / "contact.nc", "data", name=inputs_of_data)

    def outdated():
        paths = scenes().outdated("test", PRODUCTS)
        assert paths == [f"results/logs/test/inputs/{name}" for name in PRODUCTS]
        return [Path(path).stat().st_mtime > 0 for path in paths]

    assert outdated() == [False, False, False, False]
    assert scenes().unsettled_batches("test", ["one"]) == scenes().batches("test", "one")  # there are no values
    assert capsys.readouterr().err == ""
    for name in ("one", "two"):
        (made / f"figures/{name}.csv").touch()
    assert scenes().settled_batches("test", PRODUCTS[::-1]) == scenes().batches("test")
    assert scenes().unsettled_batches("test", PRODUCTS) == []
    (made / "figures/one.svg").write_bytes((made / "figures/two.svg").read_bytes())
    assert outdated() == [True, False, False, False]
    assert capsys.readouterr().err == "test: one is outdated\n"
    assert scenes().settled_batches("test", ["one"]) == []
    assert scenes().unsettled_batches("test", PRODUCTS) == scenes().batches("test", "one")
    run = scenes()
    unsettled, settled = run.unsettled_batches("test", PRODUCTS), run.settled_batches("test", PRODUCTS)
    # though fresh products have those of the stale one, too
    assert sorted(unsettled + settled) == sorted(run.batches("test"))
    assert settled
    (made / "figures/one.svg").unlink()  # Snakemake makes what is missing
    assert outdated() == [False, False, False, False]
    before = sorted(folder.rglob("*"))
    (made / "page.html").write_text("of an older version")
    dry = scenes(runs=lambda: False)
    (elsewhere,) = map(Path, dry.outdated("test", ["page.html"]))
    assert elsewhere.stat().st_mtime >= (made / "page.html").stat().st_mtime
    assert folder not in elsewhere.parents
    assert dry.outdated("test", ["two"]) == ["results/logs/test/inputs/two"]
    shutil.rmtree(folder / "results/logs")
    assert scenes(runs=lambda: False).outdated("test", ["two"]) == []
    assert [path for path in before if not path.exists()] == [path for path in before if "logs" in path.parts]
    dataset.write(xr.Dataset(), made / "contact.nc", "data", name=one)
    assert outdated() == [False, False, True, True]


@pytest.mark.parametrize("damage", ["edited", "swapped"])
def test_a_changed_batch_is_refused_though_nobody_is_to_read_it(folder, damage):
    solve_scene(scenes().scene("test"), folder / "results/curves")
    one, other = map(Path, scenes().batches("test"))
    data = folder / "results/test/contact.nc"
    dataset.write(xr.Dataset(), data, "data")
    assert scenes().batches("test") == [str(one), str(other)]
    if damage == "swapped":
        one.write_bytes(other.read_bytes())
        os.utime(one, (1e9, 1e9))
    else:
        content = bytearray(one.read_bytes())
        content[len(content) // 2] ^= 1
        one.write_bytes(content)
        os.utime(one, (data.stat().st_mtime + 1,) * 2)
    with pytest.raises(SystemExit, match=rf"^weier: {one} is (another file|not as weier wrote it).*delete it"):
        scenes().batches("test")


def test_a_locked_folder_is_refused_at_once(folder):
    locks = folder / ".snakemake/locks"
    locks.mkdir(parents=True)
    (locks / "0.output.lock").write_text("results/other/contact.nc\n")
    scenes().begin()
    (locks / "1.output.lock").write_text("results/test/contact.nc\n")
    with pytest.raises(SystemExit, match=r"^weier: results/test is locked by another run of snakemake.*--unlock"):
        scenes().products(of())
    scenes(runs=lambda: False).begin()  # a dry run reads only
    scenes(locks=False).begin()


def test_unused_batches_are_removed_when_asked(folder, capsys):
    for name in ("test", "other"):
        (folder / f"config/scenes/{name}.yaml").write_text(SCENE.replace("[demelio, bem]", "[demelio]"))
    (used,) = map(Path, scenes().batches("test"))
    solve_scene(scenes().scene("test"), used.parent)
    old = used.parent / "demelio-00000000-000000000000.nc"
    for path in (old, old.with_suffix(".json"), used.parent / "bem-00000000-000000000000.json"):
        path.write_bytes(bytes(1500))
    capsys.readouterr()
    scenes(prune=True, runs=lambda: False).begin()
    said = "1 of 2 batches are of no scene: {}, which frees 0.0 MB\n"
    assert capsys.readouterr().err == said.format("would be removed")
    assert old.exists()
    scenes().begin()
    assert old.exists()
    scenes(prune=True).begin()
    assert capsys.readouterr().err == said.format("removed")
    assert sorted(used.parent.iterdir()) == [used.with_suffix(".json"), used]


def test_pruning_waits_for_other_runs_and_keeps_curves_of_interrupted_ones(folder):
    """A run that has begun needs its descriptions, of which there are no curves yet."""
    curves, locks = folder / "results/curves", folder / ".snakemake/locks"
    for path in (curves, locks):
        path.mkdir(parents=True)
    kept = [curves / f"bem-00000000-000000000000{suffix}" for suffix in (".json", ".part")]
    for path in (*kept, curves / "bem-00000000-000000000001.json"):
        path.touch()
    lock = locks / "0.output.lock"
    lock.write_text("results/other/contact.nc\n")
    with pytest.raises(SystemExit, match=r"^weier: another run of snakemake has locked this folder"):
        scenes(prune=True).begin()
    assert len(list(curves.iterdir())) == 3
    lock.unlink()
    scenes(prune=True).begin()
    assert sorted(curves.iterdir()) == kept


@pytest.mark.parametrize("value", ["no", "off", "false", "", 2, None])
def test_what_does_not_ask_for_pruning_clearly_is_refused(value):
    with pytest.raises(SystemExit, match=r"^weier: prune must be 0 or 1, got "):
        prunes({"prune": value})
    assert [prunes(config) for config in ({}, {"prune": 0}, {"prune": False}, {"prune": 1})] == [False] * 3 + [True]


def test_the_last_batch_of_a_job_is_kept_while_another_one_is_used(folder):
    change(folder, "[demelio, bem]", "[archard, demelio, persson]")
    solve_scene(scenes().scene("test"), folder / "results/curves")
    (last,) = scenes().batches("test")
    used = [path for path in sorted((folder / "results/curves").iterdir()) if not path.name.startswith("demelio")]
    assert Path(last).name.startswith("persson")
    change(folder, "[archard, demelio, persson]", "[archard]")
    scenes(prune=True).begin()
    assert sorted((folder / "results/curves").iterdir()) == used
    assert scenes().batches("test") == [last]
    change(folder, "[archard]", "[bem]")
    scenes(prune=True).begin()
    assert not list((folder / "results/curves").iterdir())


def test_a_wrong_scene_ends_in_one_sentence(folder):
    change(folder, "1.25, gamma: 5, m: [1", "2.25, gamma: 5, m: [1")
    for function in (lambda: scenes().products(of()), lambda: scenes().batches("test", "one")):
        with pytest.raises(SystemExit, match=r"^weier: config/scenes/test.yaml.*D must lie in \(1, 2\)"):
            function()
    assert scenes().makers("test") == {}  # so that rules without scenes run
    with pytest.raises(SystemExit, match=r"^weier: there is no scene 'tset'.*did you mean 'test'"):
        scenes().batches("tset")


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


def test_an_unknown_figure_ends_in_one_sentence(folder):
    with pytest.raises(SystemExit, match=r"^weier: scene test has no figure 'three', only one, two$"):
        scenes().batches("test", "three")


def test_the_cost_of_a_scene_with_a_limit_is_reported_once_and_excess_is_refused(folder, capsys):
    change(folder, "title", "max_seconds: 1.0e-6\ntitle")
    slow = scenes(runs=lambda: False)
    for _ in range(2):
        slow.batches("test")
    forecast, refusal = capsys.readouterr().err.splitlines()
    assert forecast.startswith("test: 6 curves to solve, in about ")
    assert refusal.startswith("test: it would take longer than 1e-06 s: set max_seconds: ")
    with pytest.raises(SystemExit, match=r"^weier: test: it would take longer than 1e-06 s"):
        scenes().batches("test")
    assert not (folder / "results").exists()


@pytest.mark.parametrize("closed", [".", ".snakemake"])
def test_a_folder_without_room_for_the_records_of_snakemake_is_refused(folder, monkeypatch, closed):
    Path(closed).mkdir(exist_ok=True)
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != Path(closed))
    with pytest.raises(SystemExit, match=rf"weier: {closed} cannot be written to: .*work in a copy"):
        scenes(runs=lambda: False)


def test_a_dry_run_where_results_are_read_only_says_what_lists_them(folder, monkeypatch, capsys):
    Path("results").mkdir()
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != Path("results"))
    scenes(runs=lambda: False).batches("test")
    assert "results cannot be written to: Snakemake refuses a dry run" in capsys.readouterr().err
    with pytest.raises(SystemExit, match="weier: results cannot be written to: open it"):
        scenes().batches("test")


def test_a_run_begins_with_order(folder):
    left = folder / f"results/test/.contact.nc.{os.uname().nodename.partition('.')[0]}.999999999"
    left.parent.mkdir(parents=True)
    left.touch()
    scenes(runs=lambda: False).begin()
    assert left.exists()
    scenes().begin()
    assert not left.exists()


def test_kernels_are_compiled_for_the_numerical_method_of_a_batch(tmp_path, monkeypatch):
    monkeypatch.setattr(workflow, "DISABLED", False)
    monkeypatch.setattr(workflow, "cache_folder", lambda: tmp_path / "cache")
    kernels = scenes().kernels
    assert kernels(of(batch="bem-00275236-531c1e7735aa")) == [kernels_file("bem")]
    assert kernels_file("bem") == str(tmp_path / "cache/compiled/bem")
    assert kernels(of(batch="demelio-00275236-531c1e7735aa")) == []
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
