"""`weier solve` goes on from its file, and from that of a run that was stopped or killed."""

import json

import numpy as np
import pytest
import xarray as xr

import weier
from weier.cli import output
from weier.methods.errors import ConvergenceError
from weier.methods.load_progress import reporting_to

SERIES = ["-D", "1.25", "--gamma", "5", "-m", "2", "--phases", "1"]
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
        return json.dumps(values | {name: data.attrs[name] for name in ("problem", "title")})


PROBLEMS = {
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
    few, all_loads = "0.5,0.01,0.04,0.1", "0.01,0.02,0.04,0.1,0.2,0.5,0.9"
    for name, loads in (("a.nc", few), ("a.nc", all_loads), ("b.nc", all_loads)):
        code, _, err = run(*wanted, tmp_path / name, "--loads", loads)
        assert code == 0, err
    assert numbers(tmp_path / "a.nc") == numbers(tmp_path / "b.nc")


def test_only_the_loads_that_lack_are_solved_and_methods_may_come_in_another_order(run, tmp_path):
    solved = []
    wanted = ["solve", *SERIES, "-o", tmp_path / "a.nc", "--loads"]
    run(*wanted, "0.01:1:3", "--method", "bem", "--method", "patches")
    with reporting_to(lambda: solved.append(1)):
        assert "a.nc has 3 of 5 loads" in run(*wanted, "0.01:1:5", "--method", "patches", "--method", "bem")[2]
    assert len(solved) == 4
    with weier.open_dataset(tmp_path / "a.nc") as data:
        for method in ("patches", "bem"):
            own = weier.solve(weier.Profile(1.25, 5, 2, 1.0), np.geomspace(0.01, 1, 5), method).resistance.values
            np.testing.assert_allclose(data.resistance.sel(solution_method=method).values[0], own, rtol=1e-12)


@pytest.mark.parametrize(
    ("cause", "method"), [(KeyboardInterrupt, "bem"), (TimeoutError, "auto"), (Killed, "patches")]
)
def test_a_run_that_is_stopped_or_killed_goes_on(run, tmp_path, monkeypatch, bodies, trace, cause, method):
    """Twice, of a trace in SI units."""
    monkeypatch.setattr(output, "SAVE_SECONDS", 0.0)
    wanted = ["solve", *trace, *bodies, "--pressures", "1:200:6MPa", "--method", method, "-o"]
    wanted[-1:] = ["--tolerance", "1e-6", "-o"] if method == "auto" else ["-o"]
    assert run(*wanted, tmp_path / "b.nc")[0] == 0
    for loads in (3, 2):
        stopped(run, cause, loads, *wanted, tmp_path / "a.nc")
        assert not (tmp_path / "a.nc").exists()
        with weier.open_dataset(tmp_path / "a.part.nc") as part:
            assert part.mean_pressure.units == "MPa"
            done = part.sizes["mean_pressure"]
        assert 1 <= done < 6
    code, _, err = run(*wanted, tmp_path / "a.nc")
    assert (code, f"a.part.nc has {done} of 6 loads" in err) == (0, True)
    assert not (tmp_path / "a.part.nc").exists()
    with xr.open_dataset(tmp_path / "a.nc") as one, xr.open_dataset(tmp_path / "b.nc") as other:
        xr.testing.assert_allclose(one.drop_vars("seconds"), other.drop_vars("seconds"), rtol=1e-12, atol=0)


def test_a_trace_in_a_file_of_another_name_is_the_same_surface(run, tmp_path, trace):
    wanted = [*trace[2:], "--method", "bem", "-o", tmp_path / "a.nc", "--loads"]
    assert run("solve", *trace[:2], *wanted, "0.1")[0] == 0
    renamed = trace[1].rename(tmp_path / "b.csv")
    code, _, err = run("solve", "--trace", renamed, *wanted, "0.1,1")
    assert (code, "a.nc has 1 of 2 loads" in err) == (0, True), err
    renamed.write_text("\n".join(reversed(renamed.read_text().split())))
    code, _, err = run("solve", "--trace", renamed, *wanted, "0.1,1")
    assert (code, "of other surface" in err) == (1, True), err


def test_force_solves_anew_and_keeps_the_old_file_until_it_is_done(run, tmp_path):
    """A partial file of another problem under this name is removed."""
    path, part, loads = tmp_path / "a.nc", tmp_path / "a.part.nc", ["--loads", "0.01:3:12"]
    other = ["solve", "-D", "1.5", *SERIES[2:], *loads, "--force", "-o", path]
    stopped(run, KeyboardInterrupt, 5, "solve", *SERIES, *loads, "-o", path)
    assert part.exists()
    code, _, err = run(*other)
    assert (code, "has" in err, part.exists()) == (0, False, False)
    with weier.open_dataset(path) as data:
        assert data.D.values.tolist() == [1.5]
    whole = path.read_bytes()
    stopped(run, KeyboardInterrupt, 5, "solve", *SERIES, *loads, "--force", "-o", path)
    assert path.read_bytes() == whole


@pytest.mark.filterwarnings("default:.*too hard")
def test_known_loads_stay_if_others_fail_or_their_method_has_not_begun(run, tmp_path, monkeypatch):
    path, solved = tmp_path / "a.nc", []
    wanted = ["solve", *SERIES, "--method", "bem", "--method", "patches", "-o", path, "--loads"]
    assert run(*wanted, "0.1")[0] == 0

    def fail(*arguments):
        raise ConvergenceError("too hard")

    with monkeypatch.context() as faulty:
        faulty.setattr("weier.methods.patches.solver.solve_state", fail)
        code, _, err = run(*wanted, "0.1,1")
        assert (code, "patches: too hard" in err) == (1, True)
    with weier.open_dataset(path) as data:
        assert np.isfinite(data.compliance.values[0]).tolist() == [[True, True], [True, False]]
    stopped(run, KeyboardInterrupt, 1, *wanted, "0.1,1,2")
    with weier.open_dataset(tmp_path / "a.part.nc") as part:
        assert np.isfinite(part.compliance.values[0]).sum(axis=1).tolist() == [3, 1]
    with reporting_to(lambda: solved.append(1)):
        assert run(*wanted, "0.1,1,2")[0] == 0
    assert len(solved) == 2


def test_perfect_conductors_start_anew(run, tmp_path, bodies):
    """Their R is 0 in SI units, and cannot be converted back."""
    bodies[1].write_text(BODIES.replace("14 uohm cm", "0").replace("3e-8", "0") + SCALE)
    wanted = ["solve", *SERIES, *bodies, "--pressures", "1,10,100MPa", "-o", tmp_path / "a.nc"]
    stopped(run, TimeoutError, 2, *wanted)
    solved = []
    with reporting_to(lambda: solved.append(1)):
        assert run(*wanted)[0] == 0
    assert len(solved) == 3


REFUSED = {
    "surface": (["-D", "1.3"], 'of other surface: {"D": 1.25, '),
    "method": (["--method", "bem"], 'of other methods: ["patches"], not ["bem"]'),
    "loads": (["--loads", "0.02"], "with 2 loads that are not asked for, such as 1.81246e+06 Pa: add them, or"),
    "no bodies": (["--si", None], "of other bodies: "),
}


@pytest.mark.parametrize(("changed", "why"), REFUSED.values(), ids=REFUSED)
def test_a_file_of_another_problem_is_refused_and_stays(run, tmp_path, bodies, changed, why):
    path, loads = tmp_path / "a.nc", ["--loads", "0.01,0.1"]
    given = dict(zip([*SERIES, *bodies, *loads][::2], [*SERIES, *bodies, *loads][1::2], strict=True))
    assert run("solve", *(word for pair in given.items() for word in pair), "-o", path)[0] == 0
    whole, given = path.read_bytes(), given | dict(zip(changed[::2], changed[1::2], strict=True))
    code, _, err = run("solve", *(word for pair in given.items() if pair[1] for word in pair), "-o", path)
    assert (code, why in err) == (1, True), err
    assert err.endswith("name another file, or solve anew by --force\n")
    assert path.read_bytes() == whole


def test_other_heights_and_code_and_files_of_others_are_refused(run, tmp_path, trace, monkeypatch):
    path = tmp_path / "a.nc"
    wanted = ["solve", *trace, "--loads", "0.1,1", "-o", path]
    assert run(*wanted)[0] == 0
    heights = trace[1].read_text()
    trace[1].write_text(heights.replace("1", "2", 1))
    assert "a.nc exists, of other surface: " in run(*wanted)[2]
    trace[1].write_text(heights)
    monkeypatch.setattr(output, "numerics", lambda: "others")
    assert 'not "others": name another file' in run(*wanted)[2]
    path.write_bytes(b"notes")
    assert "a.nc exists, and is not of `weier solve`: name another file" in run(*wanted)[2]
    assert path.read_bytes() == b"notes"
