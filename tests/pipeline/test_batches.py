"""What is solved is found again case by case, and only what is missing is cut into batches."""

from unittest.mock import Mock

import numpy as np
import pytest

from tests.scenes import scene_in, solve_scene
from weier import digests
from weier.methods import demelio
from weier.methods.registry import find_method
from weier.methods.settings import defaults
from weier.pipeline import curves
from weier.pipeline.batches import Solutions, unused
from weier.pipeline.curves import CASE_SECONDS, Store, cut, read_batch
from weier.pipeline.gather import read_study

PRODUCT = {"D": [1.25, 1.5], "gamma": [2, 3], "m": 2, "seed": {"from": 1, "to": 3, "count": 3}}
SCENE = {
    "title": "t",
    "loads": [0.1, 1.0],
    "methods": ["archard", "demelio"],
    "studies": {"one": {"product": PRODUCT}},
}


def load(folder, **changes):
    return scene_in(folder, SCENE | changes)


def missing(folder, **changes):
    """The cases of each method that would be solved, and what is solved already stays where it is."""
    before = {path: path.stat().st_mtime_ns for path in folder.glob("batches/*.nc")}
    solutions = Solutions(load(folder, **changes), folder / "batches")
    solutions.files(cores=2)
    assert before == {path: path.stat().st_mtime_ns for path in folder.glob("batches/*.nc")}
    found = {}
    for batch in (batch for job in solutions.to_solve for batch in job):
        found.setdefault(batch.kind.method, []).extend(batch.cases)
    return found


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scene")
    solve_scene(load(folder), folder / "batches", cores=2)
    return folder


def product(**changes):
    return {"studies": {"one": {"product": PRODUCT | changes}}}


BOTH, LAYER = ("archard", "demelio"), ("layer",)


@pytest.mark.parametrize(
    ("changes", "count", "methods"),
    [
        ({}, 0, BOTH),
        ({"title": "another", "studies": {"another": SCENE["studies"]["one"]}}, 0, BOTH),
        (product(D=[1.25, 1.4, 1.5]), 6, BOTH),  # the outermost key, in between
        (product(gamma=[2, 3, 4]), 6, BOTH),  # an inner one
        (product(m=[1, 2]), 12, BOTH),
        (product(seed={"from": 0, "to": 3, "count": 4}), 4, BOTH),
        (product(D=1.5, seed=[3, 9]), 2, BOTH),
        ({"methods": ["archard", "layer", "demelio"]}, 12, LAYER),
        ({"methods": ["layer", "demelio"], "settings": {"layer": {"points": 40}}}, 12, LAYER),
        # A solution goes from load to load, and the bounds of a resistance are chords between them.
        ({"loads": [0.1, 0.5, 1.0]}, 12, BOTH),
        ({"contact_edges": True}, 12, BOTH),
    ],
)
def test_only_what_is_missing_is_solved(solved, changes, count, methods):
    found = missing(solved, **changes)
    assert {method: len(cases) for method, cases in found.items()} == {method: count for method in methods if count}
    for method, cases in found.items():
        own = {method: given} if (given := changes.get("settings", {}).get(method)) else {}
        assert all((case.methods, case.settings) == ((method,), own) for case in cases)


def test_a_setting_at_its_default_is_the_default(solved):
    assert missing(solved, methods=["layer"]).keys() == {"layer"}
    solve_scene(load(solved, methods=["layer"]), solved / "batches")
    points = defaults(find_method("layer"))["points"]
    assert missing(solved, methods=["layer"], settings={"layer": {"points": points}}) == {}
    assert missing(solved, methods=["layer"], settings={"layer": {"points": points + 1}}).keys() == {"layer"}


@pytest.fixture
def other_code(monkeypatch):
    """Another state of the code of one method."""
    known = curves.numerics.__wrapped__
    changed = {"code": "another", "packages": ""}
    monkeypatch.setattr(curves, "numerics", lambda method, of: changed if method == "demelio" else known(method, of))


@pytest.mark.usefixtures("other_code")
def test_a_changed_solver_solves_the_curves_of_its_own_method(solved):
    assert {method: len(cases) for method, cases in missing(solved).items()} == {"demelio": 12}


def test_the_code_of_a_method_is_what_it_runs():
    def reached(method):
        found = find_method(method)
        named = list(digests._named((found.solve, found.applies)))
        return {module for module, _ in digests._reached(named, ())}

    assert demelio.__name__ in reached("demelio")
    assert "weier.methods.archard" not in reached("demelio")
    assert {"weier.methods.bem.solver", "weier.theory.halfplane"} <= reached("bem")
    assert not any(module.startswith(("weier.scene", "weier.figures", "weier.pipeline")) for module in reached("bem"))


def test_scenes_that_share_cases_solve_them_once(tmp_path):
    store = Store(tmp_path / "batches")
    one = Solutions(load(tmp_path), store)
    other = Solutions(load(tmp_path, title="other", **product(seed=[2, 3, 4], m=2)), store)
    (path,) = one.files()
    assert sizes(store, path) == [("archard", 12), ("demelio", 12)]
    again, more = other.files()
    assert again == path
    assert sizes(store, more) == [("archard", 4), ("demelio", 4)]


def sizes(store, path):
    """The method of each batch of a job, and the number of its cases."""
    return [(batch.kind.method, len(batch.cases)) for batch in store.job(path.stem)]


def test_one_job_solves_what_needs_the_same_kernels(tmp_path):
    """In batches of one kind each; and cores share its time equally, whatever the kinds."""
    settings = {"bem": {"staircase": "kept"}}
    studies = {"one": {"product": PRODUCT}, "two": {"product": PRODUCT, "settings": settings}}
    methods = ["archard", "bem", "demelio", "patches"]
    solutions = Solutions(load(tmp_path, methods=methods, studies=studies), tmp_path)
    jobs = [sizes(solutions.store, path) for path in solutions.files()]
    assert jobs == [[("archard", 12), ("demelio", 12)], [("bem", 12), ("bem", 12)], [("patches", 12)]]
    assert [sizes(solutions.store, path) for path in solutions.files()] == jobs
    large = Solutions(load(tmp_path, methods=["archard", "demelio"], batch=8), tmp_path)
    jobs = [sizes(large.store, path) for path in large.files()]
    assert jobs == [[("archard", 8)], [("archard", 4), ("demelio", 4)], [("demelio", 8)]]
    large.store.write()
    assert [sizes(Store(tmp_path), path) for path in large.files()] == jobs


def test_the_last_batch_of_a_job_stands_for_all_of_it_unless_one_is_lost(tmp_path):
    """Before and after it is solved, since Snakemake has records of this file alone."""
    scene, folder = load(tmp_path), tmp_path / "batches"
    planned = Solutions(scene, folder).files()
    done = solve_scene(scene, folder)
    assert done.files() == planned
    one, last = (folder / f"{name}.nc" for name in done.batches())
    assert [path.stem.partition("-")[0] for path in (one, last)] == ["archard", "demelio"]
    assert planned == [last]
    for lost, left, method in ((one, [one, last], "archard"), (last, [last], "demelio")):
        lost.rename(folder / "away")
        again = Solutions(scene, folder)
        assert again.files() == left
        assert [[batch.kind.method for batch in job] for job in again.to_solve] == [[method]]
        (folder / "away").rename(lost)
    last.unlink()
    alone = Solutions(load(tmp_path, methods=["archard"]), folder)  # of a scene that does not need the other
    assert alone.files() == [one]
    assert sizes(alone.store, last) == [("archard", 12), ("demelio", 12)]
    one.with_suffix(".json").unlink()
    assert sizes(Store(folder), last) == [("demelio", 12)]


def test_what_a_scene_has_grown_by_is_read_with_the_rest(solved, tmp_path):
    grown = load(solved, methods=["archard", "layer", "demelio"], **product(m=[1, 2]))
    together = solve_scene(grown, tmp_path / "batches")
    (tmp_path / "more").mkdir()
    for path in (solved / "batches").iterdir():
        (tmp_path / "more" / path.name).write_bytes(path.read_bytes())
    in_parts = solve_scene(grown, tmp_path / "more", cores=2)
    assert len(list((tmp_path / "more").glob("*.nc"))) > len(list((tmp_path / "batches").glob("*.nc")))
    assert read_study(in_parts, "one").identical(read_study(together, "one"))


@pytest.mark.parametrize(
    ("seconds", "count", "cores", "expected"),
    [
        (0.01, 20, 2, 1),  # a small scene
        (0.1, 60, 2, 2),  # one batch a core
        (2.0, 60, 2, 4),  # two
        (1.0, 90, 2, 2),  # none below thirty seconds, and no third one that two cores wait for
        (1.0, 60, 16, 16),
        (10.0, 100, 2, 9),  # none that takes minutes
        (500.0, 3, 2, 3),
    ],
)
def test_batches_are_twice_as_many_as_cores_and_neither_short_nor_long(seconds, count, cores, expected):
    parts = cut(np.full(count, seconds), 1000, cores)
    sizes = [part.stop - part.start for part in parts]
    assert sum(sizes) == count
    assert len(parts) == expected
    assert max(sizes) - min(sizes) <= 1


def test_batches_are_no_larger_than_asked():
    assert [part.stop - part.start for part in cut(np.full(12, 1e-3), 5, 1)] == [4, 4, 4]


def test_a_study_needs_only_its_own_cases(tmp_path):
    """Later calls contain them as well."""
    studies = {"one": {"product": PRODUCT}, "two": {"product": PRODUCT | {"seed": [2, 7]}}}
    solutions = Solutions(load(tmp_path, studies=studies, methods=["demelio"]), tmp_path)
    (path,) = solutions.files(["two"])
    assert len(solutions.store.batch(path.stem).cases) == 8
    again, other = sorted(solutions.files(), key=lambda each: each != path)
    assert again == path
    assert len(solutions.store.batch(other.stem).cases) == 8
    assert set(solutions.files(["one"])) == {path, other}
    assert len(solutions.to_solve) == 2


def test_a_batch_is_read_as_it_was_described(tmp_path):
    """Its cases may have other parameters each."""
    studies = {
        "one": {"product": PRODUCT},
        "two": {"product": {"D": 1.5, "gamma": "5/2", "m": 2, "phases": [[0, 1]]}},
    }
    solutions = Solutions(load(tmp_path, studies=studies, methods=["demelio"]), tmp_path / "batches")
    (path,) = solutions.files()
    assert not (tmp_path / "batches").exists()  # before it is to be solved
    solutions.store.write()
    described, found = solutions.store.batch(path.stem), read_batch(path.with_suffix(".json"))
    assert found.title == described.title == "13 cases from one to two by demelio"
    assert found.name == described.name == path.stem
    assert list(found.cases) == list(described.cases)
    assert found.kind == described.kind
    assert found.kind.loads == [0.1, 1.0]


def test_the_cases_of_a_description_are_read_only_by_the_job_that_solves_them(tmp_path):
    """A million of them would take Snakemake seconds."""
    solutions = Solutions(load(tmp_path, methods=["demelio"]), tmp_path / "batches")
    (path,) = solutions.files()
    solutions.store.write()
    description = path.with_suffix(".json")
    description.write_text(description.read_text().splitlines()[0])
    found = Solutions(solutions.scene, tmp_path / "batches").store.batch(path.stem)
    assert found.title == solutions.store.batch(path.stem).title
    assert len(found.cases) == len(found.surfaces)
    with pytest.raises(ValueError, match=r"json does not describe a batch: delete it and run snakemake again"):
        list(found.cases)
    again = Solutions(solutions.scene, tmp_path / "batches")  # an older version has left this description
    again.files()
    again.store.write()
    assert list(read_batch(description).cases) == list(solutions.store.batch(path.stem).cases)


def test_only_batches_that_no_scene_uses_are_unused(tmp_path):
    folder = tmp_path / "batches"
    solve_scene(load(tmp_path), folder)
    solve_scene(load(tmp_path, loads=[3.0]), folder)
    current = Solutions(load(tmp_path), folder)
    found = unused(Store(folder), [current])
    assert len(found) == 2
    assert all(size == (folder / f"{name}.nc").stat().st_size for name, size in found.items())
    assert unused(Store(folder), [current, Solutions(load(tmp_path, loads=[3.0]), folder)]) == {}


@pytest.mark.parametrize(("method", "solved"), [("layer", 4), ("patches", 4 * 50)])
def test_curves_that_differ_in_phases_alone_are_expected_once_if_the_method_uses_none(tmp_path, method, solved):
    scene = load(tmp_path, methods=[method], **product(seed={"from": 1, "to": 50, "count": 50}))
    (part,) = Solutions(scene, tmp_path / "batches").parts
    cases = [part.batch_case(number) for number in range(0, 200, 50)]  # one of each D and gamma
    once = sum(case.seconds(method, np.array([0.1, 1.0])) for case in cases)
    assert part.seconds().sum() == pytest.approx(200 * CASE_SECONDS + once * solved / 4, rel=1e-9)


@pytest.mark.parametrize("of", ["kind", "cases"])
def test_a_time_limit_is_no_damaged_description(solved, monkeypatch, of):
    path = next((solved / "batches").glob("*.json"))
    cases = read_batch(path).cases
    monkeypatch.setattr(curves.json, "loads", Mock(side_effect=TimeoutError("after 10 s")))
    with pytest.raises(TimeoutError, match=r"^after 10 s$"):
        read_batch(path) if of == "kind" else cases[0]
