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
    "methods": ["archard", "bem", "layer"],
    "contact_edges": True,
    "studies": {"one": {"product": {"D": 1.25, "gamma": 2, "m": [1, 2, float("inf")], "phases": 1.0}}},
}
EVERY = {SURFACE, "archard", "bem", "layer"}


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
    """Let the other code have found other values of a quantity in the curves of a method."""
    (part,) = {part.kind.name: part for part in (*old.surfaces, *old.parts) if part.kind.method == method}.values()
    other = Store(old.store.folder, "old")
    rows = other.rows(part.kind, part.keys)
    names, origin = other.index(part.kind.name).columns[0], str(other.read(part.kind, rows, "origin")[0])
    values = {own: other.read(part.kind, rows, own) for own in names if own not in ("key", "origin")}
    values[name] = by(values[name])
    shutil.rmtree(other.segments(part.kind.name))
    found = {key: {own: column[row] for own, column in values.items()} for row, key in enumerate(part.keys)}
    other.append(part.kind, found, origin)


def adopted(old, within_errors=False):
    """The methods whose curves count, and what was said."""
    store, said = Store(old.store.folder, old.store.numerics), []
    assert adopt([old], store, within_errors, said.append) == len(EVERY)
    return {line.partition("-")[0] for line in said if line.endswith(": adopted")}, said


def test_a_sample_of_the_same_bits_stands_for_all_with_a_record_beside_the_curves(old, monkeypatch):
    monkeypatch.setattr(adoption, "SAMPLE", 1)
    found, said = adopted(old)
    assert found == EVERY
    assert all(line.endswith("of old: 1 curves solved again, the same bits: adopted") for line in said)
    records = [json.loads(path.read_text()) for path in old.store.folder.glob(f"*/{old.store.numerics}/{RECORD}")]
    expected = {"curves": "old", "code": old.store.numerics, "compared": 1, "identical": True, "adopted": True}
    assert records == [expected] * len(EVERY)
    now = curves_in(old.scene, old.store.folder)
    assert now.store.lacking(now.parts_for()) == []


def of_other_loads(edges):
    """The only contact of a curve under its other load."""
    return np.where(np.isnan(edges).any((1, 2), keepdims=True), edges[:, ::-1], edges)


@pytest.mark.parametrize(
    ("method", "name", "by", "is_within"),
    [
        ("bem", "compliance", lambda values: values * (1 + 1e-14), True),
        ("bem", "compliance", lambda values: values * 2, False),
        ("bem", "contact_edge", of_other_loads, True),
        ("archard", "compliance", lambda values: values * (1 + 1e-14), False),  # states no error
        (SURFACE, "phases", lambda values: values[:, ::-1], False),
    ],
)
def test_other_numbers_are_adopted_if_asked_and_within_stated_errors(old, tmp_path, method, name, by, is_within):
    change(old, method, name, by)
    for within_errors in (False, True):
        copy = shutil.copytree(old.store.folder, tmp_path / f"copy {within_errors}")
        expected = EVERY if within_errors and is_within else EVERY - {method}
        assert adopted(curves_in(old.scene, copy), within_errors)[0] == expected
