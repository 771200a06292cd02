"""`weier solve` and `weier plot`: one profile from the command line."""

import json
import signal

import numpy as np
import pytest
import xarray as xr

import weier
from weier.methods.load_progress import reporting_to

PROFILE = ["-D", "1.25", "--gamma", "5", "-m", "2", "--phases", "1"]


def curves(text):
    """The curves that `weier solve` prints, as valid JSON, which has no nan."""
    return xr.Dataset.from_dict(json.loads(text, parse_constant=pytest.fail))


def test_json_is_what_solve_gives(run):
    methods = ["--method", "demelio", "--method", "bem", "--set", "bem.points_per_wave=32"]
    code, out, _ = run("solve", *PROFILE, "--loads", "0.1,1", *methods)
    assert code == 0
    found = curves(out)
    assert found.mean_pressure.values.tolist() == [0.1, 1.0]
    profile = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)
    for method, settings in {"demelio": {}, "bem": {"points_per_wave": 32}}.items():
        curve = weier.solve(profile, [0.1, 1.0], method, **settings)
        assert found.resistance.sel(solution_method=method).values.tolist() == curve.resistance.values.tolist()
    fraction = found.contact_fraction.sel(solution_method="demelio").values.tolist()
    assert fraction == [None, None], "JSON has no nan"
    assert found.seconds.sel(solution_method="bem") > 0
    assert found.resistance.normalised_by == "g_0/p_0*"


def test_an_infinite_number_is_a_word_in_json(run):
    out = run("solve", "-D", "1.25", "--gamma", "5", "-m", "inf", "--loads", "0.1", "--method", "demelio")[1]
    assert curves(out).m == "inf"


def test_loads_come_once_and_increasing(run):
    expected = weier.solve(weier.Profile(1.25, 5, 2, 1.0), [0.1, 1.0], "demelio").compliance.values.tolist()
    found = curves(run("solve", *PROFILE, "--loads", "1,0.1,0.1", "--method", "demelio")[1])
    assert (found.mean_pressure.values.tolist(), found.compliance.values[0].tolist()) == ([0.1, 1.0], expected)


@pytest.mark.filterwarnings("default:.*m = inf")
def test_what_works_is_delivered_and_what_does_not_is_named(run, tmp_path):
    series = ["-D", "1.25", "--gamma", "5", "-m", "inf", "--loads", "0.1,1"]
    code, out, err = run("solve", *series, "--method", "bem", "--method", "demelio", "-o", tmp_path / "x.nc")
    assert (code, out) == (1, "")
    assert "bem: " in err
    last = "weier: not all curves could be solved, for the reasons above; all other numbers were written"
    assert err.splitlines()[-1] == last
    with weier.open_dataset(tmp_path / "x.nc") as data:
        assert np.isfinite(data.compliance.sel(solution_method="demelio").values).all()


@pytest.fixture
def shaft(tmp_path):
    """A file of heights: two waves, in mm and um."""
    path = tmp_path / "shaft.csv"
    x = np.arange(200) * 0.005
    z = 0.3 * np.cos(2 * np.pi * x) + 0.05 * np.cos(12 * np.pi * x + 1)
    path.write_text("x in mm, z in um\n" + "\n".join(f"{a:.3f},{b:.12f}" for a, b in zip(x, z, strict=True)))
    return path


@pytest.fixture
def column(tmp_path):
    """Heights in um, in one column, of which two are missing."""
    path = tmp_path / "column.txt"
    z = np.cos(np.arange(200) / 8) + 0.2 * np.cos(np.arange(200))
    path.write_text("\n".join("-9999" if at in (50, 51) else f"{height:.9f}" for at, height in enumerate(z)))
    return path


def test_two_rough_bodies_are_two_files(run, shaft, tmp_path):
    options = ["--trace", shaft, "--x-unit", "mm", "--height-unit", "um", "--shortest", "0.1", "--loads", "0.1,1"]
    head, *rows = (line.split(",") for line in shaft.read_text().splitlines())
    turned = [[x, z] for (x, _), (_, z) in zip(rows, rows[::-1], strict=True)]
    (tmp_path / "bush.csv").write_text("\n".join(map(",".join, [head, *turned])))
    code, out, _ = run("solve", *options, "--against", tmp_path / "bush.csv", "--ends", "periodic")
    units = {"x_unit": "mm", "height_unit": "um", "ends": "periodic", "shortest": 0.1}
    gap = weier.Trace.between(*(weier.Trace.read(file, **units) for file in (shaft, tmp_path / "bush.csv")))
    assert (code, curves(out).trace.item()) == (0, "shaft.csv on bush.csv")
    resistance = weier.solve(gap, [0.1, 1]).resistance.values.tolist()
    assert curves(out).resistance.sel(solution_method="patches").values.tolist() == resistance


def test_one_column_has_its_length_in_the_unit_that_is_given(run, column):
    """Values that stand for missing heights are filled and counted with both options."""
    of_column = ["solve", "--trace", column, "--length", "1.0", "--x-unit", "mm", "--loads", "0.1"]
    assert "heights must have a unit: name it, as in height_unit" in run(*of_column)[2]
    assert "got -9999 at 2 of 200 places, first at height 51" in run(*of_column, "--height-unit", "um")[2]
    filled = ["--missing-value", "-9999", "--max-gap", "2", "--detrend", "form"]
    code, out, errors = run(*of_column, "--height-unit", "um", *filled)
    assert code == 0, errors
    printed = curves(out)
    assert printed.trace_length.item() == pytest.approx(1e-3)
    assert printed.trace_filled == 2
    assert printed.trace_detrend == "form"


BODIES = "E_1: 210 GPa\nE_2: 210e9\nnu_1: 0.3\nnu_2: 0.3\nrho_1: 14 uohm cm\nrho_2: 1.4e-7\n"
SCALE = "lambda_0: 1 mm\ng_0: 1e-6\n"


@pytest.fixture
def bodies(tmp_path):
    path = tmp_path / "bodies.yaml"
    path.write_text(BODIES + SCALE)
    return str(path)


def interface(**scale):
    return weier.Interface(E_1=210e9, E_2=210e9, nu_1=0.3, nu_2=0.3, rho_1=1.4e-7, rho_2=1.4e-7, **scale)


def test_pressures_and_ohms_of_a_trace_by_one_command(run, shaft, tmp_path, bodies):
    """As Interface.solve has them, in every format."""
    options = ["--trace", str(shaft), "--x-unit", "mm", "--height-unit", "um", "--method", "bem", "--si", bodies]
    trace = weier.Trace.read(shaft, x_unit="mm", height_unit="um")
    expected = interface().solve(trace, [1e6, 1e7], "bem")
    code, out, _ = run("solve", *options, "--pressures", "10,1 MPa")
    answer = curves(out)
    assert (code, answer.mean_pressure.values.tolist(), answer.resistance.units) == (0, [1, 10], "ohm m^2")
    assert answer.resistance.values[0] == pytest.approx(expected.resistance.values, rel=1e-12)
    assert answer.mu_1 == pytest.approx(210e9 / 2.6)
    assert "normalisation" not in answer.attrs
    written = run("solve", *options, "--pressures", "1:10:2MPa", "-o", tmp_path / "si.nc")
    assert written == (0, "", f"the curves are in {tmp_path / 'si.nc'}\n")
    with xr.open_dataset(tmp_path / "si.nc") as found:
        assert (found.mean_pressure.units, found.mean_pressure.values.tolist()) == ("MPa", [1.0, 10.0])
        assert found.compliance.values.ravel() == pytest.approx(expected.compliance.values, rel=1e-12)
        assert found.compliance.units == "m"
    for path, force in ((tmp_path / "ohms.svg", []), (tmp_path / "old.svg", ["--force"])):
        (tmp_path / "old.svg").write_text("notes")
        code, out, err = run("plot", *options, "--pressures", "1:10:5MPa", *force, path)
        assert (code, out, err) == (0, "", f"the figure is in {path}\n")
        assert "(MPa)" in path.read_text()
    assert "old.svg exists: name another file, or overwrite it by --force" in run("plot", *PROFILE, path)[2]


@pytest.mark.parametrize("output", [[], ["-o", "part.nc"]])
def test_a_stopped_solution_has_the_loads_that_are_solved(run, tmp_path, monkeypatch, output):
    """Of two methods, of which the second has not begun."""
    monkeypatch.chdir(tmp_path)
    count = iter(range(1, 10))

    def stop():
        if next(count) == 3:
            raise TimeoutError("enough")

    with reporting_to(stop):
        code, out, err = run("solve", *PROFILE, "--method", "patches", "--method", "bem", *output)
    written = "the curves are in part.nc\n" if output else ""
    assert (code, err) == (1, f"weier: 3 of 40 loads are solved\n{written}weier: enough\n")
    found = xr.load_dataset("part.nc") if output else curves(out)
    expected = weier.solve(weier.Profile(1.25, 5, 2, 1.0), found.mean_pressure.values)
    solved = found.resistance.sel(solution_method="patches").values.ravel()
    assert solved.tolist() == expected.resistance.values.tolist()


def test_a_time_limit_keeps_the_loads_that_are_solved(run, tmp_path):
    """Schedulers of clusters send SIGTERM."""
    with reporting_to(lambda: signal.raise_signal(signal.SIGTERM)), pytest.raises(KeyboardInterrupt):
        run("solve", *PROFILE, "-o", tmp_path / "part.nc")
    assert xr.load_dataset(tmp_path / "part.nc").sizes["mean_pressure"] == 1
