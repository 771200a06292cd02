"""Waves on a layer, solved without a solution nearby."""

from __future__ import annotations

import numpy as np

from weier.methods.layer.solver import POINTS
from weier.methods.layer.wave import midpoints, solve_waves


def solve_from_guesses(log_load, closure, tolerance):
    mesh = midpoints(POINTS)
    return solve_waves(log_load, np.full((log_load.size, POINTS + 1), np.nan), closure, mesh, tolerance)
