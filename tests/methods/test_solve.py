"""The public interface: what it returns, what it refuses."""

from functools import partial

import numpy as np
import pytest

import weier
from weier.methods import bem, patches, registry

PROFILE = weier.Profile(1.25, 5, 2, 1.0)
LOADS = np.array([0.01, 0.1, 1.0])
MANY_WAVES = [name for name in registry.names() if name not in ("westergaard", "hybrid")]  # a finite number of them


@pytest.mark.parametrize("method", MANY_WAVES)
def test_every_method_gives_compliance_and_resistance_over_the_loads(method):
    curve = weier.solve(PROFILE, LOADS, method)
    assert curve.compliance.dims == ("mean_pressure",)
    assert np.all(np.diff(curve.compliance) > 0)
    assert np.all(np.diff(curve.resistance) < 0)
    assert curve.solution_method == method
    assert curve.attrs["seconds"] > 0
    assert {v.attrs["units"] for v in curve.data_vars.values()} == {"1"}


@pytest.mark.parametrize("curve", [weier.solve, bem.curve, partial(bem.curve, solver="direct"), patches.curve])
@pytest.mark.parametrize(
    ("loads", "message"),
    [
        ([], "list of loads"),
        ([[1.0]], "list of loads"),
        ([0.0, 1.0], "positive, got 0.0 at position 0"),
        ([0.1, np.nan], "finite, got nan at position 1"),
        ([0.1, np.inf], "finite"),
        ([0.2, 0.1], "increase, got 0.2 before 0.1: sort the loads"),
        ([9.0, 0.1], "increase, got 9.0 before 0.1"),  # the one is known without a solver
        ([0.1, 0.1], "got 0.1 at positions 0 and 1: give each load once"),
    ],
)
def test_bad_loads_are_refused(curve, loads, message):
    with pytest.raises(ValueError, match=message):
        curve(PROFILE, loads)
