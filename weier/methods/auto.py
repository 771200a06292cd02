"""The method "auto": curves within a tolerance, by the terms and the method of `weier.choose`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from weier.checks import checked_word
from weier.kernels.arrays import Array
from weier.methods.choice import TOLERANCE, choose
from weier.methods.errors import MARGIN, OutOfReachError
from weier.methods.method import COMPLIANCE, QUANTITIES, RESISTANCE, Method, Style
from weier.surface.waves import Waves
from weier.theory.bounds import complete_bounds, first_contact, resistance_bounds

MAX_LISTED = 5  # loads in a message


class AutoCurve(NamedTuple):
    """Curves within a tolerance over the loads, each of shape (loads,), and how they were solved.

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*, of the terms solved
    compliance_error : a bound, in g_0, if that of the method is one
    resistance_error : that of the method, or by chords of the concave h(p) where terms are left out, in g_0/p_0*
    contact_fraction : length in contact per length; NaN where terms are left out
    second_attempts : the number of loads at which the first attempt of patches failed; a scalar
    chosen_method, chosen_terms : the method and its number of terms; scalars
    """

    compliance: Array
    resistance: Array
    compliance_error: Array
    resistance_error: Array
    contact_fraction: Array
    second_attempts: int
    chosen_method: str
    chosen_terms: float


def _solve(profile: Waves, loads: Array, tolerance: float = TOLERANCE, quantity: str = COMPLIANCE) -> AutoCurve:
    choice = choose(profile, tolerance, quantity)
    solved = choice.method.solve(choice.kept, loads, **choice.settings)
    if quantity == RESISTANCE:
        _check_resistance(solved, loads, tolerance)
    how: Any = {
        "second_attempts": getattr(solved, "second_attempts", 0),
        "chosen_method": choice.method.name,
        "chosen_terms": float(choice.kept.m),
    }
    if not choice.left_out:
        return AutoCurve(**{name: getattr(solved, name) for name in AutoCurve._fields if name not in how}, **how)
    low, high = complete_bounds(solved.compliance, choice.left_out, profile.total_amplitude, solved.compliance_error)
    h, error = (low + high) / 2, (high - low) / 2
    shallowest, steepest = resistance_bounds(loads, h, 0.0, first_contact(choice.kept), error)
    R_error = np.maximum(steepest - solved.resistance, solved.resistance - shallowest)
    return AutoCurve(h, solved.resistance, error, R_error, np.full(loads.size, np.nan), **how)


def _check_resistance(solved: Any, loads: Array, tolerance: float) -> None:
    """Refuse a curve whose stated error of the resistance is not within the tolerance."""
    error = solved.resistance_error / np.fmax(solved.resistance, 1)
    exceeding = ~(error <= tolerance)
    if exceeding.any():
        listed = ", ".join(f"{load:.6g}" for load in loads[exceeding][:MAX_LISTED])
        raise OutOfReachError(
            f"tolerance must be at least {MARGIN * error[exceeding].max():.1e} for the resistance at these loads, "
            f"got {tolerance:g}: the error is larger at {exceeding.sum()} of {loads.size} loads ({listed}), as next "
            "to a birth or a merger; take a larger one, or leave them out"
        )


def _check(profile: Waves, quantity: str = COMPLIANCE, **others: Any) -> None:
    """Refuse a quantity that is neither compliance nor resistance."""
    checked_word("quantity", quantity, QUANTITIES)


def _seconds(profile: Waves, loads: Array, **settings: Any) -> float:
    try:
        choice = choose(profile, **settings)
    except OutOfReachError:
        return 0.0
    return choice.method.seconds(choice.kept, loads, **choice.settings)


METHOD = Method(
    name="auto",
    label="within a tolerance",
    summary="the fewest terms within a tolerance, by bem or patches (weier.choose); any m, also inf",
    solve=_solve,
    settings={
        "tolerance": "accepted error: of h, in g_0; of R, relative to the larger of R and 1 g_0/p_0*",
        "quantity": "quantity of the tolerance, compliance or resistance",
    },
    check=_check,
    style=Style("#56B4E9", (3, 0.8), "X"),
    seconds=_seconds,
)
