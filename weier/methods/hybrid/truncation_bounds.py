"""Bounds on the infinite series: the bounds theorem on a plain grid that resolves its first terms.

The formulas are those of docs/hybrid.md, "Bounds"; docs/closed_forms.md, "Bounds on the terms left out", proves the
theorem.
"""

from __future__ import annotations

import math

from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods import bem, error_model
from weier.methods.errors import NotApplicableError
from weier.methods.progress import reporting_to
from weier.surface.loads import checked_loads
from weier.surface.profile import Profile
from weier.theory.bounds import complete_bounds

MESH_FRACTION = 0.1  # The error of boundary elements for the bounds, over the amplitude of the tail.
# Their residual, over the same, and in g_0 at most: the tail of a gamma close to 1 is many times as high.
RESIDUAL_FRACTION, MAX_RESIDUAL = 0.01, 0.01
MAX_POINTS = 2**20  # a second per load


class TooManyPointsError(ValueError):
    """So many resolved terms take more points than there may be."""


def bounds(profile: Profile, mean_pressure: ArrayLike, terms: int) -> tuple[Array, Array]:
    """Return bounds on the compliance of the infinite series, from its first terms by boundary elements.

    The parameters are those of `weier.methods.hybrid.curve`.

    Returns
    -------
    lower, upper : ndarray, shape (loads,)
        In g_0, from 0 to full contact, h = sum g_n.

    Raises
    ------
    ValueError
        If the series is finite, or takes more than 2^20 points.
    ConvergenceError
        If boundary elements miss their tolerance.

    Notes
    -----
    They are [h_k, h_k + 2 G_k] with G_k the amplitude of the tail (27), widened by the bound on the error of boundary
    elements. The theorem is proved, and so is the error of a grid at first touch, z'' dx^2/8; that it is no larger
    under load was measured (docs/bem.md, "Bounds").
    """
    check_infinite(profile)
    kept = profile.truncated(terms)
    tail = kept.tail_amplitude
    allowed, residual = MESH_FRACTION * tail, min(RESIDUAL_FRACTION * tail, MAX_RESIDUAL)
    points = bem.error_model.fewest_points(kept, allowed)
    if points > MAX_POINTS:
        raise TooManyPointsError(f"terms must be fewer, got {terms}: {points} points are more than {MAX_POINTS}")
    loads = checked_loads(mean_pressure)
    with reporting_to():  # These loads are a part of others.
        curve = bem.curve(kept, loads, points=points, max_residual=residual, with_resistance=False, staircase="kept")
    error = bem.error_model.compliance_error(kept, points) + error_model.RESIDUAL_FACTOR * residual
    return complete_bounds(curve.compliance, tail, profile.total_amplitude, error)


def check_infinite(profile: Profile) -> None:
    """Refuse a finite series."""
    if math.isfinite(profile.m):
        raise NotApplicableError(
            f"terms are resolved on a layer for the infinite series, m = inf, got m = {profile.m}: take a method for "
            "finite series"
        )
