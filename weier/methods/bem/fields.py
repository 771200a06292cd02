"""Pressure, gap and displacement under one load, node by node (docs/bem.md, "The discrete problem")."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem.active_set import NestedSolver
from weier.methods.bem.grids import full_contact_pressure
from weier.methods.bem.solver import RESIDUAL, check_residual, checked_points, full_contact_load
from weier.surface.loads import checked_load
from weier.surface.waves import Waves


class Field(NamedTuple):
    """Fields at the nodes of one period, each of shape (points,): x in lambda_0, pressure in p_0*, lengths in g_0.

    The displacement is that of the half-plane, into the body, with a mean of 0.
    """

    x: Array
    pressure: Array
    gap: Array
    displacement: Array


def field(profile: Waves, mean_pressure: float, points: int | None = None, max_residual: float = RESIDUAL) -> Field:
    """Return fields of a truncated series under one mean pressure, in p_0*, by boundary elements.

    The staircase is kept: the values are those of the nodes. Parameters are those of `curve`.

    Raises
    ------
    ValueError
        If the load is not one positive number, or `points` are too few for the finest wave.
    ConvergenceError
        If the solution leaves a larger residual.

    """
    load = checked_load(mean_pressure)
    points = checked_points(profile, points)
    x = np.linspace(0.0, profile.period, points, endpoint=False)
    height = profile.sampled_height(points)
    # In full contact there is a closed form; the numerical solution at very heavy loads would be rounding.
    if load >= min(full_contact_load(profile, points), profile.full_contact_load):
        return Field(x, load + full_contact_pressure(height, profile.period), np.zeros(points), height)
    grid = NestedSolver(profile, points, max_residual)
    plane = grid.solve(load)
    check_residual(grid.residual, load, points, max_residual)
    deformed = grid.state.deformed
    return Field(x, grid.state.pressure, plane - deformed, height - deformed)
