"""How a statement is judged: one number for each profile of an ensemble of phases, against what the statement says.

The paper speaks of rough surfaces, and each profile is one of them. So a number is measured on each member of an
ensemble of profiles that differ in their phases alone, and each member says yes, no, or leaves the question open. A
statement about every load or every surface is refuted by one member, a statement of what usually happens by most of
them. Where neither is the case, the statement is not decided.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from weier.data.check import Check
from weier.kernels.arrays import Array
from weier.pipeline import curves
from weier.pipeline.claims.claim import Cases, Measured
from weier.pipeline.claims.readings import describe, need

if TYPE_CHECKING:
    import xarray as xr

MIN_MEMBERS = 6  # of an ensemble: fewer profiles say nothing of the others
MIN_SHARE = 5 / 6  # of an ensemble, to say what usually happens
OPEN_FACTOR = 1.25  # between a limit that the paper leaves to the reader, and this times it, nothing is decided
THIN = 2  # every second load is left out, to see what a number owes to the choice of loads
PARAMETERS = ("D", "gamma", "m")
LEADS = {
    Check.no: ["The statement does not hold here."],
    Check.not_decided: ["Whether the statement holds is not decided here."],
}


class Kind(enum.Enum):
    """What a statement is about."""

    every = "every member: one that contradicts is enough for a no"
    most = "most members: a tendency"


class Limits(NamedTuple):
    """The value up to which a condition is met, and the one from which it is missed.

    sign : 1 where larger values are worse, -1 where smaller ones are
    """

    met: float
    missed: float
    sign: int

    def check(self, value: float, uncertainty: float) -> Check:
        """Whether a value meets the condition, or lies between, or too close to tell."""
        if self.sign * (self.met - value) >= uncertainty:
            return Check.yes
        return Check.no if self.sign * (value - self.missed) >= uncertainty else Check.not_decided


def at_most(limit: float, factor: float = OPEN_FACTOR) -> Limits:
    """For values that must not exceed a limit; up to `factor` times it nothing is decided."""
    return Limits(limit, factor * limit, 1)


def at_least(limit: float, factor: float = OPEN_FACTOR) -> Limits:
    """For values that must reach a limit, and decide nothing below `factor` times it."""
    return Limits(factor * limit, limit, -1)


def negative(error: float) -> Limits:
    """For values below 0 whose sign is unknown within an error."""
    return Limits(-error, error, 1)


def positive(error: float) -> Limits:
    """For values above 0 whose sign is unknown within an error."""
    return Limits(error, -error, -1)


class Condition(NamedTuple):
    """One part of what a statement says.

    text : the part, as a clause that follows "that"
    quantity : what is measured for it, with its unit
    measure : from the cases of one member to the value
    limits : of the value
    kind : whether it is about every member or about most
    form : how the value is written
    """

    text: str
    quantity: str
    measure: Callable[..., float]
    limits: Limits
    kind: Kind = Kind.every
    form: str = "+.2g"


class Ensemble(NamedTuple):
    """Profiles that differ in their phases alone; the cases of a member have its phases.

    complete : whether its members are all there are, so that their number does not matter
    """

    name: str
    members: tuple[Cases, ...]
    complete: bool = False


class Finding(NamedTuple):
    """A condition on one ensemble: the value of each member, what each says, and the outcome of all."""

    condition: Condition
    ensemble: Ensemble
    values: Array
    checks: tuple[Check, ...]
    outcome: Check


def ensembles(cases: Cases) -> list[Ensemble]:
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
            found.append(Ensemble(_name(members[0], varied), members))
    need(found, f"cases of the same phases and different {varied}")
    return found


def _row(cases: Cases, last: xr.Dataset, varied: str) -> Cases:
    """One case of each value of a parameter, in its order, with the phases of the last."""
    same = {float(case[varied]): case for case in cases if _same_phases(case, last)}
    return [same[value] for value in sorted(same)]


def _name(member: Cases, varied: str) -> str:
    values = f"{varied} from {float(member[0][varied]):g} to {float(member[-1][varied]):g}"
    others = (f"{name} = {float(member[0][name]):g}" for name in PARAMETERS if name != varied)
    return ", ".join([values, *others])


def _same_phases(one: xr.Dataset, other: xr.Dataset) -> bool:
    shared = np.isfinite(one["phases"].values) & np.isfinite(other["phases"].values)
    return bool(np.allclose(one["phases"].values[shared], other["phases"].values[shared], rtol=0, atol=1e-12))


def examine(condition: Condition, ensemble: Ensemble) -> Finding:
    """What the members of an ensemble say of a condition.

    Notes
    -----
    A value is uncertain by as much as it changes where every second load is left out: what depends on the choice of
    the loads decides nothing.
    """
    values = np.array([condition.measure(*member) for member in ensemble.members])
    fewer = np.array([condition.measure(*map(_every_second_load, member)) for member in ensemble.members])
    checks = tuple(
        condition.limits.check(value, uncertainty)
        for value, uncertainty in zip(values, np.abs(values - fewer), strict=True)
    )
    return Finding(condition, ensemble, values, checks, _outcome(checks, condition.kind, ensemble.complete))


def _every_second_load(case: xr.Dataset) -> xr.Dataset:
    """The case at every second load, and at the last."""
    return case.isel(mean_pressure=slice((case.sizes["mean_pressure"] - 1) % THIN, None, THIN))


def _outcome(checks: Sequence[Check], kind: Kind, complete: bool) -> Check:
    least = 1.0 if kind is Kind.every else MIN_SHARE
    against = 0.0 if kind is Kind.every else MIN_SHARE
    share = {check: checks.count(check) / len(checks) for check in (Check.yes, Check.no)}
    enough = complete or len(checks) >= MIN_MEMBERS
    if share[Check.no] > 0 and share[Check.no] >= against and (enough or kind is Kind.every):
        return Check.no
    return Check.yes if share[Check.yes] >= least and enough else Check.not_decided


def judge(conditions: Sequence[Condition], ensembles: Iterable[Ensemble]) -> Measured:
    """A statement by its conditions, each of which has to hold on each of the ensembles."""
    groups = list(ensembles)
    return combine([[examine(condition, each) for each in groups] for condition in conditions])


def combine(findings: Sequence[Sequence[Finding]]) -> Measured:
    """A statement by what was found of its conditions, each on some ensembles.

    The value is that of the first condition, on the ensemble where the statement is worst off.
    """
    every = [finding for row in findings for finding in row]
    outcomes = {finding.outcome for finding in every}
    outcome = next(each for each in (Check.no, Check.not_decided, Check.yes) if each in outcomes)
    first = max(findings[0], key=_distance)
    reasons = [_reason(finding) for finding in every if finding.outcome != Check.yes]
    return Measured(
        "\n".join(map(_describe_values, findings)),
        "\n".join([*LEADS.get(outcome, ()), *reasons]),
        float(first.values.mean()),
        float(first.values.std()),
        len(first.values),
        outcome,
    )


def _distance(finding: Finding) -> float:
    """How far the mean lies in the direction in which the condition is missed."""
    return float(finding.condition.limits.sign * finding.values.mean())


def _describe_values(findings: Sequence[Finding]) -> str:
    condition = findings[0].condition
    return f"{condition.quantity[:1].upper()}{condition.quantity[1:]}: {'; '.join(map(_statistics, findings))}."


def _statistics(finding: Finding) -> str:
    values, form = finding.values, finding.condition.form
    if values.size == 1:
        return f"{_written(values[0], form)} for {finding.ensemble.name}"
    return (
        f"{_written(values.mean(), form)} with a spread of {_written(values.std(), form.removeprefix('+'))}, between "
        f"{_written(values.min(), form)} and {_written(values.max(), form)}, over {values.size} phases for "
        f"{finding.ensemble.name}"
    )


def _written(value: float, form: str) -> str:
    """A value by its format, and a large one in full: 2100 and not 2.1e+03."""
    text = f"{value:{form}}"
    return f"{float(text):{form[:-3]}.0f}" if "e+" in text else text


def _reason(finding: Finding) -> str:
    """Why a condition does not hold, or is not decided, in one sentence."""
    yes, no = (finding.checks.count(check) for check in (Check.yes, Check.no))
    count, name, text = len(finding.checks), finding.ensemble.name, finding.condition.text
    if finding.ensemble.complete and finding.outcome == Check.no:
        return f"For {name}, it is not so that {text}."
    if finding.ensemble.complete:
        return f"For {name}, it is open whether {text}: the value is too close to the limit."
    if finding.outcome == Check.no:
        return f"For {name}, {no} of {count} profiles contradict that {text}."
    few = f"; at least {MIN_MEMBERS} profiles are needed" if count < MIN_MEMBERS else ""
    return f"For {name}, it is open whether {text}: {yes} of {count} profiles say yes and {no} say no{few}."
