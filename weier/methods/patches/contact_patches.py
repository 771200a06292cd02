"""Declare the method of contact patches."""

from __future__ import annotations

import numpy as np

from weier.methods.method import CURVE_SECONDS, TOLERANCES, Method, Setting, Style, applies_to_resolvable
from weier.methods.patches import stages
from weier.methods.patches.certificate import sample_points
from weier.methods.patches.given_edges import (
    make_punches,
    moved_expansion,
    solve_forces_on_contacts,
    transfer_forces,
)
from weier.methods.patches.pressure_and_gap import complementary_residuals
from weier.methods.patches.solver import MIN_LOAD, curve
from weier.methods.patches.start import TOLERANCE, isolated_contacts, isolated_gaps
from weier.methods.patches.surface import surface_of
from weier.methods.patches.thin_gaps import densities_on_contacts
from weier.surface.profile import Profile


def run_kernels() -> None:
    """Solve for one contact and for one gap with the solvers of few and of many, and take both kinds of sums.

    Nothing starts from boundary elements, which may still be compiled by another process.
    """
    one_wave, light = Profile(D=1.25, gamma=2, m=1), 1e-3
    surface = surface_of(one_wave)
    nearly_full = surface.full_contact_load - light
    for guess in (isolated_contacts(surface.heights, light), isolated_gaps(surface.tensions, nearly_full)):
        assert guess is not None
        kind, series = guess.kind, guess.kind.series(surface)
        curve(one_wave, guess.load)
        state, _ = stages.solve_in_stages(surface, guess, TOLERANCE)
        punches, none = make_punches(state.segments, series.period, kind, most=0), np.zeros_like(state.coefficient)
        solve_forces_on_contacts(punches, none + kind.increment, guess.load, none, 0.0, 1.0)
        segments, first, b = state.segments, np.zeros(1, np.int64), state.coefficient
        still = np.zeros_like(segments.half_width)
        moved_expansion(segments.first_node, segments.half_width, b, b, still, still)
        transfer_forces(segments, b, first, punches)
        for singular in (False, True):
            densities_on_contacts(segments.first_node, state.coefficient, first, np.zeros((1, 1)), singular)
        _, crest, y = sample_points(state.segments)
        complementary_residuals(state, series, crest, y)


METHOD = Method(
    name="patches",
    label="contact patches",
    summary="contact edges as unknowns, ten digits; finite m",
    solve=curve,
    returns=(
        "compliance_error",
        "resistance_error",
        "indentation",
        "contact_fraction",
        "contact_fraction_error",
        "elastic_energy",
        "patch_count",
        "residual",
        "work",
        "contact_edge",
        "second_attempts",
    ),
    settings={
        "tolerance": Setting(
            TOLERANCE,
            f"accepted error of the compliance, in g_0, in {TOLERANCES}; the stated bound is within it",
            TOLERANCES,
        ),
    },
    takes_traces=True,
    least_load=MIN_LOAD,
    applies=applies_to_resolvable,
    numerical=True,
    style=Style("#000000", (), "d"),
    by_load=lambda **settings: True,
    run_kernels=run_kernels,
    seconds=lambda profile, loads, **settings: (
        CURVE_SECONDS + 7e-4 * loads.size * profile.waves_per_period[-1] ** 0.8
    ),
)
