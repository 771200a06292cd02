"""Plans as one of the methods (docs/planned.md)."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from weier.checks import checked_word
from weier.kernels.arrays import Array
from weier.methods.method import Method, Noise, Style
from weier.methods.plan_part import COMPLIANCE, QUANTITIES
from weier.methods.planned.plan import TOLERANCE
from weier.methods.planned.solver import PlannedCurve, curve
from weier.surface.profile import Profile


def _check(profile: Profile, quantity: str = COMPLIANCE, **others: Any) -> None:
    """Refuse a quantity that is neither compliance nor resistance."""
    checked_word("quantity", quantity, QUANTITIES)


def planning_method(among: Callable[[], tuple[Method, ...]]) -> Method:
    """The method that plans among others, which are looked up when a plan is made."""

    def solve(
        profile: Profile, loads: Array, tolerance: float = TOLERANCE, quantity: str = COMPLIANCE
    ) -> PlannedCurve:
        return curve(profile, loads, among(), tolerance, quantity)

    return Method(
        name="planned",
        label="planned",
        runs_others=True,
        summary="whichever of these meets a tolerance, as weier.plan chooses and explains; any m",
        solve=solve,
        settings={
            "tolerance": "largest error: of h, in g_0; of R, relative to the larger of itself and 1 g_0/p_0*",
            "quantity": "which of the two is to be that accurate, compliance or resistance",
        },
        check=_check,
        style=Style("#56B4E9", (3, 0.8), "X"),
        variants=lambda profile: (),  # The variants of the other methods are compared instead.
        noise=Noise(TOLERANCE, math.inf),  # Parts by several methods, for the compliance alone.
    )
