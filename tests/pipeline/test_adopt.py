"""Curves of other code count where it gives the same numbers, or numbers within the stated errors if asked."""

import json
import shutil

import numpy as np
import pytest

from tests.scenes import curves_in, scene_in, solve_scene
from weier.pipeline import adopt as adoption
from weier.pipeline.adopt import RECORD, adopt
from weier.pipeline.needed_curves import SURFACE
from weier.pipeline.store import Store

SCENE = {
    "title": "t",
    "loads": [0.1, 1.0],
    "methods": ["archard", "bem", "cascade", "layer"],
    "contact_edges": True,
    "studies": {"one": {"product": {"D": 1.25, "gamma": 2, "m": [1, 2, float("inf")], "phases": 1.0}}},
}
EVERY = {SURFACE, "archard", "bem", "cascade", "layer"}


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """Curves of another code."""
    folder = tmp_path_factory.mktemp("solved")
    found = solve_scene(scene_in(folder, SCENE), folder / "curves")
    for path in (folder / "curves").glob("*/*/"):
        path.rename(path.with_name("old"))
    return found


@pytest.fixture
def old(solved, tmp_path):
    """A copy of them."""
    return curves_in(solved.scene, shutil.copytree(solved.store.folder, tmp_path / "curves"))


def change(old, method, name, by):
    """Let the other code have found another value in each curve of a method."""
    (part,) = {part.kind.name: part for part in (*old.surfaces, *old.parts) if part.kind.method == method}.values()
    for path in (old.store.folder / part.kind.name / "old").iterdir():
        with np.load(path) as columns:
            values = dict(columns)
        values[name] = by(values[name])
        np.savez(path, **values)


def adopted(old, within_errors=False):
    """The methods whose curves count, and what was said."""
    store, said = Store(old.store.folder, old.store.numerics), []
    assert adopt([old], store, within_errors, said.append) == 5
    return {line.partition("-")[0] for line in said if line.endswith(": adopted")}, said


def test_a_sample_of_the_same_bits_stands_for_all_with_a_record_beside_the_curves(old, monkeypatch):
    monkeypatch.setattr(adoption, "SAMPLE", 1)
    found, said = adopted(old)
    assert found == EVERY
    assert all(line.endswith("of old: 1 curves solved again, the same bits: adopted") for line in said)
    records = [json.loads(path.read_text()) for path in old.store.folder.glob(f"*/{old.store.numerics}/{RECORD}")]
    assert len(records) == 5
    assert {(record["curves"], record["compared"], record["identical"]) for record in records} == {("old", 1, True)}
    now = curves_in(old.scene, old.store.folder)
    assert now.store.lacking(now.parts_for()) == []


@pytest.mark.parametrize(
    ("method", "name", "by"),
    [
        ("bem", "compliance", lambda values: values * (1 + 1e-15)),
        ("bem", "contact_edge", lambda values: np.concatenate([values, 0 * values[:, :, :1] + 1], axis=2)),
        # the only contact of a curve, under its other load
        (
            "bem",
            "contact_edge",
            lambda edges: np.where(np.isnan(edges).any((1, 2), keepdims=True), edges[:, ::-1], edges),
        ),
        ("archard", "resistance", lambda values: np.nextafter(values, 9.0)),
        (SURFACE, "phases", lambda values: values[:, ::-1]),
    ],
)
def test_another_number_is_not_adopted(old, method, name, by):
    change(old, method, name, by)
    found, said = adopted(old)
    assert found == EVERY - {method}
    assert sum(line.endswith("they differ: not adopted") or "within" in line for line in said) == 1


@pytest.mark.parametrize(
    ("method", "name", "factor", "expected"),
    [
        ("bem", "compliance", 1 + 1e-14, EVERY),
        ("bem", "compliance", 2, EVERY - {"bem"}),
        ("archard", "compliance", 1 + 1e-14, EVERY - {"archard"}),  # which states no error
    ],
)
def test_errors_are_those_that_curves_state(old, method, name, factor, expected):
    change(old, method, name, lambda values: values * factor)
    assert adopted(old, within_errors=True)[0] == expected
