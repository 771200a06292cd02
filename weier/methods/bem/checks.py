"""What may be asked of boundary elements, and what their solutions must meet before they are returned."""

from __future__ import annotations

import math

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.theory.arguments import checked_number, shown
from weier.theory.limits import check_points, check_resolvable
from weier.theory.waves import Waves

POINTS_PER_WAVE = {"subgrid": 32, "nodes": 64}  # of the finest wave, by default: docs/subgrid.md says why
MIN_POINTS_PER_WAVE = {"subgrid": 16, "nodes": 3}  # fewer were not measured; fewer do not show the wave


def checked_edges(edges: str | None, solver: str) -> str:
    """Where the edges of contact stand, "subgrid" or "nodes": as asked, or as this solver has them unless told.

    Raises
    ------
    ValueError
        If the solver is unknown, or such edges are, or it does not have them.

    """
    if solver not in ("fft", "direct"):
        raise ValueError(f'solver must be "fft" or "direct", got {solver!r}')
    if edges not in (None, "nodes", "subgrid"):
        raise ValueError(f'edges must be "nodes" or "subgrid", got {edges!r}')
    if edges == "subgrid" and solver != "fft":
        raise ValueError(f'edges="subgrid" takes solver="fft", got {solver!r}; edges="nodes" takes any solver')
    return edges or ("subgrid" if solver == "fft" else "nodes")


def checked_points(
    profile: Waves, points: int | None = None, edges: str = "nodes", points_per_wave: int | None = None
) -> int:
    """Points in one period: so many, or so many for each of the finest waves, or the default.

    Raises
    ------
    ValueError
        If there are no more than two points a wave, with edges "subgrid" fewer than 16, or too many for a computer;
        or if both numbers are given.

    """
    check_resolvable(profile)
    finest = profile.waves_per_period[-1]
    if points is None:
        return _checked_points_per_wave(points_per_wave, edges) * finest
    if points_per_wave is not None:
        raise ValueError(
            f"points_per_wave must be left out where there are points, got {shown(points_per_wave)} beside "
            f"points = {shown(points)}: give one of the two"
        )
    default = POINTS_PER_WAVE[edges] * finest
    condition = (
        f"be a whole number above {2 * finest}, two for each of the {finest} finest waves in a period "
        f"({default} is the default)"
    )
    count = checked_number("points", points, condition, lambda count: count > 2 * finest and count == count // 1)
    check_points(count)
    fewest = MIN_POINTS_PER_WAVE[edges] * finest
    if edges == "subgrid" and count < fewest:
        raise ValueError(
            f"points must be at least {fewest}, {MIN_POINTS_PER_WAVE[edges]} for each of the {finest} finest waves "
            f'in a period, for edges of contact between the nodes, got {count:.0f}; edges="nodes" takes any grid'
        )
    return int(count)


def _checked_points_per_wave(count: int | None, edges: str) -> int:
    if count is None:
        return POINTS_PER_WAVE[edges]
    fewest = MIN_POINTS_PER_WAVE[edges]
    condition = (
        f'be a whole number of at least {fewest} with edges="{edges}" ({POINTS_PER_WAVE[edges]} is the default)'
    )
    return int(checked_number("points_per_wave", count, condition, lambda n: n >= fewest and n == n // 1))


def check_tolerance(tolerance: float) -> None:
    """Refuse a tolerance, in g_0, that is no positive number.

    Raises
    ------
    ValueError
        If it is not.

    """
    checked_number("tolerance", tolerance, "be a positive length in g_0, such as 1e-10", lambda t: 0 < t < math.inf)


def check_residual(residual: Array, loads: Array, points: int, tolerance: float) -> None:
    """Refuse a solution with a residual above the tolerance, in g_0, or without one.

    Raises
    ------
    ConvergenceError
        With the first such residual and its load.

    """
    missed = np.flatnonzero(~(residual <= tolerance))
    if missed.size:
        worst = missed[0]
        raise ConvergenceError(
            f"boundary elements on {points} points stopped at a residual of {residual[worst]:.1e} g_0 under the mean "
            f"pressure {loads[worst]:.6g} p_0*, above the tolerance {tolerance:.1e}; try other points or a larger "
            "residual_tolerance",
            float(residual[worst]),
        )


def check_resistance(resistance: Array, loads: Array, points: int) -> None:
    """Refuse a resistance that the solver gave up, which it says by inf."""
    missed = np.flatnonzero(np.isinf(resistance))
    if missed.size:
        raise ConvergenceError(
            f"boundary elements on {points} points found the compliance but not the resistance under the mean "
            f"pressure {loads[missed[0]]:.6g} p_0*; try other points, or resistance=False",
            np.inf,
        )
