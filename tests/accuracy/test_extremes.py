"""The extremes: what is examined, the checks of a curve, and the page with its faults."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from tests.toy_method import TOY
from weier import Profile
from weier.accuracy import extremes, reference
from weier.accuracy.ill_conditioned import Extreme, variants
from weier.accuracy.runner import Outcome, Variant
from weier.methods import auto, registry, westergaard

LOADS = np.array([1e-3, 0.1, 1.0, 10.0])
METHODS = [Variant(name) for name in ("archard", "demelio", "bem", "patches")]


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


def test_a_curve_that_states_too_small_errors_is_a_fault(monkeypatch):
    """Three waves at light loads: the resistance of a grid, with its own error."""

    def overconfident(*arguments, **settings):
        solved = auto.METHOD.solve(*arguments, **settings)
        warnings.warn("divide by zero", RuntimeWarning, stacklevel=1)
        return replace(solved, resistance_error=solved.resistance_error / 100)

    series = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
    some = [Extreme("light", series, np.geomspace(1e-12, 1e-4, 5), (Variant("auto"),))]
    assert extremes.examine(some)[0].faults == []
    changed = replace(auto.METHOD, solve=overconfident)
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS[:-1], changed))
    assert extremes.examine(some)[0].faults == ["not within stated error", "not without warning"]


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


ONE, MANY = Profile(1.25, 5, 1), np.geomspace(1e-6, 10, 30)
H, R = westergaard.compliance(MANY), westergaard.resistance(MANY)
DENTED = np.where(np.arange(30) == 12, H - 1e-3, H)
FALLING = np.where(np.arange(30) == 29, H[28] - 1e-3, H)
ALL = {"within_band", "monotone", "concave"}


def passed(h, slope, h_error=0.0, R_error=0.0):
    stated = np.stack([np.full(30, h_error), np.full(30, R_error)])
    found = extremes.check("bem", ONE, MANY, np.stack([h, slope]), stated)
    return {name for name, holds in found.items() if holds}


@pytest.mark.parametrize(
    ("h", "slope", "expected"),
    [
        (H, R, ALL),
        (FALLING, R, set()),
        (DENTED, R, {"monotone"}),
        (H, R * 1.3, {"monotone"}),
        (H, R * 0.7, {"monotone"}),
        (H, R + 1, {"monotone"}),
    ],
)
def test_each_check_can_fail(h, slope, expected):
    assert passed(h, slope) == expected


def test_what_a_solution_is_off_is_allowed():
    assert passed(DENTED, R, 2e-3) == passed(FALLING, R, 2e-3) == ALL
    assert "concave" in passed(H, R * 1.3, R_error=0.4 * R.max())
