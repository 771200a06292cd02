"""The extremes as measured, and the report with their faults."""

from dataclasses import replace

import numpy as np
import pytest

from tests.conventions import check, complaints
from weier import figures
from weier.accuracy import extremes
from weier.accuracy.runner import Outcome
from weier.accuracy.runs import Comparison
from weier.accuracy.variants import Variant
from weier.data import dataset
from weier.data.variables import Check
from weier.methods import auto, registry
from weier.scene import Case, Figure

LOADS = np.array([1e-300, 1e-21, 1e-3, 0.1, 1.0, 10.0])


def small():
    """Two extremes that are no trouble, and one that is refused."""
    one, three = (Case({"D": 1.25, "gamma": "5", "m": m}, (), {}) for m in (1, 3))
    deep = Case({"D": 1.25, "gamma": "1000000", "m": 3}, (), {})
    methods = [Variant(name, name, {}) for name in ("archard", "demelio", "bem", "patches")]
    return [
        Comparison("one | wave", one, LOADS[2:], tuple(methods)),
        Comparison("three waves", three, LOADS[2:4], tuple(methods[1:3])),
        Comparison("too many", deep, LOADS[3:5], tuple(methods[2:])),
    ]


@pytest.fixture(scope="module")
def measured():
    return extremes.measure(small())


def test_a_measurement_knows_what_was_run_and_how_well(measured):
    outcome = measured["outcome"].values
    assert (outcome != Outcome.not_run).sum(axis=2).tolist() == [[4, 4, 4, 4], [0, 2, 2, 0], [0, 0, 2, 2]]
    assert (outcome[2, 2:][outcome[2, 2:] > 0] == Outcome.clear_error).all()
    digits = measured["compliance_digits"].min("mean_pressure").values
    assert (digits[0, [0, 1, 3]] > 14).all()
    assert digits[0, 2] > 1
    assert digits[1, 1] > 14
    assert (measured["monotone"].values[0] == Check.yes).all()
    assert measured["monotone"].values[2, 2] == Check.not_measured
    assert extremes.failures(measured) == []


def test_a_fault_is_reported(measured):
    bad = measured.copy(deep=True)
    bad["concave"].values[0, 0] = Check.no
    bad["without_warning"].values[1, 1] = Check.no
    bad["outcome"].values[0, 2][bad["outcome"].values[0, 2] > 0] = Outcome.unclear_error
    bad["one_curve"].values[0, 3] = Check.no
    assert extremes.failures(bad) == [
        "one | wave, archard: not concave",
        "one | wave, bem: unclear error",
        "one | wave, patches: not one curve",  # though each load alone is solved
        "three waves, demelio: not without warning",
    ]


def test_the_data_are_by_the_conventions(measured, tmp_path):
    path = tmp_path / "extremes.nc"
    dataset.write(measured, path, "Small", "examined")
    assert complaints(check([path], ["cf:1.11"], tmp_path)["cf:1.11"][str(path)]) == []


def test_the_figure_is_drawn_from_the_file_and_refused_without_digits(measured, tmp_path):
    dataset.write(measured, tmp_path / "extremes.nc", "Small", "examined")
    again = dataset.read(tmp_path / "extremes.nc")
    figures.draw(Figure("extremes"), [again], tmp_path / "extremes.png")
    assert {path.suffix for path in tmp_path.iterdir()} == {".nc", ".png", ".pdf", ".svg"}
    without = again.assign(compliance_digits=again["compliance_digits"] * np.nan)
    with pytest.raises(ValueError, match="no digits"):
        figures.draw(Figure("extremes"), [without], tmp_path / "no.png")


def test_the_summary_has_the_worst_of_each_method(measured):
    def summary(data):
        text = "\n\n".join(extremes.parts(data))
        lines = [line for line in text.splitlines() if "|" in line]
        return text, {line.split(" | ")[0]: line.strip("| ").split(" | ") for line in lines}

    text, rows = summary(measured)
    assert text.startswith("8 rows, none of them with a fault.\n")
    assert rows["| bem"][1:4] == ["3", "6", "2"]  # extremes, numbers, and errors in words
    digits = measured["compliance_digits"].sel(variant="bem")
    assert float(rows["| bem"][4]) == pytest.approx(float(digits.min()), abs=0.06)
    assert float(rows["| one \\| wave"][3]) == pytest.approx(float(digits[0].min()), abs=0.06)
    assert rows["| too many"][1:] == ["", "", "all refused", "all refused"]
    assert text.count("ValueError: the finest wave must fit at most 100000 times") == 1

    bad = measured.copy(deep=True)
    bad["concave"].values[0, 0] = Check.no
    bad["outcome"].values[0, 2][-1] = Outcome.clear_error
    text, rows = summary(bad)
    assert "8 rows, and these have a fault:\n\n- one \\| wave, archard: not concave\n" in text
    assert "some refused" in rows["| one \\| wave"][3]


def test_a_curve_that_states_too_small_errors_is_a_fault(monkeypatch):
    """Three waves at light loads: the resistance of a grid, with its own error."""

    def overconfident(*arguments, **settings):
        solved = auto.METHOD.solve(*arguments, **settings)
        return replace(solved, resistance_error=solved.resistance_error / 100)

    case = Case({"D": 1.25, "gamma": "5", "m": 3, "phases": [0.0, 1.0, 2.0]}, (), {})
    some = [Comparison("light", case, np.geomspace(1e-12, 1e-4, 5), (Variant("auto", "auto", {}),))]
    assert extremes.failures(extremes.measure(some)) == []
    changed = replace(auto.METHOD, solve=overconfident)
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS[:-1], changed))
    assert extremes.failures(extremes.measure(some)) == ["light, auto: not within stated error"]
