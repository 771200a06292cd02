"""The conditions that a solved wave is checked on."""

from __future__ import annotations

import numpy as np

from tests.layer_waves import solve_from_guesses
from weier.methods.layer.conditions import violations
from weier.methods.layer.scales import Scaling, coarser_units, finest_wave
from weier.methods.layer.solver import ACCURACY, POINTS, TOLERANCE
from weier.methods.layer.tables import BOTTOM_POSITIONS


def test_the_contact_conditions_see_a_wrong_state():
    finer, log_load = finest_wave(BOTTOM_POSITIONS[0], ACCURACY).rows.closure, np.log([0.1])
    closure = coarser_units(finer, Scaling.of(1.25, 5))
    solved = solve_from_guesses(log_load, closure, TOLERANCE)
    assert violations(solved.state, log_load, closure, solved.compliance) < 1e-12
    for component in (0, POINTS // 2, POINTS):
        wrong = solved.state.copy()
        wrong[0, component] += 0.1
        assert violations(wrong, log_load, closure, solved.compliance) > 1e-6
