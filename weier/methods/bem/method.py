"""Boundary elements as one of the methods."""

from __future__ import annotations

import math
from typing import Any

from weier.kernels.arrays import Array
from weier.methods.bem import error_model
from weier.methods.bem.solver import POINTS_PER_WAVE, RESIDUAL, BemCurve, check_words, checked_points, curve
from weier.methods.error_model import RESIDUAL_FACTOR
from weier.methods.errors import OutOfReachError
from weier.methods.method import Method, Style, applies_to_resolvable
from weier.surface.limits import check_points
from weier.surface.waves import Waves

RESIDUAL_FRACTION = 1e-3  # of the tolerance; the rest is for the error of the grid, at the cost of a step or two
# g_0: rounding leaves some 1e-18 a node (1e-14 on 10 000, 1e-13 on 100 000), so 3e-12 on `error_model.MAX_POINTS`
MIN_RESIDUAL = 1e-11
# seconds per load on few points, and their growth (docs/numerics.md, "Expected seconds")
SECONDS_LOAD, TIMED_POINTS, POINTS_POWER = 6e-5, 300, 1.4


def _solve(
    profile: Waves,
    loads: Array,
    tolerance: float | None = None,
    points_per_wave: int | None = None,
    points: int | None = None,
    staircase: str = "removed",
    solver: str = "fft",
    with_resistance: bool = True,
) -> BemCurve:
    residual = RESIDUAL
    if tolerance is not None:
        points, residual = _grid_within(profile, tolerance, points, points_per_wave)
    return curve(profile, loads, solver, points, residual, with_resistance, staircase, points_per_wave)


def _grid_within(
    profile: Waves, tolerance: float, points: int | None = None, points_per_wave: int | None = None
) -> tuple[int, float]:
    """Return the least number of points whose bound is within a tolerance, in g_0, and the residual in this bound.

    ValueError is raised if points are given, too; OutOfReachError if too many are needed.
    """
    if points is not None or points_per_wave is not None:
        raise ValueError("a grid takes tolerance, points or points_per_wave, and no two of them")
    found, least = points_within(profile, tolerance), RESIDUAL_FACTOR * MIN_RESIDUAL
    if math.isinf(found):
        raise OutOfReachError(
            f"the tolerance of boundary elements must exceed {least:g} g_0, the rounding of fine grids, got "
            f'{tolerance:g}: take a larger tolerance or the method "patches"'
        )
    if found > error_model.MAX_POINTS:
        raise OutOfReachError(
            f"boundary elements need {found:.2g} points for a tolerance of {tolerance:g} g_0, more than "
            f'{error_model.MAX_POINTS}: take a larger tolerance or the method "patches"'
        )
    return int(found), _residual_within(tolerance)


def points_within(profile: Waves, tolerance: float) -> float:
    """Return the least number of points per period whose bound is within a tolerance, in g_0; inf by rounding."""
    error = tolerance - RESIDUAL_FACTOR * _residual_within(tolerance)
    return error_model.fewest_points(profile, error) if error > 0 else math.inf


def _residual_within(tolerance: float) -> float:
    return max(RESIDUAL_FRACTION * tolerance, MIN_RESIDUAL)


def within_few_points(profile: Waves, tolerance: float) -> bool:
    """Return whether a grid no finer than the default meets a tolerance, in g_0."""
    few = min(POINTS_PER_WAVE * profile.waves_per_period[-1], error_model.MAX_POINTS)
    return points_within(profile, tolerance) <= few


def _check(
    profile: Waves,
    solver: str = "fft",
    staircase: str = "removed",
    points: int | None = None,
    points_per_wave: int | None = None,
    tolerance: float | None = None,
    **others: Any,
) -> None:
    """Refuse settings that exclude each other, or a grid that does not resolve the finest wave."""
    check_words(solver, staircase)
    if tolerance is not None:
        points, _ = _grid_within(profile, tolerance, points, points_per_wave)
    check_points(checked_points(profile, points, points_per_wave), solver == "direct")


def points_of(
    profile: Waves,
    tolerance: float | None = None,
    points_per_wave: int | None = None,
    points: int | None = None,
    **settings: Any,
) -> float:
    """Return the points in a period by the settings."""
    if tolerance is not None:
        return points_within(profile, tolerance)
    return checked_points(profile, points, points_per_wave)


def _seconds(profile: Waves, loads: Array, **settings: Any) -> float:
    """Return expected seconds of a curve by FFTs."""
    return SECONDS_LOAD * loads.size * (1 + (points_of(profile, **settings) / TIMED_POINTS) ** POINTS_POWER)


METHOD = Method(
    name="bem",
    label="boundary elements",
    summary="accelerated boundary elements (5.1) with sub-grid contact edges; finite m",
    solve=_solve,
    settings={
        "tolerance": f"accepted error of the compliance, in g_0, above {RESIDUAL_FACTOR * MIN_RESIDUAL:g}; "
        'it sets the points, and bounds R poorly: for this use patches, or auto with quantity="resistance"',
        "points_per_wave": f"nodes per finest wave, {POINTS_PER_WAVE} by default",
        "points": "nodes per period, instead of points_per_wave",
        "staircase": '"removed" for sub-grid contact edges, or "kept" for edges on nodes (Section 5.1)',
        "solver": '"fft", or "direct" for the dense inversion of Section 5.1',
        "with_resistance": "whether to compute the resistance",
    },
    applies=applies_to_resolvable,
    numerical=True,
    style=Style("#000000", (), "o"),
    seconds=_seconds,
    check=_check,
)
