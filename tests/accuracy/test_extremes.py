"""The extremes: what is examined, the page with its faults, and its figure."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from tests.toy_method import TOY
from weier import Profile
from weier.accuracy import extremes, ill_conditioned, reference
from weier.accuracy.ill_conditioned import Extreme, around, neighbours, variants
from weier.accuracy.runner import Outcome, Variant, by_default
from weier.methods import auto, registry

LOADS, USUAL = np.array([1e-3, 0.1, 1.0, 10.0]), np.geomspace(1e-6, 100, 25)
METHODS = [by_default(name) for name in ("archard", "demelio", "bem", "patches")]


@pytest.fixture(scope="module")
def examined():
    """Two extremes that are no trouble, and one that is refused."""
    deep = Profile(1.25, 1000000, 3)
    some = [
        Extreme("one | wave", Profile(1.25, 5, 1), LOADS, tuple(METHODS)),
        Extreme("three waves", Profile(1.25, 5, 3), LOADS[:2], tuple(METHODS[1:3])),
        Extreme("too many", deep, LOADS[1:3], tuple(METHODS[2:])),
    ]
    return extremes.examine(some)


def test_a_measurement_knows_what_was_run_and_how_well(examined):
    of_one, of_three, of_many = examined[:4], examined[4:6], examined[6:]
    assert all((one.outcome == Outcome.clear_error).all() for one in of_many)
    assert [one.digits[0].min() > 14 for one in (*of_one, *of_three)] == [True, True, False, True, True, False]
    assert of_one[2].digits[0].min() > 1
    assert all(one.checks["monotone"] and one.checks["concave"] for one in of_one)
    assert "monotone" not in of_many[0].checks
    assert not any(one.faults for one in examined)


def test_a_fault_is_reported(examined):
    archard, demelio, bem, patches = examined[:4]
    found = [
        archard._replace(checks={**archard.checks, "concave": False}),
        demelio._replace(checks={**demelio.checks, "without_warning": False}),
        bem._replace(outcome=np.full(4, Outcome.unclear_error), message="stopped"),
        patches._replace(message="stopped"),  # though each load alone is solved
    ]
    assert [one.faults for one in found] == [
        ["not concave"],
        ["not without warning"],
        ["unclear error"],
        ["not one curve"],
    ]
    text = "\n\n".join(extremes.parts(found))
    assert "4 rows, and these have a fault:\n\n- one \\| wave, archard: not concave\n" in text


def test_the_page_has_the_worst_of_each_method(examined):
    text = "\n\n".join(extremes.parts(examined))
    rows = {line.split(" | ")[0]: line.strip("| ").split(" | ") for line in text.splitlines() if "|" in line}
    assert text.startswith("8 rows, none of them with a fault.\n")
    assert rows["| bem"][1:4] == ["3", "6", "2"]  # extremes, numbers, and errors in words
    digits = [one.digits[0].min() for one in examined if one.variant.name == "bem"]
    assert float(rows["| bem"][4]) == pytest.approx(np.nanmin(digits), abs=0.06)
    assert float(rows["| one \\| wave"][3]) == pytest.approx(digits[0], abs=0.06)
    assert rows["| too many"][1:] == ["", "", "all refused", "all refused"]
    assert text.count("ValueError: the finest wave must fit at most 100000 times") == 1
    refused = examined[2]._replace(outcome=np.array([1, 1, 1, Outcome.clear_error]))
    assert "some refused" in "".join(extremes.parts([refused]))


def test_the_loads_of_the_figure_are_spread_where_things_happen(examined):
    powers = np.array([-300, -100, -30, -10, -3, -2, -1, 0, 1, 2, 3, 10, 30, 100, 300.0])
    case = examined[0].extreme._replace(loads=10.0**powers)
    figure = extremes.draw([examined[0]._replace(extreme=case, digits=np.full((2, powers.size), 12.0))])
    figure.draw_without_rendering()
    (axes,) = figure.axes
    assert axes.get_title() == r"$D=1.25$,  $\gamma=5$,  $m=1$"
    place = axes.transAxes.inverted().transform(axes.transData.transform([(power, 12) for power in powers]))[:, 0]
    assert np.all(np.diff(place) > 0.02)
    assert place[powers == 2] - place[powers == -2] > 0.25  # of the axis, where all digits are lost and found


def test_a_curve_that_states_too_small_errors_is_a_fault(monkeypatch):
    """Three waves at light loads: the resistance of a grid, with its own error."""

    def overconfident(*arguments, **settings):
        solved = auto.METHOD.solve(*arguments, **settings)
        return replace(solved, resistance_error=solved.resistance_error / 100)

    series = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
    some = [Extreme("light", series, np.geomspace(1e-12, 1e-4, 5), (Variant("auto", "auto", {}),))]
    assert extremes.examine(some)[0].faults == []
    changed = replace(auto.METHOD, solve=overconfident)
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS[:-1], changed))
    assert extremes.examine(some)[0].faults == ["not within stated error"]


def test_a_method_that_is_only_listed_is_examined(monkeypatch):
    """Against a reference of its own it is exact; at heavy loads it rises beyond full contact."""

    def exact(profile, loads):
        return reference.Reference(np.stack([0.5 * loads, np.full(loads.size, 0.5)]))

    monkeypatch.setitem(reference.ESTIMATE_REFERENCES, "toy", exact)
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS, TOY))
    profile, loads = Profile(1.5, 3, 2), np.array([0.2, 2.0, 40.0])
    (toy,) = (one for one in variants(profile, loads) if one.name == "toy")
    (found,) = extremes.examine([Extreme("two waves", profile, loads, (toy,))])
    assert (found.digits[0] == 16).all()
    assert found.faults == ["not within band"]


def names(profile, loads=USUAL):
    return {variant.name for variant in variants(profile, loads)}


def test_methods_meet_what_they_apply_to_within_a_minute():
    assert {"westergaard", "layer", "bem", "patches", "auto"} <= names(Profile(1.25, 5, 1))
    assert "westergaard" not in names(Profile(1.25, 5, 3))
    long = Profile(1.25, 5, 1000)
    assert "layer" in names(long, USUAL[:1]) - names(long)
    infinite, of_infinite = Profile(1.25, 5, math.inf), {"archard", "demelio", "persson", "layer"}
    assert names(infinite) == of_infinite  # by "auto" 15 625 waves, twice under each load
    assert names(infinite, USUAL[:1]) == {*of_infinite, "auto"}
    # These are tried for their refusals.
    assert "auto" in names(Profile(1.9, 2, math.inf))
    assert {"bem", "patches"} <= names(Profile(1.5, 10**6, 1000))


def test_loads_stand_beside_and_around():
    ulp = np.finfo(float).eps
    assert neighbours(1.0).tolist() == [1 - ulp, 1 - ulp / 2, 1.0, 1 + ulp, 1 + 2 * ulp]
    assert around([1.0]).tolist() == sorted([1.0, *(1 + s * d for s in (-1, 1) for d in ill_conditioned.DISTANCES)])


def test_each_extreme_has_a_name_of_its_own_and_loads_that_increase(monkeypatch):
    monkeypatch.setattr(ill_conditioned, "events", lambda *_: {"mean_pressure": xr.DataArray(USUAL)})
    found = list(ill_conditioned.extremes())
    assert len({one.name for one in found}) == len(found) > 30
    assert extremes.DRAWN in {one.name for one in found}
    assert all((np.diff(one.loads) > 0).all() and one.variants for one in found)
