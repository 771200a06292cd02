"""A method defined here, outside the package, and listed: everything else follows from its one object.

tests/accuracy drives it through the trade between speed and accuracy and through the extremes.
"""

import numpy as np
import pytest

import weier
from tests.scenes import read, scene_in, solve_scene, write_data
from tests.toy_method import TOY
from weier import figures
from weier.api import batch
from weier.figures import style
from weier.methods import registry
from weier.scene import Figure

PROFILE = weier.Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
LOADS = np.array([0.01, 0.1, 1.0])
SCENE = """
title: A toy
loads: [0.01, 0.1, 1.0]
methods: [demelio, toy]
settings: {toy: {fraction: 0.25}}
studies:
  one: {product: {D: 1.25, gamma: 5, m: [2, 3]}}
figures:
  compliance: {draw: compliance, studies: [one]}
"""


@pytest.fixture(autouse=True)
def listed(monkeypatch):
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS, TOY))


@pytest.fixture
def loaded(tmp_path):
    return scene_in(tmp_path, SCENE)


def test_it_is_solved_with_its_settings():
    curve = weier.solve(PROFILE, LOADS, "toy", fraction=0.25)
    assert curve.compliance.values == pytest.approx(0.25 * LOADS)
    with pytest.raises(ValueError, match=r'"toy" has no setting .points.: it takes fraction'):
        weier.solve(PROFILE, LOADS, "toy", points=3)


def test_a_scene_solves_gathers_and_draws_it(loaded, tmp_path):
    data = batch.solve_batch(loaded.distinct, loaded.loads)
    assert data["compliance"].sel(solution_method="toy").values == pytest.approx(np.array([0.25 * LOADS] * 2))
    write_data(solve_scene(loaded, tmp_path / "curves"), tmp_path / "contact.nc")
    gathered = read(tmp_path / "contact.nc")
    figures.draw(Figure("compliance"), [gathered], tmp_path / "figure.png")
    drawn = style.line("toy")
    assert (drawn["label"], drawn["color"]) == ("a toy", TOY.style.color)
    assert (tmp_path / "figure.png").stat().st_size > 0
