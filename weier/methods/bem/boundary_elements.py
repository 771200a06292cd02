"""Declare the method of boundary elements."""

from __future__ import annotations

import math
from typing import Any

from weier.checks import checked_count, checked_word
from weier.kernels.arrays import Array
from weier.methods.bem import stated_errors
from weier.methods.bem.loading_curve import POINTS_PER_WAVE, RESIDUAL, STAIRCASES, curve, with_errors
from weier.methods.curve import Curve
from weier.methods.error_model import RESIDUAL_FACTOR
from weier.methods.errors import OutOfReachError
from weier.methods.method import CURVE_SECONDS, TOLERANCES, Method, Range, Setting, Style, applies_to_resolvable
from weier.surface.limits import check_points, check_resolvable
from weier.surface.profile import Profile
from weier.surface.waves import MAX_POINTS, Waves

MIN_POINTS_PER_WAVE = 3  # a wave is resolved by more than two points
RESIDUAL_FRACTION = 1e-3  # fraction of the tolerance; the grid takes the rest, which costs a step or two
# g_0: rounding leaves some 1e-18 a node (1e-14 on 10 000, 1e-13 on 100 000), so 3e-12 on `stated_errors.MAX_POINTS`
MIN_RESIDUAL = 1e-11


def _solve(
    profile: Waves,
    loads: Array,
    tolerance: float | None = None,
    points_per_wave: int | None = None,
    staircase: str = "removed",
) -> Curve:
    points, residual = grid(profile, tolerance, points_per_wave)
    return curve(profile, loads, points, residual, staircase=staircase)


def grid(profile: Waves, tolerance: float | None = None, points_per_wave: int | None = None) -> tuple[int, float]:
    """Return the points per period and the residual: with a tolerance, in g_0, the fewest whose bound is within it.

    ValueError is raised if points are given, too; OutOfReachError if too many are needed.
    """
    if tolerance is None:
        return _points(profile, points_per_wave), RESIDUAL
    if points_per_wave is not None:
        raise ValueError("a grid takes tolerance or points_per_wave, and not both")
    found, least = points_within(profile, tolerance), RESIDUAL_FACTOR * MIN_RESIDUAL
    if math.isinf(found):
        raise OutOfReachError(
            f"the tolerance of boundary elements must exceed {least:g} g_0, the rounding of fine grids, got "
            f'{tolerance:g}: take a larger tolerance or the method "patches"'
        )
    if found > stated_errors.MAX_POINTS:
        raise OutOfReachError(
            f"boundary elements need {found:.2g} points for a tolerance of {tolerance:g} g_0, more than "
            f'{stated_errors.MAX_POINTS}: take a larger tolerance or the method "patches"'
        )
    return int(found), _residual_within(tolerance)


def _points(profile: Waves, points_per_wave: int | None) -> int:
    per_wave = POINTS_PER_WAVE if points_per_wave is None else points_per_wave
    check_resolvable(profile)
    return checked_count("points_per_wave", per_wave, MIN_POINTS_PER_WAVE) * profile.waves_per_period[-1]


def points_within(profile: Waves, tolerance: float) -> float:
    """Return the fewest points per period whose bound meets a tolerance, in g_0; inf if rounding prevents it."""
    error = tolerance - RESIDUAL_FACTOR * _residual_within(tolerance)
    return stated_errors.fewest_points(profile, error) if error > 0 else math.inf


def _residual_within(tolerance: float) -> float:
    return max(RESIDUAL_FRACTION * tolerance, MIN_RESIDUAL)


def within_few_points(profile: Waves, tolerance: float) -> bool:
    """Return whether a grid no finer than the default meets a tolerance, in g_0."""
    few = min(POINTS_PER_WAVE * profile.waves_per_period[-1], stated_errors.MAX_POINTS)
    return points_within(profile, tolerance) <= few


def _check(profile: Waves, staircase: str = "removed", **settings: Any) -> None:
    """Refuse settings that exclude each other, or a grid that does not resolve the finest wave."""
    checked_word("staircase", staircase, STAIRCASES)
    check_points(grid(profile, **settings)[0])


def points_of(
    profile: Waves, tolerance: float | None = None, points_per_wave: int | None = None, **others: Any
) -> float:
    """Return the number of points per period that the settings give."""
    return _points(profile, points_per_wave) if tolerance is None else points_within(profile, tolerance)


def _run_kernels() -> None:
    """Solve with edges on nodes."""
    curve(Profile(D=1.25, gamma=2, m=2), [0.1, 1.0], staircase="kept")


METHOD = Method(
    name="bem",
    label="boundary elements",
    summary="accelerated boundary elements (5.1) with sub-grid contact edges; finite m",
    solve=_solve,
    returns=(
        "compliance_error",
        "resistance_error",
        "contact_fraction",
        "patch_count",
        "residual",
        "work",
        "contact_edge",
        "points",
    ),
    settings={
        "tolerance": Setting(
            None,
            f"accepted error of the compliance, in g_0, above {RESIDUAL_FACTOR * MIN_RESIDUAL:g}; "
            'it sets the points, and bounds R poorly: for this use patches, or auto with quantity="resistance"',
            TOLERANCES,
        ),
        "points_per_wave": Setting(
            None, f"nodes per finest wave, {POINTS_PER_WAVE} by default", Range(MIN_POINTS_PER_WAVE, MAX_POINTS)
        ),
        "staircase": Setting(
            "removed",
            '"removed" for sub-grid contact edges, or "kept" for edges on nodes (Section 5.1)',
            STAIRCASES,
        ),
    },
    chosen=lambda given: {} if given.get("tolerance") else {"points_per_wave": POINTS_PER_WAVE},
    takes_traces=True,
    applies=applies_to_resolvable,
    numerical=True,
    in_paper=True,
    style=Style("#000000", (), "o"),
    seconds=lambda profile, loads, **settings: (
        CURVE_SECONDS + 1.6e-7 * loads.size * points_of(profile, **settings) ** 1.25
    ),
    check=_check,
    by_load=lambda **settings: True,
    complete=with_errors,
    run_kernels=_run_kernels,
)
