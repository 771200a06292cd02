"""The method of boundary elements: choice of the grid, solution of the loads, and checks.

docs/bem.md derives the equations ("The discrete problem"), the edges between nodes ("The staircase") and the stated
errors ("Bounds").
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier.checks import checked_count, checked_word
from weier.kernels.arrays import Array
from weier.methods.bem import active_set, stated_errors
from weier.methods.bem.grids import full_contact_pressure
from weier.methods.bem.staircase import Corrected, in_continuum, on_nodes
from weier.methods.curve import Curve
from weier.methods.error_model import RESIDUAL_FACTOR
from weier.methods.errors import ConvergenceError, OutOfReachError
from weier.methods.load_progress import count_load, keeping
from weier.methods.method import CURVE_SECONDS, TOLERANCES, Method, Range, Setting, Style, applies_to_resolvable
from weier.surface.loads import checked_loads
from weier.surface.waves import MAX_POINTS, Waves, check_resolvable

POINTS_PER_WAVE = 64  # error of R below 1 % at nine of ten loads (docs/numerics.md, "The resistance of a grid")
MIN_POINTS_PER_WAVE = 3  # a wave is resolved by more than two points
# g_0: default and smallest residual; rounding leaves some 1e-18 a node (1e-14 on 10 000), so 1e-11 on `MAX_POINTS`
RESIDUAL = 1e-10
RESIDUAL_FRACTION = 1e-3  # fraction of the tolerance; the grid takes the rest, which costs a step or two
Found = tuple[float, float, Corrected]  # residual, work and corrected solution at a load


def curve(
    profile: Waves,
    mean_pressure: ArrayLike,
    points: int | None = None,
    max_residual: float = RESIDUAL,
    staircase: str = "removed",
) -> Curve:
    """Return compliance and resistance of a truncated series by boundary elements (Section 5.1).

    Parameters
    ----------
    profile : Profile or Trace
        A surface with a finite number of terms.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    points : int, optional
        Nodes in one period, more than two for each of the finest waves; by default `POINTS_PER_WAVE` for each.
    max_residual : float
        Accepted residual, in g_0.
    staircase : "removed" or "kept"
        Whether to correct for edges that move from node to node (docs/bem.md, "The staircase"), or to keep the edges
        on nodes, as in Section 5.1.

    Raises
    ------
    ConvergenceError
        If a load leaves a larger residual.

    Notes
    -----
    `work` counts pairs of FFTs by the size of their grid. Loads are independent of each other, except that more loads
    reduce `resistance_error`, which follows from chords. With N nodes the error of h falls about as N^-2. With the
    staircase kept, R is the exact derivative of the discrete h(p), a polygon, and its error falls as N^-1.

    """
    checked_word("staircase", staircase, ("removed", "kept"))
    check_resolvable(profile)
    loads, given = checked_loads(mean_pressure), points_of(profile) if points is None else points
    points = checked_count("points", given, 2 * profile.waves_per_period[-1] + 1, MAX_POINTS)
    full = min(full_contact_load(profile, points), profile.full_contact_load)
    found, partial = list[Found](), loads[loads < full]
    corrected = in_continuum if staircase == "removed" else on_nodes
    if partial.size:  # At loads of full contact no matrix is needed.
        grid = active_set.NestedSolver(profile, points, max_residual)

        def solved() -> tuple[Array, Curve]:
            """Return the heaviest loads, which are solved first, and their curve."""
            own = loads[partial.size - len(found) :]
            return own, _as_curve(profile, own, found[::-1], points)

        with keeping(lambda _: solved() if found else None):
            for load in map(float, partial[::-1]):
                solution = grid.solve_discrete(load, True)
                if not (solution.residual <= max_residual and solution.resistance < math.inf):
                    raise ConvergenceError(
                        f"boundary elements on {points} points stopped under the mean pressure {load:.6g} p_0* at a "
                        f"residual of {solution.residual:.1e} g_0, {max_residual:.1e} wanted, or without the "
                        'derivative of the pressure; try other points, a larger tolerance, or the method "patches"',
                        solution.residual,
                    )
                found.append((solution.residual, solution.work, corrected(solution)))  # not its nodes, for memory
                count_load()
    return _as_curve(profile, loads, found[::-1], points)


def _as_curve(profile: Waves, loads: Array, found: list[Found], points: int) -> Curve:
    """Return the curve from the solutions at the loads of partial contact; at heavier loads contact is full."""
    plane, resistance, fraction, residual, work = np.tile([[0.0], [0.0], [1.0], [0.0], [0.0]], loads.size)
    most = max((edge.size // 2 for *_, (*_, edge) in found), default=0)
    count, edges = np.zeros(loads.size, np.int64), np.full((loads.size, most, 2), np.nan)
    for at, (residual[at], work[at], (plane[at], resistance[at], _, _, edge)) in enumerate(found):
        count[at] = edge.size // 2
        edges[at, : count[at]] = edge.reshape(-1, 2)
        if edge.size:  # All nodes may be in contact although the continuum has a gap between two of them.
            fraction[at] = np.sum(edge[1::2] - edge[::2]) / points
    edges -= points * np.floor(edges[:, :, :1] / points)  # the left edge of each contact is within the period
    edges = np.take_along_axis(edges, np.argsort(edges[:, :, :1], axis=1), axis=1)
    solved = Curve(
        profile.total_amplitude - plane,
        resistance,
        contact_fraction=fraction,
        patch_count=count,
        residual=residual,
        work=work,
        contact_edge=edges.reshape(loads.size, 2 * most) * (float(profile.period) / points),
        points=points,
    )
    h_error, R_error = stated_errors.errors(profile, loads, points, (solved.compliance, resistance), residual)
    return replace(solved, compliance_error=h_error, resistance_error=R_error)


def full_contact_load(profile: Waves, points: int) -> float:
    """Return the mean pressure of full contact at the nodes: above it h = sum g_n and R = 0."""
    return float(-full_contact_pressure(profile.sampled_height(points), profile.period).min())


def points_of(
    profile: Waves, tolerance: float | None = None, points_per_wave: int | None = None, **others: Any
) -> float:
    """Return the points per period: the fewest that meet a tolerance, in g_0, or inf if rounding prevents it."""
    if tolerance is None:
        check_resolvable(profile)
        return (points_per_wave or POINTS_PER_WAVE) * profile.waves_per_period[-1]
    error = tolerance - RESIDUAL_FACTOR * _residual_within(tolerance)
    return stated_errors.fewest_points(profile, error) if error > 0 else math.inf


def _residual_within(tolerance: float | None) -> float:
    return RESIDUAL if tolerance is None else max(RESIDUAL_FRACTION * tolerance, RESIDUAL)


def within_few_points(profile: Waves, tolerance: float) -> bool:
    """Return whether a grid no finer than the default meets a tolerance, in g_0."""
    return points_of(profile, tolerance) <= min(points_of(profile), MAX_POINTS)


def _grid(profile: Waves, tolerance: float | None = None, points_per_wave: int | None = None, **others: Any) -> int:
    """Return the points per period; ValueError if settings exclude each other or it is too fine."""
    points = points_of(profile, tolerance, points_per_wave)
    if tolerance is None:
        return checked_count("points", points, 1, MAX_POINTS)
    if points_per_wave is not None:
        raise ValueError("a grid takes tolerance or points_per_wave, and not both")
    if points > MAX_POINTS:
        raise OutOfReachError(
            f"boundary elements need {points:.2g} points for a tolerance of {tolerance:g} g_0, more than "
            f'{MAX_POINTS}: take a larger tolerance or the method "patches"'
        )
    return int(points)


def _solve(
    profile: Waves,
    loads: Array,
    tolerance: float | None = None,
    points_per_wave: int | None = None,
    staircase: str = "removed",
) -> Curve:
    points = _grid(profile, tolerance, points_per_wave)
    return curve(profile, loads, points, _residual_within(tolerance), staircase)


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
            f"accepted error of the compliance, in g_0, above {RESIDUAL_FACTOR * RESIDUAL:g}; "
            "it sets the points, and bounds R poorly: for this use patches",
            TOLERANCES,
        ),
        "points_per_wave": Setting(
            None, f"nodes per finest wave, {POINTS_PER_WAVE} by default", Range(MIN_POINTS_PER_WAVE, MAX_POINTS)
        ),
        "staircase": Setting(
            "removed",
            '"removed" for sub-grid contact edges, or "kept" for edges on nodes (Section 5.1)',
            ("removed", "kept"),
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
    check=_grid,
)
