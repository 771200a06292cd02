"""Stability at the extremes: all methods at the limits of floats, load by load, as tables.

A curve rises and is concave, its resistance lies between the chords on both sides, and so falls, and both lie within
the bounds that the closed form of the first wave gives for all longer series (Section 5.5).
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.accuracy.ill_conditioned import Extreme, extremes
from weier.accuracy.measurement import measurement, number
from weier.accuracy.reference import deviation, digits, find_reference
from weier.accuracy.runner import Outcome, Variant, attempt
from weier.data.markdown import plain, table
from weier.kernels.arrays import Array
from weier.methods import westergaard
from weier.methods.registry import find_method
from weier.surface.profile import Profile
from weier.theory.bounds import resistance_bounds

# Unstated errors: of heights relative to the total amplitude, and relative errors of slopes. The layer interpolates
# tables of accuracy 1e-5.
ROUNDING, NOISE = (1e-12, 1e-11), {"layer": (1e-6, 1e-5)}

HEADER = ("method", "extremes", "numbers", "errors in words", "least digits of h", "of R", "largest error of h")


class Examined(NamedTuple):
    """A variant at an extreme.

    outcome : at each load
    error, digits : errors of h and R, and their correct digits, shape (2, loads); NaN without a reference
    checks : whether the curve passes each check that can be made
    message : message of the first error
    """

    extreme: Extreme
    variant: Variant
    outcome: NDArray[np.int8]
    error: Array
    digits: Array
    checks: Mapping[str, bool]
    message: str

    @property
    def faults(self) -> list[str]:
        """The faults of a method, in words."""
        found = [f"not {name}".replace("_", " ") for name, holds in self.checks.items() if not holds]
        for bad in (Outcome.unclear_error, Outcome.not_finite):
            found += [bad.name.replace("_", " ")] * bool((self.outcome == bad).any())
        # Each load alone is solved.
        return found + ["not one curve"] * bool(self.message and (self.outcome == Outcome.finite).all())


def examine(cases: Iterable[Extreme]) -> list[Examined]:
    """Run all variants on all extremes."""
    found = []
    for case in cases:
        print(case.name, file=sys.stderr)
        found += [_examine(case, variant) for variant in case.variants]
    return found


def _examine(case: Extreme, variant: Variant) -> Examined:
    method = find_method(variant.method)
    result = attempt(variant, case.profile, case.loads)
    solved, right = result.outcome == Outcome.finite, find_reference(method, case.profile, case.loads, result)
    values = np.where(solved, result.values, np.nan)
    error, stated = deviation(values, right.values), np.nan_to_num(result.stated[:, solved])
    checks = {
        **check(method.name, case.profile, case.loads[solved], values[:, solved], stated),
        "within_stated_error": not np.any(error > result.stated + right.uncertainty),  # where both are known
        "without_warning": not result.warned,
    }
    return Examined(case, variant, result.outcome, error, digits(values, right.values), checks, result.message)


def check(method: str, profile: Profile, p: Array, curve: Array, stated: Array) -> dict[str, bool]:
    """Return the checks of compliance and resistance, with stated errors or 0, each of shape (2, loads), by name.

    Checks of the shape of a curve need at least two loads.
    """
    (h, R), found = curve, dict[str, bool]()
    noise, slope_noise = NOISE.get(method, ROUNDING)
    error, R_error = stated[0] + noise * profile.total_amplitude, stated[1] + slope_noise * R
    # Without a first contact, Persson's compliance falls without bound as ln p (docs/persson.md).
    if p.size > 0 and method != "persson":
        finer = profile.total_amplitude - 1  # amplitude of all waves but the first
        one, band = westergaard.compliance(p), finer + error.max()
        low, high = resistance_bounds(p, one, band, first_contact=0.0)
        within = (np.abs(h - finer - one) <= band) & (low - R_error <= R) & (R - R_error <= high)
        found["within_band"] = bool(np.all(within))
    if p.size > 1:
        found["monotone"] = bool(np.all(np.diff(h) >= -_both_ends(error)))
        with np.errstate(over="ignore", invalid="ignore"):
            slack, chord = _both_ends(error) / np.diff(p), np.diff(h) / np.diff(p)
            between = (chord <= (R + R_error)[:-1] + slack) & (chord >= (R - R_error)[1:] - slack)
        found["concave"] = bool(np.all(between))
    return found


def _both_ends(error: Array) -> Array:
    """Return the sum of the errors at both ends of each interval of loads."""
    return np.asarray(error[:-1] + error[1:])


def parts(found: Sequence[Examined]) -> Iterator[str]:
    """Yield the faults, the largest errors by method and by extreme, and an error message of each kind."""
    faults = [f"{one.extreme.name}, {one.variant.method}: {', '.join(one.faults)}" for one in found if one.faults]
    names = list(dict.fromkeys(one.variant.method for one in found))
    messages = dict.fromkeys(one.message for one in found if one.message)
    one_of_each = {re.split(r"\d", message)[0]: message for message in reversed(messages)}
    listed = f"and these have a fault:\n\n{_list(faults)}" if faults else "none of them with a fault."
    yield f"{len(found)} rows, {listed}"
    yield "## By method\n\nThe errors of h are in g_0."
    yield table(HEADER, [_summary(name, [one for one in found if one.variant.method == name]) for name in names])
    yield "## Digits of the compliance"
    cells = {(one.extreme.name, one.variant.method): _digits_left(one) for one in found}
    cases = dict.fromkeys(case for case, _ in cells)
    yield table(
        ["extreme", *names], [[plain(case), *(cells.get((case, name), "") for name in names)] for case in cases]
    )
    yield "## Error messages\n\nOne of each kind:"
    yield _list(reversed(one_of_each.values()))


def _list(texts: Iterable[str]) -> str:
    return "\n".join(f"- {plain(text)}" for text in texts)


def _digits_left(one: Examined) -> str:
    """Return the least correct digits of h, or what became of the loads."""
    refused = one.outcome != Outcome.finite
    if refused.all():
        return "all refused"
    left = number(float(np.fmin.reduce(one.digits[0])), ".1f") or "finite"
    return f"{left}, some refused" if refused.any() else left


def _summary(name: str, found: Sequence[Examined]) -> list[str]:
    """Return the cells of a variant, below `HEADER`."""
    outcome = np.concatenate([one.outcome for one in found])
    error, digits = (np.concatenate([getattr(one, kind) for one in found], axis=1) for kind in ("error", "digits"))
    finite = np.count_nonzero(outcome == Outcome.finite)
    least = (number(float(np.fmin.reduce(own)), ".1f") for own in digits)
    largest = number(float(np.fmax.reduce(error[0])))
    return [plain(name), str(len(found)), str(finite), str(outcome.size - finite), *least, largest]


@measurement("Stability at the extremes")
def main() -> list[str]:
    """Examine all methods at the limits of floats.

    Each method is run at ill-conditioned loads of series at the limits of their parameters. Every load must give a
    number or a clear error, and the numbers must be a curve of compliance, within the errors that the method states.
    `docs/stability.md` has this page with its definitions.
    """
    return [*parts(examine(extremes()))]
