"""Files: whole or not at all, read by others, and gathered case by case."""

import math

import netCDF4
import numpy as np
import pytest
import xarray as xr

from weier import Profile, scene
from weier.data import dataset
from weier.data.dataset import Status
from weier.methods import patches
from weier.pipeline import batch
from weier.pipeline import gather as study

SCENE = """
title: test
loads: [0.01, 0.1, 1.0]
methods: [westergaard, demelio, bem]
studies:
  waves: {product: {D: 1.25, gamma: 5, m: [1, 2, .inf]}}
  two: {product: {D: 1.25, gamma: 5, m: 2}}
"""


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "test.yaml"
    path.write_text(SCENE)
    return scene.load(path)


@pytest.fixture(scope="module")
def solved(loaded):
    return [batch.solve_batch(loaded, cases) for cases in loaded.batches.values()]


@pytest.fixture(scope="module")
def files(solved, tmp_path_factory):
    folder = tmp_path_factory.mktemp("batches")
    for number, (data, _) in enumerate(solved):
        dataset.write(data, folder / f"{number}.nc", "test", "solved", SCENE)
    return sorted(folder.iterdir())


@pytest.fixture(scope="module")
def waves(loaded, files, tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "waves.nc"
    keys = [case.key for case in loaded.studies["waves"]]
    study.gather(files, keys, path, "test", scene=SCENE, change=study.add_bounds)
    return dataset.read(path)


def test_status_says_why_a_curve_is_missing(waves):
    expected = [
        [Status.solved, Status.solved, Status.solved],
        [Status.not_applicable, Status.solved, Status.solved],
        [Status.not_applicable, Status.solved, Status.not_applicable],
    ]
    assert waves.status.values.tolist() == expected
    missing = waves.compliance.isnull().all("mean_pressure")
    assert np.all(missing == (waves.status != Status.solved))


def test_gather_keeps_the_order_of_the_study(waves):
    assert waves.m.values.tolist() == [1, 2, np.inf]
    assert waves.phase.values[1].tolist() == [0, 0]
    assert np.isnan(waves.phase.values[0, 1])


def test_gather_refuses_what_is_not_there(files, tmp_path):
    with pytest.raises(ValueError, match="1 cases are in none of the files, the first with the key nobody"):
        study.gather(files, ["nobody"], tmp_path / "a.nc", "test")
    assert not list(tmp_path.iterdir())


def test_gather_refuses_nothing(tmp_path):
    with pytest.raises(ValueError, match="there must be files to gather from, got none"):
        study.gather([], ["nobody"], tmp_path / "a.nc", "test")


def test_gather_names_the_file_of_another_scene(files, tmp_path):
    stranger = tmp_path / "stranger.nc"
    dataset.write(dataset.read(files[0]).assign_coords(key=("case", ["a", "b"])), stranger, "another")
    with pytest.raises(ValueError, match=f"none of the files.*delete {stranger} and make it again"):
        study.gather([stranger, files[1]], study.keys_of(files), tmp_path / "a.nc", "test")


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
    study.gather([tmp_path / "short.nc", tmp_path / "long.nc"], keys, tmp_path / "both.nc", "both")
    both = dataset.read(tmp_path / "both.nc")
    every = [case for cases in mixed.batches.values() for case in cases]
    xr.testing.assert_equal(both.drop_attrs(), batch.solve_batch(mixed, every)[0].drop_attrs())


def test_bounds_stand_around_the_exact_methods_only(waves):
    bem = waves.sel(solution_method="bem").isel(case=[0, 1])
    # At most: 64 nodes a wave miss 5 g_n (waves_n/points)^2 of each, and the residual is 1e-10.
    mesh = bem.error_model.COMPLIANCE * bem.total_amplitude / 64**2 + 1e-9
    assert np.all((bem.compliance_lower <= bem.compliance) & (bem.compliance - mesh <= bem.compliance_lower))
    full = bem.total_amplitude + bem.tail_amplitude
    widest = np.minimum(bem.compliance + 2 * bem.tail_amplitude + mesh, full)
    assert np.all((bem.compliance_upper <= widest) & (bem.compliance_upper >= bem.compliance))
    one, two = bem.isel(case=0), bem.isel(case=1)  # both hold the same endless series
    assert np.all((one.compliance_lower < two.compliance_upper) & (two.compliance_lower < one.compliance_upper))
    assert np.all((bem.resistance_lower <= bem.resistance) & (bem.resistance <= bem.resistance_upper))
    assert waves.sel(solution_method="demelio").compliance_lower.isnull().all()


BETWEEN_NODES = """
title: crests of all waves at one place, half a node off the grid
loads: [1.0e-9, 1.0e-6]
methods: [bem]
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2, phases: [[%r, %r]]}}
"""


def test_bounds_hold_for_crests_between_two_nodes(tmp_path):
    """The endless series with all its crests at that place touches at h = 0."""
    path, phase = tmp_path / "test.yaml", -math.pi / 320
    path.write_text(BETWEEN_NODES % (phase, 5 * phase))
    loaded = scene.load(path)
    data, _ = batch.solve_batch(loaded, loaded.studies["one"])
    bounded = study.add_bounds(data).squeeze()
    assert bounded["points"] == 320
    long = Profile(1.25, 5, 4, [phase * 5**n for n in range(4)])
    truth = patches.curve(long, loaded.loads).compliance  # more terms raise it, by what they have at most
    assert truth[0] < 1e-7
    assert bounded["compliance"][0] > 4e-4
    assert np.all(bounded["compliance_lower"] <= truth)
    assert np.all(bounded["compliance_lower"] >= 0)


def test_seconds_are_kept_apart(solved):
    data, cost = solved[0]
    assert "seconds" not in data
    assert float(cost.seconds.min()) > 0


def test_a_written_file_is_read_back_and_written_the_same(waves, tmp_path):
    first, second = tmp_path / "a.nc", tmp_path / "b.nc"
    dataset.write(waves, first, "test")
    dataset.write(dataset.read(first), second, "test")
    assert first.read_bytes() == second.read_bytes()
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["a.nc", "b.nc"]


def test_a_variable_without_values_takes_no_chunk(waves, tmp_path):
    path, blank = tmp_path / "a.nc", tmp_path / "b.nc"
    dataset.write(waves, path, "test")
    dataset.write(waves.assign(work=waves.work * np.nan), blank, "test")
    assert path.stat().st_size - blank.stat().st_size > 3000
    again = dataset.read(blank)
    assert again.work.isnull().all()
    assert again.work.attrs == waves.work.attrs
    assert again.drop_vars("work").identical(dataset.read(path).drop_vars("work"))


def test_netcdf4_alone_finds_everything(waves, tmp_path):
    path = tmp_path / "a.nc"
    dataset.write(waves, path, "test")
    with netCDF4.Dataset(path) as file:
        h = file["compliance"]
        assert h.dimensions == ("case", "solution_method", "mean_pressure")
        assert h.units == "1"
        assert h.normalised_by == "g_0"
        assert file["status"].flag_meanings.split()[2] == "not_applicable"
        assert list(file["solution_method"][:]) == ["westergaard", "demelio", "bem"]
        assert "g_0" in file.normalisation
        assert all("long_name" in variable.ncattrs() for variable in file.variables.values())


def test_a_file_that_cannot_be_finished_is_not_there(waves, tmp_path):
    broken = waves.assign(bad=("case", np.array([object(), 1, 2], dtype=object)))
    with pytest.raises((TypeError, ValueError)):
        dataset.write(broken, tmp_path / "a.nc", "test")
    assert list(tmp_path.iterdir()) == []


def test_a_truncated_or_foreign_file_is_refused_in_one_sentence(waves, tmp_path):
    path = tmp_path / "a.nc"
    dataset.write(waves, path, "test")
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(ValueError, match="not a whole netCDF file: if weier made it, delete it"):
        dataset.read(path)
    xr.Dataset({"x": 1}).to_netcdf(path)
    with pytest.raises(ValueError, match="not of weier"):
        dataset.read(path)
    with pytest.raises(ValueError, match=r"there is no file .*none\.nc: make it first"):
        dataset.read(tmp_path / "none.nc")
