"""Tables, and scale by scale to the infinite series: how fine and how many they may become."""

from __future__ import annotations

import math

import numpy as np
import pytest

from weier import ConvergenceError, Profile
from weier.methods import layer
from weier.methods.layer import fixed_point, layer_curve, scaling_tables
from weier.methods.layer.layer_curve import ACCURACY, POINTS, _may_be_infinite
from weier.methods.layer.scales import model_of
from weier.methods.layer.scaling_tables import BOTTOM_POSITIONS, MAX_POSITION, MIN_LOADS
from weier.surface.series import tail_amplitude


@pytest.mark.parametrize(("D", "gamma", "m"), [(1.02, 5, math.inf), (1.5, 3, 3), (1.75, 2, math.inf), (1.98, 4, 30)])
def test_what_the_tables_leave_below_their_first_row_is_not_seen(D, gamma, m):
    """The lightest load of the ordinary tables, on these and on those that begin 650 e-folds lower."""
    loads = np.array([MIN_LOADS[0], 1e-12, 1.0])
    model = model_of(D, gamma, m, POINTS, ACCURACY)
    short, long = (layer_curve._solve(loads, bottom, MAX_POSITION, model)[0] for bottom in BOTTOM_POSITIONS)
    np.testing.assert_allclose(short, long, rtol=ACCURACY)


@pytest.mark.parametrize(("limit", "least"), [("MAX_HALVINGS", 2), ("MAX_ROWS", 20)])
@pytest.mark.parametrize("m", [3, math.inf])
def test_a_table_that_misses_the_accuracy_is_refused(monkeypatch, limit, least, m):
    for module in (scaling_tables, fixed_point):
        monkeypatch.setattr(module, limit, least)
    with pytest.raises(ConvergenceError, match=r"still off by .* rows, above .*, its part of the accuracy"):
        layer.curve(Profile(1.25, 5, m), [0.1, 0.2])


def test_scales_one_by_one_reach_the_infinite_series():
    """So many terms that the tail is below the accuracy, and too few to be taken for infinite."""
    D, gamma, m = 1.75, 2, 110
    model = model_of(D, gamma, m, POINTS, ACCURACY)
    assert not _may_be_infinite(BOTTOM_POSITIONS[0], model)
    loads = np.array([1e-12, 1e-6, 1e-3, 0.1, 1.0, 3.6])
    tail = tail_amplitude(m, D, gamma)
    finite, infinite = (layer.curve(Profile(D, gamma, terms), loads).compliance for terms in (m, math.inf))
    print(f"D = {D}, gamma = {gamma}: {np.abs(finite / infinite - 1).max():.1e} apart, the tail is {tail:.1e} g_0")
    assert np.all(np.abs(infinite - finite) <= tail + ACCURACY * infinite)


def test_too_many_scales_are_refused():
    with pytest.raises(ConvergenceError, match=r"errors of the layer model add up over .* scales") as refused:
        layer.curve(Profile(1.9999999, 1.01, math.inf), [0.1])
    assert refused.value.residual > ACCURACY
    with pytest.raises(ConvergenceError, match="a series of 5000 terms still differs from the infinite one"):
        layer.curve(Profile(1.999, 2, 5000), [0.1])
