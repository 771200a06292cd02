"""What a scene leaves, read by strangers: the CF and ACDD checker, plain xarray and netCDF4."""

import json
import math
import os
import platform
import re
import shutil
import subprocess
from datetime import UTC, datetime, timedelta
from importlib.metadata import version

import netCDF4
import numpy as np
import pytest
import xarray as xr

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


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """The data of a scene."""
    folder = tmp_path_factory.mktemp("scene")
    claims.write(solve_scene(scene_in(folder, SCENE), folder / "curves"), folder / "contact.nc", folder / "claims.md")
    return folder / "contact.nc"


@pytest.fixture
def file(path):
    with netCDF4.Dataset(path) as file:
        yield file


def test_the_checker_of_cf_and_acdd_finds_nothing(path, tmp_path):
    """Of ACDD what is highly recommended; what has no dimension has no units, and mechanics no standard names."""
    bad = shutil.copy(path, tmp_path / "bad.nc")
    with netCDF4.Dataset(bad, "a") as file:
        file["compliance"].units = "nonsense"
        file.delncattr("summary")
    environment = os.environ | dict.fromkeys(("http_proxy", "https_proxy"), "http://127.0.0.1:9")  # it has no network
    options = ["-t", "cf:1.11", "-t", "acdd:1.3", "-c", "strict", "-f", "json_new", "-o", "answers.json"]
    command = ["cchecker.py", *options, path, bad]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert "exceptions occurred" not in done.stdout + done.stderr
    answers = json.loads((tmp_path / "answers.json").read_text(encoding="utf-8"))
    good, bad = (
        {
            text
            for convention, ranks in (("cf:1.11", ("high", "medium", "low")), ("acdd:1.3", ("high",)))
            for rank in ranks
            for check in answers[str(of)][convention][f"{rank}_priorities"]
            for text in check["msgs"]
            if not (convention == "acdd:1.3" and re.search("standard_name|units", text))
        }
        for of in (path, bad)
    )
    assert good == set()
    assert all(any(word in text for text in bad) for word in ("nonsense", "summary"))  # so this test can fail


def test_a_file_has_the_date_the_versions_and_the_commit_that_made_it(file, monkeypatch):
    age = datetime.now(UTC) - datetime.fromisoformat(file.date_created)
    assert timedelta(0) <= age < timedelta(hours=1)
    versions = f"numpy {np.__version__}", f"numba {version('numba')}", f"Python {platform.python_version()}"
    assert all(text in file.source for text in versions)
    assert file.product_version == provenance.VERSION
    assert re.fullmatch(r"[0-9a-f]{40}( with changes)?|unknown: not run from a checkout", file.git_commit)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    assert provenance.attributes("title", "solved")["date_created"] == "2001-09-09T01:46:40+00:00"


def test_plain_xarray_reads_it(path):
    with xr.open_dataset(path) as data:
        curve = data.sel(solution_method="demelio").isel(case=data.m.values == 2)
        exact = demelio.compliance(1.0, 1.25, 5, 2)
        assert float(curve.compliance.sel(mean_pressure=1.0)[0]) == pytest.approx(exact, rel=1e-12)
        assert set(data.coords) >= {"D", "gamma", "m", "phases", "key"}
        assert data.attrs["scene"] == SCENE


def test_a_table_of_the_whole_file_has_a_row_for_each_load_and_term(path):
    """Edges of contact and claims have dimensions of their own, and would repeat each row some hundred times."""
    with xr.open_dataset(path) as data, dataset.open_dataset(path) as whole:
        assert set(data.sizes) == {"case", "solution_method", "mean_pressure", "term"}
        assert len(data.to_dataframe()) == math.prod(data.sizes.values()) < 1000
        assert {"contact_edge", "claim_holds"} <= set(whole.data_vars)
        with xr.open_dataset(path, group="details") as details:
            assert details.contact_edge.variable.equals(whole.contact_edge.variable)


def test_variables_have_the_names_and_units_of_their_table(file):
    groups = [file, *file.groups.values()]
    for name, variable in [pair for group in groups for pair in group.variables.items()]:
        of_table = variables.VARIABLES.get(name)
        assert "long_name" in variable.ncattrs(), name
        if of_table and of_table.dtype == "f8":
            normalised = getattr(variable, "normalised_by", "")
            assert (normalised or variable.units) == of_table.unit
            assert variable.units in ("1", "rad", "s", "m"), name
            assert variable.long_name == of_table.long_name + f", in {normalised}" * bool(normalised)
    assert "g_0" in file.normalisation
