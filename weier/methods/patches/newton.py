"""Newton's method on a set of segments, and when to give it up because the set is not the right one."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from weier.methods.patches.collocation import assemble
from weier.methods.patches.segments import Segments, from_right, moved, spaces
from weier.methods.patches.waves import Waves

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Factors = tuple[Array, NDArray[np.int32]]

MOST_STEPS = 25
SMALLEST_SHRINKAGE = -0.6  # of ln(half-width) in one step
LARGEST_GROWTH = 1.2
LARGEST_CLOSING = 0.7  # of the space between two segments in one step
MOST_CRAMPED = 2  # steps that would join or remove segments, before that is done
CLOSED = 0.1  # of a space at the start: still closing, it will not stay open
FADED = 1e-3  # of a width at the start: one that Newton then goes on halving is a double root at 0
FADING = 0.3
ROUNDING_STEP = 1e-5  # steps below this that no longer shrink have met rounding, of a contact just born
SHRINKS = 0.3  # of the step before: far from rounding, Newton's next step is its square, and much less
NEAR = 1e-5  # steps below this leave the matrix so much the same that its last factors serve
SWEEPS = 3  # of refinement with them
REFINED = 1e-13  # of the sensitivities, what one more sweep would change


class Status(IntEnum):
    """How Newton's method ended; `topology`: a segment insists on vanishing, or two on meeting."""

    converged = 0
    stalled = 1
    topology = 2


class Iterate(NamedTuple):
    """Newton's result.

    status, steps : how it ended, after how many
    size : of the last step, the largest relative change of a density, a place or a width
    segments, phi, approach, sensitivity : where the steps have led, as in `State`
    closing : whether each segment and the next one on the right insist on meeting, shape (segments,)
    vanishing : whether each segment insists on vanishing, shape (segments,)
    """

    status: Status
    steps: int
    size: float
    segments: Segments
    phi: Array
    approach: float
    sensitivity: Array
    closing: Flags
    vanishing: Flags


def newton(
    here: Segments, phi: Array, approach: float, waves: Waves, load: float, dual: bool, tolerance: float
) -> Iterate:
    """Solve for phi, centres, half-widths and approach.

    Raises
    ------
    LinAlgError
        If the equations are singular.
    """
    start = _Start(spaces(here, waves.period), here.half_width)
    size, cramped, status, steps, factors = np.inf, 0, Status.stalled, 0, None
    limits = _Limits(1.0, *np.zeros((2, start.space.size), bool))
    while status == Status.stalled and steps < MOST_STEPS:
        jacobian, right = assemble(here, phi, approach, waves, load, dual)
        change, factors = _solved(jacobian, right, factors if size < NEAR else None)
        steps += 1
        before, size = size, _size(here, phi, change[:, 0])
        if not size < np.inf:
            break
        limits = _limits(here, change[:, 0], waves.period, start)
        step = -limits.damping * change[:, 0]
        phi = phi + step[: phi.size]
        here = _stepped(here, step[phi.size :], waves.period)
        approach += step[-1]
        cramped += int(np.any(limits.closing) or np.any(limits.vanishing))
        if cramped == MOST_CRAMPED:
            status = Status.topology
        elif limits.damping == 1 and (size < tolerance or (size < ROUNDING_STEP and size > SHRINKS * before)):
            status = Status.converged
    return Iterate(status, steps, size, here, phi, approach, -change[:, 1], limits.closing, limits.vanishing)


def _solved(matrix: Array, right: Array, near: Factors | None) -> tuple[Array, Factors]:
    """The solution, refined from the factors of a nearby matrix if there is one, and the factors used.

    Raises
    ------
    LinAlgError
        If the matrix is singular.
    """
    if near is not None:
        change, first = _substituted(near, right), 1.0
        for sweep in range(SWEEPS):
            rest = _substituted(near, right - matrix @ change)
            change += rest
            share = np.abs(rest[:, 1]).max() / np.abs(change[:, 1]).max()
            share = max(share, abs(rest[-1, 1] / change[-1, 1]))
            first = share if sweep == 0 else first
            if share * first < REFINED:
                return change, near
    lu, pivot, singular = dgetrf(matrix.T, overwrite_a=True)  # whose columns are the rows of the matrix: no copy
    if singular:
        raise np.linalg.LinAlgError
    return _substituted((lu, pivot), right), (lu, pivot)


def _substituted(factors: Factors, right: Array) -> Array:
    return dgetrs(*factors, right, trans=1)[0]


def _size(segments: Segments, phi: Array, change: Array) -> float:
    """The largest relative change of any segment's density, place or width; not a number if any is none."""
    if not np.all(np.isfinite(change)):
        return np.nan
    starts = segments.first[:-1]
    most = np.maximum.reduceat(np.abs(change[: phi.size]), starts) / np.maximum.reduceat(np.abs(phi), starts)
    return float(max(most.max(), np.abs(change[phi.size : -1]).max()))


class _Start(NamedTuple):
    """Spaces on the right of each segment, and half-widths, where Newton began: in lambda_0, shape (segments,)."""

    space: Array
    half_width: Array


class _Limits(NamedTuple):
    """The share of a step that keeps all segments apart and of their order of width, and what it works against.

    closing, vanishing : as in `Iterate`
    """

    damping: float
    closing: Flags
    vanishing: Flags


def _limits(segments: Segments, change: Array, period: float, start: _Start) -> _Limits:
    n, space = start.space.size, spaces(segments, period)
    growth, shift = -change[-1 - n : -1], -change[-1 - 2 * n : -1 - n]
    r = segments.half_width
    loss = r * (growth + shift) + from_right(r * (growth - shift))
    return _Limits(
        _damping(loss / space, growth), _closing(loss, space, start.space), _vanishing(growth, r, start.half_width)
    )


def _closing(loss: Array, space: Array, start: Array) -> Flags:
    """Spaces that a full step would close, or nearly, where little is left of them; or take more of, where faded."""
    closed = (loss > LARGEST_CLOSING * space) & ((loss > space) | (space < CLOSED * start))
    return closed | (loss > FADING * space) & (space < FADED * start)


def _vanishing(growth: Array, half_width: Array, start: Array) -> Flags:
    """Segments that a full step would leave no width, or halve once more where they have faded."""
    return (growth < -1) | (growth < -FADING) & (half_width < FADED * start)


def _damping(loss: Array, growth: Array) -> float:
    """The share of a step within all limits, from the share of each space and of each width that it would take."""
    closest, least, most = np.max(loss), growth.min(), growth.max()
    return float(
        min(
            1.0,
            LARGEST_CLOSING / closest if closest > LARGEST_CLOSING else 1.0,
            SMALLEST_SHRINKAGE / least if least < SMALLEST_SHRINKAGE else 1.0,
            LARGEST_GROWTH / most if most > LARGEST_GROWTH else 1.0,
        )
    )


def _stepped(segments: Segments, change: Array, period: float) -> Segments:
    """Moved and widened by so many half-widths."""
    n, r = segments.centre.size, segments.half_width
    return moved(segments, segments.centre + change[:n] * r, r * (1 + change[n : 2 * n]), period)
