"""Boundary elements for a profile: choose the grid, start the solver, check what it returns."""

from __future__ import annotations

import math
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from weier.bem import corrected, direct, fft
from weier.bem.contact import no_answer
from weier.bem.grids import full_contact, inverse, nested_grids
from weier.bem.subgrid import make_continuum
from weier.errors import ConvergenceError
from weier.halfplane import eigenvalues, influence_coefficients
from weier.limits import check_points, check_resolvable
from weier.loads import checked_loads
from weier.profile import Profile
from weier.summits import summits

Array = NDArray[np.float64]

POINTS_PER_WAVE = 64  # of the finest wave: an error of h below 7e-4 g_0


class Curve(NamedTuple):
    """Boundary-element curves over the loads, each of shape (loads,).

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp of the contact as it stands, in g_0/p_0*
    contact_fraction : nodes in contact per node
    patch_count : contacts in one period; 0 in full contact
    residual : largest violation of a contact condition, on a freshly applied operator, in g_0
    work : pairs of FFTs (solver "fft"; those of coarser grids by their size) or dense solutions ("direct")
    points : nodes in one period, a scalar
    compliance_error, resistance_error : expected, in the same units; NaN with edges "nodes", which know none
    """

    compliance: Array
    resistance: Array
    contact_fraction: Array
    patch_count: NDArray[np.int64]
    residual: Array
    work: Array
    points: int
    compliance_error: Array
    resistance_error: Array


def curve(
    profile: Profile,
    mean_pressure: ArrayLike,
    solver: str = "fft",
    points: int | None = None,
    tolerance: float = 1e-10,
    resistance: bool = True,
    edges: str = "subgrid",
) -> Curve:
    """Compliance and resistance of a truncated series by boundary elements (Section 5.1).

    Parameters
    ----------
    profile : Profile
        With a finite number of terms.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    solver : "fft" or "direct"
        The fast solver, or the paper's dense one: the same discrete system, equal to rounding.
    points : int, optional
        Nodes in one period; 64 for each of the finest waves unless told.
    tolerance : float
        Largest residual, in g_0.
    resistance : bool
        Whether the fast solver should solve for the resistance too; without, it is NaN. It costs nothing beside
        edges "subgrid", which need it.
    edges : "subgrid" or "nodes"
        Whether the edges of contact stand between the nodes, where the continuum has them (docs/subgrid.md), or on
        them, as in Section 5.1. The direct solver has them on the nodes.

    Returns
    -------
    Curve
        Arrays over the loads.

    Raises
    ------
    ValueError
        If the loads are not positive and increasing, `solver` or `edges` is unknown, or `points` are too few for
        the finest wave, or too many.
    ConvergenceError
        If a load misses the tolerance.

    Notes
    -----
    With edges "subgrid" the compliance converges as N^-3 and the resistance as N^-2. With edges "nodes" it is about
    N^-2 and N^-1, since the edges of contact move by whole nodes: the resistance is then the exact derivative of
    the discrete h(p), which is linear as long as no node changes side.

    """
    loads = checked_loads(mean_pressure)
    points = checked_points(profile, points)
    check_tolerance(tolerance)
    if solver not in ("fft", "direct"):
        raise ValueError(f'solver must be "fft" or "direct", got {solver!r}')
    if edges not in ("subgrid", "nodes"):
        raise ValueError(f'edges must be "subgrid" or "nodes", got {edges!r}')
    check_points(points, dense=solver == "direct")
    if solver == "fft" and edges == "subgrid":
        found = _between_nodes(profile, loads, points, tolerance)
        return found if resistance else found._replace(resistance=np.full(loads.size, np.nan))
    partial = loads[loads < flattening_load(profile, points)]
    if partial.size == 0:
        answer = no_answer(0)
    elif solver == "fft":
        hierarchy = nested_grids(profile, points, tolerance)
        start = full_contact(hierarchy, float(partial[-1]))
        answer = fft.solve_loads(hierarchy, start, partial, resistance)
    else:
        start = np.ones(points)
        influence = influence_coefficients(points, profile.period)
        answer = direct.solve_loads(profile.sampled_height(points), influence, start, partial, tolerance)
    check_residual(answer.residual, partial, points, tolerance)
    _check_resistance(answer.resistance, partial, points)
    return _with_full_contact(
        profile, loads, points, answer.flat, answer.resistance, answer.contact_nodes / points, answer.patches,
        answer.residual, answer.work, np.full(partial.size, np.nan), np.full(partial.size, np.nan),
    )  # fmt: skip


def _between_nodes(profile: Profile, loads: Array, points: int, tolerance: float) -> Curve:
    """The curve with the edges of contact between the nodes."""
    partial = loads[loads < full_contact_load(profile)]
    answer = corrected.no_loads(0)
    if partial.size:
        hierarchy = nested_grids(profile, points, tolerance)
        start = full_contact(hierarchy, float(partial[-1]))
        answer = corrected.solve_loads(hierarchy, start, partial, make_continuum(profile, points))
    check_residual(answer.residual, partial, points, tolerance)
    _check_resistance(answer.resistance, partial, points)
    return _with_full_contact(profile, loads, points, *answer)


def _with_full_contact(
    profile: Profile, loads: Array, points: int, flat: Array, resistance: Array, contact_fraction: Array,
    patches: NDArray[np.int64], residual: Array, work: Array,
    compliance_error: Array, resistance_error: Array,
) -> Curve:  # fmt: skip
    """The curve from what is known of the lighter loads: the others press all gaps shut."""

    def whole(values: NDArray[Any], flattened: float) -> NDArray[Any]:
        return np.concatenate([values, np.full(loads.size - values.size, flattened)])

    return Curve(
        whole(profile.total_amplitude - flat, profile.total_amplitude),
        whole(resistance, 0.0),
        whole(contact_fraction, 1.0),
        whole(patches, 0).astype(np.int64),
        whole(residual, 0.0),
        whole(work, 0),
        points,
        whole(compliance_error, 0.0),
        whole(resistance_error, 0.0),
    )


def checked_points(profile: Profile, points: int | None = None) -> int:
    """`points` if the finest wave can be seen on them, or the default.

    Raises
    ------
    ValueError
        If there are no more than two points a wave, or more than a computer holds.

    """
    check_resolvable(profile)
    finest = profile.wavenumber[-1]
    if points is None:
        return POINTS_PER_WAVE * finest
    if not isinstance(points, Real) or not points > 2 * finest or points != points // 1:
        raise ValueError(
            f"points must be a whole number above {2 * finest}, two for each of the {finest} finest waves in a "
            f"period, got {points}; {POINTS_PER_WAVE * finest} is the default"
        )
    check_points(points)
    return int(points)


def check_tolerance(tolerance: float) -> None:
    """Refuse a tolerance, in g_0, that is no positive number.

    Raises
    ------
    ValueError
        If it is not.

    """
    if not 0 < tolerance < math.inf:
        raise ValueError(f"tolerance must be a positive length in g_0, such as 1e-10, got {tolerance}")


def flattening_load(profile: Profile, points: int) -> float:
    """The mean pressure from which on all nodes touch: then the solution is known, h = sum g_n and R = 0."""
    height = profile.sampled_height(points)
    pressure = np.fft.irfft(inverse(eigenvalues(points, profile.period)) * np.fft.rfft(height), points)
    return float(-pressure.min())


def full_contact_load(profile: Profile) -> float:
    """The mean pressure from which on no gap is left in the continuum, in p_0*."""
    _, phase = summits(-profile.full_contact_pressure, profile.wavenumber, profile.phase, profile.period)
    return float((-np.cos(phase) @ profile.full_contact_pressure).max())


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
            "tolerance",
            float(residual[worst]),
        )


def _check_resistance(resistance: Array, loads: Array, points: int) -> None:
    """Refuse a resistance that the solver gave up, which it says by inf."""
    missed = np.flatnonzero(np.isinf(resistance))
    if missed.size:
        raise ConvergenceError(
            f"boundary elements on {points} points found the compliance but not the resistance under the mean "
            f"pressure {loads[missed[0]]:.6g} p_0*; try other points, or resistance=False",
            np.inf,
        )
