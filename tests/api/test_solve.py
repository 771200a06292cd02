"""What `weier.solve` returns: a curve that describes itself, or those of many as the pipeline has them."""

import json
import math

import numpy as np
import pytest
import xarray as xr

import weier
from tests.scenes import scene_in
from weier.api.batch import solve_batch
from weier.data import curves, provenance
from weier.methods.registry import find_method, names
from weier.methods.settings import defaults

LOADS = [0.01, 0.1, 1.0]
SMOOTH = weier.Profile(1.25, 5, 2, (0.0, 1.0))
ROUGH = weier.Profile(1.5, "5/2", 3, weier.random_phases(7))


SAME = """
title: the same
loads: [0.01, 0.1, 1.0]
methods: [demelio, bem]
settings: {bem: {tolerance: 1.0e-3}}
studies:
  both:
    cases: [{D: 1.25, gamma: 5, m: 2, phases: [[0.0, 1.0]]}, {D: 1.5, gamma: 5/2, m: 3, seed: 7}]
"""


def profile_of(method):
    return weier.Profile(1.25, 5, 1) if method == "westergaard" else SMOOTH


@pytest.mark.parametrize("method", names())
def test_a_curve_knows_its_profile_and_all_settings_also_in_a_file_and_a_table(method, tmp_path):
    profile, path = profile_of(method), tmp_path / "curve.nc"
    curve = weier.solve(profile, LOADS, method)
    assert (curve.D, curve.gamma, curve.m, curve.solution_method) == (1.25, 5, profile.m, method)
    assert np.isnan(curve.seed)
    again = curves.profile(curve)
    assert (again.D, again.gamma, again.m) == (profile.D, profile.gamma, profile.m)
    assert np.array_equal(again.listed_phases, profile.listed_phases)
    used = {name: value for name, value in defaults(find_method(method)).items() if value is not None}
    assert used.items() <= json.loads(curve.attrs["settings"]).items()
    assert curve.attrs["source"] == provenance.origin()
    curve.to_netcdf(path)
    with xr.open_dataset(path) as found:
        assert found.identical(curve)
    with weier.open_dataset(path) as data:
        one = data.weier.cases(D=1.25, gamma=5, m=profile.m).sel(solution_method=method, mean_pressure=0.1)
        np.testing.assert_equal(
            one.compliance.item(), curve.compliance.values[1]
        )  # NaN of a method of the area alone
    frame = curve.drop_dims("term").to_dataframe()  # the phases are over the terms, all else over the loads
    assert frame.index.tolist() == LOADS
    assert (frame["solution_method"] == method).all()


@pytest.mark.parametrize(
    ("given", "used"),
    [
        ({}, {"points_per_wave": 64, "staircase": "removed"}),
        ({"points_per_wave": 20, "staircase": "kept"}, {"points_per_wave": 20, "staircase": "kept"}),
        ({"tolerance": 0.01}, {"tolerance": 0.01, "staircase": "removed"}),  # which chooses the points
    ],
)
def test_settings_are_those_that_were_used(given, used):
    one, several = weier.solve(SMOOTH, [0.1], "bem", **given), weier.solve([SMOOTH], [0.1], ["bem"], bem=given)
    assert json.loads(one.attrs["settings"]) == json.loads(several.settings.item()) == used
    assert one.points == several.points.item()
    if "points_per_wave" in used:
        assert one.points == used["points_per_wave"] * SMOOTH.waves_per_period[-1]
        assert one.points_per_wave == used["points_per_wave"]


def test_several_profiles_and_methods_are_what_the_pipeline_writes(tmp_path):
    found = weier.solve([SMOOTH, ROUGH], LOADS, ["demelio", "bem"], bem={"tolerance": 1e-3})
    loaded = scene_in(tmp_path, SAME)
    written = solve_batch(loaded.studies["both"], loaded.loads)
    xr.testing.assert_identical(
        found.drop_vars(["key", "seconds", "case"]).drop_attrs(), written.drop_vars(["key", "seconds"]).drop_attrs()
    )
    for case, profile in enumerate((SMOOTH, ROUGH)):
        for method, settings in (("demelio", {}), ("bem", {"tolerance": 1e-3})):
            one = weier.solve(profile, LOADS, method, **settings)
            both = found.isel(case=case).sel(solution_method=method)
            assert both.compliance.values == pytest.approx(one.compliance.values, rel=1e-14)
            assert json.loads(str(both.settings.values)) == json.loads(one.attrs["settings"])
    found.to_netcdf(tmp_path / "both.nc")
    with weier.open_dataset(tmp_path / "both.nc") as data:
        assert data.weier.cases(D=1.5).sel(solution_method="bem").compliance.shape == (1, 3)


def test_what_cannot_be_solved_is_named_and_the_others_are_there():
    irrational = weier.Profile(1.25, math.sqrt(2), 3)
    with pytest.warns(UserWarning, match="bem: the finest wave .*: take fewer terms, a gamma of") as warned:
        found = weier.solve([SMOOTH, irrational], LOADS, ["demelio", "bem"])
    assert [warning.filename for warning in warned] == [__file__]
    assert found.status.values.tolist() == [[0, 0], [0, 2]]
    assert np.isfinite(found.compliance.values[found.status.values == 0]).all()
    assert np.isnan(found.compliance.values[1, 1]).all()
