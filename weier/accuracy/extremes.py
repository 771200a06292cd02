"""Stability at the extremes: all methods at the limits of floats, load by load, as tables."""

from __future__ import annotations

import re
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.accuracy import curve_checks
from weier.accuracy.ill_conditioned import Extreme, extremes
from weier.accuracy.measurement import measurement, number
from weier.accuracy.reference import deviation, digits, find_reference
from weier.accuracy.runner import Outcome, Variant, attempt
from weier.data.markdown import plain, table
from weier.kernels.arrays import Array
from weier.methods.registry import find_method

# checks whose failure is a fault, in addition to unclear errors
CHECKS = "monotone", "concave", "within_band", "within_stated_error", "without_warning"
DIGITS_TEXT = """\
Correct digits of h at the worst load of each extreme. *All refused*: an error is raised at all loads; *some refused*:
at some of them; *finite*: numbers without a reference; empty: the method does not apply or would take minutes."""
DEFINITIONS = """\
A row is one method at the loads of one extreme, in p_0*. An *ulp* is one unit in the last place of a number. Every
load must give a finite number or an error message of one sentence. The curve of finite numbers must pass the checks
below, within rounding, iteration error and the tolerance of the method. Any failure is a fault, and so is a warning
of numpy.

- The compliance h never falls.
- The resistance R falls, and the slope of each chord of h lies between the resistances at its ends.
- h and R lie within the bounds that the first wave, in closed form, sets on every longer series, widened by the
  stated error of the method.
- Errors of h and R do not exceed the stated ones.

*Digits* are correct digits relative to the number itself; 16 means no error. An estimate is compared with its
defining sums in 50 digits, the non-linear layer with itself on twice the points. Methods that solve the series are
compared with the exact contact: in closed form at first contact and full contact, otherwise by contact patches at a
tolerance of 1e-12 on the same profile shifted along x. Some problems are ill-conditioned:

- Within a rounding error of full contact, or of p_n* in Demelio's formula, half an ulp of p changes the resistance as
  much as the digits show.
- At light loads a grid has few digits of h, because its smallest contact is one node.
- If two crests are equally high, or 1e-15 apart, rounding of their heights decides at loads such as 1e-100 whether
  one or both touch. R then has one value or half of it, which counts as 0.3 digits."""
HEADER = ("method", "extremes", "numbers", "errors in words", "least digits of h", "of R", "largest error of h")


class Examined(NamedTuple):
    """A variant at an extreme.

    outcome : at each load
    error, digits : errors of h and R, and their correct digits, shape (2, loads); NaN without a reference
    checks : whether the curve passes each of CHECKS that can be made
    message : message of the first error
    """

    extreme: Extreme
    variant: Variant
    outcome: NDArray[np.int8]
    error: Array
    digits: Array
    checks: Mapping[str, bool | None]
    message: str

    @property
    def faults(self) -> list[str]:
        """The faults of a method, in words."""
        found = [f"not {name}".replace("_", " ") for name in CHECKS if self.checks.get(name) is False]
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
        **curve_checks.check(method.name, case.profile, case.loads[solved], values[:, solved], stated),
        "within_stated_error": curve_checks.within_stated_error(error, result.stated, right.uncertainty),
        "without_warning": not result.warned,
    }
    return Examined(case, variant, result.outcome, error, digits(values, right.values), checks, result.message)


def parts(found: Sequence[Examined]) -> Iterator[str]:
    """Yield the faults, the largest errors by method and by extreme, and an error message of each kind."""
    faults = [f"{one.extreme.name}, {one.variant.name}: {', '.join(one.faults)}" for one in found if one.faults]
    names = list(dict.fromkeys(one.variant.name for one in found))
    messages = dict.fromkeys(one.message for one in found if one.message)
    one_of_each = {re.split(r"\d", message)[0]: message for message in reversed(messages)}
    listed = f"and these have a fault:\n\n{_list(faults)}" if faults else "none of them with a fault."
    yield f"{len(found)} rows, {listed}"
    yield "## By method\n\nThe errors of h are in g_0."
    yield table(HEADER, [_summary(name, [one for one in found if one.variant.name == name]) for name in names])
    yield f"## Digits of the compliance\n\n{DIGITS_TEXT}"
    yield table(
        ["extreme", *names], [_digits_of(list(own), names) for _, own in groupby(found, lambda one: one.extreme.name)]
    )
    yield "## Error messages\n\nOne of each kind:"
    yield _list(reversed(one_of_each.values()))
    yield f"## Definitions\n\n{DEFINITIONS}"


def _list(texts: Iterable[str]) -> str:
    return "\n".join(f"- {plain(text)}" for text in texts)


def _digits_of(found: Sequence[Examined], names: Collection[str]) -> list[str]:
    """Return the least correct digits of h by each variant at one extreme."""
    by_name = {one.variant.name: one for one in found}
    return [plain(found[0].extreme.name), *(_digits_left(by_name[name]) if name in by_name else "" for name in names)]


def _digits_left(one: Examined) -> str:
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
    `docs/stability.md` is a copy of this page.
    """
    return [*parts(examine(extremes()))]
