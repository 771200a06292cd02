"""Estimate of the infinite series from its first terms, with bounds.

The formulas are those of docs/hybrid.md: "The equations" and "Bounds"; "Error and limits" has the grid.
docs/closed_forms.md, "Bounds on the terms left out", proves the bounds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.kernels.blas import one_thread
from weier.methods import bem
from weier.methods.bem.error_model import fewest_points
from weier.methods.errors import ConvergenceError, NotApplicableError, OutOfReachError
from weier.methods.hybrid.closure import MAX_LOAD, closure_at_nodes
from weier.methods.hybrid.newton import solve_loads
from weier.methods.progress import converting, reporting_to
from weier.surface.loads import checked_loads
from weier.surface.profile import Profile
from weier.theory.bounds import complete_bounds
from weier.theory.halfplane import influence_coefficients

# least number of points per finest resolved wave: the error is 0.9/32^2 of its amplitude, since the layer smooths the
# contact edges (tests/methods/hybrid/test_solver.py)
POINTS_PER_WAVE = 32
MESH_FRACTION = 0.1  # error of both meshes over the amplitude of the tail, which is the error that a user sees
MAX_TOLERANCE = 1.0  # g_0: the tail of a gamma close to 1 is many times as high
MAX_POINTS = 2**14  # More points take minutes.
MIN_LOAD = 1e-6  # p_0*; lighter loads displace the surface by less than the residual


class HybridCurve(NamedTuple):
    """Curve of the infinite series; arrays of shape (loads,).

    compliance : estimate of h clipped to its bounds, in g_0
    resistance : dh/dp of the estimate, in g_0/p_0*
    compliance_lower, compliance_upper : bounds on h from the resolved terms alone (27), widened by the bound on the
        error of boundary elements
    residual : largest violation of the equations, in g_0
    """

    compliance: Array
    resistance: Array
    compliance_lower: Array
    compliance_upper: Array
    residual: Array

    @property
    def distance_to_bounds(self) -> Array:
        """The distance of the estimate to the farther of its bounds, in g_0."""
        return np.maximum(self.compliance_upper - self.compliance, self.compliance - self.compliance_lower)


@one_thread
def curve(profile: Profile, mean_pressure: ArrayLike, terms: int, points: int | None = None) -> HybridCurve:
    """Solve the infinite series with its first terms resolved; return estimate and bounds.

    Parameters
    ----------
    profile : Profile
        With m = inf.
    mean_pressure : array_like, shape (loads,)
        Increasing mean pressures, in p_0*.
    terms : int
        Number of terms to resolve, at least 1.
    points : int, optional
        Nodes per period; by default `POINTS_PER_WAVE` for each of the finest resolved waves, more if the error of the
        mesh would exceed a tenth of the tail.

    Returns
    -------
    HybridCurve
        Arrays over the loads.

    Raises
    ------
    ValueError
        If the series is finite, or takes too many points; NotApplicableError if a load is too light or too heavy.
    ConvergenceError
        If Newton's method stops short of its tolerance.
    """
    check_infinite(profile)
    kept, loads = profile.truncated(terms), checked_loads(mean_pressure)
    points = checked_points(kept, points)
    outside = (loads < MIN_LOAD) | (loads > MAX_LOAD)
    if outside.any():
        raise NotApplicableError(
            f"mean_pressure must lie in [{MIN_LOAD:g}, {MAX_LOAD:g}] p_0* where terms are resolved on the layer, got "
            f"{loads[outside][0]:g}: take another method for the infinite series"
        )
    closure = closure_at_nodes(kept, float(influence_coefficients(points, kept.period)[0]))
    h, R, residual = solve_loads(kept, loads, points, closure)
    lower, upper = bounds(profile, loads, terms)
    return HybridCurve(np.clip(h, lower, upper), R, lower, upper, residual)


def checked_points(kept: Profile, points: int | None = None) -> int:
    """Return the number of nodes for these terms, given or by default; ValueError if it is too large."""
    points = bem.checked_points(kept, points or default_points(kept))
    if points > MAX_POINTS:
        raise ValueError(f"terms must be fewer, got {kept.m}, which take {points} points, more than {MAX_POINTS}")
    return points


def default_points(kept: Profile) -> int:
    """Return the number of nodes for which the error of the mesh is small against the height of the layer."""
    finest = kept.waves_per_period[-1]
    least, most = POINTS_PER_WAVE * finest, MAX_POINTS // finest * finest
    # With more terms the least number is refused, and the height of the layer may vanish.
    return least if least > most else max(least, min(fewest_points(kept, MESH_FRACTION * kept.tail_amplitude), most))


def bounds(profile: Profile, mean_pressure: ArrayLike, terms: int) -> tuple[Array, Array]:
    """Return bounds on the compliance of the infinite series, from its first terms by boundary elements.

    The parameters are those of `curve`.

    Returns
    -------
    lower, upper : ndarray, shape (loads,)
        In g_0, from 0 to full contact, h = sum g_n.

    Raises
    ------
    ValueError
        If the series is finite; OutOfReachError if the terms take too many points.
    ConvergenceError
        If boundary elements miss their tolerance.
    """
    check_infinite(profile)
    kept, loads = profile.truncated(terms), checked_loads(mean_pressure)
    tolerance = min(MESH_FRACTION * kept.tail_amplitude, MAX_TOLERANCE)
    try:
        with reporting_to(), converting(lambda curve: None):  # These loads are a part of others.
            solved = bem.curve(kept, loads, *bem.grid(kept, tolerance), with_resistance=False, staircase="kept")
    except OutOfReachError as error:
        raise OutOfReachError(
            f"terms must be fewer, got {terms}: their bounds take more points than boundary elements solve"
        ) from error
    except ConvergenceError as error:
        raise ConvergenceError(
            f"the bounds from {terms} resolved terms stopped at a residual of {error.residual:.1e} g_0: resolve "
            "fewer terms",
            error.residual,
        ) from error
    return complete_bounds(solved.compliance, kept.tail_amplitude, profile.total_amplitude, solved.compliance_error)


def check_infinite(profile: Profile) -> None:
    """Refuse a finite series."""
    if math.isfinite(profile.m):
        raise NotApplicableError(
            f"terms are resolved on a layer for the infinite series, m = inf, got m = {profile.m}: take a method for "
            "finite series"
        )
