"""A batch: each case with whatever its methods return."""

from __future__ import annotations

import numpy as np
import pytest

from tests.scenes import scene_in
from weier.api import batch
from weier.api.fields import fields
from weier.api.interface import Interface
from weier.api.solve import solve
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile


def test_mean_gap_and_area_coefficient_are_those_of_the_fields_and_of_two_bodies():
    """kappa = A E* h'/p with 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 and the slope of the heights in metres."""
    x = np.arange(200) / 200
    trace = Trace(1e-6 * np.cos(2 * np.pi * x) + 2e-7 * np.cos(10 * np.pi * x + 1), 1e-3, ends="periodic", unit="m")
    bodies = {"E_1": 210e9, "nu_1": 0.3, "E_2": 120e9, "nu_2": 0.34}
    found = Interface(**bodies, rho_1=1.4e-7, rho_2=1.7e-8, lambda_0=1e-3, g_0=1e-6).solve(
        [trace, Profile(1.5, 3, 2, 1.0)], [1e7, 1e8, 5e8], ["patches"]
    )
    E = 1 / ((1 - 0.3**2) / 210e9 + (1 - 0.34**2) / 120e9)
    slope = np.sqrt((1e-6 * 2 * np.pi / 1e-3) ** 2 + (2e-7 * 10 * np.pi / 1e-3) ** 2) / np.sqrt(2)
    assert (found.rms_slope[0], found.rms_height[0]) == (pytest.approx(slope), pytest.approx(7.2111e-7, rel=1e-4))
    assert (found.rms_slope.units, found.rms_curvature.units, found.mean_gap.units) == ("1", "m^-1", "m")
    area = E * found.rms_slope * found.contact_fraction / found.mean_pressure
    np.testing.assert_allclose(found.area_coefficient, area.transpose(*found.area_coefficient.dims), rtol=1e-12)
    own = fields(Profile(1.5, 3, 2, 1.0), 0.1)
    solved = solve([Profile(1.5, 3, 2, 1.0)], [0.1], ["patches", "demelio", "persson"])
    assert solved.mean_gap.values[0, 0] == pytest.approx(own.mean_gap, rel=1e-12)
    assert solved.area_coefficient.isnull().values.tolist() == [[[False], [True], [False]]]
    for method in ("patches", "persson"):
        one, listed = solve(Profile(1.5, 3, 2, 1.0), [0.1], method), solved.isel(case=0).sel(solution_method=method)
        assert (one.mean_gap, one.area_coefficient) == (listed.mean_gap, listed.area_coefficient)
    for infinite in (Profile(1.5, 3, np.inf), Profile(1.5, 10, 400)):  # slopes, the second beyond the range of floats
        assert solve([infinite], [0.1], ["persson"]).area_coefficient.isnull().all()
    light = solve([Profile(1.5, 3, 4)], [1e-6], ["persson"])
    assert light.area_coefficient.item() == pytest.approx(np.sqrt(8 / np.pi), rel=1e-9)  # of Persson's theory


def test_the_choice_is_stored_with_its_curves(tmp_path):
    study = {"product": {"D": 1.25, "gamma": 5, "m": [2, "inf"]}}
    loaded = scene_in(tmp_path, {"title": "t", "loads": [0.1, 1], "tolerance": 0.1, "studies": {"one": study}})
    data = batch.solve_batch(loaded.studies["one"], loaded.loads)
    assert data["solution_method"].values.tolist() == ["auto"]
    assert data["chosen_method"].values.tolist() == ["bem", "patches"]  # terms of the second are left out
    assert data["chosen_terms"].values.tolist() == [2, 3]
    assert np.all(data["compliance_error"].values <= 0.1)
