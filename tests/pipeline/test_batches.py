"""What is solved is found again case by case, and only what is missing is cut into batches."""

import pytest

from tests.scenes import scene_in, solve_scene
from weier.pipeline import batches
from weier.pipeline.batches import Missing, Solutions, cut_into_batches, read_batch
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
    """Methods of each case that would be solved, and what is solved already stays where it is."""
    before = {path: path.stat().st_mtime_ns for path in folder.glob("batches/*.nc")}
    files = Solutions(load(folder, **changes), folder / "batches").files(cores=2)
    made = [read_batch(path.with_suffix(".json")) for path in files if path not in before]
    assert before == {path: path.stat().st_mtime_ns for path in folder.glob("batches/*.nc")}
    return [case for batch in made for case in batch.cases]


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
    assert [case.methods for case in found] == [methods] * count
    assert all(case.settings == changes.get("settings", {}) for case in found)


def test_another_program_solves_all_again(solved, monkeypatch):
    monkeypatch.setattr(batches, "digest_of_sources", lambda *parts: "another")
    assert len(missing(solved)) == 12


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
def test_batches_are_twice_as_many_as_cores_and_neither_short_nor_long(tmp_path, seconds, count, cores, expected):
    loaded = load(tmp_path)
    members = [Missing(loaded.distinct[0], ("one",), seconds)] * count
    parts = cut_into_batches(members, loaded, cores)
    assert sum(map(len, parts)) == count
    assert len(parts) == expected
    assert max(map(len, parts)) - min(map(len, parts)) <= 1


def test_batches_are_no_larger_than_asked(tmp_path):
    members = [Missing(case, ("one",), 1e-3) for case in load(tmp_path).distinct]
    parts = cut_into_batches(members, load(tmp_path, batch=5), 1)
    assert [len(part) for part in parts] == [4, 4, 4]


def test_a_study_needs_only_its_own_cases(tmp_path):
    """Later calls contain them as well."""
    studies = {"one": {"product": PRODUCT}, "two": {"product": PRODUCT | {"seed": [2, 7]}}}
    solutions = Solutions(load(tmp_path, studies=studies), tmp_path)
    (path,) = solutions.files(["two"])
    assert len(read_batch(path.with_suffix(".json")).cases) == 8
    again, other = solutions.files()
    assert again == path
    assert len(read_batch(other.with_suffix(".json")).cases) == 8
    assert set(solutions.files(["one"])) == {path, other}
    assert len(solutions.to_solve) == 2


def test_a_batch_says_what_it_holds(tmp_path):
    (path,) = Solutions(load(tmp_path), tmp_path).files()
    batch = read_batch(path.with_suffix(".json"))
    assert batch.title == "12 cases of one"
    assert batch.common["loads"] == [0.1, 1.0]


def test_batches_of_another_program_go(solved, tmp_path, monkeypatch):
    scene_then = load(tmp_path)
    solve_scene(scene_then, tmp_path / "batches")
    Solutions(load(tmp_path, loads=[3.0]), tmp_path / "batches").files()  # planned and not solved
    Solutions(scene_then, tmp_path / "batches").tidy()
    assert [len(list((tmp_path / "batches").glob(f"*.{kind}"))) for kind in ("json", "nc")] == [1, 1]
    monkeypatch.setattr(batches, "digest_of_sources", lambda *parts: "another")
    Solutions(scene_then, tmp_path / "batches").tidy()
    assert list(tmp_path.glob("batches/*")) == []
