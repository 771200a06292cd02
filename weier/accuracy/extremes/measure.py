"""Every method on every extreme, as one dataset."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from enum import IntEnum
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.accuracy.extremes import verdicts
from weier.accuracy.extremes.cases import Extreme, extremes
from weier.accuracy.extremes.conditioning import conditioning
from weier.accuracy.extremes.examine import Examined, Outcome, examine
from weier.accuracy.extremes.truth import TIGHTEST, Truth, truth
from weier.data import dataset
from weier.data.check import Verdict
from weier.data.variables import CURVE, RUN, flags
from weier.methods import bem, patches
from weier.methods.method import Variant
from weier.methods.registry import method_named
from weier.pipeline.batch import describe_case
from weier.theory.profile import Profile

KEPT = (
    "total_amplitude", "tail_amplitude", "first_contact", "compliance", "resistance", "compliance_error", "points",
    "settings",
)  # fmt: skip


VERDICTS = {
    "monotone": "whether the compliance never falls",
    "concave": "whether the resistance falls and lies between the chords to either side",
    "inside": "whether both lie within the bounds that the first wave sets",
    "as_expected": "whether both are within the errors that the method itself expects",
    "together": "whether all loads were solved as one curve",
    "silent": "whether nothing was warned of",
}
TEXTS = {"message": "what was said where there is no number", "compared_with": "what the digits are counted against"}
DIGITS = {
    "compliance_digits": "correct digits of the compliance, relative to itself",
    "resistance_digits": "correct digits of the resistance, relative to itself",
}


def measure(cases: Sequence[Extreme] | None = None) -> xr.Dataset:
    """Run all methods on all extremes, or on those given.

    Returns
    -------
    Dataset
        As the dataset of a scene, with extremes for cases, each at its own loads, and contenders for methods.
        outcome says what became of each load; monotone, concave, inside, as_expected, together and silent judge the
        curve; compliance_digits and resistance_digits count what is right, from 0 to 16, where anything is known.
        Condition numbers of the boundary elements stand over the dimension nodes.

    """
    cases = list(extremes() if cases is None else cases)
    data = _blank(cases)
    for number, extreme in enumerate(cases):
        print(f"extreme {number + 1}/{len(cases)}: {extreme.name}", file=sys.stderr)
        describe_case(data, number, extreme.case)
        for contender in extreme.contenders:
            _fill(data, number, extreme, contender)
    return data.merge(conditioning())


def _blank(cases: Sequence[Extreme]) -> xr.Dataset:
    names = list(dict.fromkeys(contender.name for extreme in cases for contender in extreme.contenders))
    loads = np.unique(np.concatenate([extreme.loads for extreme in cases]))
    terms = max(_finite_terms(extreme.case.profile) for extreme in cases)
    data = dataset.blank(len(cases), names, loads, terms)
    data = data.drop_vars(set(data.data_vars) - set(KEPT))
    shape = {"case": len(cases), "solution_method": len(names), "mean_pressure": loads.size}
    run, curve = (tuple(shape[dim] for dim in dims) for dims in (RUN, CURVE))
    data["extreme"] = "case", [extreme.name for extreme in cases], _about("what is extreme")
    data["outcome"] = CURVE, np.zeros(curve, "i1"), _about("what a method made of a load", Outcome)
    for name, text in DIGITS.items():
        limits = {"valid_min": 0.0, "valid_max": verdicts.MOST_DIGITS}
        data[name] = CURVE, np.full(curve, np.nan), _about(text) | limits
    for name, text in VERDICTS.items():
        data[name] = RUN, np.full(run, Verdict.not_measured, "i1"), _about(text, Verdict)
    for name, text in TEXTS.items():
        data[name] = RUN, np.full(run, "", object), _about(text)
    return data


def _finite_terms(profile: Profile) -> int:
    return profile.terms if np.isfinite(profile.m) else 1


def _about(long_name: str, meanings: type[IntEnum] | None = None) -> dict[str, Any]:
    about: dict[str, Any] = {"long_name": long_name, "units": "1", "coverage_content_type": "qualityInformation"}
    return about | (flags(meanings) if meanings else {})


def _fill(data: xr.Dataset, number: int, extreme: Extreme, contender: Variant) -> None:
    profile, loads = extreme.case.profile, extreme.loads
    place = number, data["solution_method"].values.tolist().index(contender.name)
    rows = np.searchsorted(data["mean_pressure"].values, loads)
    found = examine(contender, profile, loads)
    solved = found.outcome == Outcome.finite
    data["outcome"].values[place][rows] = found.outcome
    known = truth(contender.method, profile, loads[solved])  # costs as much as the solution
    h, R = found.compliance[solved], found.resistance[solved]
    curves = {
        "compliance": h,
        "resistance": R,
        "compliance_error": verdicts.distance(h, known.compliance),
        "compliance_digits": verdicts.digits(h, known.compliance),
        "resistance_digits": verdicts.digits(R, known.resistance),
    }
    if contender.method == "planned":  # for the compliance
        curves["resistance_digits"] = np.full(h.size, np.nan)
    for name, values in curves.items():
        data[name].values[place][rows[solved]] = values
    judged = _judged(contender, profile, loads, found) | _expected(profile, found, solved, known)
    for name, verdict in judged.items():
        data[name].values[place] = verdict
    if contender.method == "bem" and np.isfinite(found.compliance).any():
        data["points"].values[place] = _points(contender, profile)
    data["message"].values[place] = found.message
    data["compared_with"].values[place] = known.source if np.isfinite(curves["compliance_digits"]).any() else ""
    data["settings"].values[place] = json.dumps(dict(contender.settings), sort_keys=True)


def _judged(contender: Variant, profile: Profile, loads: NDArray[np.float64], found: Examined) -> dict[str, Verdict]:
    """The verdicts on a curve; on its shape where there are two loads at least."""
    judged = {"together": Verdict(not found.message), "silent": Verdict(not found.warned)}
    solved = found.outcome == Outcome.finite
    p, h, R = loads[solved], found.compliance[solved], found.resistance[solved]
    if p.size == 0:
        return judged
    noise, total = method_named(contender.method).noise, profile.total_amplitude
    mesh = (
        bem.error_model.compliance_error(profile, _points(contender, profile)) if contender.method == "bem" else 0.0
    )
    judged["inside"] = Verdict(verdicts.inside(profile, p, h, R, noise, mesh))
    if p.size > 1:
        judged["monotone"] = Verdict(verdicts.monotone(h, noise.height * total))
        judged["concave"] = Verdict(verdicts.concave(p, h, R, noise, total))
    return judged


def _expected(profile: Profile, found: Examined, solved: NDArray[np.bool_], known: Truth) -> dict[str, Verdict]:
    """The verdict on the errors that a method expects, where it expects any and the truth is known."""
    h, R = found.compliance[solved], found.resistance[solved]
    blurs = (
        np.full(h.size, patches.error_model.error(TIGHTEST, "compliance") * profile.total_amplitude),
        patches.error_model.error(TIGHTEST, "resistance") * np.maximum(R, 1),
    )
    off = verdicts.distance(h, known.compliance), verdicts.distance(R, known.resistance)
    errors = found.compliance_error[solved], found.resistance_error[solved]
    said = [verdicts.expected(*each) for each in zip(off, errors, blurs, strict=True)]
    said = [each for each in said if each is not None]
    return {"as_expected": Verdict(all(said))} if said else {}


def _points(contender: Variant, profile: Profile) -> int:
    return bem.checked_points(profile, contender.settings.get("points"))
