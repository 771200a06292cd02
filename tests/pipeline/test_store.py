"""Segments of the store: whole or not there, read by key, and named where they are damaged."""

import re

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
    """Also one that two segments have."""
    for wanted in ([0, 1, 2, 3], [3, 0, 3, 2], [1]):
        assert read(store, KEYS[wanted], "compliance").tolist() == [[value, value + 1] for value in wanted]
        assert read(store, KEYS[wanted], "status").tolist() == [0] * len(wanted)
    assert read(store, KEYS[:4], "chosen").tolist() == ["", "layer", "", ""]
    assert read(store, KEYS[:4], "origin").tolist() == ["one", "another", "one", "another"]
    edges = read(store, KEYS[:4], "edges")
    assert edges.shape == (4, 2, 3)
    assert np.isnan(edges).sum(axis=(1, 2)).tolist() == [6, 6, 4, 0]
    assert read(store, KEYS[:4], "residual") is None
    store.append(KIND, {KEYS[0]: row(0), KEYS[5]: row(5)}, "again")
    assert read(store, KEYS[[0, 5, 1]], "compliance")[:, 0].tolist() == [0, 5, 1]


def test_missing_curves_and_damaged_segments_are_named_with_what_to_do(store):
    path = min((store.folder / KIND.name / "now").iterdir())
    whole = path.read_bytes()
    for content in (
        b"",
        whole[: len(whole) // 2],
        *(whole[:n] + bytes([whole[n] ^ 4]) + whole[n + 1 :] for n in (9, 99)),
    ):
        path.write_bytes(content)
        with pytest.raises(
            ValueError, match=rf"^{re.escape(str(path))} is damaged: move it away and run snakemake again"
        ):
            Store(store.folder, "now").rows(KIND, KEYS[:1])
    path.unlink()
    with pytest.raises(ValueError, match=r"^2 curves by bem are not solved: run snakemake again$"):
        Store(store.folder, "now").rows(KIND, KEYS[:4])
    with pytest.raises(ValueError, match=r"^1 curves by bem are not solved"):
        Store(store.folder, "later").rows(KIND, KEYS[:1])
