"""Boundary elements for a profile: choice of the grid, solver and checks.

docs/bem.md derives the equations ("The discrete problem"), the edges between nodes ("The staircase") and the stated
errors ("Bounds").
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier.checks import checked_number, checked_word
from weier.kernels.arrays import Array
from weier.methods.bem import active_set, stated_errors
from weier.methods.bem.grids import full_contact_pressure
from weier.methods.bem.staircase import ContactPoint, contact_on_nodes, remove_staircase
from weier.methods.curve import Curve
from weier.methods.errors import ConvergenceError
from weier.methods.load_progress import count_load, keeping
from weier.surface.limits import check_points, check_resolvable
from weier.surface.loads import checked_loads
from weier.surface.waves import Waves

POINTS_PER_WAVE = 64  # error of R below 1 % at nine of ten loads (docs/numerics.md, "The resistance of a grid")
STAIRCASES = ("removed", "kept")
RESIDUAL = 1e-10  # g_0: default residual, below the error of any grid


def curve(
    profile: Waves,
    mean_pressure: ArrayLike,
    points: int | None = None,
    max_residual: float = RESIDUAL,
    with_resistance: bool = True,
    staircase: str = "removed",
) -> Curve:
    """Return compliance and resistance of a truncated series by boundary elements (Section 5.1).

    Parameters
    ----------
    profile : Profile or Trace
        With a finite number of terms.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    points : int, optional
        Nodes in one period; by default `POINTS_PER_WAVE` for each of the finest waves.
    max_residual : float
        Largest residual that is accepted, in g_0.
    with_resistance : bool
        Whether to compute the resistance; otherwise it is NaN, which saves a third of the time if the staircase is
        kept. Removing the staircase needs the same second solution.
    staircase : "removed" or "kept"
        Whether the staircase of edges that move from node to node is corrected (docs/bem.md, "The
        staircase"). Kept, all is as in Section 5.1, with edges on nodes.

    Returns
    -------
    Curve
        With the residual at the nodes, on a freshly applied operator, the pairs of FFTs as `work`, counted by the
        size of their grid, and the stated errors. The error of the compliance is a bound at first contact, and was
        never exceeded in tests at other loads. The error of the resistance follows from chords of the concave h(p),
        and is a bound if the error of the compliance is one.

    Raises
    ------
    ValueError
        If the loads are not positive and increasing, `staircase` is unknown, or there are too few points for the
        finest wave, or too many.
    ConvergenceError
        If a load leaves a larger residual.

    Notes
    -----
    The loads are independent of each other, except that more loads reduce `resistance_error`. The compliance
    converges approximately as N^-2.

    With the staircase kept, the resistance converges as N^-1: it is the exact derivative of the discrete h(p), a
    polygon, and the contact edges move by whole nodes.

    """
    loads = checked_loads(mean_pressure)
    checked_word("staircase", staircase, STAIRCASES)
    points = checked_points(profile, points)
    full = min(full_contact_load(profile, points), profile.full_contact_load)
    found, partial = list[ContactPoint](), loads[loads < full]
    point_of = remove_staircase if staircase == "removed" else contact_on_nodes
    if partial.size:  # At loads of full contact no matrix is needed.
        grid = active_set.NestedSolver(profile, points, max_residual)

        def solved() -> tuple[Array, Curve]:
            """Return the heaviest loads, which are solved first, and their curve."""
            own = loads[partial.size - len(found) :]
            return own, _as_curve(profile, own, found[::-1], points, with_resistance)

        with keeping(lambda _: solved() if found else None):
            for load in map(float, partial[::-1]):
                solution = grid.solve_discrete(load, with_resistance or staircase == "removed")
                check_residual(solution.residual, load, points, max_residual)
                check_resistance(solution.resistance, load, points)
                found.append(point_of(solution))
                count_load()
    return _as_curve(profile, loads, found[::-1], points, with_resistance)


def _as_curve(profile: Waves, loads: Array, found: list[ContactPoint], points: int, with_resistance: bool) -> Curve:
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
    solved = Curve(
        compliance,
        resistance,
        contact_fraction=fraction,
        patch_count=count,
        residual=residual,
        work=work,
        contact_edge=edge,
        points=points,
    )
    return with_errors(profile, loads, solved)


def with_errors(profile: Waves, loads: Array, curve: Curve, **settings: Any) -> Curve:
    """Return a curve with its stated errors; the error of the resistance depends on all loads."""
    points, residual = int(curve.values()["points"]), curve.values()["residual"]
    h_error, R_error = stated_errors.errors(profile, loads, points, (curve.compliance, curve.resistance), residual)
    return replace(curve, compliance_error=h_error, resistance_error=R_error)


def full_contact_load(profile: Waves, points: int) -> float:
    """Return the mean pressure of full contact at the nodes: above it h = sum g_n and R = 0."""
    return float(-full_contact_pressure(profile.sampled_height(points), profile.period).min())


def checked_points(profile: Waves, points: int | None = None) -> int:
    """Return the points per period, given or by default; ValueError if they are too few for a wave, or too many."""
    check_resolvable(profile)
    finest = profile.waves_per_period[-1]
    points = POINTS_PER_WAVE * finest if points is None else points
    condition = (
        f"be a whole number above {2 * finest}, two for each of the {finest} finest waves in a period "
        f"({POINTS_PER_WAVE * finest} is the default)"
    )
    count = checked_number("points", points, condition, lambda count: count > 2 * finest and count == count // 1)
    check_points(count)
    return int(count)


def check_residual(residual: float, load: float, points: int, max_residual: float) -> None:
    """Raise ConvergenceError if a residual is NaN or exceeds the limit, in g_0."""
    if not residual <= max_residual:
        raise ConvergenceError(
            f"boundary elements on {points} points stopped at a residual of {residual:.1e} g_0 under the mean "
            f"pressure {load:.6g} p_0*, above {max_residual:.1e}; try other points, a larger "
            'tolerance, or the method "patches"',
            residual,
        )


def check_resistance(resistance: float, load: float, points: int) -> None:
    """Refuse a resistance of inf, which marks a solution that did not converge."""
    if np.isinf(resistance):
        raise ConvergenceError(
            f"boundary elements on {points} points found the pressure under {load:.6g} p_0* but not its derivative "
            "by the load; try other points, or contact patches",
            np.inf,
        )
