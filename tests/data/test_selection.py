"""Opened files: labelled selection, read on access, and joined without being held in memory."""

import math
import shutil

import netCDF4
import numpy as np
import pytest
import xarray as xr

import weier
from weier import Profile
from weier.data import curves, dataset

CASES = [
    Profile(1.25, 5, 2, 1.0),
    Profile(1.5, 5, 2, 1.0),
    Profile(1.5, "5/2", 3, 1.0),
    Profile(1.5, 5, math.inf, seed=3),
    Profile(1.5, 5, 2, (1.0, 2.0)),
]


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("opened") / "contact.nc"
    dataset.write(weier.solve(CASES, [0.1, 1.0], ["demelio"]).drop_vars("case"), path, "test")
    return path


@pytest.mark.parametrize(
    ("labels", "rows"),
    [
        ({"D": 1.25}, [0]),
        ({"D": [1.25, 1.5], "gamma": 5}, [0, 1, 3, 4]),
        ({"gamma": "5/2"}, [2]),
        ({"m": np.inf}, [3]),
        ({}, [0, 1, 2, 3, 4]),
    ],
)
def test_selection_by_labels(path, labels, rows):
    with weier.open_dataset(path) as data:
        keys = data.weier.cases(**labels)["surface_key"].values.tolist()
        assert keys == data["surface_key"].values[rows].tolist()


def solved():
    profiles = [Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), Profile(1.5, 5, 2, 1.0)]
    return weier.solve(profiles, [0.1, 0.5, 1.0], ["archard", "demelio"])


SELECTED = {
    "one case": lambda data: data.isel(case=0),
    "one number": lambda data: data.isel(case=1, solution_method=0, mean_pressure=2),
    "some loads": lambda data: data.sel(mean_pressure=[1.0, 0.1]),
    "transposed": lambda data: data.transpose(),
    "one quantity": lambda data: data[["compliance"]],
}


@pytest.mark.parametrize("select", SELECTED.values(), ids=SELECTED)
def test_a_selection_has_the_same_rows(select):
    """Each row has the labels and the phases of its own curve."""
    rows = {}
    for row in solved().weier.table().to_dict("records"):
        rows[row["D"], row["solution_method"], row["mean_pressure"]] = row
    selected = select(solved())
    table = selected.weier.table()
    assert len(table) == selected.compliance.size
    for row in table.to_dict("records"):
        expected = rows[row["D"], row["solution_method"], row["mean_pressure"]]
        assert row == {name: expected[name] for name in row}
    for D in np.unique(selected.D):
        cases = selected.weier.cases(D=float(D))
        assert cases.compliance.dims == ("case", "solution_method", "mean_pressure")
        assert cases.compliance.size == selected.compliance.size / np.unique(selected.D).size


@pytest.mark.parametrize("use", [lambda data: data.weier.table(), lambda data: data.weier.cases(m=2)])
def test_a_dataset_that_holds_no_curves_is_refused(use):
    for name in ("D", "mean_pressure"):
        with pytest.raises(ValueError, match=f"holds no curves, since there is no {name}: take a result"):
            use(solved().drop_vars(name))
    with pytest.raises(ValueError, match="must be a superset of existing dimensions"):
        use(solved().stack(row=("case", "mean_pressure")))


def test_what_is_written_over_a_file_that_was_read_is_read(path, tmp_path):
    """netCDF refuses to write what is open, and xarray keeps what it has read."""
    mine = shutil.copyfile(path, tmp_path / "mine.nc")
    with weier.open_dataset(mine) as data:
        before = data["compliance"].values
    with netCDF4.Dataset(mine, "a") as file:
        file["compliance"][:] = 2 * before
    with weier.open_dataset(mine) as data:
        np.testing.assert_array_equal(data["compliance"].values, 2 * before)


PROFILES = [
    Profile(1.5, "5/2", 2, 1.0),
    Profile(1.25, 5, 4, seed=7),
    Profile(1.25, 5, math.inf, 0.5),
    Profile(1.5, 2, math.inf, seed=3),
]


@pytest.mark.parametrize("profile", PROFILES, ids=Profile.describe)
def test_a_curve_gives_its_profile_back(profile):
    """By the heights or, where there are none, the phases of its first terms."""
    both = weier.solve([Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), profile], [0.1, 1.0], ["demelio"])
    for data in (weier.solve(profile, [0.1, 1.0], "demelio"), both.isel(case=1)):
        found = curves.profile(data)
        assert (found.D, found.gamma, found.m) == (profile.D, profile.gamma, profile.m)
        terms = 3 if math.isinf(profile.m) else profile.m
        assert np.array_equal(found.truncated(terms).phase, profile.truncated(terms).phase)


def test_neighbouring_seeds_are_told_apart():
    seeds = [2**53 - 1, 2**53 - 2, 2**52, 2**52 + 1, 10**6, 10**6 + 1]
    profiles = [weier.Profile(1.5, 5, 3, seed=seed) for seed in seeds]
    data = weier.solve(profiles, [0.1], ["demelio"])
    assert np.unique(data["case"]).size == len(seeds)
    for seed, profile in zip(seeds, profiles, strict=True):
        assert np.array_equal(data.weier.cases(seed=seed).phases[0], profile.phase)
    with pytest.raises(ValueError, match=r"no case has seed = 1000002: choose from 1000000, 1000001, 45"):
        data.weier.cases(seed=10**6 + 2)


def lines(count):
    """Traces of one spectrum and several heights."""
    k, random = np.arange(1, 40), np.random.default_rng(2)
    waves = [k**-1.2 * np.exp(2j * np.pi * random.random(k.size)) for _ in range(count)]
    heights = [2e-5 * (1 + n / 4) * np.fft.irfft(np.append(0, wave), 200) for n, wave in enumerate(waves)]
    return [weier.Trace(z, 1e-3, unit="m", source=f"{n}.csv") for n, z in enumerate(heights)]


def test_an_ensemble_has_means_with_their_scatter_and_the_numerical_error():
    series = [weier.Profile(1.5, 3, 2, seed=seed) for seed in range(5)]
    data = weier.solve(series, [0.1, 1.0], ["bem", "demelio"])
    table = data.weier.ensemble()
    assert table["solution_method"].tolist() == ["bem", "bem", "demelio", "demelio"]
    assert table["cases"].tolist() == [5] * 4
    by_bem = data.sel(solution_method="bem")
    for name in ("compliance", "resistance"):
        np.testing.assert_allclose(table[f"{name}_mean"][:2], by_bem[name].values.mean(axis=0), rtol=1e-12)
        np.testing.assert_allclose(table[f"{name}_deviation"][:2], np.std(by_bem[name].values, axis=0, ddof=1))
        for share, column in ((10, "percentile_10"), (50, "median"), (90, "percentile_90")):
            expected = np.percentile(by_bem[name].values, share, axis=0)
            np.testing.assert_allclose(table[f"{name}_{column}"][:2], expected, rtol=1e-14)
        largest = by_bem[f"{name}_error"].values.max(axis=0)
        np.testing.assert_array_equal(table[f"{name}_numerical_error"][:2], largest)
    assert table["compliance_numerical_error"][2:].isna().all()
    unsolved = data[["compliance", "resistance", "contact_fraction"]].where(data.seed != 3)
    assert unsolved.weier.ensemble()["cases"].tolist() == [4] * 4


def test_labels_that_joined_curves_have_in_common_are_those_of_each():
    each = [weier.solve(Profile(1.5, 3, 2, phase), [0.1, 1.0], "demelio") for phase in (0.0, 1.0)]
    joined = xr.concat(each, "case", data_vars="all", coords="different", compat="equals")
    joined = joined.assign_coords(temperature=("case", [-40.0, -40.0]))
    assert joined.D.dims == ()
    assert joined.weier.table()["D"].tolist() == [1.5] * 4
    assert joined.weier.cases(D=1.5).sizes["case"] == 2
    assert joined.weier.ensemble()["cases"].tolist() == [2, 2]
    unknown = joined.assign_coords(temperature=("case", [-40.0, np.nan]))
    assert unknown.weier.ensemble()["cases"].tolist() == [1] * 4


def test_each_set_of_parameters_has_an_ensemble_of_its_own():
    """Means over the phases alone; a surface that occurs twice counts once."""
    kinds = [(1.25, 3, 2), (1.5, 3, 2), (1.5, 3, 3), (1.5, "5/2", 2)]
    series = [weier.Profile(*kind, seed=seed) for seed in range(3) for kind in kinds]
    data = weier.solve([*series, series[1]], [0.1, 1.0], ["bem", "demelio"])
    table = data.weier.ensemble()
    assert [(*row,) for row in table[["D", "gamma", "m"]].drop_duplicates().values] == [
        (D, float(weier.Profile(D, gamma, m).gamma), m) for D, gamma, m in kinds
    ]
    assert table["cases"].tolist() == [3] * 4 * len(kinds)
    infinite = [weier.Profile(1.5, 3, np.inf, seed=seed) for seed in (1, 2, 2)]
    assert weier.solve(infinite, [0.1], ["demelio"]).weier.ensemble()["cases"].tolist() == [2]


def test_cutoffs_settings_and_labels_of_a_user_divide_ensembles():
    steel = weier.Interface(mu_1=8e10, mu_2=8e10, nu_1=0.3, nu_2=0.3, rho_1=2e-7, rho_2=2e-7)
    x = 2 * np.pi * np.arange(200) / 200
    a, b = [1e-6 * np.cos(x) + 2e-7 * np.cos(5 * x + phase) for phase in (0, 2)]
    # Steps of one instrument differ in the last digits, and so do the default cutoffs.
    given = [(a, 1e-3, None), (b, 1.004e-3, None), (a, 1e-3, 4e-5), (b, 1.004e-3, 4e-5)]
    traces = [weier.Trace(z, length, unit="m", shortest=cutoff, source=f"{length}") for z, length, cutoff in given]
    copy = weier.Trace(a, 1e-3, unit="m", source="copy")
    data = steel.solve([*traces, copy], [1e6], tolerance=1e-2, method=["bem"])
    table = data.weier.ensemble()
    assert table["trace_shortest"].round(7).tolist() == [1e-5, 4e-5]
    assert table["cases"].tolist() == [2, 2]
    machines = data.isel(case=[0, 1]).assign_coords(machine=("case", ["a", "b"]))
    assert machines.weier.ensemble()[["machine", "cases"]].values.tolist() == [["a", 1], ["b", 1]]
    series = [weier.Profile(1.5, 3, 2, seed=seed) for seed in range(2)]
    both = [weier.solve(series, [0.1], ["bem"], tolerance=tolerance) for tolerance in (1e-2, 1e-4)]
    table = xr.concat(both, "case", data_vars="all").weier.ensemble()
    assert table["cases"].tolist() == [2, 2]
    assert table["settings"].nunique() == 2
    studies = both[0].assign_coords(study=("case", ["one, two", "two"]))
    assert [studies.weier.cases(study=name).sizes["case"] for name in ("one", "two")] == [1, 2]
    assert studies.weier.ensemble()[["study", "cases"]].values.tolist() == [["one", 1], ["two", 2]]


def test_an_ensemble_of_traces_has_common_pressures():
    steel = weier.Interface(mu_1=8e10, mu_2=8e10, nu_1=0.3, nu_2=0.3, rho_1=2e-7, rho_2=2e-7)
    traces = lines(3)
    data = steel.solve(traces, [1e6, 1e7])
    table = data.weier.ensemble()
    assert table["mean_pressure"].tolist() == [1e6, 1e7]
    each = [steel.solve(trace, [1e6, 1e7]).resistance.values for trace in traces]
    np.testing.assert_allclose(table["resistance_mean"], np.mean(each, axis=0), rtol=1e-6)
    np.testing.assert_allclose(table["resistance_deviation"], np.std(each, axis=0, ddof=1), rtol=1e-6)
    own = weier.solve(traces, [0.1, 1.0])
    with pytest.raises(ValueError, match=r"an ensemble must have common pressures, .*: solve the traces by weier"):
        own.weier.ensemble()
    assert own.isel(case=[0]).weier.ensemble()["cases"].tolist() == [1, 1]


@pytest.mark.parametrize("gamma", [2.0, 2.5, 5.0])
def test_the_phase_between_two_waves_is_that_of_the_translated_profile(gamma):
    """A translation changes both phases, but no curve."""
    for shift in (0.0, 0.1, -0.3):
        phases = np.array([2 * np.pi * shift, 1.0 + 2 * np.pi * gamma * shift])
        assert curves.phase_angle({"gamma": gamma, "phases": phases}) == pytest.approx(1.0)
    assert curves.phase_angle({"gamma": gamma, "phases": np.array([0.0, np.nan])}) == 0
