"""`weier solve` goes on from its file, and from that of a run that was stopped or killed."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import weier
from weier.cli import output
from weier.methods.errors import ConvergenceError
from weier.methods.load_progress import reporting_to
from weier.pipeline import resume

SERIES = ["-D", "1.25", "--gamma", "5", "-m", "2", "--phases", "1"]
LOADS = ["--loads", "0.01:3:12"]
BODIES = "E_1: 210 GPa\nE_2: 70 GPa\nnu_1: 0.3\nnu_2: 0.3\nrho_1: 14 uohm cm\nrho_2: 3e-8\n"
SCALE = "lambda_0: 1 mm\ng_0: 1 um\n"


@pytest.fixture
def bodies(tmp_path):
    (tmp_path / "bodies.yaml").write_text(BODIES + SCALE)
    return ["--si", tmp_path / "bodies.yaml"]


@pytest.fixture
def trace(tmp_path):
    """Random heights, in um, as options."""
    heights = np.random.default_rng(3).standard_normal(30).cumsum()
    (tmp_path / "a.csv").write_text("\n".join(f"{height:.6f}" for height in heights))
    return ["--trace", tmp_path / "a.csv", "--length", "1e-3", "--height-unit", "um"]


class Killed(BaseException):
    """What no handler of the program knows."""


def stopped(run, cause, loads, *arguments):
    """Run a command whose solver is stopped after this number of loads."""
    count = iter(range(1, 10**6))

    def listener():
        if next(count) == loads:
            raise cause("enough")

    with reporting_to(listener):
        if cause is TimeoutError:
            assert run(*arguments)[0] == 1
        else:
            with pytest.raises(cause):
                run(*arguments)


def numbers(path):
    """All numbers and texts of a file but its times."""
    with xr.open_dataset(path) as data:
        values = {str(name): own.values.tolist() for name, own in data.drop_vars("seconds").variables.items()}
        return json.dumps(values | {name: data.attrs[name] for name in ("scene", "title", "numerics")})


PROBLEMS = {
    "patches": (SERIES, ["patches"]),
    "by chords": (SERIES, ["bem"]),
    "a tolerance": (["-D", "1.25", "--gamma", "5", "-m", "inf", "--tolerance", "0.05"], ["auto"]),
    "all terms": ([*SERIES, "--tolerance", "0.01"], ["auto"]),
    "R of an infinite series": (
        ["-D", "1.2", "--gamma", "5", "-m", "inf", "--tolerance", "0.2", "--set", "auto.quantity=resistance"],
        ["auto", "demelio"],
    ),
    "several": (SERIES, ["layer", "bem", "patches", "demelio"]),
}


@pytest.mark.parametrize(("surface", "methods"), PROBLEMS.values(), ids=PROBLEMS)
def test_a_file_of_fewer_loads_gets_the_others(run, tmp_path, surface, methods):
    """The result is bitwise that of one run, also what depends on all loads, such as errors by chords."""
    wanted = ["solve", *surface, *(word for name in methods for word in ("--method", name)), "-o"]
    few, all_loads = "0.01,0.04,0.1,0.5", "0.01,0.02,0.04,0.1,0.2,0.5,0.9"
    for name, loads in (("a.nc", few), ("a.nc", all_loads), ("b.nc", all_loads)):
        code, _, err = run(*wanted, tmp_path / name, "--loads", loads)
        assert code == 0, err
    assert numbers(tmp_path / "a.nc") == numbers(tmp_path / "b.nc")


def test_methods_may_come_in_another_order(run, tmp_path):
    for methods, loads in (("bem", "patches"), "0.01,1"), (("patches", "bem"), "0.01,0.1,1"):
        wanted = [word for name in methods for word in ("--method", name)]
        assert run("solve", *SERIES, *wanted, "--loads", loads, "-o", tmp_path / "a.nc")[0] == 0
    with weier.open_dataset(tmp_path / "a.nc") as data:
        assert data.solution_method.values.tolist() == ["patches", "bem"]
        for method in ("patches", "bem"):
            own = weier.solve(weier.Profile(1.25, 5, 2, 1.0), [0.01, 0.1, 1.0], method).resistance.values
            np.testing.assert_allclose(data.resistance.sel(solution_method=method).values[0], own, rtol=1e-12)


def test_only_the_loads_that_lack_are_solved(run, tmp_path):
    solved = []
    wanted = ["solve", *SERIES, "--method", "patches", "-o", tmp_path / "a.nc", "--loads"]
    run(*wanted, "0.01:1:3")
    with reporting_to(lambda: solved.append(1)):
        assert "a.nc has 3 of 5 loads" in run(*wanted, "0.01:1:5")[2]
    assert len(solved) == 2


@pytest.mark.parametrize(
    ("cause", "method"), [(Killed, "patches"), (KeyboardInterrupt, "bem"), (TimeoutError, "auto")]
)
def test_a_run_that_is_stopped_or_killed_goes_on(run, tmp_path, monkeypatch, bodies, trace, cause, method):
    """Twice, at random loads, of a trace in SI units."""
    monkeypatch.setattr(output, "APPEND_SECONDS", 0.0)
    wanted = ["solve", *trace, *bodies, "--pressures", "1:200:9MPa", "--method", method, "-o"]
    assert run(*wanted, tmp_path / "b.nc")[0] == 0
    first, second = np.random.default_rng(len(method)).integers(2, 5, 2)
    for loads in (first, second):
        stopped(run, cause, loads, *wanted, tmp_path / "a.nc")
        assert not (tmp_path / "a.nc").exists()
        with weier.open_dataset(tmp_path / "a.part.nc") as part:
            assert part.mean_pressure.units == "MPa"
            done = part.sizes["mean_pressure"]
        assert 1 <= done < 9
    code, _, err = run(*wanted, tmp_path / "a.nc")
    assert (code, f"a.part.nc has {done} of 9 loads" in err) == (0, True)
    assert not (tmp_path / "a.part.nc").exists()
    with xr.open_dataset(tmp_path / "a.nc") as one, xr.open_dataset(tmp_path / "b.nc") as other:
        xr.testing.assert_allclose(one.drop_vars("seconds"), other.drop_vars("seconds"), rtol=1e-12, atol=0)


@pytest.mark.parametrize("suffix", [".csv", ".json"])
def test_texts_go_on_from_the_part_beside_them(run, tmp_path, capsys, suffix):
    wanted = ["solve", *SERIES, "--loads", "3:0.01:12", "-o"]
    assert run(*wanted, tmp_path / f"b{suffix}")[0] == 0
    stopped(run, KeyboardInterrupt, 5, *wanted, tmp_path / f"a{suffix}")
    said = f"weier: 5 of 12 loads are solved, and in {tmp_path / 'a.part.nc'}, from which the same command goes on\n"
    assert said in capsys.readouterr().err
    assert run(*wanted, tmp_path / f"a{suffix}")[0] == 0
    if suffix == ".csv":
        found, expected = (pd.read_csv(tmp_path / name) for name in ("a.csv", "b.csv"))
        pd.testing.assert_frame_equal(found, expected, check_exact=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"a{suffix}", f"b{suffix}"]


def test_force_solves_anew_and_keeps_the_old_file_until_it_is_done(run, tmp_path):
    path, other = tmp_path / "a.nc", ["solve", "-D", "1.5", *SERIES[2:], *LOADS, "--force", "-o", tmp_path / "a.nc"]
    assert run("solve", *SERIES, *LOADS, "-o", path)[0] == 0
    whole = path.read_bytes()
    stopped(run, KeyboardInterrupt, 5, *other)
    assert path.read_bytes() == whole
    code, _, err = run(*other)
    assert (code, "has" in err) == (0, False)
    with weier.open_dataset(path) as data:
        assert data.D.values.tolist() == [1.5]


def test_what_fails_leaves_the_file_as_it_was_and_what_others_have_solved_beside_it(run, tmp_path, monkeypatch):
    """A load that cannot be solved would leave the whole curve without numbers."""
    path, part, solved = tmp_path / "a.nc", tmp_path / "a.part.nc", []
    wanted = ["solve", *SERIES, "--method", "bem", "--method", "patches", "-o", path]
    assert run(*wanted, "--loads", "0.1")[0] == 0
    whole = path.read_bytes()

    def fail(*arguments):
        raise ConvergenceError("too hard")

    with monkeypatch.context() as faulty:
        faulty.setattr("weier.methods.patches.solver.solve_state", fail)
        assert run(*wanted, "--loads", "0.1,1")[::2] == (
            1,
            f"{path} has 1 of 2 loads\nweier: what is solved is in {part}, from which the same command goes on\n"
            "weier: D = 1.25, gamma = 5, m = 2, patches: too hard\n",
        )
    assert path.read_bytes() == whole
    with weier.open_dataset(part) as data:
        assert np.isfinite(data.compliance.values[0]).tolist() == [[True, True], [True, False]]
    with reporting_to(lambda: solved.append(1)):
        assert run(*wanted, "--loads", "0.1,1")[0] == 0
    assert len(solved) == 1
    assert not part.exists()


def test_perfect_conductors_start_anew_and_say_so(run, tmp_path, bodies):
    """Their R is 0 in SI units, and cannot be converted back; nor is a file removed that is not of this problem."""
    perfect = BODIES.replace("14 uohm cm", "0").replace("3e-8", "0")
    bodies[1].write_text(perfect + SCALE)
    wanted = ["solve", *SERIES, *bodies, "--pressures", "1,10,100MPa", "--method", "patches", "-o", tmp_path / "a.nc"]
    stopped(run, TimeoutError, 2, *wanted)
    code, _, err = run(*wanted)
    assert code == 0, err
    assert "goes on" not in err
    assert "loads" not in err
    (tmp_path / "a.part.nc").write_text("of another program")
    assert run(*wanted, "--force")[0] == 0
    assert (tmp_path / "a.part.nc").read_text() == "of another program"


REFUSED = {
    "D": (["-D", "1.3"], "of another surface: D = 1.25, not D = 1.3"),
    "gamma": (["--gamma", "5/2"], "gamma = 5, not gamma = 5/2"),
    "m": (["-m", "3"], "m = 2, not m = 3"),
    "phases": (["--phases", "2"], "phases = [1.0], not phases = [2.0]"),
    "seed": (["--seed", "4"], "phases = [1.0], not seed = 4"),
    "method": (["--method", "bem"], "of other methods: patches = "),
    "another": (["--method", "bem", "--method", "patches"], "of other methods: none, not bem = "),
    "tolerance": (["--tolerance", "1e-6", "--method", "patches"], "not patches = {'tolerance': 1e-06}"),
    "loads": (["--loads", "0.02"], "with 2 loads that are not asked for, such as 1.81246e+06 Pa: add them, or"),
    "no bodies": (["--si", None], "of other bodies: "),
}


@pytest.mark.parametrize(("changed", "why"), REFUSED.values(), ids=REFUSED)
def test_a_file_of_another_problem_is_refused_and_stays(run, tmp_path, bodies, changed, why):
    path, loads = tmp_path / "a.nc", ["--loads", "0.01,0.1"]
    assert run("solve", *SERIES, *bodies, *loads, "-o", path)[0] == 0
    whole, given = path.read_bytes(), {"--loads": loads[1], "--si": bodies[1]}
    given |= dict(zip(SERIES[::2], SERIES[1::2], strict=True)) | {"--method": "patches"}
    pairs = [pair for pair in zip(changed[::2], changed[1::2], strict=True) if pair[1]]
    own = {name: value for name, value in given.items() if name not in changed[::2]}
    if "--seed" in changed:
        del own["--phases"]
    code, _, err = run("solve", *(word for pair in [*own.items(), *pairs] for word in pair), "-o", path)
    assert (code, why in err) == (1, True), err
    assert err.endswith("name another file, or solve anew by --force\n")
    assert path.read_bytes() == whole


def test_other_bodies_heights_and_code_are_refused(run, tmp_path, bodies, trace, monkeypatch):
    wanted = ["solve", *trace, *bodies, "--pressures", "1,10MPa", "-o", tmp_path / "a.nc"]
    assert run(*wanted)[0] == 0
    bodies[1].write_text(BODIES.replace("3e-8", "4e-8") + SCALE)
    assert "a.nc exists, of other bodies: rho_2 = 3e-08, not rho_2 = 4e-08: name another file" in run(*wanted)[2]
    bodies[1].write_text(BODIES.replace("nu_2: 0.3", "nu_2: 0.34") + SCALE)
    assert "nu_2 = 0.3, not " in run(*wanted)[2]
    bodies[1].write_text(BODIES + SCALE)
    assert run(*wanted, "--ends", "periodic")[0] == 1
    heights = trace[1].read_text()
    trace[1].write_text(heights.replace("1", "2", 1))
    assert "a.nc exists, of another surface: " in run(*wanted)[2]
    trace[1].write_text(heights)
    assert run(*wanted)[0] == 0
    for code in ("others", ""):  # the latter without sources
        monkeypatch.setattr(resume, "code", lambda code=code: code)
        assert (f", not {code}): name another file" if code else "unknown without sources: name another file") in run(
            *wanted
        )[2]


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda data: data.isel(mean_pressure=[0]), "and was changed since it was solved"),
        (lambda data: data.assign_coords(mean_pressure=[0.01, 0.2]), "and was changed since it was solved"),
        (lambda data: data.drop_attrs(deep=False), "and is no file of weier"),
    ],
)
def test_a_file_that_was_changed_or_is_of_others_is_refused(run, tmp_path, change, why):
    path = tmp_path / "a.nc"
    wanted = ["solve", *SERIES, "-o", path, "--loads", "0.01,0.1"]
    run(*wanted)
    with xr.open_dataset(path) as data:
        changed = change(data.load())
    changed.drop_vars("key").to_netcdf(path)
    assert why in run(*wanted)[2]
    path.write_bytes(b"notes")
    assert "a.nc exists, and is no file of weier: name another file" in run(*wanted)[2]
    assert path.read_bytes() == b"notes"


def test_a_stop_keeps_the_known_loads_of_methods_that_have_not_begun(run, tmp_path):
    wanted = ["solve", *SERIES, "--method", "bem", "--method", "patches", "-o", tmp_path / "a.nc", "--loads"]
    run(*wanted, "0.01:1:3")
    stopped(run, KeyboardInterrupt, 1, *wanted, "0.01:1:9")
    with weier.open_dataset(tmp_path / "a.part.nc") as part:
        assert np.isfinite(part.compliance.values[0]).sum(axis=1).tolist() == [4, 3]
