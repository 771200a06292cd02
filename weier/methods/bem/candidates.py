"""What boundary elements offer to a plan: the coarsest grid that keeps within its tolerance."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem import error_model
from weier.methods.bem.solver import curve
from weier.methods.error_model import RESIDUAL_FACTOR
from weier.methods.segment import COMPLIANCE, Segment, SegmentSolution, Task, make_segment
from weier.theory.profile import Profile


def candidates(task: Task) -> Iterator[Segment]:
    """Grids for the compliance or the resistance; none for one wave, which has a closed form."""
    if task.profile.m == 1:
        return
    residual = RESIDUAL_FACTOR * error_model.PLANNED_RESIDUAL if task.quantity == COMPLIANCE else 0.0
    for share in error_model.GRID_SHARES[task.quantity]:
        allowed = share * task.tolerance - residual
        if allowed > 0:
            points = error_model.fewest_points(task.profile, allowed, task.quantity)
            if points <= error_model.MAX_POINTS:
                yield _grid(task, points)


def _grid(task: Task, points: int) -> Segment:
    profile, loads, others = task.profile, task.mean_pressure, None
    if task.quantity == COMPLIANCE:
        error = np.full(loads.size, error_model.solution_error(profile, points, error_model.PLANNED_RESIDUAL))
    else:
        error = error_model.resistance_error(profile, points, loads) * (1 + error_model.EVENT_SHARE)
        others = error_model.neighbouring_loads(profile, points, loads)
    start, load = error_model.seconds(points, task.contacts)
    waves = profile.waves_per_period[-1]
    return make_segment(
        task,
        "bem",
        f"{points / waves:.0f} points for each of {waves} waves are the fewest that do",
        partial(_solve, profile, points, others is not None),
        settings={"points": points},
        discretisation=error,
        seconds_start=start,
        seconds_load=load if others is None else (1 + others.shape[1]) * load,
        memory=error_model.memory(points),
        other_loads=others,
    )


def _solve(profile: Profile, points: int, with_neighbours: bool, loads: Array) -> SegmentSolution:
    grid = curve(profile, loads, points=points, tolerance=error_model.PLANNED_RESIDUAL, edges="nodes")
    relative = error_model.resistance_error(profile, points, loads)
    light = error_model.light_resistance_error(profile, points, loads, grid.resistance)
    # Without neighbouring loads nothing tells whether a contact is about to be born, or was just now.
    known = relative * np.maximum(grid.resistance, 1) if with_neighbours else np.full(loads.size, np.inf)
    return SegmentSolution(
        grid.compliance,
        grid.resistance,
        error_model.solution_error(profile, points, grid.residual),
        np.where(np.isinf(relative), light, known),
    )
