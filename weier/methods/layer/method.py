"""The non-linear layer as one of the methods (docs/layer.md, "Error and limits")."""

from __future__ import annotations

import math
from typing import Any

from weier.kernels.arrays import Array
from weier.methods.layer.solver import MAX_ACCURACY, MAX_POINTS, MIN_ACCURACY, MIN_POINTS, POINTS, check, curve
from weier.methods.method import Method, Style
from weier.surface.profile import Profile

# of a table of a finite series and of the infinite one, nodes that double them, and seconds of a load:
# `python -m benchmarks expected_seconds`
SECONDS = 0.008, 0.1, 42.0, 1e-4


def _seconds(
    profile: Profile,
    loads: Array,
    points: int = POINTS,
    constants: tuple[float, float, float, float] = SECONDS,
    **settings: Any,
) -> float:
    """Return the expected seconds: one table per scale of a finite series, a single one if m = inf."""
    scale, infinite, nodes, load = constants
    tables = scale * profile.m if math.isfinite(profile.m) else infinite
    return tables * (1 + (points / nodes) ** 2) + load * loads.size


METHOD = Method(
    name="layer",
    label="non-linear layer",
    summary="each wave bears on a non-linear layer of all finer ones (4.3); any m, also inf",
    solve=curve,
    settings={
        "points": f"nodes per half wave, from {MIN_POINTS} to {MAX_POINTS}",
        "accuracy": "relative error of the compliance by the tables of finer waves, "
        f"from {MIN_ACCURACY:g} to {MAX_ACCURACY:g}",
    },
    uses_phases=False,
    in_paper=True,
    style=Style("#009E73", (1.2, 1.2), "s"),
    seconds=_seconds,
    check=check,
)
