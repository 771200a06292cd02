"""The non-linear layer as one of the methods (docs/layer.md, "Error and limits")."""

from __future__ import annotations

import math
from typing import Any

from weier.kernels.arrays import Array
from weier.methods.layer.solver import ACCURACY, POINTS, LayerCurve, curve
from weier.methods.method import Method, Style
from weier.surface.profile import Profile


def _solve(
    profile: Profile,
    loads: Array,
    points: int = POINTS,
    accuracy: float = ACCURACY,
) -> LayerCurve:
    return curve(loads, profile.D, float(profile.gamma), profile.m, points, accuracy)


def _seconds(profile: Profile, loads: Array, points: int = POINTS, **settings: Any) -> float:
    """Return the expected seconds: one table per scale of a finite series, a single one if m = inf.

    The numbers are from `python -m weier.accuracy.expected_seconds`.
    """
    tables = 0.008 * profile.m if math.isfinite(profile.m) else 0.08
    return tables * (1 + (points / 33) ** 2) + 1e-4 * loads.size


METHOD = Method(
    name="layer",
    label="non-linear layer",
    summary="each wave bears on a non-linear layer of all finer ones (4.3); any m, also inf",
    solve=_solve,
    settings={
        "points": "nodes per half wave, from 4 to 500",
        "accuracy": "relative error of the compliance by the tables of finer waves, from 1e-9 to 0.01",
    },
    uses_phases=False,
    style=Style("#009E73", (1.2, 1.2), "s"),
    seconds=_seconds,
)
