"""A scene of three waves by three methods, solved once for the tests of this folder."""

import pytest

from weier import scene
from weier.data import dataset
from weier.pipeline import batch

SCENE = """
title: test
loads: [0.01, 0.1, 1.0]
methods: [westergaard, demelio, bem]
studies:
  waves: {product: {D: 1.25, gamma: 5, m: [1, 2, .inf]}}
  two: {product: {D: 1.25, gamma: 5, m: 2}}
"""


@pytest.fixture(scope="session")
def loaded(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "test.yaml"
    path.write_text(SCENE)
    return scene.load(path)


@pytest.fixture(scope="session")
def solved(loaded):
    return {name: batch.solve_batch(loaded, cases) for name, cases in loaded.batches.items()}


@pytest.fixture(scope="session")
def batches(solved, tmp_path_factory):
    """The folder of batches."""
    folder = tmp_path_factory.mktemp("batches")
    for name, (data, _) in solved.items():
        dataset.write(data, folder / f"{name}.nc", "test", "solved", SCENE)
    return folder
