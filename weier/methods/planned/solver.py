"""The method "planned", which runs the plan of a profile: each segment by its method, an error for every number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array
from weier.methods.error_model import COMPLIANCE_ROUNDING
from weier.methods.errors import OutOfReachError
from weier.methods.method import Method
from weier.methods.planned.plan import plan
from weier.methods.segment import COMPLIANCE, Segment, Solution
from weier.theory.bounds import chord_bounds, complete_bounds
from weier.theory.profile import Profile

ROUNDING = 1e-9  # of a tolerance, to which the errors expected and those found add up alike
METHOD_NAME = "<U16"  # as the table of variables has it


class Curve(NamedTuple):
    """Planned curves over the loads, each of shape (loads,).

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*
    compliance_error, resistance_error : expected, in the same units
    planned_method, planned_terms, planned_points : what was taken at each load; no points where there is no grid
    """

    compliance: Array
    resistance: Array
    compliance_error: Array
    resistance_error: Array
    planned_method: NDArray[np.str_]
    planned_terms: Array
    planned_points: Array


def curve(
    profile: Profile, mean_pressure: Array, methods: Sequence[Method], tolerance: float, quantity: str = COMPLIANCE
) -> Curve:
    """Plan and run: see `weier.plan`.

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
        Arrays over the loads.

    Raises
    ------
    OutOfReachError
        If no method meets the tolerance, as expected or as found.
    ConvergenceError
        If a solver misses its own tolerance.

    Notes
    -----
    The numbers of a load do not depend on the other loads, but for what iterations leave within their residuals.
    The error of a compliance is that of the discretisation, by the error model of the method or from the residual
    that it left, and half of what the bounds theorem leaves open between h_k and full contact. The error of a
    resistance is that of the method where all terms are modelled, or what the chords of a concave curve within the
    errors of the compliance allow, if that is less: those to no load, and to the loads that a plan for the resistance
    solves beside each one that it was asked for. A grid sees births and mergers of contacts at other loads than they
    happen: as much as the resistance changes within that distance is added to its error, and a load at which that is
    too much is solved by contact patches. A plan for the compliance solves no other loads, and has no such error.
    """
    return _within(profile, mean_pressure, methods, tolerance, quantity, ())


def _within(
    profile: Profile,
    loads: Array,
    methods: Sequence[Method],
    tolerance: float,
    quantity: str,
    failed: tuple[Segment, ...],
) -> Curve:
    """Plan and run; where errors are found above the tolerance, again without what left them."""
    curves = []
    for segment in plan(profile, loads, methods, tolerance, quantity, failed).segments:
        values = run(profile, (segment,))
        error = values.compliance_error if quantity == COMPLIANCE else _relative_error(values)
        missed = ~(error <= tolerance * (1 + ROUNDING))
        if missed.any():
            try:
                failures = (*failed, segment)
                again = _within(profile, segment.mean_pressure[missed], methods, tolerance, quantity, failures)
            except OutOfReachError as refusal:
                raise OutOfReachError(f"{refusal}; {_missed(segment, error)}") from None
            for old, new in zip(values, again, strict=True):
                old[missed] = new
        curves.append(values)
    return _joined(curves)


def _relative_error(solved: Curve) -> Array:
    return solved.resistance_error / np.maximum(solved.resistance, 1)


def _missed(segment: Segment, error: Array) -> str:
    worst = error.argmax()
    return (
        f"{segment.method} with {segment.terms:g} terms was expected to do, and left an error of {error[worst]:.2g} "
        f"at {segment.mean_pressure[worst]:g} p_0*"
    )


def run(profile: Profile, segments: Sequence[Segment]) -> Curve:
    """Run segments that cover the loads one after the other.

    Raises
    ------
    ConvergenceError
        If a solver misses its own tolerance.
    """
    return _joined([_curve(segment, _solved(profile, segment)) for segment in segments])


def _joined(curves: Sequence[Curve]) -> Curve:
    return Curve(*(np.concatenate(columns) for columns in zip(*curves, strict=True)))


def _curve(segment: Segment, solved: Solution) -> Curve:
    count = segment.mean_pressure.size
    points = float(segment.settings.get("points", np.nan))
    return Curve(
        *solved,
        np.full(count, segment.method, METHOD_NAME),
        np.full(count, float(segment.terms)),
        np.full(count, points),
    )


def _solved(profile: Profile, segment: Segment) -> Solution:
    """One segment for the whole series, its resistance held by the chords of each load to the others it brings."""
    p = segment.mean_pressure
    others = np.empty((p.size, 0)) if segment.other_loads is None else segment.other_loads
    loads, index = np.unique(np.column_stack([p, others]), return_inverse=True)
    solved = _completed(profile, segment, segment.solve(loads))
    h, R, h_error, R_error = (values[index.reshape(p.size, -1)] for values in solved)
    error = h_error + COMPLIANCE_ROUNDING * h
    low, high = chord_bounds(p, h[:, 0], error[:, 0], others, np.array([h[:, 1:], error[:, 1:]]))
    between = np.clip(R[:, 0], low, high)
    chord_error = np.maximum(high - between, between - low)
    # What happens to the contacts between a load and those beside it may have happened at the other side of the load.
    own_error = R_error[:, 0] + np.abs(R[:, 1:] - R[:, :1]).max(axis=1, initial=0.0)
    known = own_error <= chord_error
    return Solution(
        h[:, 0], np.where(known, R[:, 0], between), h_error[:, 0], np.where(known, own_error, chord_error)
    )


def _completed(profile: Profile, segment: Segment, solved: Solution) -> Solution:
    """The same for the whole series: the middle of what the terms left out can make of it."""
    if segment.whole:
        return solved
    low, high = complete_bounds(solved.compliance, profile.amplitude_beyond(segment.terms), profile.total_amplitude)
    width = high - low
    complete = segment.terms == profile.m
    return Solution(
        solved.compliance + width / 2,
        solved.resistance,
        solved.compliance_error + width / 2,
        solved.resistance_error if complete else np.full(width.size, np.inf),
    )
