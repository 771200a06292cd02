"""What a claim is, and how it is judged: a statement of the paper, and the conditions that it says of any phases.

The paper speaks of rough surfaces, and each profile is one of them. So a number is measured on each member of an
ensemble of profiles that differ in their phases alone, and each member says yes, no, or leaves the question open. A
statement about every load or every surface is refuted by one member, a statement of what usually happens by most of
them. Where neither is the case, the statement is not decided.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from weier.data.variables import Check
from weier.theory.tables import significant

if TYPE_CHECKING:
    import xarray as xr

Case: TypeAlias = "xr.Dataset"
Cases: TypeAlias = Sequence[Case]
OPEN_FACTOR = 1.25  # between a limit that the paper leaves to the reader, and this times it, nothing is decided
MIN_MEMBERS = 6  # of an ensemble: fewer profiles say nothing of the others
MIN_SHARE = 5 / 6  # of an ensemble, to say what usually happens
THIN = 2  # every second load is left out, to see what a number owes to the choice of loads


class MissingError(ValueError):
    """The studies lack what a claim is about."""


class Limits(NamedTuple):
    """The value up to which a condition is met, and the one from which it is missed.

    sign : 1 where larger values are worse, -1 where smaller ones are
    word, nominal : the limit in words: "at most", 0.05
    """

    met: float
    missed: float
    sign: int
    word: str
    nominal: float

    def check(self, value: float, uncertainty: float) -> Check:
        """Whether a value meets the condition, or lies between, or so close that neither is certain."""
        if self.sign * (self.met - value) >= uncertainty:
            return Check.yes
        return Check.no if self.sign * (value - self.missed) >= uncertainty else Check.not_decided


def at_most(limit: float, factor: float = OPEN_FACTOR) -> Limits:
    """For values that must not exceed a limit; up to `factor` times it nothing is decided."""
    return Limits(limit, factor * limit, 1, "at most", limit)


def at_least(limit: float, factor: float = OPEN_FACTOR) -> Limits:
    """For values that must reach a limit, and decide nothing below `factor` times it."""
    return Limits(factor * limit, limit, -1, "at least", limit)


def negative(error: float) -> Limits:
    """For values below 0 whose sign is unknown within an error."""
    return Limits(-error, error, 1, "below", 0.0)


def positive(error: float) -> Limits:
    """For values above 0 whose sign is unknown within an error."""
    return Limits(error, -error, -1, "above", 0.0)


class Condition(NamedTuple):
    """One part of what a statement says.

    text : the part, as a clause
    quantity, unit : what is measured for it; "%" for parts of a whole, empty for a number
    measure : from the cases of one member to the value
    limits : of the value
    most : whether it is about most members, a tendency, or about every one, so that one is enough for a no
    ensembles : which of the ensembles it is about
    """

    text: str
    quantity: str
    unit: str
    measure: Callable[..., float]
    limits: Limits
    most: bool = False
    ensembles: slice = slice(None)


class Ensemble(NamedTuple):
    """Profiles that differ in their phases alone; the cases of a member have its phases.

    name : what its members share, for people
    members : the cases of each
    complete : whether its members are all there are, so that their number does not matter
    """

    name: str
    members: tuple[Cases, ...]
    complete: bool = False


class Claim:
    """A statement of the paper, how the cases of a scene make ensembles to judge it on, and its conditions."""

    def __init__(self, statement: str, ensembles: Callable[[Cases], list[Ensemble]], *conditions: Condition) -> None:
        self.statement, self.ensembles, self.conditions = statement, ensembles, conditions


class Finding(NamedTuple):
    """A condition on one ensemble, as a file holds it.

    statement, quantity, unit, ensemble : in words
    limit, met, missed, sign : the limit in words, and as in `Limits`
    value : what decides: the worst member of all, or the middle one where most count
    values, checks : of each member
    outcome : of all
    """

    statement: str
    quantity: str
    unit: str
    ensemble: str
    limit: str
    met: float
    missed: float
    sign: int
    value: float
    values: Sequence[float]
    checks: Sequence[int]
    outcome: int

    @property
    def votes(self) -> str:
        """How many members say what."""
        total, undecided = len(self.checks), VOTES[Check.not_decided]
        if total == 1:
            return undecided * (Check.not_decided in self.checks)
        counts = [(self.checks.count(check), words) for check, words in VOTES.items() if check in self.checks]
        (first, words), *others = counts
        return ", ".join([f"{first} of {total} {words}", *(f"{count} {words}" for count, words in others)])


VOTES = {Check.yes: "say yes", Check.no: "say no", Check.not_decided: "too close to call"}


class Judgement(NamedTuple):
    """What came of a claim.

    statement : what the paper says
    outcome : of all findings together
    findings : one for each condition and ensemble
    missing : what the studies lack for it where it could not be measured
    """

    statement: str
    outcome: Check
    findings: tuple[Finding, ...] = ()
    missing: str = ""

    @property
    def decisive(self) -> Finding:
        """The finding that the outcome rests on: of the first condition with it, where the value is worst."""
        same = [finding for finding in self.findings if finding.outcome == self.outcome]
        first = [finding for finding in same if finding.statement == same[0].statement]
        return max(first, key=lambda finding: finding.sign * finding.value)


def written(value: float, unit: str) -> str:
    """A value in its unit, with two digits."""
    if value == 0:
        return "0"
    return f"{significant(100 * value, 2)} %" if unit == "%" else f"{significant(value, 2)} {unit}".rstrip()


def judge(claim: Claim, cases: Cases) -> Judgement:
    """A claim by its conditions, each of which has to hold on each of the ensembles that it is about."""
    try:
        ensembles = claim.ensembles(cases)
        findings = tuple(
            _examine(condition, on) for condition in claim.conditions for on in ensembles[condition.ensembles]
        )
    except MissingError as error:
        return Judgement(claim.statement, Check.not_measured, missing=str(error))
    outcomes = {finding.outcome for finding in findings}
    outcome = next(check for check in (Check.no, Check.not_decided, Check.yes) if check in outcomes)
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
