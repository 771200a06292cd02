"""What a scene leaves, read by strangers: the CF and ACDD checker, plain xarray and netCDF4."""

import math
import platform
import re
import shutil
from datetime import UTC, datetime, timedelta
from importlib.metadata import version

import netCDF4
import numpy as np
import pytest
import xarray as xr

from tests.conventions import check, complaints
from tests.scenes import scene_in, solve_scene
from weier.data import dataset, provenance, variables
from weier.methods import demelio
from weier.pipeline import claims

SCENE = """
title: Ünïcode waves
loads: [0.01, 0.1, 1.0]
methods: [westergaard, demelio, bem, patches, auto]
contact_edges: true
settings:
  bem: {tolerance: 1.0e-3}
  auto: {tolerance: 0.5}
studies:
  waves: {product: {D: 1.25, gamma: 5, m: [1, 2, .inf]}}
claims:
  one_wave_bounds: [waves]
"""
METHODS = ["westergaard", "demelio", "bem", "patches", "auto"]

# A mechanics dataset has no place on Earth and no time, was made by a program and by people who give no address, and
# its keywords are free words. weier does not know who creates and publishes a file. What has no dimension has no
# units: a figure of xarray would write "[1]" at its axis.
IMPOSSIBLE = (
    "geospatial_",
    "units",
    "time_coverage_",
    "standard_name",
    "instrument",
    "platform",
    "creator_email",
    "creator_url",
    "publisher_email",
    "publisher_url",
    "keywords_vocabulary",
    "acknowledgement",
    "contributor_",
    "creator_institution",
    "date_issued",
    "date_metadata_modified",
    "naming_authority",
    "id not present",
    "publisher_",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Every kind of file that a scene leaves."""
    folder = tmp_path_factory.mktemp("scene")
    loaded = scene_in(folder, SCENE)
    solutions = solve_scene(loaded, folder / "curves")
    claims.write(solutions, folder / "contact.nc", folder / "claims.md")
    return folder


@pytest.fixture(scope="module")
def files(folder):
    return sorted(folder.rglob("*.nc"))


CF, ACDD = "cf:1.11", "acdd:1.3"


@pytest.fixture(scope="module")
def bad(folder, tmp_path_factory):
    """A file of which both conventions complain."""
    path = tmp_path_factory.mktemp("bad") / "bad.nc"
    shutil.copy(folder / "contact.nc", path)
    with netCDF4.Dataset(path, "a") as file:
        file["compliance"].units = "nonsense"
        file.delncattr("summary")
    return path


@pytest.fixture(scope="module")
def answers(files, bad):
    """Those of the checker, which takes a second a file."""
    return check([*files, bad], (CF, ACDD), bad.parent)


def test_cf_strict_finds_nothing(files, answers):
    assert len(files) == 1
    answers = {str(path): answers[CF][str(path)] for path in files}
    assert {name: complaints(answer) for name, answer in answers.items()} == {str(path): [] for path in files}
    assert all(answer["scored_points"] == answer["possible_points"] > 50 for answer in answers.values())


def test_acdd_misses_only_what_mechanics_cannot_have(files, answers):
    for path in files:
        said = complaints(answers[ACDD][str(path)])
        assert [word for word in IMPOSSIBLE if not any(word in text for text in said)] == []  # no excuse without need
        lacking = [text for text in said if not any(word in text for word in IMPOSSIBLE)]
        assert lacking == []


def test_the_dates_of_a_file_are_those_of_the_run(files, monkeypatch):
    now = datetime.now(UTC)
    for path in files:
        with netCDF4.Dataset(path) as file:
            assert timedelta(0) <= now - datetime.fromisoformat(file.date_created) < timedelta(hours=1)
            assert file.date_modified == file.date_created
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    found = provenance.attributes("title", "solved")
    assert found["date_created"] == "2001-09-09T01:46:40+00:00"


def test_a_file_has_the_versions_and_the_commit_that_made_it(files):
    for path in files:
        with netCDF4.Dataset(path) as file:
            assert file.python_version == platform.python_version()
            assert (file.numpy_version, file.numba_version) == (np.__version__, version("numba"))
            assert file.product_version == provenance.VERSION
            assert re.fullmatch(r"[0-9a-f]{40}( with changes)?|unknown: not run from a checkout", file.git_commit)


def test_quantities_name_what_says_how_good_they_are(files):
    found = 0
    for path in files:
        with netCDF4.Dataset(path) as file:
            for variable in file.variables.values():
                related = getattr(variable, "ancillary_variables", "").split()
                assert set(related) <= set(file.variables)
                found += len(related)
    assert found > 8
    with netCDF4.Dataset(next(path for path in files if path.stem == "contact")) as file:
        assert file["resistance"].ancillary_variables.split() == [
            "resistance_error",
            "resistance_lower",
            "resistance_upper",
            "residual",
            "status",
        ]


def test_the_checker_would_complain(bad, answers):
    """So the two tests above can fail."""
    for convention, word in ((CF, "nonsense"), (ACDD, "summary")):
        assert any(word in text for text in complaints(answers[convention][str(bad)]))


def test_plain_xarray_reads_it(folder):
    with xr.open_dataset(folder / "contact.nc") as data:
        curve = data.sel(solution_method="demelio").isel(case=data.m.values == 2)
        exact = demelio.compliance(1.0, 1.25, 5, 2)
        assert float(curve.compliance.sel(mean_pressure=1.0)[0]) == pytest.approx(exact, rel=1e-12)
        assert set(data.coords) >= {"D", "gamma", "m", "phases", "key"}
        assert data.attrs["scene"] == SCENE


def test_a_table_of_the_whole_file_has_a_row_for_each_load_and_term(folder):
    """Edges of contact and claims have dimensions of their own, and would repeat each row some hundred times."""
    with xr.open_dataset(folder / "contact.nc") as data, dataset.open_dataset(folder / "contact.nc") as whole:
        assert set(data.sizes) == {"case", "solution_method", "mean_pressure", "term"}
        assert len(data.to_dataframe()) == math.prod(data.sizes.values()) < 1000
        assert {"contact_edge", "claim_holds"} <= set(whole.data_vars)
        with xr.open_dataset(folder / "contact.nc", group="details") as details:
            assert details.contact_edge.variable.equals(whole.contact_edge.variable)
            assert details.claim_holds.variable.equals(whole.claim_holds.variable)


def test_netcdf4_reads_it(files):
    for path in files:
        with netCDF4.Dataset(path) as file:
            for name, variable in {**file.variables, **of_groups(file)}.items():
                of_table = variables.VARIABLES.get(name)
                assert "long_name" in variable.ncattrs(), name
                if of_table and of_table.dtype == "f8":
                    normalised = getattr(variable, "normalised_by", "")
                    assert (normalised or variable.units) == of_table.unit
                    assert variable.units in ("1", "rad", "s", "m"), name
                    assert variable.long_name == of_table.long_name + f", in {normalised}" * bool(normalised)
            assert "g_0" in file.normalisation
            if path.stem not in ("convergence", "tradeoff"):
                methods = [str(name) for name in file["solution_method"][:]]
                assert methods == METHODS if path.stem == "contact" else len(methods) == 1


def of_groups(file):
    return {name: variable for group in file.groups.values() for name, variable in group.variables.items()}
