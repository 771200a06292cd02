"""Tables, and scale by scale to the infinite series: how fine and how many they may become."""

from __future__ import annotations

import math

import numpy as np
import pytest

from weier import ConvergenceError, Profile
from weier.methods import layer
from weier.methods.layer import fixed_point, nonlinear_layer, scaling_tables
from weier.methods.layer.nonlinear_layer import ACCURACY, POINTS
from weier.methods.layer.scales import model_of
from weier.methods.layer.scaling_tables import BOTTOM_POSITIONS, MIN_LOADS


@pytest.mark.parametrize(("D", "gamma", "m"), [(1.02, 5, math.inf), (1.5, 3, 3), (1.98, 4, 12)])
def test_what_the_tables_leave_below_their_first_row_is_not_seen(D, gamma, m):
    """The lightest load of the ordinary tables, on these and on those that begin 650 e-folds lower."""
    loads = np.array([MIN_LOADS[0], 1e-12, 1.0])
    model = model_of(D, gamma, m, POINTS, ACCURACY)
    short, long = (nonlinear_layer._solve(loads, bottom, model)[0] for bottom in BOTTOM_POSITIONS)
    np.testing.assert_allclose(short, long, rtol=ACCURACY)


def test_the_steepest_cubic_between_two_rows_is_flat_in_the_middle():
    """3 x - 6 x^2 + 4 x^3: with steeper ends it would fall."""
    closure = scaling_tables.closure_from_table(np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.array([3.5, 9.0]))
    x = np.linspace(0, 1, 5)
    np.testing.assert_allclose(closure.cubics(x), 3 * x - 6 * x**2 + 4 * x**3, atol=1e-15)


def test_a_kink_at_which_the_value_agrees_by_chance_is_found_by_the_slope():
    """The cubic of (x - 1/4)+ on one cell is right in the middle; its slope is off by 1/8, which counts as 1/64."""

    def waves(x, _):
        return scaling_tables.Rows(x, np.maximum(x - 0.25, 0), 1.0 * (x >= 0.25), np.empty((x.size, 0)))

    coarse, fine = (scaling_tables.tabulate(waves, np.array([0.0, 1.0]), part / 128) for part in (1.01, 0.99))
    assert coarse.position.tolist() == [0.0, 0.5, 1.0]
    assert 0.25 in fine.position


@pytest.mark.parametrize(
    ("m", "name", "limit", "says"),
    [
        (3, "MAX_ROWS", 40, "still off by .* rows, above .*, its part of the accuracy"),
        (math.inf, "MAX_ROWS", 40, "still off by .* rows, above .*, its part of the accuracy"),
        (math.inf, "MAX_STEPS", 3, "D = 1.25 and gamma = 5 still changes by .*: choose"),
    ],
)
def test_a_table_that_misses_the_accuracy_is_refused(monkeypatch, m, name, limit, says):
    for module in (scaling_tables, fixed_point):
        monkeypatch.setattr(module, name, limit, raising=False)
    with pytest.raises(ConvergenceError, match=says):
        layer.curve(Profile(1.25, 5, m), [0.1, 0.2])


def test_too_many_scales_are_refused():
    for D, gamma in ((1.9999, 5), (1.25, 1.0002)):
        with pytest.raises(ConvergenceError, match=r"add up over [56]\d{3} scales for D = .*, and 5000 are the most"):
            layer.curve(Profile(D, gamma, math.inf), [0.1])
    with pytest.raises(ConvergenceError, match="a series of 6000 terms still differs from the infinite one"):
        layer.curve(Profile(1.999, 2, 6000), [0.1])
