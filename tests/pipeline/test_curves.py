"""The curves of a scene: which are missing, which job solves them, and how they are stored, adopted and read."""

import json
import re
import shutil

import numpy as np
import pytest
import xarray as xr

from tests.scenes import curves_in, read, scene_in, solve_scene, write_data
from weier.api import batch
from weier.methods.registry import find_method
from weier.methods.settings import defaults
from weier.pipeline import adopt as adoption
from weier.pipeline import jobs
from weier.pipeline.adopt import RECORD, adopt
from weier.pipeline.gather import Solved, read_study
from weier.pipeline.needed_curves import SURFACE, Kind
from weier.pipeline.store import Store
from weier.pipeline.workflow import missing
from weier.scene.case import identity
from weier.scene.identity import keys_of

PRODUCT = {"D": [1.25, 1.5], "gamma": [2, 3], "m": 2, "seed": {"from": 1, "to": 3, "count": 3}}
SCENE = {"title": "t", "loads": [0.1, 1.0], "methods": ["archard", "bem"], "studies": {"one": {"product": PRODUCT}}}


def product(**changes):
    return {"studies": {"one": {"product": PRODUCT | changes}}}


def curves_of(folder, **changes):
    """The curves of the scene with some changes, as another process finds them."""
    return curves_in(scene_in(folder, SCENE | changes), folder / "curves")


def lacking(curves):
    again = curves_in(curves.scene, curves.store.folder)
    return again.store.lacking(again.parts_for())


def fill(curves, every=1):
    """Append rows without numbers for what is missing, or for a part of it."""
    for part in lacking(curves):
        curves.store.append(part.kind, {key: {"seconds": 1.0} for key in part.keys[::every]}, "test")


def count(parts):
    """The number of curves by each method."""
    found = {}
    for part in parts:
        found[part.kind.method] = found.get(part.kind.method, 0) + len(part.keys)
    return found


# --- what a curve is ---


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"title": "another", "studies": {"another": SCENE["studies"]["one"]}}, {}),
        (product(D=["1.5", 1.25], gamma=["6/2", 2.0], m="2", seed=[3, 2]), {}),
        (product(D=[1.25, 1.4, 1.5]), {"surface": 6, "archard": 2, "bem": 6}),
        (product(seed={"from": 0, "to": 3, "count": 4}), {"surface": 4, "bem": 4}),
        ({"methods": ["bem", "persson"]}, {"persson": 4}),
        # A solution goes from load to load, and the bounds of a resistance are chords between them.
        ({"loads": [0.1, 0.5, 1.0]}, {"archard": 4, "bem": 12}),
        ({"contact_edges": True}, {"archard": 4, "bem": 12}),
        ({"studies": {"one": {"product": PRODUCT, "loads": [0.2]}}}, {"archard": 4, "bem": 12}),
    ],
)
def test_only_what_is_missing_is_solved(tmp_path, changes, expected):
    fill(curves_of(tmp_path))
    assert count(lacking(curves_of(tmp_path, **changes))) == expected


def test_the_same_value_is_one_however_it_is_written():
    same = {"gamma": ("10/2", 5.0, "5"), "D": (1.25, "125e-2"), "m": (2, "2"), "phases": ([0, 1], (0.0, "1"))}
    assert all(len({repr(identity(name, value)) for value in values}) == 1 for name, values in same.items())
    assert identity("gamma", 2.5) == identity("gamma", "5/2") != identity("gamma", "5/3")
    assert identity("seed", 2**53) != identity("seed", 2**53 + 1)
    assert identity("m", np.inf) == np.inf


def test_another_setting_or_default_is_another_kind_and_other_phases_are_another_surface(tmp_path):
    def name(**settings):
        return curves_of(tmp_path, methods=["layer"], settings={"layer": settings}).parts[0].kind.name

    usual = defaults(find_method("layer"))["points"]
    assert name() == name(points=usual) != name(points=usual + 1)
    axes = {"D": 1.25, "gamma": 2, "m": 3, "phases": [[0, 1, 2], [0, 2, 1]]}
    phases = {"studies": {"one": {"product": axes}}}
    assert len({*curves_of(tmp_path, **phases).surfaces[0].keys.tolist()}) == 2


# --- which job solves it ---


def shares(curves, of):
    return [missing("scene/all.products", lambda name: curves, f"{number}-of-{of}") for number in range(of)]


def named(parts):
    return [(part.kind.name, key) for part in parts for key in part.keys.tolist()]


def test_jobs_share_the_seconds_of_curves_whatever_others_have_solved_meanwhile(tmp_path):
    """Each curve once, also one that two studies have, and curves of one kind or one more seed by different jobs."""

    def seeds(count):
        long = {"product": PRODUCT | {"m": [1, 2, 3, 4], "seed": {"from": 4, "to": 3 + count, "count": count}}}
        return curves_of(tmp_path, studies={"one": SCENE["studies"]["one"], "long": long})

    full = seeds(11)
    planned, before = lacking(full), shares(full, 3)
    assert sorted(key for own in before for key in named(own)) == sorted(named(planned)) == sorted({*named(planned)})
    seconds = [sum(part.seconds.sum() for part in own) for own in before]
    longest = max(part.seconds.max() for part in planned)
    assert max(seconds) - min(seconds) <= longest < 0.1 * min(seconds)
    fill(full, every=2)  # by others, in part
    for one, now in zip(before, shares(full, 3), strict=True):
        assert set() < set(named(now)) < set(named(one))
    fill(full)
    more = [len(named(own)) for own in shares(seeds(12), 3)]
    assert (sum(more), max(more) <= 16) == (32, True)


def test_an_error_of_one_curve_fails_the_job_once_the_others_are_solved(tmp_path, monkeypatch):
    """Even one that no solver raises."""
    curves, row, said = curves_of(tmp_path, **product(m=[2, float("inf")])), jobs._row, []

    def fails(kind, case, say):
        if kind.method == "archard" and case.parameters["D"] == 1.25:
            raise ZeroDivisionError
        return row(kind, case, say)

    monkeypatch.setattr(jobs, "_row", fails)
    with pytest.raises(ZeroDivisionError):
        jobs.solve(lacking(curves), curves.store, "test", said.append)
    assert count(lacking(curves)) == {"archard": 4}
    assert any("bem: m = inf has no finest wave" in line for line in said)


def test_jobs_that_are_stopped_keep_their_curves_and_the_next_one_solves_the_rest(tmp_path, monkeypatch):
    """Ctrl-C, as which SIGTERM counts, loses no curve, and a kill those since the last segment."""
    curves, row, left = curves_of(tmp_path, methods=["archard", "demelio"]), jobs._row, []

    def stopped(*given):
        left.append(sum(count(lacking(curves)).values()))
        if len(left) % 6 == 0:
            raise KeyboardInterrupt
        return row(*given)

    monkeypatch.setattr(jobs, "_row", stopped)
    for seconds in (60, 0):
        monkeypatch.setattr(jobs, "APPEND_SECONDS", seconds)
        with pytest.raises(KeyboardInterrupt):
            jobs.solve(lacking(curves), curves.store, "test", lambda line: None)
    assert left == [left[0]] * 6 + [left[0] - number for number in range(5, 11)]
    monkeypatch.undo()
    jobs.solve(lacking(curves), curves.store, "test", lambda line: None)
    assert lacking(curves) == []


# --- how it is stored ---

KIND = Kind("bem", {}, (0.1, 1.0))
KEYS = keys_of(range(6))


def row(value, **more):
    return {"status": 0, "compliance": np.array([value, value + 1.0]), **more}


@pytest.fixture
def store(tmp_path):
    """Four curves in two segments, the second with a quantity and a longer row more."""
    store = Store(tmp_path / "curves", "now")
    store.append(KIND, {KEYS[2]: row(2, edges=np.ones((1, 2))), KEYS[0]: row(0)}, "one")
    store.append(KIND, {KEYS[1]: row(1, chosen="layer"), KEYS[3]: row(3, edges=2 * np.ones((2, 3)))}, "another")
    return store


def test_curves_are_read_by_key_in_any_order_and_more_than_once(store):
    """Also one that two segments have, and none by the key of another one."""

    def read(keys, name):
        return store.read(KIND, store.rows(KIND, keys), name)

    for wanted in ([0, 1, 2, 3], [3, 0, 3, 2], [1]):
        assert read(KEYS[wanted], "compliance").tolist() == [[value, value + 1] for value in wanted]
        assert read(KEYS[wanted], "status").tolist() == [0] * len(wanted)
    assert read(KEYS[:4], "chosen").tolist() == ["", "layer", "", ""]
    assert read(KEYS[:4], "origin").tolist() == ["one", "another", "one", "another"]
    edges = read(KEYS[:4], "edges")
    assert edges.shape == (4, 2, 3)
    assert np.isnan(edges).sum(axis=(1, 2)).tolist() == [6, 6, 4, 0]
    assert read(KEYS[:4], "residual") is None
    store.append(KIND, {KEYS[0]: row(0), KEYS[5]: row(5)}, "again")
    assert read(KEYS[[0, 5, 1]], "compliance")[:, 0].tolist() == [0, 5, 1]
    assert not store.index(KIND.name).find(KEYS - np.uint64(1))[0].any()


def test_missing_curves_and_damaged_segments_are_named_with_what_to_do(store):
    path = min((store.folder / KIND.name / "now").iterdir())
    whole = path.read_bytes()
    for content in (b"", whole[: len(whole) // 2], whole[:99] + bytes([whole[99] ^ 4]) + whole[100:]):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=rf"^{re.escape(str(path))} is damaged: move it away"):
            Store(store.folder, "now").rows(KIND, KEYS[:1])
    path.unlink()
    for numerics, unsolved in (("now", 2), ("later", 4)):
        with pytest.raises(ValueError, match=rf"^{unsolved} curves by bem are not solved: run snakemake again$"):
            Store(store.folder, numerics).rows(KIND, KEYS[:4])


# --- how it is adopted ---

ADOPTED = product(D=1.25, gamma=2, m=[1, 2, float("inf")], seed=1) | {"contact_edges": True}
EVERY = {SURFACE, "archard", "bem", "layer"}


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """Curves of another code."""
    folder = tmp_path_factory.mktemp("solved")
    scene = scene_in(folder, SCENE | ADOPTED | {"methods": ["archard", "bem", "layer"]})
    found = solve_scene(scene, folder / "curves")
    for path in (folder / "curves").glob("*/*/"):
        path.rename(path.with_name("old"))
    return found


@pytest.mark.parametrize(
    ("method", "name", "by", "is_within"),
    [
        ("bem", "compliance", lambda values: values, None),
        ("bem", "compliance", lambda values: values * (1 + 1e-14), True),
        ("bem", "compliance", lambda values: values * 2, False),
        ("bem", "contact_edge", lambda values: values[::-1], True),
        ("archard", "compliance", lambda values: values * (1 + 1e-14), False),  # states no error
        (SURFACE, "phases", lambda values: values[::-1], False),
    ],
)
def test_curves_of_other_code_are_adopted_if_a_sample_is_the_same_or_if_asked_within_stated_errors(
    solved, tmp_path, monkeypatch, method, name, by, is_within
):
    row = jobs._row

    def found_by_this_code(kind, *given):
        found = row(kind, *given)
        return found | {name: by(found[name])} if kind.method == method and name in found else found

    monkeypatch.setattr(jobs, "_row", found_by_this_code)
    monkeypatch.setattr(adoption, "SAMPLE", 1 if is_within is None else 50)
    for within_errors in (False, True):
        folder = shutil.copytree(solved.store.folder, tmp_path / f"copy {within_errors}")
        old = curves_in(solved.scene, folder)
        said = [*adopt([old], Store(folder, old.store.numerics), within_errors)]
        assert len(said) == len(EVERY)
        expected = EVERY if is_within is None or (within_errors and is_within) else EVERY - {method}
        assert {line.partition("-")[0] for line in said if line.endswith(": adopted")} == expected
        assert {part.kind.method for part in lacking(old)} <= EVERY - expected
        records = [json.loads(path.read_text()) for path in folder.glob(f"*/{old.store.numerics}/{RECORD}")]
        assert sum(record.pop("adopted") for record in records) == len(expected)
        if is_within is None:
            record = {"curves": "old", "code": old.store.numerics, "compared": 1, "identical": True}
            assert records == [record] * len(EVERY)


# --- how it is read ---

WAVE = {"product": {"D": 1.25, "gamma": 5, "m": 2}}
SHORT = {"product": {"D": 1.25, "gamma": 5, "m": 1, "phases": [0, 1.0]}, "methods": ["archard", "patches"]}
STUDIES = {"short": SHORT, "long": WAVE}
MIXED = {"title": "mixed", "loads": [0.01, 0.1, 1.0], "contact_edges": True, "studies": STUDIES}


def file_of(curves, folder):
    write_data(curves, folder / "contact.nc")
    return read(folder / "contact.nc")


@pytest.mark.parametrize("methods", [["demelio"], ["layer", "bem", "patches"], ["bem", "patches", "layer"]])
def test_curves_of_jobs_are_those_of_cases_solved_one_by_one(tmp_path, methods):
    """The edges of contact are those of the last method that tells them, whichever was solved first."""
    solve_scene(scene_in(tmp_path, MIXED | {"methods": ["bem"]}), tmp_path / "curves")
    mixed = scene_in(tmp_path, MIXED | {"methods": methods})
    found = file_of(solve_scene(mixed, tmp_path / "curves", jobs=3), tmp_path)
    expected = batch.solve_batch(mixed.distinct, mixed.loads, contact_edges=True)
    edges = expected["contact_edge"].dropna("edge", how="all").variable
    xr.testing.assert_equal(found["contact_edge"].dropna("edge", how="all").variable, edges)
    for name in expected.variables.keys() - {"seconds", "key", "contact_edge"}:
        xr.testing.assert_equal(found[name].variable, expected[name].variable)
    assert found.attrs["origin_0"] == "test"
    assert np.unique(found.origin.values[found.status.values == 0]).tolist() == [0]


def test_the_edges_of_a_case_are_those_of_the_last_method_that_found_some_alone(tmp_path):
    curves = curves_of(tmp_path, methods=["bem", "patches"], contact_edges=True)
    for part, edges, every in zip(curves.parts, (4, 2), (1, 2), strict=True):
        found = {key: {"contact_edge": np.full((2, edges), edges)} for key in part.keys[::every]}
        curves.store.append(part.kind, found, "test")
    fill(curves)
    by_turns = np.array([[2, 2, np.nan, np.nan], [4, 4, 4, 4]] * 6)
    np.testing.assert_equal(Solved(curves).values("contact_edge")[:, 0], by_turns)


def test_a_file_has_the_loads_of_all_studies_and_each_study_its_own(tmp_path):
    """Cases of one surface have one key of it."""
    loads = {"coarse": [0.05, 1.0], "fine": [0.02, 0.1, 1.0, 2.0]}
    studies = {name: WAVE | {"loads": own} for name, own in loads.items()} | {"common": WAVE}
    scene = scene_in(tmp_path, {"title": "one", "loads": [0.1, 1.0], "methods": ["demelio"], "studies": studies})
    of_loads = solve_scene(scene, tmp_path / "curves")
    data = file_of(of_loads, tmp_path)
    assert data.mean_pressure.values.tolist() == [0.02, 0.05, 0.1, 1.0, 2.0]
    assert (len({*data.surface_key.values}), len({*data.key.values})) == (1, 3)
    for name, expected in (loads | {"common": [0.1, 1.0]}).items():
        own = data.compliance.isel(case=data.study.values.tolist().index(name)).dropna("mean_pressure", how="all")
        study = read_study(of_loads, name)
        assert study.mean_pressure.values.tolist() == own.mean_pressure.values.tolist() == expected
        assert study.compliance.values[0].tolist() == own.values.tolist()
        assert np.isfinite(study.compliance).all()
