"""Boundary elements as one of the methods."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem import error_model
from weier.methods.bem.solver import Curve, check_tolerance, checked_edges, checked_points, curve
from weier.methods.method import Method, Noise, Settings, Style, applies_to_resolvable
from weier.methods.segment import Segment, SegmentSolution, Task, make_segment
from weier.theory.limits import check_points
from weier.theory.waves import Waves

# Points for each of the finest waves. Halved, they stay whole.
NODES_COMPARED = (12, 24, 96, 384, 1536)  # with the edges of contact on nodes: from the paper's 12 on
POINTS_COMPARED = (16, 32, 64, 128, 256, 512, 1024)
MAX_POINTS_COMPARED = 100_000  # in one period
RESIDUALS_COMPARED = (1e-5, 1e-6, 1e-8)  # beside the default 1e-10, on 32 points a wave
POINTS_AT_RESIDUALS = 32


def _solve(
    profile: Waves, loads: Array, points_per_wave: int | None = None, points: int | None = None,
    edges: str | None = None, solver: str = "fft", resistance: bool = True, residual_tolerance: float = 1e-10,
) -> Curve:  # fmt: skip
    return curve(profile, loads, solver, points, residual_tolerance, resistance, edges, points_per_wave)


def _variants(profile: Waves) -> Iterator[tuple[str, Settings]]:
    """Edges of contact on nodes and between them, on several grids; residuals at which the solver stops."""
    waves = profile.waves_per_period[-1]
    largest = MAX_POINTS_COMPARED / waves
    for count in (count for count in NODES_COMPARED if count <= largest):
        yield f"nodes {count}", {"points": count * waves, "edges": "nodes"}
    for count in (count for count in POINTS_COMPARED if count <= largest):
        yield f"{count}", {"points": count * waves}
    grid = {"points": POINTS_AT_RESIDUALS * waves}
    for residual in RESIDUALS_COMPARED:
        yield f"{POINTS_AT_RESIDUALS} {residual:.0e}", {**grid, "residual_tolerance": residual}


def _check(
    profile: Waves, solver: str = "fft", points: int | None = None, edges: str | None = None,
    points_per_wave: int | None = None, residual_tolerance: float = 1e-10, **others: Any,
) -> None:  # fmt: skip
    """Refuse settings that do not go together, or a grid that the finest wave cannot be seen on."""
    edges = checked_edges(edges, solver)
    check_tolerance(residual_tolerance, edges)
    check_points(checked_points(profile, points, edges, points_per_wave), solver == "direct")


def _seconds(profile: Waves, loads: Array) -> float:
    """On the default grid, at most: at each load as many contacts as there are waves."""
    contacts = np.full(loads.size, float(profile.waves_per_period[-1]))
    start, each = error_model.seconds(checked_points(profile, None, "subgrid"), contacts)
    return start + float(each.sum())


def _candidates(task: Task) -> Iterator[Segment]:
    """Grids for the compliance or the resistance; none for one wave, which has a closed form."""
    waves = task.profile.waves_per_period[-1]
    for per_wave in error_model.PLANNED_POINTS_PER_WAVE:
        if task.profile.m > 1 and per_wave * waves <= error_model.MAX_POINTS:
            offer = _grid(task, per_wave * waves)
            if np.any(np.isfinite(offer.discretisation)):
                yield offer


def _grid(task: Task, points: int) -> Segment:
    """A grid at the loads where it is expected to state no larger error than the tolerance."""
    profile, waves = task.profile, task.profile.waves_per_period[-1]
    error = error_model.stated_error(profile, points, task.quantity, task.contacts)
    start, load = error_model.seconds(points, task.contacts)
    return make_segment(
        task,
        "bem",
        f"{points / waves:.0f} points for each of {waves} waves are the fewest that do",
        partial(_solve_segment, profile, points),
        settings={"points": points, "edges": "subgrid"},
        discretisation=np.where(error <= task.tolerance, error, np.inf),
        seconds_start=start,
        seconds_load=load,
        memory=error_model.memory(points),
    )


def _solve_segment(profile: Waves, points: int, loads: Array) -> SegmentSolution:
    grid = curve(profile, loads, points=points, tolerance=error_model.PLANNED_RESIDUAL, edges="subgrid")
    return SegmentSolution(grid.compliance, grid.resistance, grid.compliance_error, grid.resistance_error)


METHOD = Method(
    name="bem",
    label="boundary elements",
    summary="boundary elements of linear pressure (5.1); finite m",
    solve=_solve,
    settings={
        "points_per_wave": "nodes for each of the finest waves, 32 by default, or 64 with edges on nodes",
        "points": "nodes in one period, in place of points_per_wave",
        "edges": '"subgrid", with edges of contact between the nodes, the default of "fft"; or "nodes"',
        "solver": '"fft", or "direct" for the dense matrix of Section 5.1',
        "resistance": "whether to solve for the resistance, too",
        "residual_tolerance": "largest residual of a condition, in g_0; at most 1e-5 with edges between the nodes",
    },
    applies=applies_to_resolvable,
    takes_traces=True,
    numerical=True,
    style=Style("#000000", (), "o"),
    noise=Noise(1e-9, 2.5e-3),  # a residual of 1e-10, and the largest error of R on 32 points a wave
    algorithms=({}, {"solver": "direct"}),
    options=({"edges": "nodes"},),
    variants=_variants,
    seconds=_seconds,
    candidates=_candidates,
    check=_check,
)
