"""The choice of the terms and the method for a curve within a tolerance.

If terms of total amplitude G are omitted, h lies in [h_k, h_k + 2 G] (docs/closed_forms.md, "Bounds on the
terms left out"). Half of the tolerance is for the omitted terms, the rest for the solution of the others.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from weier.checks import checked_number, checked_word
from weier.methods import bem, patches
from weier.methods.errors import MARGIN, OutOfReachError
from weier.methods.method import COMPLIANCE, QUANTITIES, RESISTANCE, Method
from weier.surface.limits import MAX_WAVES
from weier.surface.profile import Profile, terms_within
from weier.surface.waves import Waves, checked_surface

TOLERANCE = 1e-3


@dataclass(frozen=True, repr=False)
class Choice:
    """The terms and method for a curve within a tolerance; displayed as a sentence.

    Attributes
    ----------
    kept : Profile or Trace
        The surface solved: the first terms of a series, or all of it.
    left_out : float
        Sum of the amplitudes of the other terms, in g_0.
    method : Method
        The method that solves it.
    settings : dict
        Its settings.
    """

    kept: Waves
    left_out: float
    method: Method
    settings: Mapping[str, Any]

    def __repr__(self) -> str:
        """Return the choice in a sentence."""
        terms = f"the first {self.kept.m:g} terms" if self.left_out else "all terms"
        others = f"; the others change h by {self.left_out:.2g} g_0 at most" if self.left_out else ""
        return f'{terms} by method "{self.method.name}", tolerance {self.settings["tolerance"]:.2g}{others}'


def choose(profile: Waves, tolerance: float = TOLERANCE, quantity: str = COMPLIANCE) -> Choice:
    """Choose the terms and the method for a curve within a tolerance, without solving it.

    Parameters
    ----------
    profile : Profile or Trace
        A surface with any number of terms, also inf.
    tolerance : float
        Accepted error of the compliance, in g_0; or of the resistance, relative to the larger of R and 1 g_0/p_0*.
    quantity : "compliance" or "resistance"
        The quantity of the tolerance.

    Returns
    -------
    Choice
        With the attributes `kept`, `left_out`, `method` and `settings`.

    Raises
    ------
    ValueError
        If the tolerance or the quantity is out of range; OutOfReachError, with the smallest tolerance within reach,
        if the terms needed cannot be resolved.

    Notes
    -----
    The omitted terms have a total amplitude G of at most half the tolerance. Since h lies in [h_k, h_k + 2 G], the
    middle is returned, with the error G. The kept terms are solved by boundary elements if their bound meets the
    rest of the tolerance on a grid no finer than the default one, otherwise by contact patches. The bound of boundary
    elements is a theorem at first contact, and at heavier loads one that no test has exceeded. For a tolerance of the
    resistance all terms are kept.

    Examples
    --------
    >>> import weier
    >>> weier.choose(weier.Profile(D=1.25, gamma=5, m=float("inf")), tolerance=1e-2)
    the first 5 terms by method "bem", tolerance 0.0066; the others change h by 0.0034 g_0 at most

    """
    surface = checked_surface(profile)
    checked_word("quantity", quantity, QUANTITIES)
    least, most = patches.MIN_TOLERANCE, patches.MAX_TOLERANCE
    wanted = checked_number(
        "tolerance", tolerance, f"lie in [{least:g}, {most:g})", lambda number: least <= number < most
    )
    if quantity == RESISTANCE:
        return _for_resistance(surface, wanted)
    most_omitted = min(wanted / 2, wanted - least)
    kept, left_out = _fewest_terms(surface, most_omitted)
    if left_out > most_omitted:
        raise OutOfReachError(_out_of_reach(surface, kept, left_out, wanted))
    rest = wanted - left_out
    if bem.within_few_points(kept, rest):
        return Choice(kept, left_out, bem.METHOD, {"tolerance": rest})
    return Choice(kept, left_out, patches.METHOD, {"tolerance": rest})


def _for_resistance(surface: Waves, tolerance: float) -> Choice:
    if math.isinf(surface.m):
        raise OutOfReachError(
            "the resistance of an infinite series has bounds only: ask for its compliance, whose curve has them as "
            f"resistance_error, or take a finite m; got {surface.describe()}"
        )
    patches.METHOD.check_applies(surface)
    # A hundredth is arbitrary: the stated error of R is checked after the solution.
    h_tolerance = min(max(1e-2 * tolerance, patches.MIN_TOLERANCE), patches.TOLERANCE)
    return Choice(surface, 0.0, patches.METHOD, {"tolerance": h_tolerance})


def _fewest_terms(surface: Waves, most_omitted: float) -> tuple[Waves, float]:
    """Return the first terms of a surface whose tail is at most `most_omitted`, and that tail, in g_0.

    If more are needed than can be resolved, return the largest number of terms that can.
    """
    if not isinstance(surface, Profile):
        patches.METHOD.check_applies(surface)
        return surface, 0.0
    most = terms_within(surface, MAX_WAVES)
    kept = next((k for k in range(1, most) if surface.amplitude_beyond(k) <= most_omitted), most)
    return surface.truncated(kept), surface.amplitude_beyond(kept)


def _out_of_reach(surface: Waves, kept: Waves, left_out: float, tolerance: float) -> str:
    least = MARGIN * max(2 * left_out, left_out + patches.MIN_TOLERANCE)
    which = f"for the compliance of {surface.describe()}"
    why = f"{kept.m:g} terms are the most that can be resolved, and the others sum to {left_out:.1e} g_0"
    others = "a shorter series, or an estimate such as the layer, which states no error"
    if least >= patches.MAX_TOLERANCE:
        return f"no tolerance is within reach {which}: {why}; take {others}"
    return (
        f"tolerance must be at least {least:.1e} g_0 {which}, got {tolerance:g}: {why}; take a larger one, {others}"
    )
