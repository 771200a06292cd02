"""Claims: statements of the paper, with conditions that are judged on ensembles of profiles.

The paper makes statements about rough surfaces, and each profile is a sample of one. So a number is measured on each
member of an ensemble of profiles that differ only in their phases, and each member confirms or refutes the condition
or leaves it undecided. A statement about all loads or surfaces is refuted by one member, and a statement about a
tendency by most members. Otherwise the statement is not decided.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from weier.data import curves
from weier.data.markdown import significant
from weier.data.variables import Check

if TYPE_CHECKING:
    import xarray as xr

Case: TypeAlias = Mapping[str, Any]  # maps names of variables to arrays
Cases: TypeAlias = Sequence[Case]
OPEN_FACTOR = 1.25  # values within this factor of a limit that the paper does not quantify are not decided
MIN_MEMBERS = 6  # smaller ensembles do not generalise
MIN_FRACTION = 5 / 6  # fraction of an ensemble that decides on a tendency


class MissingError(ValueError):
    """The studies lack data for a claim."""


def cases_of(study: xr.Dataset) -> list[Case]:
    """Return the cases of a study as views of its arrays, much faster than a Dataset for each."""
    variables = study.transpose("case", ..., "mean_pressure").variables
    values = {str(name): variable.values for name, variable in variables.items()}
    own = [str(name) for name, variable in variables.items() if "case" in variable.dims]
    return [values | {name: values[name][row] for name in own} for row in range(study.sizes["case"])]


class Limits(NamedTuple):
    """Limits of a condition: `met` and better meet it, `missed` and worse violate it.

    sign : 1 where larger values are worse, -1 where smaller ones are
    word, nominal : the limit in words: "at most", 0.05
    error : numerical quantity, if any, with a stated error that makes a sign uncertain
    """

    met: float
    missed: float
    sign: int
    word: str
    nominal: float
    error: str = ""

    def check(self, value: float, uncertainty: float) -> Check:
        """Return whether a value meets or violates the condition, beyond its uncertainty."""
        if self.sign * (self.met - value) >= uncertainty:
            return Check.yes
        return Check.no if self.sign * (value - self.missed) >= uncertainty else Check.not_decided


def at_most(limit: float, factor: float = OPEN_FACTOR) -> Limits:
    """Return an upper limit; values between it and `factor` times it leave the condition undecided."""
    return Limits(limit, factor * limit, 1, "at most", limit)


def at_least(limit: float, factor: float = OPEN_FACTOR) -> Limits:
    """Return a lower limit; values between `factor` times it and the limit leave the condition undecided."""
    return Limits(factor * limit, limit, -1, "at least", limit)


def negative(quantity: str) -> Limits:
    """Return limits for negative values; the stated error of this numerical quantity makes their sign uncertain."""
    return Limits(0.0, 0.0, 1, "below", 0.0, quantity)


def positive(quantity: str) -> Limits:
    """Return limits for positive values, as `negative`."""
    return Limits(0.0, 0.0, -1, "above", 0.0, quantity)


def not_negative(quantity: str) -> Limits:
    """Return limits for values of at least 0, as `negative`."""
    return positive(quantity)._replace(word="at least")


class Condition(NamedTuple):
    """One condition of a statement.

    quantity, unit : the measured quantity; "%" for fractions, empty for a number
    measure : function from the cases of one member to the value
    limits : the values that meet and violate the condition
    most : whether it is a tendency of most members; otherwise one member refutes it
    ensembles : the ensembles to which it applies
    decides : whether the verdict depends on it; otherwise its number is only reported
    """

    quantity: str
    unit: str
    measure: Callable[..., float]
    limits: Limits
    most: bool = False
    ensembles: slice = slice(None)
    decides: bool = True


class Ensemble(NamedTuple):
    """Profiles that differ in their phases alone; the cases of a member have its phases.

    name : the common parameters of its members, in words
    members : the cases of each member
    complete : whether no further members exist, so that few are enough
    decides : whether a verdict depends on it; otherwise it is only reported
    """

    name: str
    members: tuple[Cases, ...]
    complete: bool = False
    decides: bool = True


class Claim:
    """A statement of the paper, a function from the cases of a scene to its ensembles, and its conditions."""

    def __init__(self, statement: str, ensembles: Callable[[Cases], list[Ensemble]], *conditions: Condition) -> None:
        self.statement, self.ensembles, self.conditions = statement, ensembles, conditions


class Finding(NamedTuple):
    """The result of a condition on one ensemble.

    value : the decisive one: of the worst member, or the median for a tendency
    values, checks : the value and the check of each member
    outcome : of all
    """

    condition: Condition
    ensemble: Ensemble
    value: float
    values: Sequence[float]
    checks: Sequence[Check]
    outcome: Check

    @property
    def decides(self) -> bool:
        """Whether the verdict depends on it."""
        return self.condition.decides and self.ensemble.decides

    @property
    def limit(self) -> str:
        """The limit in words."""
        limits = self.condition.limits
        return f"{limits.word} {written(limits.nominal, self.condition.unit)}"

    @property
    def votes(self) -> str:
        """The numbers of members by their results, in words."""
        total, undecided = len(self.checks), VOTES[Check.not_decided]
        if total == 1:
            return undecided * (Check.not_decided in self.checks)
        counts = [(self.checks.count(check), words) for check, words in VOTES.items() if check in self.checks]
        (first, words), *others = counts
        return ", ".join([f"{first} of {total} {words}", *(f"{count} {words}" for count, words in others)])


# The checks of members in words.
VOTES = {Check.yes: "say yes", Check.no: "say no", Check.not_decided: "too close to call"}


class Judgement(NamedTuple):
    """The result of a claim.

    statement : the statement of the paper
    outcome : the combined outcome of all findings
    findings : one for each condition and ensemble
    missing : missing data, if the claim could not be measured
    """

    statement: str
    outcome: Check
    findings: tuple[Finding, ...] = ()
    missing: str = ""

    @property
    def decisive(self) -> Finding:
        """The decisive finding: the worst value of the first condition with this outcome."""
        same = [finding for finding in self.findings if finding.decides and finding.outcome == self.outcome]
        first = [finding for finding in same if finding.condition is same[0].condition]
        return max(first, key=lambda finding: finding.condition.limits.sign * finding.value)


def written(value: float, unit: str) -> str:
    """Return a value in its unit, with two digits."""
    if value == 0:
        return "0"
    return f"{significant(100 * value, 2)} %" if unit == "%" else f"{significant(value, 2)} {unit}".rstrip()


def judge(claim: Claim, cases: Cases, at_fewer_loads: Cases) -> Judgement:
    """Judge a claim on cases, and on the same at every second load: each condition must hold on each ensemble."""
    try:
        ensembles = list(zip(claim.ensembles(cases), claim.ensembles(at_fewer_loads), strict=True))
        findings = tuple(
            _examine(condition, *on) for condition in claim.conditions for on in ensembles[condition.ensembles]
        )
    except MissingError as error:
        return Judgement(claim.statement, Check.not_measured, missing=str(error))
    outcomes = {finding.outcome for finding in findings if finding.decides}
    outcome = next(check for check in (Check.no, Check.not_decided, Check.yes) if check in outcomes)
    return Judgement(claim.statement, outcome, findings)


def _examine(condition: Condition, ensemble: Ensemble, at_fewer_loads: Ensemble) -> Finding:
    """Return the result of a condition on the members of an ensemble.

    Notes
    -----
    The uncertainty of a value is its change if every second load is omitted, and the stated error of the numerical
    curve if it could change a sign.
    """
    limits, most = condition.limits, condition.most
    values, fewer = (
        [float(condition.measure(*member)) for member in on.members] for on in (ensemble, at_fewer_loads)
    )
    stated = [max(stated_error(case, limits.error) for case in member) for member in ensemble.members]
    checks = [
        limits.check(value, abs(value - other) + error)
        for value, other, error in zip(values, fewer, stated, strict=True)
    ]
    value = float(np.median(values)) if most else max(values, key=lambda value: limits.sign * value)
    return Finding(condition, ensemble, value, values, checks, _outcome(checks, most, ensemble.complete))


def stated_error(case: Case, quantity: str) -> float:
    """Return the median stated error of the most accurate numerical curve (h in g_0, R relative); 0 without one."""
    if not quantity:
        return 0.0
    method = curves.numerical_method(case)
    error, values = (curves.curve(case, name, method) for name in (f"{quantity}_error", quantity))
    if error is None or values is None:
        return 0.0
    known = np.isfinite(error) & (values > 0)
    return (
        float(np.median(error[known] / (values[known] if quantity == "resistance" else 1.0))) if known.any() else 0.0
    )


def _outcome(checks: Sequence[Check], most: bool, complete: bool) -> Check:
    least = MIN_FRACTION if most else 1.0
    yes, no = (checks.count(check) / len(checks) for check in (Check.yes, Check.no))
    enough = complete or len(checks) >= MIN_MEMBERS
    if (no >= MIN_FRACTION and enough) if most else no > 0:
        return Check.no
    return Check.yes if yes >= least and enough else Check.not_decided
