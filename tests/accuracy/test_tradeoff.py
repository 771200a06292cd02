"""The measured trade: errors against the exact contact, who takes part, what is written and drawn."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.toy_method import TOY
from weier import Profile
from weier.accuracy import runner, tradeoff
from weier.methods import bem, registry
from weier.methods.errors import ConvergenceError
from weier.methods.registry import find_method

ROUNDING = 1e-15  # g_0: of heights of the order of 1
LOADS = np.array([0.01, 0.1, 2.0])
ONE, TWO = Profile(1.25, 5, 1), Profile(1.5, 3, 2, (0.0, 1.0))


@pytest.fixture(scope="module")
def measured():
    """By profile and variant, on grids of at most 800 points."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tradeoff, "MAX_POINTS", 800)
        patch.setattr(tradeoff, "REPEAT", 1)
        patch.setattr(registry, "METHODS", (*registry.METHODS, TOY))
        return {(one.problem.profile, one.name): one for one in tradeoff.measure([ONE, TWO], LOADS)}


@pytest.mark.parametrize("name", ["bem", "patches"])
def test_errors_and_what_is_stated_of_them_are_within_the_tolerance(measured, name):
    run = [measured[key] for key in measured if key[0] == TWO and re.fullmatch(rf"{name} [\d.]+(e-\d+)?", key[1])]
    assert len(run) >= {"bem": 4, "patches": 11}[name]  # a grid of 800 points is the finest here
    for one in run:
        error, stated = tradeoff.errors(one).max(axis=2)
        assert stated[0] <= one.problem.variants[one.name].settings["tolerance"]
        assert np.all(error <= stated)
    # Contact patches are at rounding at any tolerance, since their moves square the error.
    assert run[-1].error[0].max() < max(1e-2 * run[0].error[0].max(), ROUNDING)


def test_errors_are_those_of_independent_profiles(measured):
    for name in ("archard", "demelio", "layer"):  # less accurate than a coarse grid
        assert np.isnan(measured[TWO, name].result.stated).all()
        assert measured[TWO, name].error[0].max() > 10 * measured[TWO, "bem 0.01"].error[0].max()
    demelio, R = (find_method(name).solve(TWO, LOADS).resistance for name in ("demelio", "patches"))
    assert tradeoff.errors(measured[TWO, "demelio"])[0, 1] == pytest.approx(
        np.abs(demelio - R) / np.maximum(R, 1), abs=1e-9
    )
    # The reference is of the same profile shifted along x: no variant is right by construction.
    exact = measured[TWO, "patches 1e-11"].error
    assert 0 < exact[0].max() < 1e-11
    assert exact[1].max() < 1e-11
    # One wave is Westergaard's in closed form.
    assert measured[ONE, "archard"].error.max() < 1e-13


def test_a_method_that_is_only_listed_takes_part_where_it_applies(measured):
    exact = find_method("patches").solve(TWO, LOADS).compliance
    assert measured[TWO, "toy"].error[0] == pytest.approx(np.abs(0.5 * LOADS - exact), abs=1e-9)
    assert (ONE, "toy") not in measured
    assert "| toy | 1 |" in tradeoff.table_of(list(measured.values()))


def test_a_grid_too_fine_for_a_profile_and_a_solver_that_stops_are_left_out(measured, monkeypatch):
    assert (ONE, "bem 1e-05") in measured
    assert (TWO, "bem 1e-05") not in measured

    def stop(profile, loads, **settings):
        raise ConvergenceError("stopped")

    monkeypatch.setattr(runner, "PACKAGE", Path(__file__).parent)  # whose errors have clear messages
    monkeypatch.setattr(registry, "METHODS", (replace(bem.METHOD, solve=stop), registry.METHODS[1]))
    assert [one.name for one in tradeoff.measure([ONE], LOADS)] == ["archard"]
