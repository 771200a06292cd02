"""`weier table` and `weier report`: tables of a file, and of several measured lines."""

import csv
import re

import numpy as np
import pandas as pd
import pytest
import yaml

import weier
from weier.api.task import CurveTask
from weier.cli import tables
from weier.methods.errors import ConvergenceError
from weier.methods.load_progress import reporting_to

BODIES = {"E_1": 210e9, "E_2": 210e9, "nu_1": 0.3, "nu_2": 0.3, "rho_1": 2e-7, "rho_2": 2e-7}
PRESSURES = ["--si", "bodies.yaml", "--pressures", "1:10:3MPa"]
FILES = ["a.csv", "b.csv", "c.txt"]


@pytest.fixture
def lines(tmp_path, monkeypatch):
    """Three files as instruments write them, and their traces."""
    monkeypatch.chdir(tmp_path)
    x, random = np.arange(200) * 5.0, np.random.default_rng(3)  # um
    traces, k = [], np.arange(1, 30)
    for name in FILES:
        z = 20 * np.fft.irfft(np.append(0, k**-1.2 * np.exp(2j * np.pi * random.random(k.size))), x.size)
        rows = [f"{a:.1f},{b:.5f}" for a, b in zip(x, z, strict=True)]
        if name == "c.txt":  # decimal commas
            text = "x [µm];z [µm]\n" + "\n".join(row.replace(",", ";").replace(".", ",") for row in rows)
        else:
            text = "x (um),z (um)\n" + "\n".join(rows)
        (tmp_path / name).write_text(text)
        traces.append(weier.Trace(z.round(5), 1e-3, x_unit="m", height_unit="um"))
    (tmp_path / "bodies.yaml").write_text("\n".join(f"{name}: {value}" for name, value in BODIES.items()))
    return traces


def test_a_table_has_the_scatter_of_the_lines_in_the_unit_of_the_pressures(run, lines, tmp_path):
    """In every format, with all digits, but for five of a table that is printed."""
    outputs = [word for suffix in ("csv", "svg", "nc") for word in ("-o", f"report.{suffix}")]
    assert run("report", *FILES, *PRESSURES, *outputs)[0] == 0
    solved = weier.Interface(**BODIES).solve(lines, [1e6, 10**6.5, 1e7]).isel(solution_method=0)
    resistance, pressure = solved.resistance.values, np.array([1, 10**0.5, 10]) / solved.contact_fraction.values
    table = pd.read_csv("report.csv")
    contacts = table["contact_pressure_median (MPa)"].to_numpy()
    assert contacts == pytest.approx(np.median(pressure, axis=0), rel=1e-9)
    assert len(table.columns) == len(tables.COLUMNS)
    assert table["mean_pressure (MPa)"].to_numpy() == pytest.approx([1, 10**0.5, 10], rel=1e-15)
    low, median, high = np.percentile(resistance, [10, 50, 90], axis=0)
    for name, expected in (("percentile_10", low), ("median", median), ("percentile_90", high)):
        assert table[f"resistance_{name} (ohm m^2)"].to_numpy() == pytest.approx(expected, rel=1e-9), name
    assert (table["resistance_numerical_error (ohm m^2)"] > 0).all()
    printed = [line.split() for line in run("report", *FILES, *PRESSURES)[1].splitlines()]
    assert ["3.1623", "3", *(f"{value:.5g}" for value in (median[1], low[1]))] in printed
    with weier.open_dataset("report.nc") as data:
        assert (data.mean_pressure.units, data.resistance.units) == ("MPa", "ohm m^2")
        assert data.mean_pressure.values == pytest.approx([1, 10**0.5, 10], rel=1e-15)
        assert data.resistance.values[:, 0] == pytest.approx(resistance, rel=1e-9)
    assert "(MPa)" in (tmp_path / "report.svg").read_text()


def test_a_report_as_netcdf_gives_tables_of_each_line(run, lines):
    code, _, err = run("report", *FILES, "./a.csv", *PRESSURES, "-o", "all.nc")
    assert (code, err.splitlines()[0]) == (0, "a.csv is left out: it has the heights of a.csv")
    assert run("table", "all.nc", "all.csv")[0] == 0
    table = pd.read_csv("all.csv")
    exact = weier.Interface(**BODIES).solve(lines, [1e6, 10**6.5, 1e7]).resistance.values.ravel()
    assert table["resistance (ohm m^2)"].to_numpy() == pytest.approx(exact, rel=1e-9)


@pytest.mark.filterwarnings("default:.*no patches")  # pytest would raise it, and the command prints it
def test_lines_that_failed_are_not_counted(run, lines, monkeypatch):
    own = CurveTask.solve

    def failing(curve):
        if curve.profile.source == "b.csv":
            raise ConvergenceError("no patches")
        return own(curve)

    monkeypatch.setattr(CurveTask, "solve", failing)
    code, out, err = run("report", *FILES, *PRESSURES)
    assert "no patches" in err
    assert (code, out.splitlines()[0]) == (1, "2 of 3 lines: a.csv, c.txt")
    assert "not all curves could be solved, for the reasons above" in err
    resistance = weier.Interface(**BODIES).solve([lines[0], lines[2]], [1e6, 10**6.5, 1e7]).resistance.values[:, 0]
    assert f"{np.median(resistance, axis=0)[0]:.5g}" in out


def test_a_report_that_is_stopped_is_of_the_lines_that_are_solved(run, lines):
    """The second line is stopped at its second load."""
    count = iter(range(1, 100))

    def stop():
        if next(count) == 5:
            raise TimeoutError("enough")

    with reporting_to(stop):
        code, _, err = run("report", *FILES, *PRESSURES, "-o", "report.csv")
    assert (code, err) == (1, "1 of 3 lines: a.csv\nweier: enough\n")
    expected = weier.Interface(**BODIES).solve(lines[0], [1e6, 10**6.5, 1e7]).resistance.values
    table = pd.read_csv("report.csv")
    assert table["resistance_median (ohm m^2)"].to_numpy() == pytest.approx(expected, rel=1e-9)


def test_a_report_of_one_line_says_its_name(run, lines):
    assert run("report", "a.csv", *PRESSURES)[1].startswith("a.csv\n")


def test_heat_has_its_own_unit_in_tables_and_figures(run, lines, tmp_path):
    heat = {name: value for name, value in BODIES.items() if not name.startswith("rho")} | {"k_1": 40, "k_2": 40}
    (tmp_path / "heat.yaml").write_text("\n".join(f"{name}: {value}" for name, value in heat.items()))
    options = ["--si", "heat.yaml", "--pressures", "1,10MPa", "-o", "heat.csv", "-o", "heat.svg"]
    assert run("report", *FILES, *options)[0] == 0
    electric = weier.Interface(**BODIES).solve(lines, [1e6, 1e7]).resistance.values[:, 0] / 4e-7
    found = pd.read_csv("heat.csv")["resistance_median (K m^2/W)"].to_numpy()
    assert found == pytest.approx(np.median(electric, axis=0) / 20, rel=1e-9)
    assert "thermal resistance" in (tmp_path / "heat.svg").read_text()


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (["a.csv", "--pressures", "1MPa"], "Missing option '--si'"),
        (["a.csv", *PRESSURES, "-o", "b.csv"], "b.csv exists: name another file, or overwrite it by --force"),
        (["a.csv", "b.csv", *PRESSURES, "-o", "./b.csv", "--force"], "b.csv is one of FILES: name another output"),
        (["a.csv", "long.csv", *PRESSURES], "got 1e-05 to 2e-05 m, two steps of each file by default: give 2e-05 m"),
        (["a.csv", "bad.csv", *PRESSURES], "bad.csv, line 2, "),
        (["a.csv", *PRESSURES, "--pressures", "1MPa", "-o", "c.png"], "a figure takes at least 2 loads, got 1"),
        (["a.csv", *PRESSURES, "-o", "link.csv"], "Not a directory"),
        (["a.csv", *PRESSURES, "-o", f"{'x' * 251}.csv"], "File name too long"),
        (["a.csv", *PRESSURES, "-o", f"{'x' * 250}.csv"], "File name too long"),  # of the temporary file
    ],
)
def test_what_cannot_be_reported_is_refused_before_it_is_solved(run, lines, tmp_path, monkeypatch, options, why):
    (tmp_path / "long.csv").write_text("\n".join(["x (um),z (um)", *(f"{10 * n},{np.cos(n)}" for n in range(100))]))
    (tmp_path / "bad.csv").write_text("x (um),z (um)\n0,1\n1,a\n")
    (tmp_path / "link.csv").symlink_to("a.csv/table.csv")
    monkeypatch.setattr("weier.cli.call.solve_under", None)
    code, _, err = run("report", *options)
    assert code in (1, 2)
    assert why in " ".join(err.split())


SCALED = BODIES | {"rho_1": 1.4e-7, "lambda_0": 1e-3, "g_0": 1e-6}


def bodies(**changes):
    return "".join(f"{name}: {value}\n" for name, value in (SCALED | changes).items())


def curve():
    return weier.solve(weier.Profile(D=1.25, gamma=5, m=2, phases=1.0), [0.1, 1.0], "demelio")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """With a file of one curve and one of two bodies."""
    monkeypatch.chdir(tmp_path)
    curve().to_netcdf(tmp_path / "curve.nc")
    (tmp_path / "bodies.yaml").write_text(bodies())
    return tmp_path


def rows(text):
    return list(csv.DictReader(text.splitlines()))


def test_a_table_goes_to_a_file_and_to_standard_output(run, folder):
    code, out, _ = run("table", "curve.nc")
    assert code == 0
    assert run("table", "curve.nc", "curves.csv") == (0, "", "the table is in curves.csv\n")
    assert (folder / "curves.csv").read_text() == out
    assert run("table", "curve.nc", "curves.csv")[2] == (
        "weier: curves.csv exists: name another file, or overwrite it by --force\n"
    )
    assert run("table", "curve.nc", "curves.csv", "--force")[0] == 0
    assert [float(row["compliance (g_0)"]) for row in rows(out)] == curve().compliance.values.tolist()
    assert {row["phases (rad)"] for row in rows(out)} == {"[0.0, 1.0]"}


def test_bodies_may_stand_in_a_scene_and_with_units(run, folder):
    expected = weier.Interface(**SCALED).in_si(curve()).resistance.values
    with_units = {"E_1": "210 GPa", "rho_1": "14 uohm cm", "lambda_0": "1 mm"}
    (folder / "units.yaml").write_text(bodies(**with_units))
    (folder / "scene.yaml").write_text(yaml.safe_dump({"title": "t", "interface": SCALED | with_units}))
    for given in ("bodies.yaml", "units.yaml", "scene.yaml"):
        code, out, err = run("table", "curve.nc", "--si", given)
        assert (code, err) == (0, "")
        assert [float(row["resistance (ohm m^2)"]) for row in rows(out)] == pytest.approx(expected, rel=1e-14)


WRONG_BODIES = [
    ("g_0: 1\ng_0: 1\n", "bodies.yaml: line 2: found duplicate key"),
    ("mu_1: 1.0\n", "bodies.yaml: missing 2 required keyword-only arguments: 'nu_1' and 'nu_2'"),
    (bodies(E_1="80 mm"), "E_1 must be in Pa, got values in mm"),
]


@pytest.mark.parametrize(("text", "why"), WRONG_BODIES)
def test_bodies_that_are_wrong_are_refused_in_a_sentence(run, folder, text, why):
    (folder / "bodies.yaml").write_text(text)
    code, out, err = run("table", "curve.nc", "--si", "bodies.yaml")
    assert (code, out, err.count("\n")) == (1, "", 1)
    assert re.search(why, err)


def test_files_of_others_are_refused_in_a_sentence(run, folder):
    curve().drop_vars("D").to_netcdf("no_d.nc")
    for name, why in {"no_d": "there is no D", "none": "there is no file none.nc"}.items():
        code, out, err = run("table", f"{name}.nc")
        assert (code, out, err.count("\n")) == (1, "", 1)
        assert why in err
