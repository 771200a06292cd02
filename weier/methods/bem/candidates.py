"""What boundary elements offer to a plan: grids with edges between the nodes, and the errors that they state."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem import error_model
from weier.methods.bem.solver import curve
from weier.methods.segment import Segment, SegmentSolution, Task, make_segment
from weier.theory.profile import Profile


def candidates(task: Task) -> Iterator[Segment]:
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
        partial(_solve, profile, points),
        settings={"points": points, "edges": "subgrid"},
        discretisation=np.where(error <= task.tolerance, error, np.inf),
        seconds_start=start,
        seconds_load=load,
        memory=error_model.memory(points),
    )


def _solve(profile: Profile, points: int, loads: Array) -> SegmentSolution:
    grid = curve(profile, loads, points=points, tolerance=error_model.PLANNED_RESIDUAL, edges="subgrid")
    return SegmentSolution(grid.compliance, grid.resistance, grid.compliance_error, grid.resistance_error)
