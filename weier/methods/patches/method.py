"""Contact patches as one of the methods, and what they offer to a plan (docs/planned.md, "What is offered")."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.method import TOLERANCES_COMPARED, Method, Noise, Settings, Style, applies_to_resolvable
from weier.methods.patches import error_model, many_contacts
from weier.methods.patches.certificate import sample_points
from weier.methods.patches.fields import residuals_by_sums, residuals_one_by_one
from weier.methods.patches.solver import TOLERANCE, PatchCurve, curve
from weier.methods.patches.start import MAX_TOLERANCE, MIN_TOLERANCE, isolated_contacts, isolated_gaps
from weier.methods.patches.surface import surface_of
from weier.methods.plan_part import PartSolution, PlanPart, Task, make_part
from weier.surface.profile import Profile
from weier.surface.waves import Waves

# Kernels are run on one wave, under this load, in p_0*, and so far below the load of full contact.
ONE_WAVE, LIGHT = Profile(D=1.25, gamma=2, m=1), 1e-3


def _variants(profile: Waves) -> Iterator[tuple[str, Settings]]:
    for tolerance in TOLERANCES_COMPARED:
        yield f"{tolerance:.0e}", {"tolerance": tolerance}


def _seconds(profile: Waves, loads: Array) -> float:
    """Seconds of a curve at most, with as many contacts at each load as there are waves."""
    waves = profile.waves_per_period[-1]
    return float(error_model.seconds(waves, np.full(loads.size, float(waves))).sum())


def _solve_loads(profile: Waves, loads: Array, tolerance: float = TOLERANCE) -> PatchCurve:
    return curve(profile, loads, tolerance)


def _run_kernels() -> None:
    """Solve for one contact and for one gap with the solvers of few and of many, and take both kinds of sums.

    Nothing starts from boundary elements, which may still be compiled by another process.
    """
    surface = surface_of(ONE_WAVE)
    nearly_full = surface.full_contact_load - LIGHT
    for guess in (isolated_contacts(surface.heights, LIGHT), isolated_gaps(surface.tensions, nearly_full)):
        assert guess is not None
        series = surface.series(guess.dual)
        curve(ONE_WAVE, guess.load)
        state, _ = many_contacts.solve_many_contacts(surface, guess, TOLERANCE)
        _, crest, y = sample_points(state.segments, True)
        residuals_one_by_one(state, series, crest, y)
        residuals_by_sums(state, series, crest, y, series.crest_position[crest], y)


def candidates(task: Task) -> Iterator[PlanPart]:
    """Contact patches, where memory suffices for all contacts; none for one wave, which has a closed form."""
    tolerance = error_model.loosest_tolerance(task.tolerance, task.quantity)
    if task.profile.m > 1 and tolerance >= MIN_TOLERANCE:
        yield _patches(task, min(tolerance, MAX_TOLERANCE))


def _patches(task: Task, tolerance: float) -> PlanPart:
    waves = task.profile.waves_per_period[-1]
    fits = task.contacts <= error_model.MAX_CONTACTS
    error = np.where(fits, error_model.error(tolerance, task.quantity), np.inf)
    return make_part(
        task,
        "patches",
        "exact edges of these contacts cost less than a grid that is fine enough",
        partial(_solve, task.profile, tolerance),
        settings={"tolerance": tolerance},
        discretisation=error,
        seconds_start=error_model.SECONDS_START,
        seconds_load=error_model.seconds(waves, task.contacts, tolerance),
        memory=error_model.memory(waves, float(task.contacts.max(where=fits, initial=1.0))),
    )


def _solve(profile: Waves, tolerance: float, loads: Array) -> PartSolution:
    solved = curve(profile, loads, tolerance)
    error = np.where(solved.patch_count > 0, solved.compliance_error, 0)
    return PartSolution(solved.compliance, solved.resistance, error, solved.resistance_error)


METHOD = Method(
    name="patches",
    label="contact patches",
    summary="the edges of contact as unknowns, ten digits; finite m, any number of contacts",
    solve=_solve_loads,
    settings={
        "tolerance": "largest accepted error of the compliance, in g_0, from 1e-13 to 1; the bound is within it",
    },
    applies=applies_to_resolvable,
    takes_traces=True,
    numerical=True,
    style=Style("#000000", (), "d"),
    noise=Noise(1e-10, 1e-7),  # These go with the default tolerance, 1e-10.
    run_kernels=_run_kernels,
    variants=_variants,
    seconds=_seconds,
    candidates=candidates,
)
