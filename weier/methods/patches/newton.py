"""Newton's method on a given number of segments, which gives up when that number turns out to be wrong.

There are too many segments if step after step would leave one of them no width, or make two of them overlap. Then the
caller removes the one or merges the two.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags
from weier.methods.patches.collocation import assemble
from weier.methods.patches.segments import Segments, distances_to_next, move_segments, values_of_next
from weier.methods.patches.surface import CosineSeries

Factors = tuple[Array, NDArray[np.int32]]
NO_FACTORS: Factors = (np.empty((0, 0)), np.empty(0, np.int32))

MAX_STEPS = 25
MIN_GROWTH, MAX_GROWTH = -0.6, 1.2  # of a half-width in one step, relative to it
MAX_DISTANCE_LOSS = 0.7  # of the distance between two segments, in one step
MAX_TOPOLOGY_STEPS = 2  # steps that would merge or remove segments before Newton's method gives up
MAX_MEETING_DISTANCE = 0.1  # over the distance at the start: two segments this close that still approach will meet
MAX_DOUBLE_ROOT = 1e-3  # of a width or distance at the start: one that Newton goes on halving is a double root at 0
MIN_HALVING = 0.3  # of a width or distance in one step, from which on it counts as being halved
MAX_ROUNDING_STEP = 1e-5  # smaller steps that no longer shrink are rounding, as in a contact that has just been born
MIN_ROUNDING_RATIO = 0.3  # of a step over the one before: free of rounding, Newton's steps shrink far more


class NewtonStatus(IntEnum):
    """How Newton's method ended; `topology` means that segments vanish or meet."""

    converged = 0
    stalled = 1
    topology = 2


class NewtonResult(NamedTuple):
    """Where Newton's method has led.

    status, steps : how it ended, and after how many steps
    step_size : of the last step, the largest relative change of a density or of a distance between two segments, or
        of a centre or width in half-widths
    segments, phi, approach, sensitivity : the unknowns and their derivatives in the load, as in `ContactState`
    meeting : whether each segment meets the next one on its right, shape (segments,)
    vanishing : whether each segment vanishes, shape (segments,)
    factors : of the last matrix
    """

    status: NewtonStatus
    steps: int
    step_size: float
    segments: Segments
    phi: Array
    approach: float
    sensitivity: Array
    meeting: Flags
    vanishing: Flags
    factors: Factors


def newton_iteration(
    segments: Segments,
    phi: Array,
    approach: float,
    series: CosineSeries,
    load: float,
    dual: bool,
    tolerance: float,
) -> NewtonResult:
    """Solve for phi, the centres, the half-widths and the approach; LinAlgError if the equations are singular."""
    start = _Layout(distances_to_next(segments, series.period), segments.half_width)
    step_size, topology_steps, status, steps, factors = np.inf, 0, NewtonStatus.stalled, 0, NO_FACTORS
    limits = _StepLimits(1.0, np.inf, *np.zeros((2, segments.centre.size), bool))
    while status == NewtonStatus.stalled and steps < MAX_STEPS:
        jacobian, right_side = assemble(segments, phi, approach, series, load, dual)
        solution, factors = _solve(jacobian, right_side)
        steps += 1
        limits = _step_limits(segments, solution[:, 0], series.period, start)
        previous_size = step_size
        step_size = max(relative_step(segments, phi, solution[:, 0]), limits.distance_change)
        if not step_size < np.inf:
            break
        step = -limits.damping * solution[:, 0]
        phi = phi + step[: phi.size]
        segments = _apply_step(segments, step[phi.size :], series.period)
        approach += step[-1]
        topology_steps += int(np.any(limits.meeting) or np.any(limits.vanishing))
        if topology_steps == MAX_TOPOLOGY_STEPS:
            status = NewtonStatus.topology
        elif limits.damping == 1 and _small_enough(step_size, previous_size, tolerance):
            status = NewtonStatus.converged
    return NewtonResult(
        status,
        steps,
        step_size,
        segments,
        phi,
        approach,
        -solution[:, 1],
        limits.meeting,
        limits.vanishing,
        factors,
    )


def _small_enough(step_size: float, previous_size: float, tolerance: float) -> bool:
    """Whether a step is below the tolerance, or so small that it should have shrunk more, were it not rounding."""
    return step_size < tolerance or (step_size < MAX_ROUNDING_STEP and step_size > MIN_ROUNDING_RATIO * previous_size)


def _solve(matrix: Array, right_side: Array) -> tuple[Array, Factors]:
    """The solution and the factors used."""
    lu, pivot, singular = scipy.linalg.lapack.dgetrf(matrix.T, overwrite_a=True)  # LAPACK's columns are numpy's rows
    if singular:
        raise np.linalg.LinAlgError
    return back_substitute((lu, pivot), right_side), (lu, pivot)


def back_substitute(factors: Factors, right_side: Array) -> Array:
    """Solve with factors."""
    return np.asarray(scipy.linalg.lapack.dgetrs(*factors, right_side, trans=1)[0])


def relative_step(segments: Segments, phi: Array, step: Array) -> float:
    """The largest relative change of any segment's density, centre or width; NaN if the step is not finite."""
    if not np.all(np.isfinite(step)):
        return np.nan
    starts = segments.first_node[:-1]
    change = np.maximum.reduceat(np.abs(step[: phi.size]), starts) / np.maximum.reduceat(np.abs(phi), starts)
    return float(max(change.max(), np.abs(step[phi.size : -1]).max()))


class _Layout(NamedTuple):
    """Distance from each segment to the next, and half-widths, in lambda_0, shape (segments,)."""

    distance: Array
    half_width: Array


class _StepLimits(NamedTuple):
    """The share of a step that keeps all segments apart and their widths positive, and which would meet or vanish.

    distance_change : largest change of the distance between two segments that a full step makes, relative to it
    meeting, vanishing : as in `NewtonResult`
    """

    damping: float
    distance_change: float
    meeting: Flags
    vanishing: Flags


def _step_limits(segments: Segments, solution: Array, period: float, start: _Layout) -> _StepLimits:
    n, distance = start.distance.size, distances_to_next(segments, period)
    growth, shift = -solution[-1 - n : -1], -solution[-1 - 2 * n : -1 - n]
    r = segments.half_width
    loss = r * (growth + shift) + values_of_next(r * (growth - shift))
    return _StepLimits(
        _damping(loss / distance, growth),
        float(np.abs(loss / distance).max()),
        _meeting_segments(loss, distance, start.distance),
        _vanishing_segments(growth, r, start.half_width),
    )


def _meeting_segments(loss: Array, distance: Array, start: Array) -> Flags:
    """Whether a full step would make segments meet, or halve a distance that has nearly gone; `loss` is its loss."""
    meeting = (loss > MAX_DISTANCE_LOSS * distance) & ((loss > distance) | (distance < MAX_MEETING_DISTANCE * start))
    return meeting | (loss > MIN_HALVING * distance) & (distance < MAX_DOUBLE_ROOT * start)


def _vanishing_segments(growth: Array, half_width: Array, start: Array) -> Flags:
    """Whether a full step would leave segments no width, or halve a width that has nearly gone."""
    return (growth < -1) | (growth < -MIN_HALVING) & (half_width < MAX_DOUBLE_ROOT * start)


def _damping(loss: Array, growth: Array) -> float:
    """The share of a step within all limits, from the relative loss of each distance and growth of each width."""
    max_loss, min_growth, max_growth = np.max(loss), growth.min(), growth.max()
    return float(
        min(
            1.0,
            MAX_DISTANCE_LOSS / max_loss if max_loss > MAX_DISTANCE_LOSS else 1.0,
            MIN_GROWTH / min_growth if min_growth < MIN_GROWTH else 1.0,
            MAX_GROWTH / max_growth if max_growth > MAX_GROWTH else 1.0,
        )
    )


def _apply_step(segments: Segments, step: Array, period: float) -> Segments:
    """The segments moved and widened by so many half-widths."""
    n, r = segments.centre.size, segments.half_width
    return move_segments(segments, segments.centre + step[:n] * r, r * (1 + step[n : 2 * n]), period)
