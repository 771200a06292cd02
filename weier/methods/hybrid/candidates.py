"""The candidates of a plan by resolved terms on the layer: as few terms as some load allows.

Their errors are those of docs/hybrid.md, "The error, and where it stops".
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem.error_model import compliance_error as mesh_error
from weier.methods.hybrid import error_model
from weier.methods.hybrid.closure import MAX_LOAD
from weier.methods.hybrid.solver import MAX_POINTS, MIN_LOAD, POINTS_PER_WAVE, curve, default_points
from weier.methods.plan_part import COMPLIANCE, PartSolution, PlanPart, Task, make_part
from weier.surface.profile import Profile, terms_within


def candidates(task: Task) -> Iterator[PlanPart]:
    """Estimates of the infinite series with more and more terms, up to those that meet the tolerance at all loads."""
    if task.quantity != COMPLIANCE or math.isfinite(task.profile.m):
        return
    for terms in range(1, terms_within(task.profile, MAX_POINTS / POINTS_PER_WAVE) + 1):
        offer = _resolved(task, task.profile.truncated(terms))
        if np.any(offer.error <= task.tolerance):
            yield offer
        if np.all(offer.error <= task.tolerance):
            return


def _resolved(task: Task, kept: Profile) -> PlanPart:
    loads, points = task.mean_pressure, default_points(kept)
    carried = (loads >= MIN_LOAD) & (loads <= MAX_LOAD)
    estimate = np.where(carried, error_model.compliance_error(loads, kept), np.inf)
    mesh = np.full(loads.size, mesh_error(kept, points))
    start, load = error_model.seconds(points)
    return make_part(
        task,
        "hybrid",
        f"on a layer of all finer terms, {kept.tail_amplitude:.1e} g_0 in all",
        partial(_solve, task.profile, kept.terms, points),
        terms=kept.terms,
        settings={"points": points},
        discretisation=mesh,
        estimate=estimate,
        seconds_start=start,
        seconds_load=np.full(loads.size, load),
        memory=error_model.memory(points),
        includes_tail=True,
    )


def _solve(profile: Profile, terms: int, points: int, loads: Array) -> PartSolution:
    """The estimate, with the smaller of the errors by its error model and by its bounds."""
    kept, solved = profile.truncated(terms), curve(profile, loads, terms, points)
    modelled = error_model.compliance_error(loads, kept) + mesh_error(kept, points)
    error = np.minimum(modelled, solved.distance_to_bounds)
    return PartSolution(solved.compliance, solved.resistance, error, np.full(loads.size, np.inf))
