"""Ensembles of cases, and quantities that several claims measure on a case.

The numerical curve of a case is the solution by its most accurate method. Excess and error compare an estimate with
it. Averages are over the load, which is the axis of the paper's figures, and ranges of loads end at interpolated
compliances, so that no number depends on how the loads are spaced.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from weier.data import curves
from weier.kernels.arrays import Array, Flags
from weier.methods.registry import find_method
from weier.pipeline.claims.claim import MIN_MEMBERS, Case, Cases, Ensemble, MissingError
from weier.surface.profile import PARAMETERS

PARTIAL = (0.1, curves.FULL_CONTACT_COMPLIANCE)  # compliances between which resistances are compared
PHASE_DIGITS = 11  # Phases that agree in these digits are equal.
ROUNDING = 1e-9  # allowance for rounding and iteration in numbers close to 1


def need(available: object, what: str) -> None:
    """Raise MissingError if the data of a claim are not available."""
    if not available:
        raise MissingError(f"there are no {what}")


def by_phases(cases: Cases) -> list[Ensemble]:
    """Return an ensemble for each D, gamma and m, with each case as a member; a single wave has one member."""
    need(cases, "cases")
    return [
        Ensemble(describe(group[0]), [(case,) for case in group], len(group) >= MIN_MEMBERS or group[0]["m"] == 1)
        for group in curves.groups(cases, *PARAMETERS)
    ]


def by_mean(cases: Cases) -> list[Ensemble]:
    """Return the mean of each ensemble, which decides, and its members for information."""
    single = by_phases(cases)
    means = [
        Ensemble(f"{own.name}, mean of {len(own.members)}", [(_mean_curves(own.members),)], own.enough)
        for own in single
    ]
    return means + [own._replace(name=f"{own.name}, one by one", decides=False) for own in single]


def _mean_curves(members: Sequence[Cases]) -> Case:
    """Return the mean curves of an ensemble of phases, with the largest of their stated errors."""
    cases = [case for (case,) in members]
    averaged = ("compliance", "resistance", "contact_fraction", "first_contact")
    largest = ("compliance_error", "resistance_error")
    values = {name: np.mean([case[name] for case in cases], axis=0) for name in averaged}
    values |= {name: np.max([case[name] for case in cases], axis=0) for name in largest}
    return {**cases[0], **values}


def series(varied: str, cases: Cases) -> list[Ensemble]:
    """Return members: cases of equal phases (of common terms), ordered by the one parameter that varies."""
    others, found = [name for name in PARAMETERS if name != varied], []
    for group in curves.groups(cases, *others):
        members = [row for row in _rows(group, varied) if len(row) > 1]
        if members:
            ends = [f"{float(case[varied]):g}" for case in (members[0][0], members[0][-1])]
            fixed = [f"{name} = {float(group[0][name]):g}" for name in others]
            name = ", ".join([f"{varied} from {ends[0]} to {ends[1]}", *fixed])
            found.append(Ensemble(name, members, len(members) >= MIN_MEMBERS))
    need(found, f"cases of the same phases and different {varied}")
    return found


def _rows(cases: Cases, varied: str) -> list[Cases]:
    """Return rows of cases, one case per value of a parameter, that share the phases of their common terms."""
    ordered = sorted(cases, key=lambda case: float(case[varied]))
    phases = [tuple(case["phases"][np.isfinite(case["phases"])].round(PHASE_DIGITS).tolist()) for case in ordered]
    rows: list[Cases] = []
    for last, common in zip(ordered, phases, strict=True):
        if last[varied] == ordered[-1][varied]:
            alike = (case for case, own in zip(ordered, phases, strict=True) if own == common[: len(own)])
            rows.append([*{float(case[varied]): case for case in alike}.values()])
    return rows


def curve(case: Case, method: str | None, quantity: str = "compliance") -> Array:
    """Return the values of a quantity over the loads by one method; raises MissingError if the method has none."""
    values = curves.curve(case, quantity, method)
    if values is None:
        what = f"{quantity} by {find_method(method).label}" if method else "numerical solution"
        raise MissingError(f"{describe(case)} has no {what}")
    return values


def numerical(case: Case, quantity: str = "compliance") -> Array:
    """Return the values by the most accurate method that solved the case; raises MissingError if none did."""
    return curve(case, curves.numerical_method(case), quantity)


def stated_error(quantity: str, *cases: Case) -> float:
    """Return the largest of the median stated errors of numerical curves (h in g_0, R relative); 0 without them."""
    medians = [0.0]
    for case in cases:
        method = curves.numerical_method(case)
        error, values = (curves.curve(case, name, method) for name in (f"{quantity}_error", quantity))
        if error is not None and values is not None:
            known = np.isfinite(error) & (values > 0)
            scaled = error[known] / (values[known] if quantity == "resistance" else 1.0)
            medians += [float(np.median(scaled))] if known.any() else []
    return max(medians)


def describe(case: Case) -> str:
    """Return the profile of a case in words."""
    return curves.profile(case).describe()


def partial_contact(case: Case) -> Flags:
    """Return whether the contact is partial at each load; raises MissingError if no load gives partial contact."""
    partial: Flags = numerical(case, "contact_fraction") < 1 - ROUNDING
    need(partial.any(), "loads of partial contact")
    return partial


def between(case: Case, values: Array, low: float, high: float) -> tuple[Array, Array]:
    """Return loads and values where the numerical compliance lies in a range, relative to full contact.

    The ends of the range are interpolated, so that they do not depend on the spacing of the loads. A range up to
    full contact ends at the last load of partial contact, since all methods agree above. MissingError is raised if
    the loads do not reach across half of the range.
    """
    loads, relative, partial = case["mean_pressure"], numerical(case) / case["total_amplitude"], partial_contact(case)
    loads, relative, values = loads[partial], relative[partial], values[partial]
    middle = (low + high) / 2
    need(relative[0] < middle < relative[-1], f"loads across {middle:.0%} of the compliance at full contact")
    ends = np.interp([low, high], relative, loads)
    inside = (loads > ends[0]) & (loads < ends[1])
    within = np.concatenate([ends[:1], loads[inside], ends[1:]])
    return within, np.interp(within, loads, values)


def mean(loads: Array, values: Array) -> float:
    """Return the mean of the values over the load, by the trapezoidal rule."""
    return float(np.trapezoid(values, loads) / (loads[-1] - loads[0]))


def ratio(values: Array, others: Array) -> Array:
    """Return the ratio of two curves, in full contact, where both vanish, without a warning."""
    with np.errstate(divide="ignore", invalid="ignore"):
        quotient: Array = values / others
    return quotient


def excess(case: Case, method: str) -> Array:
    """Return the compliance by an estimate less the numerical one, in g_0, shape (loads,)."""
    return curve(case, method) - numerical(case)


def errors_of_resistance(case: Case, method: str, lowest: float = PARTIAL[0]) -> tuple[Array, Array]:
    """Return loads of partial contact, and the relative errors of the resistance by an estimate there."""
    error = ratio(curve(case, method, "resistance"), numerical(case, "resistance")) - 1
    return between(case, error, lowest, PARTIAL[1])


def resistance_of_independent_contacts(case: Case) -> Array:
    """Return R of N equal contacts at even spacing, with the same N and total area; NaN in full contact.

    Each of them is the contact of one wave of wavelength 1/N: R = -(1/N) ln sin^2(pi A/2) by (8) and (13).
    """
    count, fraction = numerical(case, "patch_count"), numerical(case, "contact_fraction")
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(-2 * np.log(np.sin(np.pi * fraction / 2)) / np.where(count > 0, count, np.nan))
