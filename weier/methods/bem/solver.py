"""Boundary elements for a profile: choose the grid, start the solver, check what it returns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array, Indices
from weier.methods.bem import active_set, direct, error_model
from weier.methods.bem.contact_list import LISTED
from weier.methods.bem.grids import full_contact_pressure
from weier.methods.bem.subgrid_solver import LoadSolution, check_residual, solve_curve
from weier.methods.errors import ConvergenceError
from weier.methods.progress import count_load
from weier.theory.arguments import checked_number, shown
from weier.theory.limits import check_points, check_resolvable
from weier.theory.loads import checked_loads
from weier.theory.waves import Waves

POINTS_PER_WAVE = {"subgrid": 32, "nodes": 64}  # of the finest wave, by default: docs/subgrid.md says why
MIN_POINTS_PER_WAVE = {"subgrid": 16, "nodes": 3}  # that it takes: fewer were not measured; fewer show no wave
MAX_TOLERANCE = {"subgrid": 1e-5, "nodes": 1.0}  # of residuals, in g_0: with larger ones stated errors do not hold


class Curve(NamedTuple):
    """Boundary-element curves over the loads, each of shape (loads,).

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*; with edges "nodes", of the contact as it stands
    contact_fraction : length in contact per length; with edges "nodes", nodes in contact per node
    patch_count : contacts in one period, those between two nodes among them; 0 in full contact
    residual : largest violation of a contact condition on the grid, on a freshly applied operator, in g_0
    work : pairs of FFTs (solver "fft"; those of other grids by their size) or dense solutions ("direct")
    compliance_error : an estimate, in g_0, whose coverage is measured; with edges "nodes", the most that a grid can
        miss at first touch, and no larger error was measured at any load
    resistance_error : an estimate, in g_0/p_0*; NaN with edges "nodes": a grid does not see births between its nodes
    contact_edge : left and right edge of each contact in turn, shape (loads, edges), in lambda_0, padded with NaN;
        with edges "nodes" there are none
    points, edges : nodes in one period, as asked for, and where the edges of contact stand; scalars. A load whose
        correction is not verified is solved on twice or four times as many nodes, or by contact patches.
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
    edges: str


def curve(
    profile: Waves,
    mean_pressure: ArrayLike,
    solver: str = "fft",
    points: int | None = None,
    tolerance: float = 1e-10,
    resistance: bool = True,
    edges: str | None = None,
    points_per_wave: int | None = None,
) -> Curve:
    """Compliance and resistance of a truncated series by boundary elements (Section 5.1).

    Parameters
    ----------
    profile : Profile or Trace
        With a finite number of terms.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    solver : "fft" or "direct"
        The fast solver, or the paper's dense one: the same discrete system, equal to rounding.
    points : int, optional
        Nodes in one period; unless told, 32 for each of the finest waves, or 64 with edges "nodes".
    tolerance : float
        Largest residual, in g_0; 1e-5 at most with edges "subgrid", whose rate is solved no more tightly, either.
    resistance : bool
        Whether the fast solver should solve for the resistance too; without, it is NaN. It costs nothing beside
        edges "subgrid", which need it anyway.
    edges : "subgrid" or "nodes", optional
        Whether the edges of contact stand between the nodes, where the continuum has them (docs/subgrid.md), or on
        nodes, as in Section 5.1. The fast solver does the former unless told, and takes at least 16 points for each
        of the finest waves then; the dense solver knows the latter only.
    points_per_wave : int, optional
        Nodes for each of the finest waves, instead of `points`: the same for profiles of any period.

    Returns
    -------
    Curve
        Arrays over the loads, with estimates of their errors.

    Raises
    ------
    ValueError
        If the loads are not positive and increasing, `solver` or `edges` is unknown or one does not go with the
        other, or there are too few points for the finest wave, or too many, or both their numbers are given.
    ConvergenceError
        If a load misses the tolerance, or neither finer grids nor contact patches verify its solution.

    Notes
    -----
    Compliance and resistance converge as N^-3 and N^-2. With edges "nodes" they do so as N^-2, about, and N^-1: the
    resistance is then the exact derivative of the discrete h(p), which is linear as long as no node changes side, and
    the edges of contact move by whole nodes.

    With edges "subgrid" and up to 64 points for each of the finest waves, a load starts from the pressure of the next
    heavier one, if it is more than half of that. In a list and alone its numbers differ, by up to 2.6e-8 g_0 and 1e-5
    of the resistance on 16 to 64 points: both are within what is stated.

    """
    loads = checked_loads(mean_pressure)
    edges = checked_edges(edges, solver)
    check_tolerance(tolerance, edges)
    points = checked_points(profile, points, edges, points_per_wave)
    check_points(points, dense=solver == "direct")
    if edges == "subgrid":
        return _subgrid_curve(profile, loads, points, tolerance, resistance)
    return _nodal_curve(profile, loads, points, tolerance, resistance, solver)


def _nodal_curve(profile: Waves, loads: Array, points: int, tolerance: float, resistance: bool, solver: str) -> Curve:
    """The curve with the edges of contact on nodes."""
    rows, partial = [], loads[loads < full_contact_load(profile, points)]
    if partial.size:  # a matrix is not filled for loads that press all gaps shut
        grid = (active_set.NestedSolver if solver == "fft" else direct.DenseSolver)(profile, points, tolerance)
    for load in map(float, partial[::-1]):
        rows.append(grid.solve_discrete(load, resistance))
        check_residual(rows[-1].residual, load, points, tolerance)
        count_load()
    curve = _as_curve(profile, loads, rows[::-1], [], np.full((loads.size, 0), np.nan), points, "nodes")
    check_resistance(curve.resistance, loads, points)
    error = error_model.solution_error(profile, points, curve.residual)
    return curve._replace(compliance_error=error, resistance_error=np.full(loads.size, np.nan))


def _subgrid_curve(profile: Waves, loads: Array, points: int, tolerance: float, resistance: bool) -> Curve:
    """The curve with the edges of contact between nodes."""
    found = solve_curve(profile, points, tolerance, loads)
    rows, errors = [], [(each.compliance_error, each.resistance_error) for each in found]
    edge = _padded_edges(found, loads.size)
    fractions = np.nansum(edge[:, 1::2] - edge[:, ::2], axis=1) / profile.period
    for each, fraction in zip(found, fractions, strict=False):  # full contact has none
        rows.append((each.plane, each.resistance, fraction, each.contacts.size, each.residual, each.work))
    curve = _as_curve(profile, loads, rows, errors, edge, points, "subgrid")
    unknown = np.full(loads.size, np.nan)
    return curve if resistance else curve._replace(resistance=unknown, resistance_error=unknown)


def _as_curve(
    profile: Waves, loads: Array, found: Sequence[tuple[float, ...]], errors: Sequence[tuple[float, ...]],
    contact_edge: Array, points: int, edges: str,
) -> Curve:  # fmt: skip
    """The curve of what was found at the loads of partial contact; the heavier loads press all gaps shut."""
    rows = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (loads.size, 1))
    rows[: len(found)] = np.reshape(found, (-1, 6))
    plane, resistance, fraction, patches, residual, work = rows.T.copy()
    stated = np.zeros((2, loads.size))
    stated[:, : len(errors)] = np.reshape(errors, (-1, 2)).T
    return Curve(
        profile.total_amplitude - plane, resistance, fraction, patches.astype(np.int64), residual, work, stated[0],
        stated[1], contact_edge, points, edges,
    )  # fmt: skip


def _padded_edges(solutions: list[LoadSolution], loads: int) -> Array:
    """Left and right edges of the contacts at each load, shape (loads, edges)."""
    contacts = np.concatenate([np.zeros(0, LISTED), *(each.contacts for each in solutions)])
    count = np.zeros(loads, np.int64)
    count[: len(solutions)] = [each.contacts.size for each in solutions]
    edge = np.full((loads, count.max(initial=0), 2), np.nan)
    edge[np.arange(edge.shape[1]) < count[:, None]] = np.stack([contacts["left"], contacts["right"]], axis=1)
    return edge.reshape(loads, 2 * edge.shape[1])


def full_contact_load(profile: Waves, points: int) -> float:
    """The mean pressure from which on all nodes touch: then the solution is known, h = sum g_n and R = 0."""
    return float(-full_contact_pressure(profile.sampled_height(points), profile.period).min())


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


def check_tolerance(tolerance: float, edges: str) -> None:
    """Refuse a tolerance, in g_0, that is no positive number, or too large for what is stated of the solution.

    Raises
    ------
    ValueError
        If it is not.

    """
    most = MAX_TOLERANCE[edges]
    condition = f'be a positive length in g_0, such as 1e-10, and at most {most:g} with edges="{edges}"'
    checked_number("tolerance", tolerance, condition, lambda t: 0 < t <= most)


def check_resistance(resistance: Array, loads: Array, points: int) -> None:
    """Refuse a resistance that the solver gave up, which it says by inf."""
    failed = np.flatnonzero(np.isinf(resistance))
    if failed.size:
        raise ConvergenceError(
            f"boundary elements on {points} points found the compliance but not the resistance under the mean "
            f"pressure {loads[failed[0]]:.6g} p_0*; try other points, or resistance=False",
            np.inf,
        )
