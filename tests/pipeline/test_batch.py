"""A batch: the same rows however many threads solve them."""

import numpy as np
import pytest

from weier import scene
from weier.pipeline import batch

SCENE = """\
title: threads
loads: [0.01, 0.1, 1]
methods: [layer, bem, patches]
studies:
  one: {product: {D: 1.5, gamma: 2, m: [1, 2, 3], seed: [1, 2]}}
"""


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "test.yaml"
    path.write_text(SCENE)
    return scene.load(path)


def test_the_data_do_not_depend_on_the_threads(loaded):
    cases = loaded.studies["one"]
    (one, _), (many, cost) = batch.solve_batch(loaded, cases), batch.solve_batch(loaded, cases, threads=4)
    assert one.identical(many)
    assert np.all(cost.seconds > 0)


def test_what_a_thread_raises_reaches_the_caller(loaded, monkeypatch):
    def broken(*arguments):
        raise MemoryError("no room")

    monkeypatch.setattr(batch, "answer", broken)
    with pytest.raises(MemoryError, match="no room"):
        batch.solve_batch(loaded, loaded.studies["one"], threads=2)
