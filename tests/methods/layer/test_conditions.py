"""The conditions that a solved wave is checked on."""

from __future__ import annotations

import math

import numpy as np

from tests.layer_waves import solve_from_guesses
from weier.methods.layer.conditions import cosines, violation
from weier.methods.layer.rows import BOTTOM_POSITIONS
from weier.methods.layer.scales import Scaling, coarser_units, finest_wave
from weier.methods.layer.solver import ACCURACY, POINTS, TOLERANCE


def test_the_contact_conditions_see_a_wrong_state():
    finer, log_load = finest_wave(BOTTOM_POSITIONS[0], 0.0, ACCURACY).rows.closure, math.log(0.1)
    closure = coarser_units(finer, Scaling.of(1.25, 5))
    solved = solve_from_guesses(np.array([log_load]), closure, TOLERANCE)
    h = solved.compliance[0]
    assert violation(solved.state[0], log_load, closure, h, cosines(POINTS)) < 1e-12
    for component in (0, POINTS // 2, POINTS):
        wrong = solved.state[0].copy()
        wrong[component] += 0.1
        assert violation(wrong, log_load, closure, h, cosines(POINTS)) > 1e-6
