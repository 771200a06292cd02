"""The method "planned", which runs the plan of a profile: each part by its method, an error for every number.

What is run again and what is stated is in docs/planned.md, "The choice".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import thread_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.data.variables import VARIABLES
from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import COMPILING_SECONDS
from weier.methods.error_model import COMPLIANCE_ROUNDING
from weier.methods.errors import ConvergenceError, OutOfReachError
from weier.methods.method import Method
from weier.methods.plan_part import COMPLIANCE, PartSolution, PlanPart
from weier.methods.planned.plan import Plan, plan, within_reach
from weier.methods.progress import reporting_to
from weier.surface.profile import Profile
from weier.tables import significant
from weier.theory.bounds import chord_bounds, complete_bounds

ROUNDING = 1e-9  # Rounding of errors, over the tolerance: those expected and those stated are sums of the same terms.
# A part is stopped after so many times the seconds planned, but not before the second.
MAX_OVERRUN, MIN_OVERRUN_SECONDS = 10, 60.0
METHOD_NAME = VARIABLES["planned_method"].dtype
OUT_OF_REACH = "out of reach"  # It stands in the place of a method where none met the tolerance.
MAX_TOLERANCE = 1.0  # The largest tolerance that is suggested, in g_0.
MARGIN = 1.05  # A suggested tolerance is so many times the error: more than rounding to two digits takes off.
UNSOLVED = PartSolution(*(np.full(1, value) for value in (np.nan, np.nan, np.inf, np.inf)))


class PlannedCurve(NamedTuple):
    """Planned curves over the loads, each of shape (loads,), and the forecast of the plan.

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*
    compliance_error, resistance_error : estimated, in the same units
    planned_method, planned_terms, planned_points : the choice at each load; no points where there is no grid
    planned_seconds, planned_error : seconds on one core, and the largest error of the quantity planned for: scalars,
        NaN for a part of a plan
    unsolved : why some loads have no numbers, in a sentence; None where all have
    """

    compliance: Array
    resistance: Array
    compliance_error: Array
    resistance_error: Array
    planned_method: NDArray[np.str_]
    planned_terms: Array
    planned_points: Array
    planned_seconds: float = np.nan
    planned_error: float = np.nan
    unsolved: str | None = None

    @property
    def arrays(self) -> Sequence[Any]:
        """All that has the shape (loads,)."""
        return self[:-3]

    def error(self, quantity: str) -> Array:
        """The error of a quantity at each load, as tolerances count it: of R, relative to the larger of R and 1."""
        of_resistance: Array = self.resistance_error / np.fmax(self.resistance, 1)
        return self.compliance_error if quantity == COMPLIANCE else of_resistance


def curve(
    profile: Profile, mean_pressure: Array, methods: Sequence[Method], tolerance: float, quantity: str = COMPLIANCE
) -> PlannedCurve:
    """Plan a curve and run the plan: see `weier.plan`.

    Parameters
    ----------
    profile : Profile
        With any number of terms.
    mean_pressure : array, shape (loads,)
        Increasing, in p_0*.
    methods : sequence of Method
        To choose from.
    tolerance, quantity
        As in `weier.plan`.

    Returns
    -------
    PlannedCurve
        Arrays over the loads, and the forecast of the plan. Where the stated errors of all solutions that were
        expected to meet the tolerance exceed it, the numbers of that load are NaN, and `unsolved` says so.

    Raises
    ------
    OutOfReachError
        If at some load no method is expected to meet the tolerance, or no solution at any load meets it.
    ConvergenceError
        If a part takes more than ten times as long as planned, and over a minute; it names the next best.

    Notes
    -----
    The numbers of a load do not depend on the other loads, but for residuals of iterations.

    The error of a compliance is that which the method states of its own solution, and half of the interval that the
    bounds theorem leaves between h_k and full contact. The error of a resistance is that of the method where all
    terms are modelled, or that by the chords of a concave curve within the errors of the compliance, if that is less.
    The chords lead to no load, and to the loads that a plan for the resistance of a long series solves beside each
    load.

    A load whose solution states more than the tolerance, as next to births of contacts, is planned and solved again
    without the part that left that error: by another method, with other settings, or with more terms, whichever is
    expected to meet the tolerance at the least cost.
    """
    made = plan(profile, mean_pressure, methods, tolerance, quantity)
    found = _run_within(made, methods, ())._replace(planned_seconds=made.seconds, planned_error=made.error)
    exceeding = _exceeding(made, found)
    if not exceeding.any():
        return found
    why = _excess_message(made, found, mean_pressure, exceeding)
    if exceeding.all():
        raise OutOfReachError(why)
    for values in found.arrays:
        values[exceeding] = OUT_OF_REACH if values is found.planned_method else np.nan
    return found._replace(unsolved=why)


def _exceeding(made: Plan, found: PlannedCurve) -> Flags:
    """The loads at which the stated error of a curve exceeds the tolerance of its plan."""
    return ~(found.error(made.quantity) <= made.tolerance * (1 + ROUNDING))


def _excess_message(made: Plan, found: PlannedCurve, loads: Array, exceeding: Flags) -> str:
    """A message: at which loads the tolerance was missed, by how much, and what to do."""
    error = np.where(exceeding, found.error(made.quantity), 0)
    worst, missing = int(error.argmax()), loads[exceeding]
    where = f", from {missing[0]:.3g} to {missing[-1]:.3g} p_0*" if missing.size > 1 else ""
    left, remedy = "stopped", "take a larger tolerance for them, or leave them out"
    if np.isfinite(error[worst]):
        left, larger = f"left an error of {error[worst]:.2g}", MARGIN * error[worst]
        choice = f"take a tolerance of {significant(larger, 2)} for them, or " if larger < MAX_TOLERANCE else ""
        remedy = f"{choice}leave them out"
    return (
        f"the {made.quantity} is not within {made.tolerance:g} at {missing.size} of {loads.size} loads{where}: "
        f"{found.planned_method[worst]} with {found.planned_terms[worst]:g} terms was expected to do, and {left} at "
        f"{loads[worst]:.3g} p_0*; {remedy}"
    )


def _run_within(made: Plan, methods: Sequence[Method], failed: Sequence[PlanPart]) -> PlannedCurve:
    """Run a plan; where errors exceed the tolerance, plan and run again without the parts that left them."""
    return _concatenate([_run_part(made, part, methods, (*failed, part)) for part in made.parts])


def _run_part(made: Plan, part: PlanPart, methods: Sequence[Method], without: Sequence[PlanPart]) -> PlannedCurve:
    """Run a part; loads that it leaves with larger errors are planned and run again `without` it.

    Where nothing else is expected to meet the tolerance, the solution of the least error stands.
    """
    loads, wanted = part.mean_pressure, (methods, made.tolerance, made.quantity, without)
    try:
        values = _attempt_in_time(made.profile, part)
    except TimeoutError as overrun:
        next_best = _next_best(part, lambda loads: plan(made.profile, loads, *wanted))
        raise ConvergenceError(f"{overrun}; {next_best}") from None
    exceeding = np.flatnonzero(_exceeding(made, values))
    again = exceeding[within_reach(made.profile, loads[exceeding], *wanted)] if exceeding.size else exceeding
    if again.size:
        others = _run_within(plan(made.profile, loads[again], *wanted), methods, without)
        better = ~(values.error(made.quantity)[again] <= others.error(made.quantity))
        for old, new in zip(values.arrays, others.arrays, strict=True):
            old[again[better]] = new[better]
    return values


def _attempt_in_time(profile: Profile, part: PlanPart) -> PlannedCurve:
    """Run a part; TimeoutError, between two of its loads, if it takes far longer than planned."""
    allowed = max(MAX_OVERRUN * part.seconds, MIN_OVERRUN_SECONDS)
    start, done, count = thread_time() - COMPILING_SECONDS.get(), 0, part.mean_pressure.size

    def look_at_clock() -> None:
        nonlocal done
        done, seconds = done + 1, thread_time() - COMPILING_SECONDS.get() - start
        if seconds > allowed and done < count:
            raise TimeoutError(
                f"{_label(part)} was expected to take {part.seconds:.2g} s, and was stopped after "
                f"{seconds:.0f} s with {done} of {count} loads solved"
            )

    with reporting_to(look_at_clock):
        return _attempt(profile, part)


def _next_best(stopped: PlanPart, plan_again: Callable[[Array], Plan]) -> str:
    """The next best choice after a part that was stopped."""
    try:
        other = plan_again(stopped.mean_pressure)
    except OutOfReachError:
        return "no other method is as accurate: take a larger tolerance"
    best = ", ".join(dict.fromkeys(map(_label, other.parts)))
    return f"the next best is {best}, in {other.seconds:.2g} s for all loads: take that method, or a larger tolerance"


def _label(part: PlanPart) -> str:
    return f"{part.method} with {part.terms:g} terms"


def _attempt(profile: Profile, part: PlanPart) -> PlannedCurve:
    """Run a part; loads at which its solver fails have infinite errors, and the others are solved without them."""
    try:
        return run(profile, (part,))
    except ConvergenceError:
        count = part.mean_pressure.size
        if count == 1:
            return _curve_of(part, UNSOLVED)
        halves = slice(None, count // 2), slice(count // 2, None)
        return _concatenate([_attempt(profile, part.at(half)) for half in halves])


def run(profile: Profile, parts: Sequence[PlanPart]) -> PlannedCurve:
    """Run parts that cover the loads one after the other."""
    return _concatenate([_curve_of(part, _solve(profile, part)) for part in parts])


def _concatenate(curves: Sequence[PlannedCurve]) -> PlannedCurve:
    columns: Any = map(np.concatenate, zip(*(one.arrays for one in curves), strict=True))
    return PlannedCurve(*columns)


def _curve_of(part: PlanPart, solved: PartSolution) -> PlannedCurve:
    count, points = part.mean_pressure.size, part.settings.get("points", np.nan)
    method = np.full(count, part.method, METHOD_NAME)
    return PlannedCurve(*solved, method, np.full(count, float(part.terms)), np.full(count, float(points)))


def _solve(profile: Profile, part: PlanPart) -> PartSolution:
    """The solution of one part for the whole series.

    Its resistance is bounded by the chords from each load to the other loads that are solved with it.
    """
    p, others = part.mean_pressure, part.other_loads
    loads, index = np.unique(np.column_stack([p, others]), return_inverse=True)
    solved = _complete(profile, part, part.solve(loads))
    h, R, h_error, R_error = (values[index.reshape(p.size, -1)] for values in solved)
    error = h_error + COMPLIANCE_ROUNDING * h
    low, high = chord_bounds(p, h[:, 0], error[:, 0], others, np.array([h[:, 1:], error[:, 1:]]))
    between = np.clip(R[:, 0], low, high)
    chord_error = np.maximum(high - between, between - low)
    known = R_error[:, 0] <= chord_error
    return PartSolution(
        h[:, 0], np.where(known, R[:, 0], between), h_error[:, 0], np.where(known, R_error[:, 0], chord_error)
    )


def _complete(profile: Profile, part: PlanPart, solved: PartSolution) -> PartSolution:
    """The solution of the whole series: the middle of the bounds theorem's interval for the terms left out."""
    left_out = 0.0 if part.includes_tail else profile.amplitude_beyond(part.terms)
    low, high = complete_bounds(solved.compliance, left_out, profile.total_amplitude)
    half = (high - low) / 2
    return PartSolution(
        solved.compliance + half,
        solved.resistance,
        solved.compliance_error + half,
        np.where(left_out > 0, np.inf, solved.resistance_error),
    )
