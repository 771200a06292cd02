"""Cases from batches: gathered into a file, or read into memory, in their order."""

import netCDF4
import numpy as np
import pytest
import xarray as xr

from tests.scenes import scene_in, solve_scene
from weier.api import batch
from weier.data import dataset, netcdf
from weier.data.provenance import run_date
from weier.data.variables import Status
from weier.pipeline import claims
from weier.pipeline import gather as gathering
from weier.pipeline.batches import Solutions
from weier.pipeline.curves import numerics
from weier.pipeline.gather import gather, read_study
from weier.pipeline.products import made_of

WAVE = {"product": {"D": 1.25, "gamma": 5, "m": 2}}
OF_ONE = {"title": "one", "loads": [0.1, 1.0], "methods": ["demelio"]}
VERSIONS = ("numpy", "scipy", "numba", "rocket_fft")


@pytest.fixture
def waves(solutions):
    return read_study(solutions, "waves")


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


def test_a_study_is_read_while_others_are_not_solved(tmp_path):
    """As a figure of it is drawn while their batches run."""
    one = scene_in(tmp_path, {**OF_ONE, "studies": {"one": WAVE}})
    solve_scene(one, tmp_path / "curves")
    both = scene_in(
        tmp_path, {**OF_ONE, "studies": {"one": WAVE, "other": {"product": {"D": 1.5, "gamma": 5, "m": 2}}}}
    )
    solutions = Solutions(both, tmp_path / "curves")
    assert read_study(solutions, "one").D.values.tolist() == [1.25]
    with pytest.raises(ValueError, match=r"D = 1\.5, .* is not solved by demelio in .*: run snakemake again"):
        read_study(solutions, "other")


def test_variables_that_no_method_has_take_no_memory(tmp_path):
    """A million cases of two estimates have a dozen of them; texts that are equal are one text."""
    two = scene_in(tmp_path, {**OF_ONE, "studies": {"one": {"product": {"D": [1.25, 1.5], "gamma": 5, "m": 2}}}})
    data = read_study(solve_scene(two, tmp_path / "curves"), "one")
    assert data.residual.values.strides[0] == 0
    assert np.isnan(data.residual.values).all()
    assert data.compliance.values.strides[0] > 0
    first, second = data.settings.values[:, 0]
    assert first is second


def test_variables_that_nobody_shows_are_not_read(solutions, waves):
    """A figure of a hundred thousand numerical curves would take 2 GB."""
    without = ("residual", "status", "numerics", "of another method")
    xr.testing.assert_identical(read_study(solutions, "waves", without), waves.drop_vars(without, errors="ignore"))


def without_studies(data):
    """What a batch knows of a scene's file."""
    known = [name for name in data.variables if str(name).startswith("study")]
    return data.drop_vars([*known, "numerics", "seconds"])


@pytest.mark.parametrize("block", [1, 2**25])
def test_a_file_holds_what_was_solved(solutions, solved, tmp_path, monkeypatch, block):
    """Written block by block or at once, from several files."""
    monkeypatch.setattr(gathering, "BLOCK_BYTES", block)
    gather(solutions, tmp_path / "a.nc")
    found = without_studies(dataset.read(tmp_path / "a.nc"))
    xr.testing.assert_identical(found.drop_attrs(), solved.drop_vars("seconds").drop_attrs())


def without_seconds(loaded):
    """All cases of a scene as one batch, but for what differs from run to run."""
    return batch.solve_batch(loaded.distinct, loaded.loads, loaded.contact_edges).drop_vars("seconds").drop_attrs()


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
    mixed = scene_in(tmp_path, MIXED)
    solutions = solve_scene(mixed, tmp_path / "batches")
    parts = [dataset.read(path) for path in sorted((tmp_path / "batches").glob("*.nc"))]
    assert [(part.solution_method.values.tolist(), part.sizes["term"]) for part in parts] == [
        (["archard"], 1),
        (["demelio"], 2),
        (["patches"], 1),
    ]
    gather(solutions, tmp_path / "both.nc")
    both = without_studies(dataset.read(tmp_path / "both.nc"))
    xr.testing.assert_equal(both.drop_attrs(), without_seconds(mixed))


def test_the_code_and_packages_of_each_curve_stand_beside_it(solutions, waves, tmp_path):
    code = [numerics(method, is_trace=False)["code"] for method in ("westergaard", "demelio", "bem")]
    assert len(set(code)) == 3
    assert waves.numerics.values.tolist() == [code] * 3
    gather(solutions, tmp_path / "a.nc")
    with dataset.open_dataset(tmp_path / "a.nc") as data:
        versions = [f"{name.replace('_', '-')} {data.attrs[f'{name}_version']}" for name in VERSIONS]
    assert ", ".join(versions) == numerics("bem", is_trace=False)["packages"]


@pytest.mark.parametrize("damage", ["edited", "swapped"])
def test_a_batch_that_another_program_has_changed_is_refused(loaded, tmp_path, damage):
    solutions = solve_scene(loaded, tmp_path / "batches", cores=2)
    one, other, *_ = sorted((tmp_path / "batches").glob("*.nc"))
    if damage == "swapped":
        one.write_bytes(other.read_bytes())
    else:
        with netCDF4.Dataset(one, "a") as file:
            file["compliance"][...] = 1.0
    expected = {"swapped": "is another file than its name says", "edited": "is not as weier wrote it"}
    with pytest.raises(ValueError, match=rf"{one.name} {expected[damage]}.*delete it and make it again"):
        gather(solutions, tmp_path / "a.nc")


EDGES = """
title: edges
loads: [0.01, 0.1]
methods: [{methods}]
contact_edges: true
studies:
  one: {{product: {{D: 1.25, gamma: 5, m: 2}}}}
"""


@pytest.mark.parametrize("later", ["layer, bem, patches", "bem, patches, layer", "patches, bem"])
def test_the_edges_of_contact_are_those_of_the_last_method_that_tells_them(tmp_path, later):
    """Whichever of them was solved first."""
    solve_scene(scene_in(tmp_path, EDGES.format(methods="bem")), tmp_path / "batches")
    grown = scene_in(tmp_path, EDGES.format(methods=later))
    data = read_study(solve_scene(grown, tmp_path / "batches"), "one")
    xr.testing.assert_equal(data.drop_vars("numerics").drop_attrs(), without_seconds(grown))


@pytest.mark.parametrize("reader", [xr.open_dataset, dataset.open_dataset])
def test_files_whose_longest_series_differ_are_joined_by_plain_xarray(solutions, tmp_path, reader):
    """Of other studies, too: what a file lacks is missing, and the shorter series have no phases beyond their own."""
    gather(solutions, tmp_path / "a.nc")
    longer = scene_in(
        tmp_path,
        "title: longer\nloads: [0.01, 0.1]\nmethods: [demelio]\n"
        "studies: {more: {product: {D: 1.5, gamma: 5, m: 4, phases: 1}}}",
    )
    gather(solve_scene(longer, tmp_path / "longer"), tmp_path / "b.nc")
    with reader(tmp_path / "a.nc") as a, reader(tmp_path / "b.nc") as b:
        assert a.sizes["term"] < b.sizes["term"] == 4
        both = xr.concat([a, b], dim="case", join="outer", data_vars="all").load()
        assert both.sizes["case"] == a.sizes["case"] + b.sizes["case"]
        assert both.phases.values[-1].tolist() == [0, 1, 1, 1]
        assert both.phases.isnull().values[0, a.sizes["term"] :].all()
        more = both.isel(case=both.study_more == 1)
        own = more.compliance.sel(solution_method="demelio", mean_pressure=[0.01, 0.1])
        assert np.array_equal(own.values, b.compliance.sel(solution_method="demelio").values)
        assert len(both.isel(case=both.study_waves == 1).case) == int(a.study_waves.sum())


def test_each_study_is_selected_by_name_though_its_cases_stand_in_others(tmp_path):
    """`study` of such a case is "one, two", which `== "one"` finds nowhere."""
    loaded = scene_in(
        tmp_path,
        "title: two\nloads: [0.1]\nmethods: [demelio]\n"
        "studies: {one: {product: {D: 1.5, gamma: 5, m: 2}}, two: {product: {D: 1.5, gamma: 5, m: [2, 3]}}}",
    )
    gather(solve_scene(loaded, tmp_path / "batches"), tmp_path / "two.nc")
    with xr.open_dataset(tmp_path / "two.nc") as data:
        assert data.isel(case=data.study_one == 1).m.values.tolist() == [2]
        assert data.isel(case=data.study_two == 1).m.values.tolist() == [2, 3]
    with dataset.open_dataset(tmp_path / "two.nc") as data, pytest.raises(ValueError, match=r"choose from one, two$"):
        data.weier.cases(study="three")


def test_a_file_has_the_name_that_it_was_given(solutions, tmp_path):
    gather(solutions, tmp_path / "a.nc", name="made-of-this")
    assert netcdf.sealed_name(tmp_path / "a.nc") == "made-of-this"


def test_the_seconds_of_each_curve_stand_beside_it_unless_bytes_are_to_be_reproducible(
    solutions, tmp_path, monkeypatch
):
    gather(solutions, tmp_path / "a.nc")
    data, folder = dataset.read(tmp_path / "a.nc"), solutions.store.folder
    batches = [dataset.read(folder / f"{name}.nc") for name in solutions.batches()]
    assert np.all(np.isfinite(data.seconds) == (data.status == Status.solved))
    assert np.nansum(data.seconds) == pytest.approx(sum(np.nansum(batch.seconds) for batch in batches))
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    gather(solutions, tmp_path / "b.nc")
    assert "seconds" not in dataset.read(tmp_path / "b.nc")


@pytest.fixture
def titled(tmp_path, monkeypatch):
    """The paths of data and claims, and a function that writes them for a scene of a title."""
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    data, table = tmp_path / "contact.nc", tmp_path / "claims.md"

    def write(title, **others):
        scene = scene_in(tmp_path, {**OF_ONE, "studies": {"one": WAVE}, "title": title, **others})
        claims.write(solve_scene(scene, tmp_path / "curves"), data, table)

    return data, table, write


def test_a_changed_title_changes_attributes_alone(titled, monkeypatch):
    data, table, write = titled
    write("first")
    before = dataset.read(data)
    with monkeypatch.context() as patch:
        patch.setattr(gathering, "Reader", None)  # no batch is read
        write("second")
    after = dataset.read(data)
    xr.testing.assert_equal(after, before)
    changed = {"title", "id", "scene", "date_issued", "date_metadata_modified"}
    assert {name for name in after.attrs if after.attrs[name] != before.attrs[name]} - changed == set()
    assert after.attrs["title"] == "second"
    assert "title: second" in after.attrs["scene"]
    assert table.read_text().startswith("# second")
    netcdf.check_sealed(data, made_of(table))


@pytest.mark.parametrize(
    "others", [{"loads": [0.2, 1.0]}, {"studies": {"two": WAVE}}, {"claims": {"layer_close": ["one"]}}]
)
def test_other_changes_of_a_scene_write_its_data_again(titled, others):
    data, table, write = titled
    write("first")
    write("first", **others)
    found = dataset.read(data)
    data.unlink()
    write("first", **others)
    xr.testing.assert_equal(found, dataset.read(data))
    netcdf.check_sealed(data, made_of(table))


def test_data_that_were_edited_get_no_other_title(titled):
    data, _, write = titled
    write("first")
    damaged = bytearray(data.read_bytes())
    damaged[len(damaged) // 2] ^= 1
    data.write_bytes(damaged)
    with pytest.raises(ValueError, match="not as weier wrote it"):
        write("second")
    assert data.read_bytes() == damaged


def test_data_get_the_date_that_is_set_and_seconds_without_one(titled, monkeypatch):
    data, _, write = titled
    for date, has_seconds in (("", True), ("1000000000", False), ("1200000000", False), ("", True)):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
        write("first")
        found = dataset.read(data)
        assert ("seconds" in found) == has_seconds
        assert has_seconds or found.attrs["date_created"] == run_date()[0]


def test_reproducible_data_are_written_as_a_whole(titled, monkeypatch):
    data, _, write = titled
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    write("second")
    fresh = data.read_bytes()
    write("first")
    write("second")
    assert data.read_bytes() == fresh
