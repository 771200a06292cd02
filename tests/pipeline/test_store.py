"""Segments of the store: whole or not there, read by key, and named where they are damaged."""

import re
from dataclasses import replace

import numpy as np
import pytest

from weier.pipeline.needed_curves import Kind
from weier.pipeline.store import Store
from weier.scene.identity import keys_of

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


def read(store, keys, name):
    return store.read(KIND, store.rows(KIND, keys), name)


def test_curves_are_read_by_key_in_any_order_and_more_than_once(store):
    for wanted in ([0, 1, 2, 3], [3, 0, 3, 2], [1]):
        found = read(store, KEYS[wanted], "compliance")
        assert found.tolist() == [[value, value + 1] for value in wanted]
        assert read(store, KEYS[wanted], "status").tolist() == [0] * len(wanted)
    assert read(store, KEYS[:4], "chosen").tolist() == ["", "layer", "", ""]
    assert read(store, KEYS[:4], "origin").tolist() == ["one", "another", "one", "another"]
    edges = read(store, KEYS[:4], "edges")
    assert edges.shape == (4, 2, 3)
    assert np.isnan(edges).sum(axis=(1, 2)).tolist() == [6, 6, 4, 0]
    assert read(store, KEYS[:4], "residual") is None


def test_what_is_not_solved_is_named_with_what_to_do(store):
    for kind, keys, count in ((KIND, KEYS[[0, 4, 5]], 2), (replace(KIND, method="layer"), KEYS[:1], 1)):
        with pytest.raises(
            ValueError, match=rf"^{count} curves by {kind.method} are not solved: run snakemake again$"
        ):
            store.rows(kind, keys)
    assert not Store(store.folder, "later").index(KIND.name).keys.size


def test_a_damaged_segment_is_named_with_what_to_do(store):
    """Wherever the damage is: it is refused, or has changed no number."""
    path, names = min((store.folder / KIND.name / "now").iterdir()), ("compliance", "status", "edges", "origin")
    whole, correct = path.read_bytes(), [read(store, KEYS[:4], name) for name in names]
    contents = [whole[: len(whole) // 2], b"", b"not a segment"]
    contents += [whole[:n] + bytes([whole[n] ^ 4]) + whole[n + 1 :] for n in range(0, len(whole), 5)]
    refused = []
    for content in contents:
        path.write_bytes(content)
        try:
            again = [read(Store(store.folder, "now"), KEYS[:4], name) for name in names]
        except ValueError as error:
            refused.append(str(error))
            continue
        for values, expected in zip(again, correct, strict=True):
            np.testing.assert_array_equal(values, expected)
    assert len(refused) > len(contents) / 2
    advice = rf"{path} is damaged \(.*\): move it away and run snakemake again"
    assert [line for line in refused if not re.match(advice, line)] == []
    path.unlink()
    with pytest.raises(ValueError, match=r"^2 curves by bem are not solved"):
        read(Store(store.folder, "now"), KEYS[:4], "compliance")


def test_either_of_two_solutions_of_a_curve_serves(store):
    store.append(KIND, {KEYS[0]: row(0), KEYS[5]: row(5)}, "again")
    assert read(store, KEYS[[0, 5, 1]], "compliance")[:, 0].tolist() == [0, 5, 1]
    assert len(store.index(KIND.name).keys) == 6
