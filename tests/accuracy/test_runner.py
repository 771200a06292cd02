"""A variant ends in numbers, or in an error with a clear message; any other error ends the measurement."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from weier import Profile
from weier.accuracy import runner
from weier.accuracy.runner import Variant, attempt
from weier.methods import registry, westergaard
from weier.methods.curve import Curve
from weier.methods.errors import ConvergenceError
from weier.methods.method import Method

ONE, LOADS = Profile(1.25, 5, 1), np.array([1e-3, 0.1, 1.0])


@pytest.fixture
def solved(monkeypatch):
    """List a method whose solver is given, and run it; its errors count as those of weier."""
    monkeypatch.setattr(runner, "PACKAGE", Path(__file__).parent)

    def run(solve):
        monkeypatch.setattr(registry, "METHODS", (*registry.METHODS, Method("new", "new", "is tested", solve)))
        return attempt(Variant("new"), ONE, LOADS)

    return run


def raising(error):
    def solve(profile, loads):
        raise error

    return solve


@pytest.mark.parametrize("error", [ConvergenceError("stopped at 1e-3: try other points"), ValueError("p is 1")])
def test_a_clear_error_refuses_the_loads(solved, error):
    found = solved(raising(error))
    assert found.message == f"{type(error).__name__}: {error}"
    assert np.isnan(found.values).all()


@pytest.mark.parametrize("error", [ConvergenceError("stopped at nan"), ConvergenceError(""), ValueError("2 of inf")])
def test_an_error_without_a_clear_message_ends_the_measurement(solved, error):
    with pytest.raises(RuntimeError, match="without a clear message"):
        solved(raising(error))


def test_an_error_of_a_library_and_a_number_that_is_not_finite_end_the_measurement(solved):
    with pytest.raises(RuntimeError, match="without a clear message"):
        solved(lambda profile, loads: np.linalg.cholesky(-np.eye(2)))
    with pytest.raises(RuntimeError, match="not finite"):
        solved(lambda profile, loads: Curve(loads, np.inf * loads))


def test_a_warning_is_kept_and_a_curve_that_breaks_is_tried_load_by_load(solved):
    def solve(profile, loads):
        if loads.size > 1:
            warnings.warn("divide by zero", RuntimeWarning, stacklevel=1)
            raise ConvergenceError("together they stop")
        warnings.warn("overflow", RuntimeWarning, stacklevel=1)
        return Curve(westergaard.compliance(loads), westergaard.resistance(loads))

    found = solved(solve)
    assert found.warned == ("divide by zero", "overflow")
    assert found.message == "ConvergenceError: together they stop"
    assert found.solved.all()
    assert found.values[0] == pytest.approx(westergaard.compliance(LOADS), rel=1e-15)
