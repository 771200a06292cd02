"""Contact patches as one of the methods."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.error_model import RESIDUAL_FACTOR
from weier.methods.method import Method, Noise, Settings, Style, applies_to_resolvable
from weier.methods.patches import error_model, many_contacts
from weier.methods.patches.candidates import candidates
from weier.methods.patches.punch_forces import MAX_DENSE, invert_punches
from weier.methods.patches.solver import TOLERANCE, Curve, curve
from weier.methods.patches.start import Starts
from weier.methods.patches.surface import surface_of
from weier.theory.profile import Profile

TOLERANCES_COMPARED = (1e-6, 1e-8, 1e-10, 1e-12)  # they set the nodes of each contact

THREE_WAVES = Profile(D=1.25, gamma=2, m=3, phases=(0.0, 1.0, 2.0))


def _variants(profile: Profile) -> Iterator[tuple[str, Settings]]:
    for tolerance in TOLERANCES_COMPARED:
        yield f"{tolerance:.0e}", {"tolerance": tolerance}


def _solution_error(profile: Profile, solved: Curve) -> float:
    """What the residual leaves of the compliance, in g_0."""
    return RESIDUAL_FACTOR * float(solved.residual.max(initial=0.0))


def _seconds(profile: Profile, loads: Array) -> float:
    """Seconds of a curve at most, with as many contacts at each load as there are waves."""
    waves = profile.waves_per_period[-1]
    return float(error_model.seconds(waves, np.full(loads.size, float(waves))).sum())


def _solve_without_matrix() -> None:
    """A few contacts by what serves thousands, and the start and the forces that only these have."""
    surface = surface_of(THREE_WAVES)
    Starts(THREE_WAVES, surface, TOLERANCE).from_fewer_waves(0.3)
    for load in (0.3, 0.9 * surface.full_contact_load):  # contacts, and gaps
        guess = list(Starts(THREE_WAVES, surface, TOLERANCE).guesses(load))[-1]
        many_contacts.solve_many_contacts(surface, guess, load, TOLERANCE)
    centre = np.arange(2.0 * MAX_DENSE)
    invert_punches(centre, np.full(centre.size, 0.1), float(centre.size))


METHOD = Method(
    name="patches",
    label="contact patches",
    summary="the edges of contact as unknowns, ten digits; finite m, any number of contacts",
    solve=curve,
    applies=applies_to_resolvable,
    numerical=True,
    style=Style("#000000", (), "d"),
    noise=Noise(1e-10, 1e-7),  # a tolerance of 1e-10
    run_rare_kernels=_solve_without_matrix,
    variants=_variants,
    seconds=_seconds,
    solution_error=_solution_error,
    candidates=candidates,
)
