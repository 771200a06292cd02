"""Cases from batches: gathered into a file, or read into memory, in their order."""

import numpy as np
import pytest
import xarray as xr

from weier import scene
from weier.data import dataset
from weier.data.dataset import Status
from weier.pipeline import batch
from weier.pipeline import gather as gathering
from weier.pipeline.gather import batch_file, gather, read, read_study


@pytest.fixture
def files(batches):
    return sorted(batches.iterdir())


def keys(loaded, study):
    return [case.key for case in loaded.studies[study]]


@pytest.fixture
def waves(loaded, batches):
    return read_study(loaded, "waves", batches)


def test_status_says_why_a_curve_is_missing(waves):
    expected = [
        [Status.solved, Status.solved, Status.solved],
        [Status.not_applicable, Status.solved, Status.solved],
        [Status.not_applicable, Status.solved, Status.not_applicable],
    ]
    assert waves.status.values.tolist() == expected
    missing = waves.compliance.isnull().all("mean_pressure")
    assert np.all(missing == (waves.status != Status.solved))


def test_a_study_keeps_its_order(waves):
    assert waves.m.values.tolist() == [1, 2, np.inf]
    assert waves.phases.values[1].tolist() == [0, 0]
    assert np.isnan(waves.phases.values[0, 1])


@pytest.mark.parametrize("block", [1, 2**25])
def test_a_file_holds_what_is_read(loaded, files, tmp_path, monkeypatch, block):
    """Written block by block or read at once, from several files."""
    monkeypatch.setattr(gathering, "BLOCK_BYTES", block)
    backwards = keys(loaded, "waves")[::-1]
    gather(files, backwards, tmp_path / "a.nc", "test")
    xr.testing.assert_identical(dataset.read(tmp_path / "a.nc").drop_attrs(), read(files, backwards).drop_attrs())


def test_what_is_not_there_is_refused(files, tmp_path):
    with pytest.raises(ValueError, match="1 cases are in none of the files, the first with the key nobody"):
        gather(files, ["nobody"], tmp_path / "a.nc", "test")
    with pytest.raises(ValueError, match="1 cases are in none of the files, the first with the key nobody"):
        read(files, ["nobody"])
    assert not list(tmp_path.iterdir())


def test_a_batch_that_is_not_there_is_named(loaded, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"there is no file .*waves-0\.nc: make it first"):
        read_study(loaded, "waves", tmp_path)


def test_nothing_is_gathered_from_nothing(tmp_path):
    with pytest.raises(ValueError, match="there must be files to gather from, got none"):
        gather([], ["nobody"], tmp_path / "a.nc", "test")


def test_the_file_of_another_scene_is_named(loaded, batches, tmp_path):
    own, other = (batch_file(batches, name) for name in loaded.batches)
    foreign = tmp_path / "foreign.nc"
    count = dataset.read(own).sizes["case"]
    renamed = dataset.read(own).assign_coords(key=("case", [f"other{number}" for number in range(count)]))
    dataset.write(renamed, foreign, "another")
    with pytest.raises(ValueError, match=f"none of the files.*delete {foreign} and make it again"):
        gather([foreign, other], keys(loaded, "waves"), tmp_path / "a.nc", "test")


def test_files_of_other_loads_are_refused(files, tmp_path):
    moved = dataset.read(files[1])
    dataset.write(moved.assign_coords(mean_pressure=2 * moved.mean_pressure), tmp_path / "moved.nc", "moved")
    with pytest.raises(ValueError, match="differ in loads: delete the older one"):
        read([files[0], tmp_path / "moved.nc"], dataset.read(files[0]).key.values.tolist())


MIXED = """
title: mixed
loads: [0.01, 0.1, 1.0]
methods: [demelio]
contact_edges: true
studies:
  short: {product: {D: 1.25, gamma: 5, m: 1}, methods: [archard, patches]}
  long: {product: {D: 1.25, gamma: 5, m: 2}}
"""


def test_batches_of_other_methods_and_terms_come_together(tmp_path):
    (tmp_path / "mixed.yaml").write_text(MIXED)
    mixed = scene.load(tmp_path / "mixed.yaml")
    parts = [batch.solve_batch(mixed, cases)[0] for cases in mixed.batches.values()]
    assert [(part.solution_method.values.tolist(), part.sizes["term"], part.sizes["edge"]) for part in parts] == [
        (["archard", "patches"], 1, 2), (["demelio"], 2, 10)
    ]  # fmt: skip
    for name, part in zip(("short", "long"), parts, strict=True):
        dataset.write(part, tmp_path / f"{name}.nc", name)
    keys = [key for part in parts for key in part.key.values.tolist()]
    gather([tmp_path / "short.nc", tmp_path / "long.nc"], keys, tmp_path / "both.nc", "both")
    both = dataset.read(tmp_path / "both.nc")
    every = [case for cases in mixed.batches.values() for case in cases]
    xr.testing.assert_equal(both.drop_attrs(), batch.solve_batch(mixed, every)[0].drop_attrs())


PART = 500


def test_cases_may_come_in_any_order(tmp_path):
    data = dataset.blank(PART, ["demelio", "bem"], np.array([0.1, 1.0]), 3)
    for number in range(2):
        rows = number * PART + np.arange(PART)
        data["key"].values[:], data["D"].values[:] = [f"{row:06}" for row in rows], 1.25 + rows / 2**20
        dataset.write(data, tmp_path / f"part{number}.nc", "part")
    wanted = [999, 3, 500, 501, 2]
    some = [f"{row:06}" for row in wanted]
    gather(sorted(tmp_path.glob("part*.nc")), some, tmp_path / "some.nc", "some")
    found = dataset.read(tmp_path / "some.nc")["D"].values
    assert found.tolist() == [1.25 + row / 2**20 for row in wanted]
