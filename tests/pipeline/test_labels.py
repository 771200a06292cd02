"""Cases of one profile are distinguished by study, seed and settings: in the file, by `sel`, and on the page."""

import numpy as np
import pytest
import xarray as xr

import weier
from tests.scenes import scene_in, solve_scene
from weier.pipeline import claims

SCENE = """
title: Grids
loads: [0.1, 1.0]
methods: [bem]
studies:
  coarse: {product: {D: 1.25, gamma: 5, m: 1}, settings: {bem: {points_per_wave: 40, staircase: kept}}}
  fine: {product: {D: 1.25, gamma: 5, m: 1}, settings: {bem: {points_per_wave: 80, staircase: kept}}}
  between: {product: {D: 1.25, gamma: 5, m: 1}, settings: {bem: {points_per_wave: 80, staircase: removed}}}
  alike: {product: {D: 1.25, gamma: 5, m: 1}, settings: {bem: {points_per_wave: 80, staircase: kept}}}
  drawn: {product: {D: 1.25, gamma: 5, m: 2, seed: [7, 8]}, methods: [demelio]}
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("grids")
    solutions = solve_scene(scene_in(folder, SCENE), folder / "curves")
    claims.write(solutions, folder / "contact.nc", folder / "claims.md")
    return folder / "contact.nc"


def test_a_file_labels_its_cases(path):
    with xr.open_dataset(path) as data:
        assert data.study.values.tolist() == ["coarse", "fine, alike", "between", "drawn", "drawn"]
        np.testing.assert_array_equal(data.bem_points_per_wave, [40, 80, 80, np.nan, np.nan])
        assert data.bem_staircase.values.tolist() == ["kept", "kept", "removed", "", ""]
        np.testing.assert_array_equal(data.seed, [np.nan, np.nan, np.nan, 7, 8])
        assert "bem_tolerance" not in data.coords  # is left out only by a method that is not run
        assert data.bem_points_per_wave.attrs["long_name"] == "setting points_per_wave of method bem"
        assert {"study", "bem_points_per_wave", "seed"} <= set(data["compliance"].coords)


def test_each_case_has_a_name_that_tells_it_from_the_others(path):
    with weier.open_dataset(path) as data:
        names = [
            "coarse: D = 1.25, gamma = 5, m = 1, phases = 0, bem_points_per_wave = 40, bem_staircase = kept",
            "fine, alike: D = 1.25, gamma = 5, m = 1, phases = 0, bem_points_per_wave = 80, bem_staircase = kept",
            "between: D = 1.25, gamma = 5, m = 1, phases = 0, bem_points_per_wave = 80, bem_staircase = removed",
            "drawn: D = 1.25, gamma = 5, m = 2, seed = 7",
            "drawn: D = 1.25, gamma = 5, m = 2, seed = 8",
        ]
        assert data.case.values.tolist() == names
        series = data.compliance.sel(solution_method="demelio").to_series()
        assert series.index.names == ["case", "mean_pressure"]
        assert data.sel(case=names[1]).bem_points_per_wave == 80
