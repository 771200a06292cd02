"""Curves over the loads, with the contact edges along them, and single loads."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from weier.kernels.blas import one_thread
from weier.methods.patches.fields import State
from weier.methods.patches.march import solutions
from weier.methods.patches.solution import Solution, solution
from weier.methods.patches.surface import Surface, surface_of
from weier.theory.loads import checked_loads
from weier.theory.profile import Profile

Array = NDArray[np.float64]

TOLERANCE = 1e-10
LEAST_LOAD = 1e-300  # in p_0*: squares of half-widths underflow below it


class Curve(NamedTuple):
    """Exact curves over the loads, each of shape (loads,).

    compliance : h, in g_0, from the profile whose waves all peak together
    indentation : the same from first contact, in g_0, with full relative accuracy at light loads
    resistance : dh/dp, in g_0/p_0*
    contact_fraction : length in contact per length
    patch_count : contacts in one period; 0 in full contact
    residual : largest violation of a contact condition, on a freshly evaluated operator, in g_0
    work : Newton steps
    contact_edge : left and right edge of each contact in turn, shape (loads, edges), in lambda_0; padded with NaN
    """

    compliance: Array
    indentation: Array
    resistance: Array
    contact_fraction: Array
    patch_count: NDArray[np.int64]
    residual: Array
    work: NDArray[np.int64]
    contact_edge: Array


@one_thread
def curve(profile: Profile, mean_pressure: ArrayLike, tolerance: float = TOLERANCE) -> Curve:
    """Compliance and resistance of a truncated series by contact patches.

    Parameters
    ----------
    profile : Profile
        With a finite number of terms.
    mean_pressure : array_like, shape (loads,)
        Increasing, positive, in p_0*.
    tolerance : float
        Relative size of the last Newton step and of the last Chebyshev coefficients.

    Returns
    -------
    Curve
        Arrays over the loads.

    Raises
    ------
    ValueError
        If the loads are not increasing from 1e-300 or above, the tolerance is not within reach, or the waves are
        too many.
    ConvergenceError
        If a load cannot be solved, or its solution fails a check.

    Notes
    -----
    Chebyshev collocation of the singular integral equation on every contact, whose edges are unknowns, or on every
    gap where that takes fewer nodes. The error falls exponentially with the nodes.

    """
    loads = loads_within_reach(mean_pressure)
    check_tolerance(tolerance)
    seen = surface_of(profile)
    rows, contacts = np.empty((loads.size, 7)), []
    for i, (state, steps) in enumerate(solutions(profile, seen, loads, tolerance)):
        rows[i] = *_measures(seen, state), steps
        contacts.append(solution(seen, state, loads[i]).edges)
    compliance, indentation, resistance, fraction, count, miss, work = rows.T
    return Curve(
        compliance,
        indentation,
        resistance,
        fraction,
        count.astype(np.int64),
        miss,
        work.astype(np.int64),
        _padded(contacts),
    )


def _padded(contacts: list[Array]) -> Array:
    table = np.full((len(contacts), max(edges.size for edges in contacts)), np.nan)
    for row, edges in zip(table, contacts, strict=True):
        row[: edges.size] = edges.ravel()
    return table


def _measures(seen: Surface, state: State | None) -> tuple[float, float, float, float, int, float]:
    """Compliance, indentation, resistance, contact fraction, patches, residual; of full contact for None."""
    total, top = seen.total_amplitude, seen.heights.top
    if state is None:
        return total, top, 0.0, 1.0, 0, 0.0
    share = float(2 * state.segments.half_width.sum() / seen.heights.period)
    count, resistance = state.segments.centre.size, float(state.sensitivity[-1])
    if state.dual:
        return total + state.approach, top + state.approach, resistance, 1 - share, count, state.residual
    return total - top + state.approach, state.approach, resistance, share, count, state.residual


def solve_load(profile: Profile, mean_pressure: float, tolerance: float = TOLERANCE) -> Solution:
    """The contacts under one mean pressure, and with them the pressure and the gap everywhere.

    Parameters
    ----------
    profile : Profile
        With a finite number of terms.
    mean_pressure : float
        Positive, in p_0*.
    tolerance : float
        As in `curve`.

    Returns
    -------
    Solution
        Evaluates pressure, gap and displacement at any x.

    Raises
    ------
    ValueError
        If the load is below 1e-300, the tolerance is not within reach, or the waves are too many.
    ConvergenceError
        If the load cannot be solved.

    """
    return solve_loads(profile, [mean_pressure], tolerance)[0]


@one_thread
def solve_loads(profile: Profile, mean_pressure: ArrayLike, tolerance: float = TOLERANCE) -> list[Solution]:
    """The same for several loads, each started from the one before.

    Parameters
    ----------
    profile, tolerance
        As in `solve_load`.
    mean_pressure : array_like, shape (loads,)
        Increasing, positive, in p_0*.

    Returns
    -------
    list of Solution
        One a load.

    Raises
    ------
    ValueError
        If the loads are not increasing from 1e-300 or above, the tolerance is not within reach, or the waves are
        too many.
    ConvergenceError
        If a load cannot be solved.

    """
    loads = loads_within_reach(mean_pressure)
    check_tolerance(tolerance)
    seen = surface_of(profile)
    found = solutions(profile, seen, loads, tolerance)
    return [solution(seen, state, load) for load, (state, _) in zip(loads, found, strict=True)]


def check_tolerance(tolerance: float) -> None:
    """Refuse a tolerance that rounding would not allow, or that would not be one.

    Raises
    ------
    ValueError
        If it lies outside [1e-13, 1e-6].
    """
    if not 1e-13 <= tolerance <= 1e-6:
        raise ValueError(f"tolerance must lie in [1e-13, 1e-6], got {tolerance}")


def loads_within_reach(mean_pressure: ArrayLike) -> Array:
    """The loads, if they rise and are no lighter than numbers allow.

    Raises
    ------
    ValueError
        If they do not increase from `LEAST_LOAD` or above.
    """
    loads = checked_loads(mean_pressure)
    if loads[0] < LEAST_LOAD:
        raise ValueError(f"mean_pressure must be at least {LEAST_LOAD:g} p_0* for contact patches, got {loads[0]:g}")
    return loads
