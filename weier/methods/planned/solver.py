"""The method "planned", which runs the plan of a profile: each segment by its method, an error for every number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import thread_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.data.variables import VARIABLES
from weier.kernels.arrays import Array
from weier.kernels.jit import COMPILING_SECONDS
from weier.methods.error_model import COMPLIANCE_ROUNDING
from weier.methods.errors import ConvergenceError, OutOfReachError
from weier.methods.method import Method
from weier.methods.planned.plan import Plan, plan
from weier.methods.progress import telling
from weier.methods.segment import COMPLIANCE, Segment, SegmentSolution
from weier.theory.bounds import chord_bounds, complete_bounds
from weier.theory.profile import Profile

ROUNDING = 1e-9  # of a tolerance: expected errors and those found are sums that may be rounded differently
MAX_OVERRUN, MIN_OVERRUN_SECONDS = 10, 60.0  # times the seconds planned, and at least, before a segment is stopped
METHOD_NAME = VARIABLES["planned_method"].dtype


UNSOLVED = SegmentSolution(*(np.full(1, value) for value in (np.nan, np.nan, np.inf, np.inf)))


class Curve(NamedTuple):
    """Planned curves over the loads, each of shape (loads,), and what the plan expected before.

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*
    compliance_error, resistance_error : estimated, in the same units
    planned_method, planned_terms, planned_points : what was taken at each load; no points where there is no grid
    planned_seconds, planned_error : seconds on one core, and the largest error of the quantity planned for: scalars,
        NaN for a part of a plan
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

    @property
    def arrays(self) -> Sequence[Any]:
        """All that has the shape (loads,)."""
        return self[:-2]


def curve(
    profile: Profile, mean_pressure: Array, methods: Sequence[Method], tolerance: float, quantity: str = COMPLIANCE
) -> Curve:
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
    Curve
        Arrays over the loads, and what the plan expected.

    Raises
    ------
    OutOfReachError
        If no method meets the tolerance, as expected or as found.
    ConvergenceError
        If a segment takes more than ten times as long as planned, and over a minute; it names the next best.

    Notes
    -----
    The numbers of a load do not depend on the other loads, but for what iterations leave within their residuals.
    The error of a compliance is what the method states of its own solution, and half of what the bounds theorem
    leaves open between h_k and full contact. The error of a resistance is that of the method where all terms are
    modelled, or what the chords of a concave curve within the errors of the compliance allow, if that is less: those
    to no load, and to the loads that a plan for the resistance of a long series solves beside each one that it was
    asked for. A load whose solution states more than the tolerance, as next to births of contacts, is planned and
    solved again without what left that error: on a finer grid, by contact patches or with more terms.
    """
    made = plan(profile, mean_pressure, methods, tolerance, quantity)
    return _run_within(made, methods, ())._replace(planned_seconds=made.seconds, planned_error=made.error)


def _run_within(made: Plan, methods: Sequence[Method], failed: Sequence[Segment]) -> Curve:
    """Run a plan; where errors are found above the tolerance, plan and run again without what left them."""
    return _concatenate([_run_segment(made, segment, methods, (*failed, segment)) for segment in made.segments])


def _run_segment(made: Plan, segment: Segment, methods: Sequence[Method], without: Sequence[Segment]) -> Curve:
    """Run a segment; loads that it leaves with larger errors are planned and run again `without` it."""

    def plan_again(loads: Array) -> Plan:
        return plan(made.profile, loads, methods, made.tolerance, made.quantity, without)

    try:
        values = _attempt_in_time(made.profile, segment)
    except TimeoutError as overrun:
        raise ConvergenceError(f"{overrun}; {_next_best(segment, plan_again)}") from None
    of_resistance = values.resistance_error / np.fmax(values.resistance, 1)
    error = values.compliance_error if made.quantity == COMPLIANCE else of_resistance
    exceeding = ~(error <= made.tolerance * (1 + ROUNDING))
    if exceeding.any():
        try:
            again = _run_within(plan_again(segment.mean_pressure[exceeding]), methods, without)
        except OutOfReachError as refusal:
            raise OutOfReachError(f"{refusal}; {_excess_message(segment, error)}") from None
        for old, new in zip(values.arrays, again.arrays, strict=True):
            old[exceeding] = new
    return values


def _attempt_in_time(profile: Profile, segment: Segment) -> Curve:
    """Run a segment; TimeoutError, between two of its loads, if it takes far longer than planned."""
    allowed = max(MAX_OVERRUN * segment.seconds, MIN_OVERRUN_SECONDS)
    start, done, count = thread_time() - COMPILING_SECONDS.get(), 0, segment.mean_pressure.size

    def look_at_clock() -> None:
        nonlocal done
        done, seconds = done + 1, thread_time() - COMPILING_SECONDS.get() - start
        if seconds > allowed and done < count:
            raise TimeoutError(
                f"{_label(segment)} was expected to take {segment.seconds:.2g} s, and was stopped after "
                f"{seconds:.0f} s with {done} of {count} loads solved"
            )

    with telling(look_at_clock):
        return _attempt(profile, segment)


def _next_best(stopped: Segment, plan_again: Callable[[Array], Plan]) -> str:
    """What would come after a segment that was stopped."""
    try:
        other = plan_again(stopped.mean_pressure)
    except OutOfReachError:
        return "no other method is as accurate: take a larger tolerance"
    best = ", ".join(dict.fromkeys(map(_label, other.segments)))
    return f"the next best is {best}, in {other.seconds:.2g} s for all loads: take that method, or a larger tolerance"


def _label(segment: Segment) -> str:
    return f"{segment.method} with {segment.terms:g} terms"


def _attempt(profile: Profile, segment: Segment) -> Curve:
    """Run a segment; loads that its solver gives up have infinite errors, and the others are solved without them."""
    try:
        return run(profile, (segment,))
    except ConvergenceError:
        count = segment.mean_pressure.size
        if count == 1:
            return _curve_of(segment, UNSOLVED)
        halves = slice(None, count // 2), slice(count // 2, None)
        return _concatenate([_attempt(profile, segment.at(half)) for half in halves])


def _excess_message(segment: Segment, error: Array) -> str:
    worst = error.argmax()
    left = f"left an error of {error[worst]:.2g}" if np.isfinite(error[worst]) else "stopped"
    return f"{_label(segment)} was expected to do, and {left} at {segment.mean_pressure[worst]:g} p_0*"


def run(profile: Profile, segments: Sequence[Segment]) -> Curve:
    """Run segments that cover the loads one after the other."""
    return _concatenate([_curve_of(segment, _solve(profile, segment)) for segment in segments])


def _concatenate(curves: Sequence[Curve]) -> Curve:
    columns: Any = map(np.concatenate, zip(*(each.arrays for each in curves), strict=True))
    return Curve(*columns)


def _curve_of(segment: Segment, solved: SegmentSolution) -> Curve:
    count, points = segment.mean_pressure.size, segment.settings.get("points", np.nan)
    method = np.full(count, segment.method, METHOD_NAME)
    return Curve(*solved, method, np.full(count, float(segment.terms)), np.full(count, float(points)))


def _solve(profile: Profile, segment: Segment) -> SegmentSolution:
    """The solution of one segment for the whole series.

    Its resistance is bounded by the chords from each load to the other loads that are solved with it.
    """
    p, others = segment.mean_pressure, segment.other_loads
    loads, index = np.unique(np.column_stack([p, others]), return_inverse=True)
    solved = _complete(profile, segment, segment.solve(loads))
    h, R, h_error, R_error = (values[index.reshape(p.size, -1)] for values in solved)
    error = h_error + COMPLIANCE_ROUNDING * h
    low, high = chord_bounds(p, h[:, 0], error[:, 0], others, np.array([h[:, 1:], error[:, 1:]]))
    between = np.clip(R[:, 0], low, high)
    chord_error = np.maximum(high - between, between - low)
    known = R_error[:, 0] <= chord_error
    return SegmentSolution(
        h[:, 0], np.where(known, R[:, 0], between), h_error[:, 0], np.where(known, R_error[:, 0], chord_error)
    )


def _complete(profile: Profile, segment: Segment, solved: SegmentSolution) -> SegmentSolution:
    """The solution of the whole series: the middle of the bounds that the terms left out allow."""
    left_out = 0.0 if segment.includes_tail else profile.amplitude_beyond(segment.terms)
    low, high = complete_bounds(solved.compliance, left_out, profile.total_amplitude)
    half = (high - low) / 2
    return SegmentSolution(
        solved.compliance + half,
        solved.resistance,
        solved.compliance_error + half,
        np.where(left_out > 0, np.inf, solved.resistance_error),
    )
