"""How a statement is judged: one number for each profile of an ensemble of phases, against what the statement says.

The paper speaks of rough surfaces, and each profile is one of them. So a number is measured on each member of an
ensemble of profiles that differ in their phases alone, and each member says yes, no, or leaves the question open. A
statement about every load or every surface is refuted by one member, a statement of what usually happens by most of
them. Where neither is the case, the statement is not decided.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from weier.data.check import Check
from weier.methods import curves
from weier.pipeline.claims.claim import Case, Cases, Claim, Condition, Ensemble, Finding, Judgement, written
from weier.pipeline.claims.measures import MissingError, describe, need
from weier.theory.profile import PARAMETERS

MIN_MEMBERS = 6  # of an ensemble: fewer profiles say nothing of the others
MIN_SHARE = 5 / 6  # of an ensemble, to say what usually happens
THIN = 2  # every second load is left out, to see what a number owes to the choice of loads


def by_phases(cases: Cases) -> list[Ensemble]:
    """The cases by D, gamma and m, each a member of its ensemble; a single wave has no phases to differ in."""
    need(cases, "cases")
    return [
        Ensemble(describe(group[0]), tuple((case,) for case in group), float(group[0]["m"]) == 1)
        for group in curves.groups(cases, *PARAMETERS)
    ]


def series(cases: Cases, varied: str) -> list[Ensemble]:
    """Members whose cases differ in one parameter, in its order, and agree in the phases of the terms of all."""
    found = []
    for group in curves.groups(cases, *(name for name in PARAMETERS if name != varied)):
        largest = max(float(case[varied]) for case in group)
        rows = [_row(group, last, varied) for last in group if float(last[varied]) == largest]
        members = tuple(row for row in rows if len(row) > 1)
        if members:
            first, last = members[0][0], members[0][-1]
            others = [f"{name} = {float(first[name]):g}" for name in PARAMETERS if name != varied]
            name = ", ".join([f"{varied} from {float(first[varied]):g} to {float(last[varied]):g}", *others])
            found.append(Ensemble(name, members))
    need(found, f"cases of the same phases and different {varied}")
    return found


def _row(cases: Cases, last: Case, varied: str) -> Cases:
    """One case of each value of a parameter, in its order, with the phases of the last."""
    same = {float(case[varied]): case for case in cases if _same_phases(case, last)}
    return [same[value] for value in sorted(same)]


def _same_phases(one: Case, other: Case) -> bool:
    differences = one["phases"].values - other["phases"].values
    return bool((np.abs(differences[np.isfinite(differences)]) < 1e-12).all())


def judge(claim: Claim, cases: Cases) -> Judgement:
    """A claim by its conditions, each of which has to hold on each of the ensembles that it is about."""
    try:
        ensembles = claim.ensembles(cases)
        findings = tuple(_examine(each, on) for each in claim.conditions for on in ensembles[each.ensembles])
    except MissingError as error:
        return Judgement(claim.statement, Check.not_measured, missing=str(error))
    outcomes = {finding.outcome for finding in findings}
    outcome = next(each for each in (Check.no, Check.not_decided, Check.yes) if each in outcomes)
    return Judgement(claim.statement, outcome, findings)


def _examine(condition: Condition, ensemble: Ensemble) -> Finding:
    """What the members of an ensemble say of a condition.

    Notes
    -----
    A value is uncertain by as much as it changes where every second load is left out: what depends on the choice of
    the loads decides nothing.
    """
    limits, most = condition.limits, condition.most
    values = [float(condition.measure(*member)) for member in ensemble.members]
    fewer = [condition.measure(*map(_every_second_load, member)) for member in ensemble.members]
    checks = [limits.check(value, abs(value - other)) for value, other in zip(values, fewer, strict=True)]
    value = float(np.median(values)) if most else max(values, key=lambda value: limits.sign * value)
    limit = f"{limits.word} {written(limits.nominal, condition.unit)}"
    outcome = _outcome(checks, most, ensemble.complete)
    words = condition.text, condition.quantity, condition.unit, ensemble.name, limit
    return Finding(*words, limits.met, limits.missed, limits.sign, value, values, checks, outcome)


def _every_second_load(case: Case) -> Case:
    """The case at every second load, and at the last."""
    return case.isel(mean_pressure=slice((case.sizes["mean_pressure"] - 1) % THIN, None, THIN))


def _outcome(checks: Sequence[Check], most: bool, complete: bool) -> Check:
    least = MIN_SHARE if most else 1.0
    yes, no = (checks.count(check) / len(checks) for check in (Check.yes, Check.no))
    enough = complete or len(checks) >= MIN_MEMBERS
    if (no >= MIN_SHARE and enough) if most else no > 0:
        return Check.no
    return Check.yes if yes >= least and enough else Check.not_decided
