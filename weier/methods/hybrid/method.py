"""Resolved terms on the layer of all finer ones, as one of the methods (docs/hybrid.md)."""

from __future__ import annotations

from typing import Any

from weier.kernels.arrays import Array
from weier.methods.hybrid.solver import (
    MAX_POINTS,
    POINTS_PER_WAVE,
    HybridCurve,
    check_infinite,
    checked_points,
    curve,
    default_points,
)
from weier.methods.method import Method, Style
from weier.surface.profile import Profile, terms_within

DEFAULT_POINTS = 2**11  # nodes that limit the default number of resolved terms
# of the table of the layer, of a load, and of each of its nodes: `python -m weier.accuracy expected_seconds`
SECONDS = 0.17, 0.004, 2e-5


def _solve(profile: Profile, loads: Array, terms: int | None = None) -> HybridCurve:
    return curve(profile, loads, terms or _default_terms(profile))


def _default_terms(profile: Profile) -> int:
    return terms_within(profile, DEFAULT_POINTS / POINTS_PER_WAVE)


def _check(profile: Profile, terms: int | None = None) -> None:
    """Refuse more terms than the grid resolves."""
    if terms is not None:
        checked_points(profile.truncated(terms))


def _seconds(
    profile: Profile,
    loads: Array,
    terms: int | None = None,
    constants: tuple[float, float, float] = SECONDS,
    **settings: Any,
) -> float:
    """Return expected seconds of a curve: the table of the layer, and Newton's method on the nodes of these terms."""
    start, load, node = constants
    points = min(default_points(profile.truncated(terms or _default_terms(profile))), MAX_POINTS)  # more are refused
    return start + loads.size * (load + node * points)


METHOD = Method(
    name="hybrid",
    label="resolved terms on the layer",
    summary="coarse terms by boundary elements on the layer of all finer ones; m = inf",
    solve=_solve,
    settings={"terms": "number of terms to resolve; by default the largest that fits on the default grid"},
    applies=check_infinite,
    seconds=_seconds,
    check=_check,
    style=Style("#8C510A", (4, 1, 1, 1), "D"),
)
