"""What takes long says so once, and ends at its limit."""

import re

import numpy as np
import pytest

import weier
from weier.api import progress
from weier.methods import layer
from weier.methods.load_progress import reporting_to
from weier.pipeline.single import case_of, solve_one

PROFILE = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)
LOADS = np.geomspace(1e-2, 1, 20)


def test_a_short_solution_says_nothing(capsys):
    weier.solve([PROFILE], LOADS[:1], ["patches", "bem"])  # which may compile
    capsys.readouterr()
    weier.solve(PROFILE, LOADS, "patches", max_seconds=1000)
    weier.solve([PROFILE], LOADS, ["demelio", "bem"])
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("profile", [PROFILE, [PROFILE, PROFILE]], ids=["one", "several"])
def test_a_long_solution_says_so_once(profile, capsys, monkeypatch):
    """Before it begins, where that is known, and otherwise once it has lasted as long."""
    monkeypatch.setattr(progress, "LONG", 1e-3)
    weier.solve(profile, LOADS, "patches")
    count = 20 * (1 if profile is PROFILE else 2)
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith(f"weier.solve: {count} loads take about ")
    assert err.endswith(" s; max_seconds would limit them\n")
    watch = progress.Watch(4, 0.0, None)
    for _ in range(6):
        watch()
    watch.start -= 1
    watch.done = 2
    watch()
    watch()
    assert capsys.readouterr().err == "weier.solve: 3 of 4 loads, about 0 s left; max_seconds would limit them\n"


def test_one_load_is_announced_in_the_singular(capsys):
    progress.Watch(1, 200.0, None)
    assert capsys.readouterr().err == "weier.solve: 1 load takes about 200 s; max_seconds would limit it\n"


def test_what_is_refused_is_not_announced(capsys):
    series = weier.Profile(D=1.25, gamma=5, m=5, phases=1.0)
    refusal = "the tolerance of boundary elements must exceed .*, got 1e-12"
    with pytest.raises(ValueError, match=refusal):
        weier.solve(series, [0.1], "bem", tolerance=1e-12)
    with pytest.raises(ValueError, match=refusal):
        weier.solve([series], [0.1], ["patches", "bem"], bem={"tolerance": 1e-12})
    with pytest.raises(ValueError, match=refusal):
        solve_one(case_of({"D": 1.25, "gamma": 5, "m": 5}, ["bem"], {"bem": {"tolerance": 1e-12}}), np.array([0.1]))
    assert capsys.readouterr() == ("", "")


def test_series_that_differ_in_phases_alone_are_announced_as_one_if_the_method_uses_none(capsys):
    series = [weier.Profile(D=1.25, gamma=5, m=2, seed=seed) for seed in range(120)]
    settings = {"layer": {"points": 150}}
    assert len(series) * layer.METHOD.seconds(series[0], LOADS, **settings["layer"]) > progress.LONG
    weier.solve(series, LOADS, ["layer"], **settings)
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("profile", [PROFILE, [PROFILE, PROFILE]], ids=["one", "several"])
def test_a_limit_ends_a_solution_with_a_sentence(profile):
    with pytest.raises(TimeoutError, match=r"max_seconds = 1e-06 ended the solution after 1 of \d+ loads: raise it"):
        weier.solve(profile, LOADS, "patches", max_seconds=1e-6)
    curve = weier.solve(PROFILE, LOADS, "patches")  # which is not disturbed by the one before
    assert np.isfinite(curve.resistance.values).all()


@pytest.mark.parametrize("limit", [0, -1.0, "10", float("nan")])
def test_a_limit_is_a_positive_number(limit):
    with pytest.raises(ValueError, match="max_seconds must be positive"):
        weier.solve(PROFILE, LOADS, "demelio", max_seconds=limit)


def test_a_long_search_for_events_says_so_beforehand(capsys, monkeypatch):
    """Its progress is that of the contact length."""
    monkeypatch.setattr(progress, "LONG", 1e-3)
    monkeypatch.setattr(progress, "TERMINAL_SECONDS", 0.0)
    monkeypatch.setattr(progress.sys.stderr, "isatty", lambda: True)
    found = weier.events(PROFILE, 1e-3, 1.0)
    announced, *shown = capsys.readouterr().err.split(progress.ERASE)
    assert re.fullmatch(r"weier.events: the search takes about \S+ s\n", announced)
    share = [int(text.split("%")[0].split()[-1]) for text in shown if "%" in text]
    assert share == sorted(share)
    assert 0 < share[0] < 50 < share[-1]
    assert found.sizes["event"] == 6


def test_a_short_search_for_events_says_nothing(capsys):
    weier.events(PROFILE, 1e-3, 1.0)
    assert capsys.readouterr() == ("", "")


class Stop:
    """A listener that raises an exception after some loads, as Ctrl-C and a time limit do."""

    def __init__(self, loads, error):
        self.left, self.error = loads, error

    def __call__(self):
        """Count one load."""
        self.left -= 1
        if self.left == 0:
            raise self.error("enough")


@pytest.mark.parametrize("error", [KeyboardInterrupt, TimeoutError])
@pytest.mark.parametrize(
    ("method", "settings", "solved"),
    [
        ("patches", {}, slice(0, 5)),
        ("bem", {}, slice(15, 20)),
        ("auto", {"tolerance": 1e-8}, slice(0, 5)),
        ("auto", {"tolerance": 1e-2}, slice(15, 20)),
    ],
)
def test_a_stopped_solution_keeps_the_loads_that_are_solved(error, method, settings, solved):
    """The same bits as those of the whole curve, in p_0* and in Pa."""
    bodies = {"E_1": 210e9, "E_2": 210e9, "nu_1": 0.3, "nu_2": 0.3, "rho_1": 1.4e-7, "rho_2": 1.4e-7}
    steel = weier.Interface(**bodies, lambda_0=1e-3, g_0=1e-6)
    for solve, loads in ((weier.solve, LOADS), (steel.solve, steel.pressure(LOADS))):
        whole = solve(PROFILE, loads[::-1], method, **settings).isel(mean_pressure=slice(None, None, -1))
        with pytest.raises(error) as stopped, reporting_to(Stop(5, error)):
            solve(PROFILE, loads[::-1], method, **settings)
        curve = stopped.value.curve
        assert curve.mean_pressure.equals(whole.mean_pressure[solved])
        for name in ("compliance", "resistance", "compliance_error"):
            np.testing.assert_array_equal(curve[name], whole[name][solved])
        assert np.array_equal(curve.phases, PROFILE.phase)


def test_a_stopped_list_keeps_its_cases():
    series = [weier.Profile(D=1.25, gamma=5, m=2, seed=seed) for seed in range(4)]
    whole = weier.solve(series, LOADS, ["demelio", "patches"])
    with pytest.raises(TimeoutError) as stopped, reporting_to(Stop(43, TimeoutError)):
        weier.solve(series, LOADS, ["demelio", "patches"])
    curves = stopped.value.curve
    assert curves["case"].values.tolist() == whole["case"].values[:3].tolist()
    for name in ("compliance", "resistance", "compliance_lower"):
        expected = whole[name].values[:3].copy()
        expected[2, 1, 3:] = np.nan
        np.testing.assert_array_equal(curves[name].values[:2], expected[:2])
        if name != "compliance_lower":  # which more loads make tighter
            np.testing.assert_array_equal(curves[name].values[2], expected[2])


def test_a_stopped_search_has_no_curve_of_what_was_solved_for_it():
    with pytest.raises(TimeoutError) as stopped, reporting_to(Stop(1, TimeoutError)):
        weier.find_load(PROFILE, resistance=1.0)
    assert stopped.value.curve is None
