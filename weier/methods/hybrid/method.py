"""Resolved terms on the layer of all finer ones, as one of the methods (docs/hybrid.md)."""

from __future__ import annotations

from typing import Any

from weier.kernels.arrays import Array
from weier.methods.hybrid.solver import POINTS_PER_WAVE, HybridCurve, check_infinite, curve
from weier.methods.method import Method, Style
from weier.surface.profile import Profile, terms_within

DEFAULT_POINTS = 2**11  # nodes that limit the default number of resolved terms


def _solve(profile: Profile, loads: Array, terms: int | None = None) -> HybridCurve:
    return curve(profile, loads, terms or terms_within(profile, DEFAULT_POINTS / POINTS_PER_WAVE))


def _seconds(profile: Profile, loads: Array, **settings: Any) -> float:
    """Return expected seconds of a curve on the default grid."""
    # from `python -m weier.accuracy.expected_seconds`
    return 0.1 + 0.013 * loads.size


METHOD = Method(
    name="hybrid",
    label="resolved terms on the layer",
    summary="coarse terms by boundary elements on the layer of all finer ones; m = inf",
    solve=_solve,
    settings={"terms": "number of terms to resolve; by default the largest that fits on the default grid"},
    applies=check_infinite,
    seconds=_seconds,
    style=Style("#8C510A", (4, 1, 1, 1), "D"),
)
