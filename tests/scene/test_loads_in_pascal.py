"""Scenes with loads in Pa: common pressures of traces and series, and results in SI units."""

import numpy as np
import pytest

import weier
from tests.scene.test_traces import BODIES, HEIGHTS, X, write_heights
from tests.scenes import curves_in, scene_in, solve_scene, write_data
from weier.figures import many_curves, page, scene_checks, values
from weier.pipeline.gather import read_study
from weier.scene import SceneError

MPA = np.array([5.0, 50.0, 500.0])
OPTIONS = {"ends": "periodic", "unit": "m", "shortest": "8e-6"}
SCENE = {
    "title": "t",
    "loads": {"unit": "MPa", "from": 5, "to": 500, "count": 3, "spacing": "log"},
    "methods": ["patches"],
    "studies": {
        "lines": {"trace": {"file": ["a.csv", "b.csv"], **OPTIONS}},
        "series": {"product": {"D": 1.5, "gamma": 2, "m": 2, "seed": [1, 2]}},
    },
    "interface": BODIES | {"lambda_0": 1e-3, "g_0": 1e-6},
    "figures": {
        "lines": {"draw": "resistance", "studies": ["lines"], "colour": "trace"},
        "scatter": {"draw": "compliance", "studies": ["lines"], "median over": "trace"},
        "series": {"draw": "compliance", "studies": ["series"], "median over": "seed"},
    },
}


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("si")
    write_heights(folder / "a.csv")
    write_heights(folder / "b.csv", 3 * np.roll(HEIGHTS, 7) + 2e-7 * np.cos(2 * np.pi * X / 32e-6))
    loaded = scene_in(folder, SCENE, scene_checks.load_scene)
    return folder, loaded, solve_scene(loaded, folder / "curves")


def test_the_data_are_those_of_an_interface_for_the_same_pressures(solved):
    folder, loaded, solutions = solved
    write_data(solutions, folder / "contact.nc")
    surfaces = [case.profile for name in loaded.studies for case in loaded.studies[name]]
    expected = weier.Interface(**SCENE["interface"]).solve(surfaces, 1e6 * MPA, contact_edges=False)
    with weier.open_dataset(folder / "contact.nc") as data:
        assert data.mean_pressure.values == pytest.approx(MPA, rel=1e-15)
        for name, unit in (("compliance", "m"), ("resistance", "ohm m^2"), ("resistance_error", "ohm m^2")):
            assert data[name].units == unit
            assert data[name].values == pytest.approx(expected[name].values, rel=1e-12), name
        assert data.mean_pressure.units == "MPa"
        assert "normalisation" not in data.attrs
        assert [data.attrs[name] for name in ("lambda_0", "g_0", "rho_1")] == [1e-3, 1e-6, 2e-7]
        ensemble = data.weier.cases(study="lines").weier.ensemble()
        assert ensemble["resistance_mean"].values == pytest.approx(expected.resistance.values[:2, 0].mean(axis=0))
        with pytest.raises(ValueError, match="data must be normalised"):
            weier.Interface(**SCENE["interface"]).in_si(data)
    page.write(solutions, folder / "page.html")
    text = (folder / "page.html").read_text()
    assert '"axis_label":"mean pressure p (MPa)"' in text.replace(": ", ":")


def test_a_scene_says_where_contacts_yield(solved):
    folder, *_ = solved
    hard = scene_in(folder, SCENE | {"interface": SCENE["interface"] | {"hardness_2": "1 GPa"}})
    with pytest.warns(UserWarning, match="contacts yield from a mean pressure of .* MPa on, at . of 3 loads"):
        write_data(curves_in(hard, folder / "curves"), folder / "hard.nc")
    with weier.open_dataset(folder / "hard.nc") as data:
        assert data.attrs["hardness_2"] == 1e9
        expected = data.mean_pressure / data.contact_fraction
        table = data.weier.table()
        assert table["contact_pressure"].to_numpy() == pytest.approx(expected.transpose("case", ...).values.ravel())
    page.write(curves_in(hard, folder / "curves"), folder / "page.html")  # without a warning


def test_figures_are_in_si_units(solved):
    """The curves of traces of different scales reduce at the common pressures, those of a series as arrays."""
    _, loaded, solutions = solved
    units = {"compliance": "(m)", "resistance": r"($\Omega\,$m$^2$)"}
    for name, figure in loaded.figures.items():
        ((study,), quantity) = figure.studies, figure.draw
        shown = [read_study(solutions, study)], "", quantity, figure.grouping, figure.interface
        (axes,) = many_curves.draw(*shown).axes
        surfaces = [case.profile for case in loaded.studies[study]]
        own = weier.Interface(**SCENE["interface"]).solve(surfaces, 1e6 * MPA)[quantity].values[:, 0]
        at = [np.interp(MPA, line.get_xdata(), line.get_ydata()) for line in axes.get_lines()]
        wanted = own if name == "lines" else [np.median(own, axis=0)]
        # A compliance between two loads is drawn within these, and the last resistance may be 0.
        assert np.array(at) == pytest.approx(np.array(wanted), rel=1e-9), name
        assert axes.get_xlabel().endswith("(MPa)")
        assert axes.get_ylabel().endswith(units[quantity])
        assert values.as_csv(axes.figure).splitlines()[0].split(",")[2] == "mean pressure p (MPa)"
        assert axes.dataLim.x0 == pytest.approx(5)


def test_a_figure_without_si_units_is_refused(solved):
    changes = {"figures": {"f": {"draw": "phases", "studies": ["series"]}}}
    with pytest.raises(SceneError, match=r"figures\.f\.draw: phases has no SI units: give loads in"):
        scene_in(solved[0], SCENE | changes, scene_checks.load_scene)


def test_single_loads_have_units_too(solved):
    loaded = scene_in(solved[0], SCENE | {"loads": ["5 bar", "1 bar"]})
    assert loaded.load_unit == "bar"
    assert loaded.loads == pytest.approx([1e5, 5e5], rel=1e-14)
