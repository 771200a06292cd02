"""The method "auto": curves within a tolerance by the fewest terms.

If terms of total amplitude G are left out, h lies in [h_k, h_k + 2 G] (docs/closed_forms.md, "Bounds on the terms
left out"). Half of the tolerance is for these terms, the rest for the solution of the others. R of an infinite series
is estimated from successive truncations ("A tolerance of the resistance" there).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from weier.checks import checked_number, checked_word
from weier.kernels.arrays import Array
from weier.methods import bem, patches
from weier.methods.curve import COMPLIANCE, QUANTITIES, RESISTANCE, Curve
from weier.methods.errors import MARGIN, OutOfReachError
from weier.methods.load_progress import converting
from weier.methods.method import TOLERANCES, Method, Setting, Style
from weier.surface.profile import Profile, terms_within
from weier.surface.waves import MAX_WAVES, Waves, checked_surface
from weier.theory.bounds import complete_bounds, first_contact, resistance_bounds

TOLERANCE = 1e-3
MAX_LISTED = 5  # a message lists at most this many loads
# stated error of R over the sum of the remaining differences, extrapolated by the decay of the amplitudes; true
# errors were at most 0.88 of it in 69 cases (`python -m benchmarks truncated_resistance --count 40`)
DIFFERENCE_FACTOR = 4.0
# NaN if terms are left out
CONTACT_QUANTITIES = "indentation", "contact_fraction", "contact_fraction_error", "elastic_energy", "patch_count"


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
        Accepted error of the compliance, in g_0; or of the resistance, relative to the larger of R and 1 g_0/p_0*:
        if terms are left out, it is estimated from successive truncations and is no bound.
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
    middle is returned, with the error G. The kept terms are solved by contact patches, whose a-posteriori bound is
    evaluated on samples, so that the curve of the infinite series also has a bound. A surface that is kept whole is
    solved by boundary elements if their error, which is a theorem at first contact and was never exceeded in tests at
    other loads, meets the tolerance on a grid no finer than the default one. For a tolerance of the resistance all
    terms of a finite series are kept; for an infinite one, further terms are added while it is solved.

    Examples
    --------
    >>> import weier
    >>> weier.choose(weier.Profile(D=1.25, gamma=5, m=float("inf")), tolerance=1e-2)
    the first 5 terms by method "patches", tolerance 0.0066; the others change h by 0.0034 g_0 at most

    """
    surface = checked_surface(profile)
    checked_word("quantity", quantity, QUANTITIES)
    wanted = checked_number("tolerance", tolerance, f"lie in {TOLERANCES}", TOLERANCES.__contains__)
    if quantity == RESISTANCE:
        return _for_resistance(surface, wanted)
    most_omitted = min(wanted / 2, wanted - TOLERANCES.least)
    kept, left_out = _fewest_terms(surface, most_omitted)
    if left_out > most_omitted:
        raise OutOfReachError(_out_of_reach(surface, kept, left_out, wanted))
    method = bem.METHOD if not left_out and bem.within_few_points(kept, wanted) else patches.METHOD
    return Choice(kept, left_out, method, {"tolerance": wanted - left_out})


def _for_resistance(surface: Waves, tolerance: float) -> Choice:
    # A hundredth is arbitrary: the stated error of R is checked after the solution.
    settings = {"tolerance": min(max(1e-2 * tolerance, TOLERANCES.least), patches.TOLERANCE)}
    if not math.isinf(surface.m):
        patches.METHOD.check_applies(surface)
        return Choice(surface, 0.0, patches.METHOD, settings)
    kept, left_out = _fewest_terms(surface, tolerance / DIFFERENCE_FACTOR, least=3)
    if kept.m < 3:
        raise OutOfReachError(
            f"the resistance of {surface.describe()} is estimated from three truncations, and {kept.m:g} terms are "
            "the most that can be resolved: take a finite m"
        )
    return Choice(kept, left_out, patches.METHOD, settings)


def _fewest_terms(surface: Waves, most_omitted: float, least: int = 1) -> tuple[Waves, float]:
    """Return the fewest terms k with a tail G_k <= `most_omitted`, and G_k, in g_0; at most the resolvable terms."""
    if not isinstance(surface, Profile):
        patches.METHOD.check_applies(surface)
        return surface, 0.0
    most = terms_within(surface, MAX_WAVES)
    kept = next((k for k in range(least, most) if surface.amplitude_beyond(k) <= most_omitted), most)
    return surface.truncated(kept), surface.amplitude_beyond(kept)


def _out_of_reach(surface: Waves, kept: Waves, left_out: float, tolerance: float) -> str:
    least = MARGIN * max(2 * left_out, left_out + TOLERANCES.least)
    which = f"for the compliance of {surface.describe()}"
    why = f"{kept.m:g} terms are the most that can be resolved, and the others sum to {left_out:.1e} g_0"
    others = "a shorter series, or an estimate such as the layer, which states no error"
    if least >= TOLERANCES.most:
        return f"no tolerance is within reach {which}: {why}; take {others}"
    return (
        f"tolerance must be at least {least:.1e} g_0 {which}, got {tolerance:g}: {why}; take a larger one, {others}"
    )


def _solve(profile: Waves, loads: Array, tolerance: float = TOLERANCE, quantity: str = COMPLIANCE) -> Curve:
    choice = choose(profile, tolerance, quantity)
    if quantity == RESISTANCE and choice.left_out and isinstance(profile, Profile):
        return _extrapolated(profile, choice, loads, tolerance)
    with converting(lambda solved: (solved[0], _as_curve(profile, choice, *solved))):
        solved = choice.method.solve(choice.kept, loads, **choice.settings)
    if quantity == RESISTANCE:
        _check_resistance(solved, loads, tolerance)
    return _as_curve(profile, choice, loads, solved)


def _as_curve(profile: Waves, choice: Choice, loads: Array, solved: Curve) -> Curve:
    """Return the curve of the whole surface from the curve of the terms solved.

    If terms are left out, R of the terms solved is kept, with an error from chords of the concave h(p); quantities of
    the contact are NaN, and there are no edges.
    """
    solved = replace(solved, chosen_method=choice.method.name, chosen_terms=float(choice.kept.m))
    if not choice.left_out:
        return solved
    known = solved.values()
    low, high = complete_bounds(
        solved.compliance, choice.left_out, profile.total_amplitude, known["compliance_error"]
    )
    unknown: dict[str, Any] = {name: np.full(loads.size, np.nan) for name in CONTACT_QUANTITIES if name in known}
    whole = replace(
        solved,
        compliance=(low + high) / 2,
        compliance_error=(high - low) / 2,
        contact_edge=np.empty((loads.size, 0)),
        **unknown,
    )
    return _with_resistance_error(choice, loads, whole)


def _with_resistance_error(choice: Choice, loads: Array, curve: Curve) -> Curve:
    """Return the curve of a truncated series with the error of its resistance by chords over all loads."""
    R, error = curve.resistance, curve.values()["compliance_error"]
    shallowest, steepest = resistance_bounds(loads, curve.compliance, 0.0, first_contact(choice.kept), error)
    return replace(curve, resistance_error=np.maximum(steepest - R, R - shallowest))


def _extrapolated(profile: Profile, choice: Choice, loads: Array, tolerance: float) -> Curve:
    """Return the curve of an infinite series with as many terms as its resistance requires, and the estimated error.

    The differences of successive truncations decay about as the amplitudes, by the factor q = gamma^(D-2) a term, so
    that the remaining ones sum to the last one times q/(1 - q). No terms are added if the tolerance cannot be
    reached with the largest number of terms that can be resolved.
    """
    q, most, curves = float(profile.gamma) ** (profile.D - 2), terms_within(profile, MAX_WAVES), list[Curve]()
    for k in range(1, most + 1):
        # Near full contact of a truncation R vanishes, and the difference to the next truncation means nothing.
        if loads[-1] > 0.5 * profile.truncated(k).full_contact_load:
            continue
        with converting(lambda _: None):  # listeners expect a curve of all terms, not of fewer
            curves.append(choice.method.solve(profile.truncated(k), loads, **choice.settings))
        if len(curves) < 3:
            continue
        solved, R = curves[-1], [curve.resistance for curve in curves[-3:]]
        difference = np.maximum(np.abs(R[2] - R[1]), q * np.abs(R[1] - R[0]))
        error = DIFFERENCE_FACTOR * q / (1 - q) * difference + solved.values()["resistance_error"]
        excess = float(np.max(error / np.fmax(solved.resistance, 1))) / tolerance
        if (excess <= 1 and k >= choice.kept.m) or q ** (most - k) * excess > 1:
            break
    if len(curves) < 3:
        raise OutOfReachError(
            f"the resistance under {loads[-1]:.6g} p_0* cannot be estimated for {profile.describe()}: the {most} "
            "terms that can be resolved are nearly in full contact; take lighter loads"
        )
    if not excess <= 1:
        least = f"tolerance must be at least {MARGIN * excess * tolerance:.1e}, got {tolerance:g}:"
        raise OutOfReachError(
            f"{'no tolerance is within reach:' if MARGIN * excess * tolerance >= 1 else least} the resistance of "
            f"{profile.describe()} is known to {excess * tolerance:.1e} from the first {k} terms, and each of the "
            f"{most - k} more that can be resolved leaves about {q:.2f} of that; take heavier loads or a finite m"
        )
    reached = replace(choice, kept=profile.truncated(k), left_out=profile.amplitude_beyond(k))
    return replace(_as_curve(profile, reached, loads, solved), resistance_error=error)


def _check_resistance(solved: Curve, loads: Array, tolerance: float) -> None:
    """Raise OutOfReachError if the stated error of the resistance exceeds the tolerance."""
    error = solved.values()["resistance_error"] / np.fmax(solved.resistance, 1)
    exceeding = ~(error <= tolerance)
    if exceeding.any():
        listed = ", ".join(f"{load:.6g}" for load in loads[exceeding][:MAX_LISTED])
        raise OutOfReachError(
            f"tolerance must be at least {MARGIN * error[exceeding].max():.1e} for the resistance at these loads, "
            f"got {tolerance:g}: the error is larger at {exceeding.sum()} of {loads.size} loads ({listed}), as next "
            "to a birth or a merger; take a larger one, or leave them out"
        )


def _seconds(profile: Waves, loads: Array, **settings: Any) -> float:
    """Return the expected seconds of the method that is chosen; inf if the tolerance is out of reach."""
    try:
        choice = choose(profile, **settings)
    except OutOfReachError:
        return math.inf
    return choice.method.seconds(choice.kept, loads, **choice.settings)


METHOD = Method(
    name="auto",
    label="within a tolerance",
    summary="the fewest terms within a tolerance, by bem or patches (weier.choose); any m, also inf",
    solve=_solve,
    returns=tuple(dict.fromkeys([*bem.METHOD.returns, *patches.METHOD.returns, "chosen_method", "chosen_terms"])),
    settings={
        "tolerance": Setting(
            TOLERANCE,
            f"accepted error, in {TOLERANCES}: of h, in g_0; of R, relative to the larger of R and 1 g_0/p_0*",
            TOLERANCES,
        ),
        "quantity": Setting(COMPLIANCE, "quantity of the tolerance, compliance or resistance", QUANTITIES),
    },
    takes_traces=True,
    infinite=True,
    check=choose,
    style=Style("#56B4E9", (3, 0.8), "X"),
    seconds=_seconds,
)
