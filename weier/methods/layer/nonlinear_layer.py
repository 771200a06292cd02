"""Declare the method of the non-linear layer (docs/layer.md, "Error and limits")."""

from __future__ import annotations

import math
from typing import Any

from weier.kernels.arrays import Array
from weier.methods.layer.layer_curve import (
    ACCURACY,
    MAX_ACCURACY,
    MAX_POINTS,
    MIN_ACCURACY,
    MIN_POINTS,
    POINTS,
    check,
    curve,
)
from weier.methods.layer.scaling_tables import MIN_LOADS
from weier.methods.method import CURVE_SECONDS, Method, Range, Setting, Style
from weier.surface.profile import Profile

INFINITE_TERMS = 11  # The tables of an infinite series take as long as the tables of this number of terms.


def _seconds(profile: Profile, loads: Array, points: int = POINTS, **settings: Any) -> float:
    """Return the expected seconds of the tables of all terms but the finest."""
    terms = profile.m if math.isfinite(profile.m) else INFINITE_TERMS
    return CURVE_SECONDS + 6e-4 * (terms - 1) * points


METHOD = Method(
    name="layer",
    label="non-linear layer",
    summary="each wave bears on a non-linear layer of all finer ones (4.3); any m, also inf",
    solve=curve,
    returns=("residual",),
    settings={
        "points": Setting(
            POINTS, f"nodes per half wave, from {MIN_POINTS} to {MAX_POINTS}", Range(MIN_POINTS, MAX_POINTS)
        ),
        "accuracy": Setting(
            ACCURACY,
            "relative error of the compliance by the tables of finer waves, "
            f"from {MIN_ACCURACY:g} to {MAX_ACCURACY:g}",
            Range(MIN_ACCURACY, MAX_ACCURACY),
        ),
    },
    infinite=True,
    least_load=MIN_LOADS[1],
    uses_phases=False,
    in_paper=True,
    style=Style("#009E73", (1.2, 1.2), "s"),
    seconds=_seconds,
    check=check,
)
