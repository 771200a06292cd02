"""Waves on a layer, solved without a solution nearby."""

from __future__ import annotations

from weier.methods.layer.solver import POINTS
from weier.methods.layer.wave import midpoints, solve_waves


def solve_from_guesses(log_load, closure, tolerance):
    return solve_waves(log_load, closure, midpoints(POINTS), tolerance)
