"""A variant ends in numbers, or in an error, which is judged for clarity."""

import warnings

import numpy as np
import pytest

from weier import Profile
from weier.accuracy.runner import Outcome, Variant, attempt
from weier.methods import registry, westergaard
from weier.methods.curve import Curve
from weier.methods.errors import ConvergenceError
from weier.methods.method import Method


def solve_first_wave(profile, loads, factor: float = 1.0):
    """The compliance of the first wave alone, times a factor."""
    return Curve(factor * westergaard.compliance(loads), factor * westergaard.resistance(loads))


def raising(error):
    """A method that raises an error."""

    def solve(profile, loads):
        raise error

    return Method("raising", "raising", "raises an error", solve)


ONE, LOADS = Profile(1.25, 5, 1), np.array([1e-3, 0.1, 1.0])


@pytest.fixture
def listed(monkeypatch):
    """List a method, and return its only variant."""

    def listing(method):
        monkeypatch.setattr(registry, "METHODS", (*registry.METHODS, method))
        return Variant(method.name)

    return listing


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
def test_what_is_a_clear_error(listed, error, outcome):
    found = attempt(listed(raising(error)), ONE, LOADS)
    assert set(found.outcome) == {outcome}
    assert found.message == f"{type(error).__name__}: {error}"
    assert np.isnan(found.values).all()


def test_a_time_limit_is_no_result(listed):
    with pytest.raises(TimeoutError):
        attempt(listed(raising(TimeoutError())), ONE, LOADS)


def test_a_warning_is_kept_and_a_curve_that_breaks_is_tried_load_by_load(listed):
    def solve(profile, loads):
        if loads.size > 1:
            warnings.warn("divide by zero", RuntimeWarning, stacklevel=1)
            raise ConvergenceError("together they stop")
        warnings.warn("overflow", RuntimeWarning, stacklevel=1)
        return solve_first_wave(profile, loads)

    breaking = Method("breaking", "breaking", "one load at a time", solve)
    found = attempt(listed(breaking), ONE, LOADS)
    assert found.warned == ("divide by zero", "overflow")
    assert found.message == "ConvergenceError: together they stop"
    assert set(found.outcome) == {Outcome.finite}
    assert found.values[0] == pytest.approx(westergaard.compliance(LOADS), rel=1e-15)
