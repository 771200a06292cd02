"""A scene of three waves by three methods, solved once for the tests of this folder."""

import pytest

from tests.scenes import scene_in, solve_scene

SCENE = """
title: test
loads: [0.01, 0.1, 1.0]
methods: [westergaard, demelio, bem]
studies:
  waves: {product: {D: 1.25, gamma: 5, m: [1, 2, .inf]}}
  two: {product: {D: 1.25, gamma: 5, m: 2}}
"""


@pytest.fixture(scope="session")
def solutions(tmp_path_factory):
    """All its cases, in several files."""
    folder = tmp_path_factory.mktemp("scene")
    return solve_scene(scene_in(folder, SCENE), folder / "curves", jobs=2)
