"""The extremes: what is examined, the checks of a curve, and the page with its faults."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from tests.toy_method import TOY
from weier import Profile
from weier.accuracy import extremes, reference
from weier.accuracy.comparison import compare
from weier.accuracy.runner import Problem, Variant
from weier.methods import auto, registry, westergaard

LOADS = np.array([1e-3, 0.1, 1.0, 10.0])


def examine(name, profile, loads, *methods):
    return [*compare([Problem(name, profile, loads, {name: Variant(name) for name in methods})], own_sums=True)]


@pytest.fixture(scope="module")
def examined():
    """Two extremes that are no trouble, and one that is refused."""
    return [
        *examine("one | wave", Profile(1.25, 5, 1), LOADS, "archard", "demelio", "bem", "patches"),
        *examine("three waves", Profile(1.25, 5, 3), LOADS[:2], "demelio", "bem"),
        *examine("too many", Profile(1.25, 1000000, 3), LOADS[1:3], "bem", "patches"),
    ]


def test_the_page_has_the_digits_of_each_extreme_and_the_refusals(examined):
    page = list(extremes.parts(examined))
    assert page[0] == "8 rows, none of them with a fault."
    one, three, many = page[2].splitlines()[-3:]
    assert [float(cell.split(",")[0]) > 14 for cell in one.split(" | ")[-4:-2]] == [True, True]
    assert three.endswith(" |  |")  # by patches, which were not run on them
    assert 1 < float(three.split(" | ")[-2].split(",")[0]) < 14
    assert many == "| too many |  |  | all refused | all refused |"
    assert "the finest wave must fit at most" in page[-1]


def test_a_fault_is_reported(examined):
    archard, demelio, bem, patches = (one.result for one in examined[:4])
    found = [
        examined[0]._replace(result=archard._replace(values=1.001 * archard.values)),
        examined[1]._replace(result=demelio._replace(warned=("divide by zero",))),
        examined[2]._replace(error=np.full((2, 4), 1.0)),
        examined[3]._replace(result=patches._replace(message="stopped")),  # though each load alone is solved
    ]
    said = [extremes.faults(one) for one in found]
    assert said[:2] + said[3:] == [["not within the bounds"], ["warning: divide by zero"], ["not one curve"]]
    assert f"h by bem is off by 1.00e+00, stated {bem.stated[0, 0]:.2e} (one | wave): " in said[2][0]
    text = "\n\n".join(extremes.parts(found))
    assert "4 rows, and these have a fault:\n\n- one \\| wave, archard: not within the bounds\n" in text


def test_a_curve_that_states_too_small_errors_is_a_fault(monkeypatch):
    """Three waves at light loads: the resistance of a grid, with its own error."""

    def overconfident(*arguments, **settings):
        solved = auto.METHOD.solve(*arguments, **settings)
        warnings.warn("divide by zero", RuntimeWarning, stacklevel=1)
        return replace(solved, resistance_error=solved.resistance_error / 100)

    light = "light", Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), np.geomspace(1e-12, 1e-4, 5), "auto"
    (found,) = examine(*light)
    assert not extremes.faults(found)
    changed = replace(auto.METHOD, solve=overconfident)
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS[:-1], changed))
    (found,) = examine(*light)
    first, *others = extremes.faults(found)
    assert first == "warning: divide by zero"
    assert others
    assert all(fault.startswith("R by auto is off by ") for fault in others)


def test_a_method_that_is_only_listed_is_examined(monkeypatch):
    """Against a reference of its own it is exact; at heavy loads it rises beyond full contact."""

    def exact(profile, loads):
        return reference.Reference(np.stack([0.5 * loads, np.full(loads.size, 0.5)]))

    monkeypatch.setitem(reference.ESTIMATE_REFERENCES, "toy", exact)
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS, TOY))
    profile, loads = Profile(1.5, 3, 2), np.array([0.2, 2.0, 40.0])
    assert "toy" in extremes.variants(profile, loads)
    (found,) = examine("two waves", profile, loads, "toy")
    assert extremes._digits_left([found]) == "16.0, 16.0"
    assert extremes.faults(found) == ["not within the bounds"]


ONE, MANY = Profile(1.25, 5, 1), np.geomspace(1e-6, 10, 30)
H, R = westergaard.compliance(MANY), westergaard.resistance(MANY)
DENTED = np.where(np.arange(30) == 12, H - 1e-3, H)
FALLING = np.where(np.arange(30) == 29, H[28] - 1e-3, H)
ALL = {"within the bounds", "monotone", "concave"}


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
