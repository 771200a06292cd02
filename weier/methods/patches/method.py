"""Contact patches as one of the methods."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.error_model import RESIDUAL_FACTOR
from weier.methods.method import Method, Noise, Settings, Style, applies_to_resolvable
from weier.methods.patches import error_model
from weier.methods.patches.candidates import candidates
from weier.methods.patches.solver import Curve, curve
from weier.theory.profile import Profile

TOLERANCES_COMPARED = (1e-6, 1e-8, 1e-10, 1e-12)  # they set the nodes of each contact


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


METHOD = Method(
    name="patches",
    label="contact patches",
    summary="the edges of contact as unknowns, ten digits; finite m, any number of contacts",
    solve=curve,
    applies=applies_to_resolvable,
    numerical=True,
    style=Style("#000000", (), "d"),
    noise=Noise(1e-10, 1e-7),  # a tolerance of 1e-10
    variants=_variants,
    seconds=_seconds,
    solution_error=_solution_error,
    candidates=candidates,
)
