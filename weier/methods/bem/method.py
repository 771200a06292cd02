"""Boundary elements as one of the methods."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem import error_model
from weier.methods.bem.candidates import candidates
from weier.methods.bem.solver import Curve, checked_points, curve
from weier.methods.method import Method, Noise, Settings, Style, applies_to_resolvable
from weier.theory.profile import Profile

# Points for each of the finest waves: from the paper's 12 to 10^5. Halved, they stay whole.
POINTS_COMPARED = (12, 24, 48, 96, 192, 384, 768, 1536, 6144, 98304)
MAX_POINTS_COMPARED = 100_000  # in one period
RESIDUALS_COMPARED = (1e-2, 1e-4, 1e-6)  # beside the default 1e-10, on 96 points a wave
POINTS_AT_RESIDUALS = 96


def _variants(profile: Profile) -> Iterator[tuple[str, Settings]]:
    """Points for each of the finest waves; residuals at which the solver stops; the compliance alone."""
    waves = profile.waves_per_period[-1]
    for count in POINTS_COMPARED:
        if count * waves <= MAX_POINTS_COMPARED:
            yield f"{count}", {"points": count * waves}
    grid = {"points": POINTS_AT_RESIDUALS * waves}
    for residual in RESIDUALS_COMPARED:
        yield f"{POINTS_AT_RESIDUALS} {residual:.0e}", {**grid, "tolerance": residual}
    yield f"{POINTS_AT_RESIDUALS} h", {**grid, "resistance": False}


def _solution_error(profile: Profile, solved: Curve) -> float:
    """What grid and residual leave of the compliance, in g_0."""
    return error_model.solution_error(profile, solved.points, float(solved.residual.max(initial=0.0)))


def _seconds(profile: Profile, loads: Array) -> float:
    """On the default grid, at most: at each load as many contacts as there are waves."""
    contacts = np.full(loads.size, float(profile.waves_per_period[-1]))
    start, each = error_model.seconds(checked_points(profile), contacts)
    return start + float(each.sum())


METHOD = Method(
    name="bem",
    label="boundary elements",
    summary="boundary elements of linear pressure (5.1); finite m",
    solve=curve,
    applies=applies_to_resolvable,
    numerical=True,
    style=Style("#000000", (), "o"),
    noise=Noise(1e-9, 1e-5),  # a residual of 1e-10, a rate solved to 1e-6
    algorithms=({}, {"solver": "direct"}),
    options=({"edges": "subgrid"},),
    variants=_variants,
    seconds=_seconds,
    solution_error=_solution_error,
    candidates=candidates,
)
