"""The verdicts can fail, the truths are true, and the report tells what is wrong."""

import math
import warnings
from importlib import import_module
from pathlib import Path

import mpmath as mp
import netCDF4
import numpy as np
import pytest
from scipy.linalg import circulant

from tests.test_conventions import checked, complaints
from weier import Profile, figures
from weier.accuracy import extremes
from weier.accuracy.extremes import Outcome, Verdict, verdicts
from weier.accuracy.extremes.conditioning import operator, system
from weier.accuracy.extremes.truth import truth
from weier.data import dataset
from weier.methods import multiprecision as exact
from weier.methods import westergaard
from weier.methods.errors import ConvergenceError
from weier.methods.method import Variant
from weier.scene import Case
from weier.theory.halfplane import influence_coefficients

LOADS = np.array([1e-300, 1e-21, 1e-3, 0.1, 1.0, 10.0])
NOISE = verdicts.Noise(1e-12, 1e-11)
ONE, THREE = Profile(1.25, 5, 1), Profile(1.25, 5, 3, (0.0, 1.0, 2.0))


def curve(p):
    return westergaard.compliance(p), westergaard.resistance(p)


def test_westergaards_curve_passes():
    p = np.geomspace(1e-6, 10, 30)
    h, R = curve(p)
    assert verdicts.monotone(h, 1e-12)
    assert verdicts.concave(p, h, R, NOISE, 1.0)
    assert verdicts.inside(ONE, p, h, R, NOISE, 0.0)


def test_each_verdict_can_be_no():
    p = np.geomspace(1e-6, 10, 30)
    h, R = curve(p)
    dented = np.where(np.arange(30) == 12, h - 1e-3, h)
    assert not verdicts.monotone(np.where(np.arange(30) == 29, 0.9, h), 1e-12)
    assert not verdicts.concave(p, dented, R, NOISE, 1.0)
    assert not verdicts.concave(p, h, R * 1.3, NOISE, 1.0)
    assert not verdicts.inside(ONE, p, dented, R, NOISE, 0.0)
    assert not verdicts.inside(ONE, p, h, R + 1, NOISE, 0.0)


def test_a_number_within_the_error_it_expects():
    off, error, blur = np.array([0.1, np.nan, 0.3]), np.array([0.1, 0.1, 0.2]), np.array([0.0, 0.0, 0.1])
    assert verdicts.expected(off, error, blur)
    assert verdicts.expected(off, error, 0.9 * blur) is False
    assert verdicts.expected(off, error * np.nan, blur) is None
    assert verdicts.expected(off * np.nan, error, blur) is None


def test_digits():
    found = np.array([1.0, 1.001, 2.0, np.nan, 0.0, 1e-320, 1e-3])
    exactly = [mp.mpf(1), mp.mpf(1), mp.mpf(1), mp.mpf(1), mp.mpf(0), mp.mpf(10) ** -400, mp.mpf(0)]
    expected = [16, 3, 0, np.nan, 16, 16, 0]
    np.testing.assert_allclose(verdicts.digits(found, exactly), expected, atol=1e-12)


def test_a_long_sum_tends_to_the_endless_one():
    for function in (exact.archard, exact.demelio):
        for p in (1e-5, 0.9, 30.0):
            for limit, total in zip(function(p, 1.3, 4, math.inf), function(p, 1.3, 4, 150), strict=True):
                assert abs(limit - total) <= abs(total) * mp.mpf(10) ** -30
    for p in (1e-5, 0.9, 30.0):  # and one term is Westergaard's
        assert exact.archard(p, 1.3, 4, 1) == exact.demelio(p, 1.3, 4, 1) == exact.westergaard(p)


def test_first_touch_meets_what_the_patches_of_the_moved_profile_give():
    """Below 1e-20 p_0* the closed form is the truth, above it the patches."""
    both = [truth("patches", THREE, np.array([p])) for p in (0.9e-20, 1.1e-20)]
    # R falls by ln(1.1/0.9) between the two loads.
    assert float(both[0].resistance[0] - both[1].resistance[0]) == pytest.approx(math.log(1.1 / 0.9), rel=1e-8)
    assert float(both[0].compliance[0]) == pytest.approx(float(both[1].compliance[0]), rel=1e-12)


def test_condition_number_of_the_operator_is_that_of_its_matrix():
    values = np.abs(np.linalg.eigvalsh(circulant(influence_coefficients(16))))
    values = np.sort(values)[1:]  # that of the mean is 0
    assert operator(16) == pytest.approx(values[-1] / values[0], rel=1e-10)
    assert operator(2**20) == pytest.approx(2**20 * operator(2**10) / 2**10, rel=1e-3)
    assert system(64, 64) > system(16, 16) > 1


def raising(error):
    def solve(*arguments, **settings):
        raise error

    return solve


@pytest.fixture
def here(monkeypatch):
    """The module that examines, taking what this file raises for weier's own."""
    module = import_module("weier.accuracy.extremes.examine")
    monkeypatch.setattr(module, "PACKAGE", Path(__file__).parent)
    return module


@pytest.mark.parametrize(
    ("error", "outcome"),
    [
        (ConvergenceError("stopped at 1e-3 under p = 1: try other points"), Outcome.clear_error),
        (ValueError("p must be less, got 1"), Outcome.clear_error),
        (ConvergenceError("stopped at nan"), Outcome.unclear_error),
        (ConvergenceError(""), Outcome.unclear_error),
        (OverflowError("int too large"), Outcome.unclear_error),
    ],
)
def test_what_is_a_clear_error(here, monkeypatch, error, outcome):
    monkeypatch.setattr(here, "solve", raising(error))
    found = extremes.examine(Variant("bem", "bem", {}), ONE, np.array([0.1, 1.0]))
    assert set(found.outcome) == {outcome}
    assert found.message == f"{type(error).__name__}: {error}"


def test_what_numpy_raises_is_not_clear(here, monkeypatch):
    monkeypatch.setattr(here, "solve", lambda *arguments, **settings: np.argmax([]))
    found = extremes.examine(Variant("bem", "bem", {}), ONE, np.array([0.1]))
    assert found.outcome.tolist() == [Outcome.unclear_error]
    assert found.message.startswith("ValueError: ")


def test_a_warning_is_seen_and_a_curve_that_breaks_is_tried_load_by_load(here, monkeypatch):
    real = here.solve

    def solve(profile, loads, method, **settings):
        if loads.size > 1:
            warnings.warn("divide by zero", RuntimeWarning, stacklevel=1)
            raise ConvergenceError("together they stop")
        return real(profile, loads, method, **settings)

    monkeypatch.setattr(here, "solve", solve)
    found = extremes.examine(Variant("demelio", "demelio", {}), ONE, LOADS)
    assert found.warned == ("divide by zero",)
    assert found.message == "ConvergenceError: together they stop"
    assert set(found.outcome) == {Outcome.finite}


def test_a_planned_curve_that_expects_too_little_is_a_fault(here, monkeypatch):
    """Three waves at light loads, planned for the compliance: the resistance of a grid, with its own error."""
    real = here.solve

    def solve(*arguments, **settings):
        curve = real(*arguments, **settings)
        if "resistance_error" in curve:
            curve["resistance_error"] /= 100
        return curve

    case = Case({"D": 1.25, "gamma": "5", "m": 3, "phases": [0.0, 1.0, 2.0]}, (), {})
    some = [extremes.Extreme("light", case, np.geomspace(1e-12, 1e-4, 5), (Variant("planned", "planned", {}),))]
    assert extremes.failures(extremes.measure(some)) == []
    monkeypatch.setattr(here, "solve", solve)
    assert extremes.failures(extremes.measure(some)) == ["light, planned: not as expected"]


def small():
    """Two extremes that are no trouble, and one that is refused."""
    one, three = (Case({"D": 1.25, "gamma": "5", "m": m}, (), {}) for m in (1, 3))
    deep = Case({"D": 1.25, "gamma": "1000000", "m": 3}, (), {})
    methods = [Variant(name, name, {}) for name in ("archard", "demelio", "bem", "patches")]
    return [
        extremes.Extreme("one | wave", one, LOADS[2:], tuple(methods)),
        extremes.Extreme("three waves", three, LOADS[2:4], tuple(methods[1:3])),
        extremes.Extreme("too many", deep, LOADS[3:5], tuple(methods[2:])),
    ]


@pytest.fixture(scope="module")
def measured():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(import_module("weier.accuracy.extremes.conditioning"), "MOST_DENSE", 32)
        return extremes.measure(small())


def test_a_measurement_knows_what_was_run_and_how_well(measured):
    outcome = measured["outcome"].values
    assert (outcome != Outcome.not_run).sum(axis=2).tolist() == [[4, 4, 4, 4], [0, 2, 2, 0], [0, 0, 2, 2]]
    assert (outcome[2, 2:][outcome[2, 2:] > 0] == Outcome.clear_error).all()
    digits = measured["compliance_digits"].min("mean_pressure").values
    assert (digits[0, [0, 1, 3]] > 14).all()
    assert 1 < digits[0, 2] < 5
    assert digits[1, 1] > 14
    assert (measured["monotone"].values[0] == Verdict.yes).all()
    assert measured["monotone"].values[2, 2] == Verdict.not_measured
    assert extremes.failures(measured) == []


def test_a_fault_is_told(measured):
    bad = measured.copy(deep=True)
    bad["concave"].values[0, 0] = Verdict.no
    bad["silent"].values[1, 1] = Verdict.no
    bad["outcome"].values[0, 2][bad["outcome"].values[0, 2] > 0] = Outcome.unclear_error
    bad["together"].values[0, 3] = Verdict.no
    assert extremes.failures(bad) == [
        "one | wave, archard: not concave",
        "one | wave, bem: unclear error",
        "one | wave, patches: not as one curve",  # though each load alone is solved
        "three waves, demelio: not silent",
    ]


def test_the_data_are_by_the_conventions(measured, tmp_path):
    path = tmp_path / "extremes.nc"
    dataset.write(measured, path, "Small", "examined")
    assert complaints(checked([path], "cf:1.11", tmp_path)[str(path)]) == []
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        for variable in file.variables.values():
            assert {"long_name", "units"} <= set(variable.ncattrs())
            if variable.dtype.kind == "f":
                assert not (variable[...] < getattr(variable, "valid_min", -np.inf)).any(), variable.name
                assert not (variable[...] > getattr(variable, "valid_max", np.inf)).any(), variable.name


def test_table_figure_and_data(measured, tmp_path):
    dataset.write(measured, tmp_path / "extremes.nc", "Small", "examined")
    again = dataset.read(tmp_path / "extremes.nc")
    extremes.write_table(again, "Small", tmp_path / "extremes.md")
    text = (tmp_path / "extremes.md").read_text(encoding="utf-8")
    assert text.startswith("# Small\n\nMade by `snakemake --cores 2 extremes`")
    assert "\n8 rows, 0 of them with a fault.\n" in text
    assert text.count("clear error (1) |") == 2
    assert "1. ValueError: the finest wave must fit at most 100000 times" in text
    assert "one \\| wave" in text
    widths = {line.count(" | ") for line in text.splitlines() if line.startswith(("| one", "| three", "| too"))}
    assert widths == {len(extremes.report.HEAD) - 1}
    figures.draw("extremes", [again], "", tmp_path / "extremes.png")
    assert {path.suffix for path in tmp_path.iterdir()} == {".nc", ".md", ".png", ".pdf", ".svg"}
    with pytest.raises(ValueError, match="no digits"):
        figures.draw(
            "extremes", [again.assign(compliance_digits=again["compliance_digits"] * np.nan)], "", tmp_path / "no.png"
        )
