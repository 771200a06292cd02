"""Claims: statements of the paper, judged by numbers that are measured on ensembles of profiles.

The paper makes statements about rough surfaces, and each profile is a sample of one. So numbers are measured on each
member of an ensemble of profiles that differ only in their phases, and each member confirms or refutes the limit of a
number or leaves it undecided. A statement about all loads or surfaces is refuted by one member, and a statement about
a tendency by most members. Otherwise the statement is not decided.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

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


class Number(NamedTuple):
    """A number measured on one member of an ensemble, and its limit.

    quantity, unit : in words; "%" for fractions, empty for a number
    word, limit : "at most", "below", "at least" or "above" this limit
    factor : values between the limit and `factor` times it leave it undecided
    error : stated error of the numerical curve, which makes a sign uncertain
    most : whether it is a tendency of most members; otherwise one member refutes it
    decides : whether the verdict depends on it; otherwise it is only reported
    """

    quantity: str
    unit: str
    value: float
    word: str
    limit: float
    factor: float = OPEN_FACTOR
    error: float = 0.0
    most: bool = False
    decides: bool = True

    @property
    def sign(self) -> int:
        """1 where larger values are worse, -1 where smaller ones are."""
        return 1 if self.word in ("at most", "below") else -1

    def check(self, at_fewer_loads: Number) -> Check:
        """Return whether the number meets its limit, by more than its change if every second load is omitted."""
        uncertainty = abs(self.value - at_fewer_loads.value) + self.error
        met, missed = (self.limit, self.factor * self.limit)[:: self.sign]
        if self.sign * (met - self.value) >= uncertainty:
            return Check.yes
        return Check.no if self.sign * (self.value - missed) >= uncertainty else Check.not_decided


class Ensemble(NamedTuple):
    """Profiles that differ in their phases alone; the cases of a member have its phases.

    name : the common parameters of its members, in words
    members : the cases of each member
    enough : whether its members are all there are, or enough to generalise
    decides : whether a verdict depends on it; otherwise it is only reported
    """

    name: str
    members: Sequence[Cases]
    enough: bool = True
    decides: bool = True


class Claim(NamedTuple):
    """A statement of the paper.

    ensembles : function from the cases of a scene to its ensembles
    measure : function from the cases of a member to its numbers
    """

    statement: str
    ensembles: Callable[[Cases], list[Ensemble]]
    measure: Callable[..., Iterator[Number]]


class Finding(NamedTuple):
    """The result of a number on one ensemble.

    number : the decisive one: of the worst member, or the median for a tendency
    values, checks : the value and the check of each member
    outcome : of all
    """

    number: Number
    ensemble: Ensemble
    values: Sequence[float]
    checks: Sequence[Check]
    outcome: Check


class Judgement(NamedTuple):
    """The result of a claim.

    statement : the statement of the paper
    outcome : the combined outcome of all findings
    findings : one for each number and ensemble
    missing : missing data, if the claim could not be measured
    """

    statement: str
    outcome: Check
    findings: Sequence[Finding] = ()
    missing: str = ""

    @property
    def decisive(self) -> Finding:
        """The decisive finding: the worst value of the first number with this outcome."""
        same = [finding for finding in self.findings if finding.number.decides and finding.outcome == self.outcome]
        first = [finding for finding in same if finding.number.quantity == same[0].number.quantity]
        return max(first, key=lambda finding: finding.number.sign * finding.number.value)


def judge(claim: Claim, cases: Cases, at_fewer_loads: Cases) -> Judgement:
    """Judge a claim on cases, and on the same at every second load: each number must be right on each ensemble."""
    found: dict[str, list[Finding]] = {}
    try:
        for ensemble, fewer in zip(claim.ensembles(cases), claim.ensembles(at_fewer_loads), strict=True):
            measured, others = (
                zip(*(claim.measure(*member) for member in on.members), strict=True) for on in (ensemble, fewer)
            )
            for own, other in zip(measured, others, strict=True):
                found.setdefault(own[0].quantity, []).append(_examine(ensemble, own, other))
    except MissingError as error:
        return Judgement(claim.statement, Check.not_measured, missing=str(error))
    findings = [finding for same in found.values() for finding in same]
    outcomes = {finding.outcome for finding in findings if finding.number.decides}
    outcome = next(check for check in (Check.no, Check.not_decided, Check.yes) if check in outcomes)
    return Judgement(claim.statement, outcome, findings)


def _examine(ensemble: Ensemble, numbers: Sequence[Number], at_fewer_loads: Sequence[Number]) -> Finding:
    """Return the result of one number on all members of an ensemble."""
    values = [float(number.value) for number in numbers]
    checks = [number.check(other) for number, other in zip(numbers, at_fewer_loads, strict=True)]
    sign, most = numbers[0].sign, numbers[0].most
    value = float(np.median(values)) if most else sign * max(sign * value for value in values)
    least = MIN_FRACTION if most else 1.0
    yes, no = (checks.count(check) / len(checks) for check in (Check.yes, Check.no))
    outcome = Check.yes if yes >= least and ensemble.enough else Check.not_decided
    if (no >= MIN_FRACTION and ensemble.enough) if most else no > 0:
        outcome = Check.no
    decides = numbers[0].decides and ensemble.decides
    return Finding(numbers[0]._replace(value=value, decides=decides), ensemble, values, checks, outcome)
