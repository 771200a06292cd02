"""The tables of the scales: what they leave below their first row, and how fine they may become."""

from __future__ import annotations

import math

import numpy as np
import pytest

from weier import ConvergenceError
from weier.methods import layer
from weier.methods.layer import fixed_point, solver, tables
from weier.methods.layer.solver import ACCURACY, POINTS, TOLERANCE
from weier.methods.layer.tables import BOTTOM_POSITIONS, MIN_LOADS


@pytest.mark.parametrize(("D", "gamma", "m"), [(1.02, 5, math.inf), (1.5, 3, 3), (1.75, 2, math.inf), (1.98, 4, 30)])
def test_what_the_tables_leave_below_their_first_row_is_not_seen(D, gamma, m):
    """The lightest load of the ordinary tables, on these and on those that begin 650 e-folds lower."""
    log_load = np.log([MIN_LOADS[0], 1e-12, 1.0])
    settings = POINTS, ACCURACY, TOLERANCE
    short, long = (solver._solve(log_load, bottom, (D, gamma, m), settings)[0] for bottom in BOTTOM_POSITIONS)
    np.testing.assert_allclose(short, long, rtol=ACCURACY)


@pytest.mark.parametrize(("limit", "least"), [("MAX_HALVINGS", 2), ("MAX_ROWS", 20)])
@pytest.mark.parametrize("m", [3, math.inf])
def test_a_table_that_misses_the_accuracy_is_refused(monkeypatch, limit, least, m):
    for module in (tables, fixed_point):
        monkeypatch.setattr(module, limit, least)
    with pytest.raises(ConvergenceError, match=r"still off by .* rows, above .*, its share of the accuracy"):
        layer.curve([0.1, 0.2], 1.25, 5, m)
