"""Boundary elements for a profile: choice of the grid, solver and checks.

docs/bem.md derives the equations ("The discrete problem"), the edges between nodes ("The staircase") and the stated
errors ("Bounds").
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.checks import checked_count, checked_number, checked_word, shown
from weier.kernels.arrays import Array, Indices
from weier.methods.bem import active_set, direct, error_model
from weier.methods.bem.grids import full_contact_pressure
from weier.methods.bem.staircase import ContactPoint, contact_on_nodes, remove_staircase
from weier.methods.errors import ConvergenceError
from weier.methods.progress import count_load
from weier.surface.limits import check_points, check_resolvable
from weier.surface.loads import checked_loads
from weier.surface.waves import Waves

POINTS_PER_WAVE = 64  # error of R below 1 % at nine of ten loads (docs/numerics.md, "The resistance of a grid")
SOLVERS, STAIRCASES = ("fft", "direct"), ("removed", "kept")
MIN_POINTS_PER_WAVE = 3  # two points do not resolve a wave
RESIDUAL = 1e-10  # g_0: default residual, below the error of any grid
LARGEST_RESIDUAL = 1.0  # g_0: upper limit of the setting


class BemCurve(NamedTuple):
    """Boundary-element curves over the loads, each of shape (loads,).

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*
    contact_fraction : length in contact per length
    patch_count : contacts in one period; 0 in full contact
    residual : largest violation of a contact condition at the nodes, on a freshly applied operator, in g_0
    work : pairs of FFTs (solver "fft"; those of other grids by their size) or dense solutions ("direct")
    compliance_error : bound on the error at first contact plus that by the residual, in g_0; never exceeded in tests
        at other loads
    resistance_error : from chords of the concave curve h(p), in g_0/p_0*; a bound if `compliance_error` is one
    contact_edge : left and right edge of each contact in turn, shape (loads, edges), in lambda_0, padded with NaN;
        left edges are in the period
    points : nodes in one period; a scalar
    """

    compliance: Array
    resistance: Array
    contact_fraction: Array
    patch_count: Indices
    residual: Array
    work: Array
    compliance_error: Array
    resistance_error: Array
    contact_edge: Array
    points: int


def curve(
    profile: Waves,
    mean_pressure: ArrayLike,
    solver: str = "fft",
    points: int | None = None,
    max_residual: float = RESIDUAL,
    with_resistance: bool = True,
    staircase: str = "removed",
    points_per_wave: int | None = None,
) -> BemCurve:
    """Return compliance and resistance of a truncated series by boundary elements (Section 5.1).

    Parameters
    ----------
    profile : Profile or Trace
        With a finite number of terms.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    solver : "fft" or "direct"
        The fast solver, or the paper's dense one: the same discrete system, equal to rounding.
    points : int, optional
        Nodes in one period; 64 for each of the finest waves by default.
    max_residual : float
        Largest residual that is accepted, in g_0.
    with_resistance : bool
        Whether to compute the resistance; otherwise it is NaN, which saves the fast solver a third of its time if the
        staircase is kept. Removing the staircase needs the same second solution.
    staircase : "removed" or "kept"
        Whether the staircase of edges that move from node to node is corrected (docs/bem.md, "The
        staircase"). Kept, all is as in Section 5.1, with edges on nodes.
    points_per_wave : int, optional
        Nodes for each of the finest waves, instead of `points`: the same for profiles of any period.

    Returns
    -------
    BemCurve
        Arrays over the loads, with bounds on their errors.

    Raises
    ------
    ValueError
        If the loads are not positive and increasing, `solver` or `staircase` is unknown, there are too few points
        for the finest wave, or too many, or both their numbers are given.
    ConvergenceError
        If a load leaves a larger residual.

    Notes
    -----
    The loads are independent of each other (with the dense solver, to rounding), except that more loads reduce
    `resistance_error`. The compliance converges approximately as N^-2.

    With the staircase kept, the resistance converges as N^-1: it is the exact derivative of the discrete h(p), a
    polygon, and the contact edges move by whole nodes.

    """
    loads = checked_loads(mean_pressure)
    check_words(solver, staircase)
    check_max_residual(max_residual)
    points = checked_points(profile, points, points_per_wave)
    check_points(points, dense=solver == "direct")
    full = min(full_contact_load(profile, points), profile.full_contact_load)
    found, partial = [], loads[loads < full]
    if partial.size:  # At loads of full contact no matrix is needed.
        grid = (active_set.NestedSolver if solver == "fft" else direct.DenseSolver)(profile, points, max_residual)
    point_of = remove_staircase if staircase == "removed" else contact_on_nodes
    for load in map(float, partial[::-1]):
        solution = grid.solve_discrete(load, with_resistance or staircase == "removed")
        check_residual(solution.residual, load, points, max_residual)
        check_resistance(solution.resistance, load, points)
        found.append(point_of(solution))
        count_load()
    return _as_curve(profile, loads, found[::-1], points, with_resistance)


def _as_curve(
    profile: Waves, loads: Array, found: list[ContactPoint], points: int, with_resistance: bool
) -> BemCurve:
    """Return the curve from the solutions at the loads of partial contact; at heavier loads contact is full."""
    plane, resistance, fraction, residual, work = np.tile([[0.0], [0.0], [1.0], [0.0], [0.0]], loads.size)
    most = max((point.edge.size for point in found), default=0)
    count, edge = np.zeros(loads.size, np.int64), np.full((loads.size, most), np.nan)
    for at, point in enumerate(found):
        plane[at], resistance[at], residual[at], work[at] = point.plane, point.resistance, point.residual, point.work
        count[at] = point.edge.size // 2
        pairs = point.edge.reshape(-1, 2) - points * np.floor(point.edge[::2, None] / points)
        edge[at, : point.edge.size] = pairs[np.argsort(pairs[:, 0])].ravel() * (float(profile.period) / points)
        if point.edge.size:  # All nodes may be in contact although the continuum has a gap between two of them.
            fraction[at] = np.sum(point.edge[1::2] - point.edge[::2]) / points
    compliance = profile.total_amplitude - plane
    if not with_resistance:
        resistance = np.full(loads.size, np.nan)
    h_error, R_error = error_model.errors(profile, loads, points, (compliance, resistance), residual)
    return BemCurve(compliance, resistance, fraction, count, residual, work, h_error, R_error, edge, points)


def full_contact_load(profile: Waves, points: int) -> float:
    """Return the mean pressure of full contact at the nodes: above it h = sum g_n and R = 0."""
    return float(-full_contact_pressure(profile.sampled_height(points), profile.period).min())


def checked_points(profile: Waves, points: int | None = None, points_per_wave: int | None = None) -> int:
    """Return the points per period: given, given per finest wave, or by default.

    Raises
    ------
    ValueError
        If there are no more than two points a wave, or too many for a computer; or if both numbers are given.

    """
    check_resolvable(profile)
    finest = profile.waves_per_period[-1]
    if points is None:
        given = POINTS_PER_WAVE if points_per_wave is None else points_per_wave
        return checked_count("points_per_wave", given, MIN_POINTS_PER_WAVE) * finest
    if points_per_wave is not None:
        raise ValueError(
            f"points_per_wave must be left out if points are given, got {shown(points_per_wave)} with "
            f"points = {shown(points)}: give one of the two"
        )
    condition = (
        f"be a whole number above {2 * finest}, two for each of the {finest} finest waves in a period "
        f"({POINTS_PER_WAVE * finest} is the default)"
    )
    count = checked_number("points", points, condition, lambda count: count > 2 * finest and count == count // 1)
    check_points(count)
    return int(count)


def check_words(solver: str, staircase: str) -> None:
    """Refuse an unknown solver or treatment of the staircase by a ValueError."""
    checked_word("solver", solver, SOLVERS)
    checked_word("staircase", staircase, STAIRCASES)


def check_max_residual(max_residual: float) -> None:
    """Refuse a largest residual, in g_0, that is not positive, or larger than any compliance, by a ValueError."""
    condition = f"be a positive length in g_0, such as 1e-10, and at most {LARGEST_RESIDUAL:g}"
    checked_number("max_residual", max_residual, condition, lambda t: 0 < t <= LARGEST_RESIDUAL)


def check_residual(residual: float, load: float, points: int, max_residual: float) -> None:
    """Refuse a solution whose residual is above the largest, in g_0, or NaN, by a ConvergenceError."""
    if not residual <= max_residual:
        raise ConvergenceError(
            f"boundary elements on {points} points stopped at a residual of {residual:.1e} g_0 under the mean "
            f"pressure {load:.6g} p_0*, above {max_residual:.1e}; try other points, a larger "
            'tolerance, or the method "patches"',
            residual,
        )


def check_resistance(resistance: float, load: float, points: int) -> None:
    """Refuse a resistance of inf, which marks one that did not converge."""
    if np.isinf(resistance):
        raise ConvergenceError(
            f"boundary elements on {points} points found the pressure under {load:.6g} p_0* but not its derivative "
            'by the load; try other points, contact patches, or staircase="kept" without the resistance',
            np.inf,
        )
