"""`weier table`: curves of a file for a spreadsheet."""

import csv
import re

import pytest
import xarray as xr
import yaml

import weier

PROFILE = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)
BODIES = {
    "mu_1": 79e9,
    "mu_2": 45e9,
    "nu_1": 0.3,
    "nu_2": 0.34,
    "rho_1": 1.4e-7,
    "rho_2": 1.7e-8,
    "lambda_0": 1e-3,
    "g_0": 1e-6,
}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """With a file of one curve, such as the examples have, and one of two bodies."""
    monkeypatch.chdir(tmp_path)
    for path in ("curve.nc", "results/paper/contact.nc"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        weier.solve(PROFILE, [0.1, 1.0], "demelio").to_netcdf(tmp_path / path)
    (tmp_path / "bodies.yaml").write_text("".join(f"{name}: {value:g}\n" for name, value in BODIES.items()))
    return tmp_path


def rows(text):
    return list(csv.DictReader(text.splitlines()))


def test_a_table_goes_to_a_file_and_to_standard_output(run, folder):
    code, out, _ = run("table", "curve.nc")
    assert code == 0
    assert run("table", "curve.nc", "curves.csv") == (0, "", "")
    assert (folder / "curves.csv").read_text() == out
    curve = weier.solve(PROFILE, [0.1, 1.0], "demelio")
    assert [float(row["compliance (g_0)"]) for row in rows(out)] == curve.compliance.values.tolist()
    assert {row["phases (rad)"] for row in rows(out)} == {"[0.0, 1.0]"}


def bodies(**changes):
    """The file of bodies with other values; None takes one away."""
    values = {name: value for name, value in (BODIES | changes).items() if value is not None}
    return "".join(f"{name}: {value}\n" for name, value in values.items())


def test_bodies_may_stand_in_a_scene_and_with_units(run, folder):
    expected = rows(run("table", "curve.nc", "--si", "bodies.yaml")[1])
    in_si = weier.Interface(**BODIES).in_si(weier.solve(PROFILE, [0.1, 1.0], "demelio"))
    assert [float(row["resistance (ohm m^2)"]) for row in expected] == in_si.resistance.values.tolist()
    with_units = {"mu_1": "79 GPa", "rho_2": "1.7 uohm cm", "lambda_0": "1 mm"}
    (folder / "units.yaml").write_text(bodies(**with_units))
    (folder / "scene.yaml").write_text(yaml.safe_dump({"title": "t", "interface": BODIES | with_units}))
    for given in ("units.yaml", "scene.yaml"):
        code, out, err = run("table", "curve.nc", "--si", given)
        assert (code, err) == (0, "")
        for one, other in zip(rows(out), expected, strict=True):
            assert float(one["resistance (ohm m^2)"]) == pytest.approx(
                float(other["resistance (ohm m^2)"]), rel=1e-14
            )


WRONG_BODIES = [
    ("mu_1: 1.0\n", "bodies.yaml: missing 2 required keyword-only arguments: 'nu_1' and 'nu_2'"),
    (bodies(mu_1="80 mm"), "mu_1 must be in Pa, got values in mm"),
]


@pytest.mark.parametrize(("text", "why"), WRONG_BODIES)
def test_bodies_that_are_wrong_are_refused_in_a_sentence(run, folder, text, why):
    (folder / "bodies.yaml").write_text(text)
    code, out, err = run("table", "curve.nc", "--si", "bodies.yaml")
    assert (code, out) == (1, "")
    (line,) = err.splitlines()
    assert re.search(why, line)


def test_files_of_others_are_refused_in_a_sentence(run):
    with xr.open_dataset("curve.nc") as curve:
        curve.drop_vars("D").to_netcdf("no_d.nc")
        curve.drop_vars("compliance").to_netcdf("no_curve.nc")
    xr.Dataset({"x": [1.0]}).to_netcdf("foreign.nc")
    for name, why in {"no_d": "there is no D", "foreign": "not of weier", "none": "there is no file none.nc"}.items():
        code, out, err = run("table", f"{name}.nc")
        assert (code, out) == (1, "")
        assert err.startswith("weier: ")
        assert err.count("\n") == 1
        assert why in err
