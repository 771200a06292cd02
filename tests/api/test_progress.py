"""Progress over the loads, and what a stopped solution keeps."""

from types import SimpleNamespace

import numpy as np
import pytest

import weier
from weier.api import progress
from weier.api.progress import Progress
from weier.methods.load_progress import reporting_to
from weier.methods.registry import find_method

PROFILE = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)
LOADS = np.geomspace(1e-2, 1, 20)


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("bem", {"points_per_wave": 16}),
        ("bem", {"points_per_wave": 16, "staircase": "kept"}),
        ("patches", {}),
    ],
)
def test_each_load_counts_once(name, settings):
    """Not what a load starts from, either, and not what bounds the truncated terms."""
    counted = []
    with reporting_to(lambda: counted.append(1)):
        find_method(name).solve(PROFILE, LOADS[::8], **settings)
    assert len(counted) == 3


def test_progress_has_the_loads_and_the_remaining_time_without_that_of_compiling(monkeypatch):
    said, now = [], [0.0]
    monkeypatch.setattr(progress, "perf_counter", lambda: now[0])
    monkeypatch.setattr(progress, "TIMERS", [SimpleNamespace(done=True, duration=0.0)])
    counter = Progress(30, "30 loads", 3.0, said.append)
    progress.TIMERS[0].duration = 96.0
    for now[0], done in ((100.0, 1), (102.0, 2), (116.0, 10), (136.0, 30)):
        counter.reach(done)
    assert said == ["3 % of 30 loads, about 116 s left", "33 % of 30 loads, about 40 s left"]


def test_a_search_shows_its_progress_in_lines(monkeypatch, capsys):
    monkeypatch.setattr(progress, "LONG", 0.0)
    weier.events(PROFILE, 1e-3, 1.0)
    share = [int(line.removeprefix("weier.events: ").split()[0]) for line in capsys.readouterr().err.splitlines()]
    assert share == sorted(share)
    assert 0 <= share[0] < 50 < share[-1]


def test_a_long_solution_is_announced(monkeypatch, capsys):
    expected = find_method("patches").seconds(PROFILE, LOADS)
    monkeypatch.setattr(progress, "LONG", 0.6 * expected)
    weier.solve(PROFILE, LOADS, "patches")
    assert f"weier.solve: about {expected:.0f} s for {LOADS.size} loads; Ctrl-C ends it" in capsys.readouterr().err
    weier.solve([PROFILE] * 3, LOADS[:5], "patches", workers=2)  # half of 15 loads
    assert "Ctrl-C" not in capsys.readouterr().err


class Stop:
    """A listener that raises an exception after some loads, as Ctrl-C and a time limit do."""

    def __init__(self, loads, error):
        self.left, self.error = loads, error

    def __call__(self):
        """Count one load."""
        self.left -= 1
        if self.left == 0:
            raise self.error("enough")


@pytest.mark.parametrize(
    ("error", "method", "settings", "solved"),
    [
        (KeyboardInterrupt, "patches", {}, slice(0, 5)),
        (TimeoutError, "bem", {}, slice(15, 20)),
        (TimeoutError, "auto", {"tolerance": 1e-8}, slice(0, 5)),
        (KeyboardInterrupt, "auto", {"tolerance": 1e-2}, slice(15, 20)),
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
