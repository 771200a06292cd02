"""All methods on all extremes, in one dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from weier.accuracy import metrics, runs
from weier.accuracy.extremes import curve_checks
from weier.accuracy.extremes.ill_conditioned import extremes
from weier.accuracy.reference import find_reference
from weier.accuracy.runner import Outcome, attempt
from weier.accuracy.runs import Comparison
from weier.accuracy.variants import Variant
from weier.data.variables import CURVE, QUALITY, RUN, VARIABLES, Check, Variable
from weier.kernels.arrays import Array
from weier.methods.method import Method
from weier.methods.registry import find_method
from weier.surface.profile import Profile

# The checks of each curve, by the names of their variables.
CHECKS = {
    "monotone": "whether the compliance never falls",
    "concave": "whether the resistance falls and lies between the chords to either side",
    "within_band": "whether both lie within the bounds that the first wave sets",
    "within_stated_error": "whether both are within the errors that the method itself states",
    "one_curve": "whether all loads were solved as one curve",
    "without_warning": "whether no warning was issued",
}
DIGITS = Variable(CURVE, "", content=QUALITY)
OWN = {
    "extreme": Variable(("case",), "name of the extreme case", dtype="O", content=QUALITY),
    "outcome": Variable(CURVE, "outcome at this load", dtype="i1", flags=Outcome, content=QUALITY),
    "compliance_deviation": VARIABLES["compliance_deviation"],
    "compliance_digits": DIGITS._replace(long_name="correct digits of the compliance, relative to itself"),
    "resistance_digits": DIGITS._replace(long_name="correct digits of the resistance, relative to itself"),
    **{name: Variable(RUN, text, dtype="i1", flags=Check, content=QUALITY) for name, text in CHECKS.items()},
    "message": Variable(RUN, "error message, where there is no number", dtype="O", content=QUALITY),
    "reference": Variable(RUN, "source of the reference values", dtype="O", content=QUALITY),
}


def measure(cases: Sequence[Comparison] | None = None) -> xr.Dataset:
    """Run all methods on all extremes, or on those given.

    Returns
    -------
    Dataset
        As the dataset of a scene, with extremes for cases, each at its own loads, and variants for methods. `outcome`
        is the outcome at each load; `monotone`, `concave`, `within_band`, `within_stated_error`, `one_curve` and
        `without_warning` are checks of the curve; `compliance_digits` and `resistance_digits` are correct digits,
        from 0 to 16, where a reference is known.

    """
    cases = list(extremes() if cases is None else cases)
    data = runs.blank(cases, runs.KEPT, OWN)
    data["extreme"].values[:] = [case.name for case in cases]
    for name in CHECKS:
        data[name].values[:] = Check.not_measured
    runs.fill(data, cases, _examine)
    return data


def _examine(compared: Comparison, variant: Variant) -> dict[str, Any]:
    """Return the values of one run: its curve, outcomes, errors and checks."""
    method, profile = find_method(variant.method), compared.case.profile
    result = attempt(variant, profile, compared.loads)
    solved, right = result.outcome == Outcome.finite, find_reference(method, profile, compared.loads, result)
    h, R = (np.where(solved, values, np.nan) for values in (result.compliance, result.resistance))
    deviation = metrics.deviation(h, right.compliance), metrics.deviation(R, right.resistance)
    digits = metrics.digits(h, right.compliance), metrics.digits(R, right.resistance)
    errors = result.compliance_error, result.resistance_error
    stated = curve_checks.Stated(*(np.nan_to_num(error[solved]) for error in errors))
    both = deviation, errors, right.uncertainty
    return {
        "compliance": h,
        "resistance": R,
        "compliance_error": errors[0],
        "compliance_deviation": deviation[0],
        "compliance_digits": digits[0],
        "resistance_digits": digits[1],
        "outcome": result.outcome,
        "message": result.message,
        "reference": right.source if np.isfinite(digits[0]).any() else "",
        "points": result.others.get("points", np.nan),
        "one_curve": Check(not result.message),
        "without_warning": Check(not result.warned),
        "within_stated_error": Check.from_bool(curve_checks.within_stated_error(*map(np.concatenate, both))),
        **_check_curve(method, profile, compared.loads[solved], h[solved], R[solved], stated, result.solution_error),
    }


def _check_curve(
    method: Method, profile: Profile, p: Array, h: Array, R: Array, stated: curve_checks.Stated, solution_error: float
) -> dict[str, Check]:
    """Return the checks of a curve at the solved loads; checks of its shape need at least two loads."""
    found, noise, total = (
        {},
        curve_checks.TABLE_NOISE.get(method.name, curve_checks.ROUNDING),
        profile.total_amplitude,
    )
    # Without a first contact, Persson's compliance falls without bound as ln p (docs/persson.md).
    if p.size > 0 and method.name != "persson":
        found["within_band"] = Check(curve_checks.within_band(profile, p, h, R, noise, stated, solution_error))
    if p.size > 1:
        found["monotone"] = Check(curve_checks.monotone(h, noise.height * total, stated))
        found["concave"] = Check(curve_checks.concave(p, h, R, noise, total, stated))
    return found
