"""One profile without a scene file, from Python: what the command line is thin over."""

import numpy as np
import pytest

from tests.scenes import scene_in
from weier.methods.errors import ConvergenceError
from weier.pipeline import single
from weier.scene.yaml import parse_yaml

SERIES = {"D": 1.25, "gamma": "5/2", "m": 2, "phases": 1.0}
LOADS = np.array([0.1, 1.0])


def test_the_text_of_the_scene_makes_the_same_case(tmp_path):
    found = single.solve_one(SERIES, LOADS, ["layer"], {"layer": {"accuracy": 1e-6}})
    again = scene_in(tmp_path, found.attrs["scene"])
    assert [case.key for case in again.studies["one"]] == found["key"].values.tolist()
    assert parse_yaml(found.attrs["scene"])["settings"] == {"layer": {"accuracy": 1e-6}}


def test_what_no_method_finds_raises():
    with pytest.raises(ValueError, match="bem: m = inf has no finest wave"):
        single.solve_one(SERIES | {"m": np.inf, "phases": 0.0}, LOADS, ["bem"], {})
    with pytest.raises(ConvergenceError, match=r"patches: the compliance .* is known to .*: take a larger one"):
        single.solve_one(SERIES | {"m": 5}, np.array([1.0]), ["patches"], {"patches": {"tolerance": 1e-13}})
