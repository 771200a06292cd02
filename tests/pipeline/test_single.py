"""One profile without a scene file, from Python: what the command line is thin over."""

from pathlib import Path

import numpy as np
import pytest

from tests.scenes import scene_in
from weier.data.files import check_target
from weier.methods.errors import ConvergenceError
from weier.pipeline import single
from weier.scene.yaml import parse_yaml

SERIES = {"D": 1.25, "gamma": "5/2", "m": 2, "phases": 1.0}
LOADS = np.array([0.1, 1.0])


def test_the_text_of_the_scene_makes_the_same_case(tmp_path):
    found = single.solve_one(single.case_of(SERIES, ["layer"], {"layer": {"accuracy": 1e-6}}), LOADS)
    again = scene_in(tmp_path, found.attrs["scene"])
    assert [case.key(LOADS) for case in again.studies["one"]] == found["key"].values.tolist()
    assert parse_yaml(found.attrs["scene"])["settings"] == {"layer": {"accuracy": 1e-6}}


@pytest.mark.second_attempt
def test_what_no_method_finds_raises():
    with pytest.raises(ValueError, match="bem: m = inf has no finest wave"):
        single.solve_one(single.case_of(SERIES | {"m": np.inf, "phases": 0.0}, ["bem"], {}), LOADS)
    wanted = single.case_of(SERIES | {"gamma": "6/5", "m": 4}, ["patches"], {"patches": {"tolerance": 1e-13}})
    with pytest.raises(ConvergenceError, match=r"patches: the compliance .* is known to .*: take .* or more"):
        single.solve_one(wanted, np.array([1.0]))


def test_a_trace_whose_name_no_text_can_hold_is_solved(tmp_path, monkeypatch):
    """Python reads bytes that are no UTF-8 as halves of characters, which neither netCDF nor JSON can write."""
    monkeypatch.chdir(tmp_path)
    heights = "\n".join(f"{np.cos(2 * np.pi * x / 32):.9f}" for x in range(64))
    Path("a\udcff.csv").write_text(heights)
    trace = {"file": "a\udcff.csv", "length": 1e-3, "height_unit": "um"}
    found = single.solve_one(single.case_of({"trace": trace}, ["bem"], {}), LOADS)
    assert found["trace"].values.tolist() == ["a\ufffd.csv"]
    for text in (found.attrs["scene"], found.attrs["title"]):
        assert "a\ufffd.csv" in text
        assert text.encode()
    with pytest.raises(OSError, match="netCDF needs a path in UTF-8"):
        check_target("b\udcff.nc")
