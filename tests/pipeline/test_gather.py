"""Solved curves as datasets: gathered into a file, or read into memory, in the order of the cases."""

import numpy as np
import pytest
import xarray as xr

from tests.scenes import read, scene_in, solve_scene, write_data
from weier.api import batch
from weier.pipeline.gather import read_study

WAVE = {"product": {"D": 1.25, "gamma": 5, "m": 2}}


def file_of(curves, folder):
    write_data(curves, folder / "contact.nc")
    return read(folder / "contact.nc")


MIXED = {
    "title": "mixed",
    "loads": [0.01, 0.1, 1.0],
    "contact_edges": True,
    "studies": {
        "short": {"product": {"D": 1.25, "gamma": 5, "m": 1}, "methods": ["archard", "patches"]},
        "long": WAVE,
    },
}


@pytest.mark.parametrize("methods", [["demelio"], ["layer", "bem", "patches"], ["bem", "patches", "layer"]])
def test_curves_of_other_methods_and_terms_come_together(tmp_path, methods):
    """And the edges of contact are those of the last method that tells them, whichever was solved first."""
    solve_scene(scene_in(tmp_path, MIXED | {"methods": ["bem"]}), tmp_path / "curves")
    mixed = scene_in(tmp_path, MIXED | {"methods": methods})
    found = file_of(solve_scene(mixed, tmp_path / "curves"), tmp_path)
    expected = batch.solve_batch(mixed.distinct, mixed.loads, contact_edges=True)
    edges = expected["contact_edge"].dropna("edge", how="all").variable
    xr.testing.assert_equal(found["contact_edge"].dropna("edge", how="all").variable, edges)
    for name in expected.variables.keys() - {"seconds", "key", "contact_edge"}:
        xr.testing.assert_equal(found[name].variable, expected[name].variable)
    assert found.attrs["origin_0"] == "test"
    assert np.unique(found.origin.values[found.status.values == 0]).tolist() == [0]


def test_a_file_has_the_loads_of_all_studies_and_each_study_its_own(tmp_path):
    """Cases of one surface have one key of it."""
    loads = {"coarse": [0.05, 1.0], "fine": [0.02, 0.1, 1.0, 2.0]}
    studies = {name: WAVE | {"loads": own} for name, own in loads.items()} | {"common": WAVE}
    scene = scene_in(tmp_path, {"title": "one", "loads": [0.1, 1.0], "methods": ["demelio"], "studies": studies})
    of_loads = solve_scene(scene, tmp_path / "curves")
    data = file_of(of_loads, tmp_path)
    assert data.mean_pressure.values.tolist() == [0.02, 0.05, 0.1, 1.0, 2.0]
    assert (len({*data.surface_key.values}), len({*data.key.values})) == (1, 3)
    for name, expected in (loads | {"common": [0.1, 1.0]}).items():
        row = data.study.values.tolist().index(name)
        own = data.compliance.isel(case=row).dropna("mean_pressure", how="all")
        assert own.mean_pressure.values.tolist() == expected
        study = read_study(of_loads, name)
        assert study.mean_pressure.values.tolist() == expected
        assert study.compliance.values[0].tolist() == own.values.tolist()
        assert np.isfinite(study.compliance).all()
