"""Newton's method on a given number of segments, whose ends are unknown.

It starts close to the solution, and gives up where a step would leave a segment no width or make two overlap: then
their number is wrong.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need
from numpy.typing import NDArray

from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.patches.collocation import assemble
from weier.methods.patches.segments import Segments, distances_to_next, move_segments, values_of_next
from weier.methods.patches.surface import CosineSeries

Factors = tuple[Array, NDArray[np.int32]]

MAX_STEPS = 25
MAX_ROUNDING_STEP = 1e-5  # smaller steps that no longer shrink are rounding, as in a contact that has just been born
MIN_ROUNDING_RATIO = 0.3  # of a step over the one before: free of rounding, Newton's steps shrink far more


class NewtonResult(NamedTuple):
    """Where Newton's method has led.

    steps : how many it took
    segments, phi, approach, sensitivity : the unknowns and their derivatives in the load, as in `ContactState`
    factors : of the last matrix
    """

    steps: int
    segments: Segments
    phi: Array
    approach: float
    sensitivity: Array
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
    """Solve for phi, the centres, the half-widths and the approach; ConvergenceError if the steps do not shrink."""
    step_size = np.inf
    for steps in range(1, MAX_STEPS + 1):
        jacobian, right_side = assemble(segments, phi, approach, series, load, dual)
        solution, factors = _solve(jacobian, right_side)
        step, previous_size = -solution[:, 0], step_size
        step_size = max(relative_step(segments, phi, step), _largest_loss(segments, step, series.period))
        if not step_size < np.inf:
            break
        phi, approach = phi + step[: phi.size], approach + step[-1]
        segments = apply_step(segments, step[phi.size :], series.period)
        if _is_small(step_size, previous_size, tolerance):
            return NewtonResult(steps, segments, phi, approach, -solution[:, 1], factors)
    raise ConvergenceError(f"Newton's method fails under the mean pressure {load:.6g} p_0*", float(step_size))


def _is_small(step_size: float, previous_size: float, tolerance: float) -> bool:
    """Whether a step is below the tolerance, or so small that it should have shrunk more, were it not rounding."""
    return step_size < tolerance or (step_size < MAX_ROUNDING_STEP and step_size > MIN_ROUNDING_RATIO * previous_size)


def _solve(matrix: Array, right_side: Array) -> tuple[Array, Factors]:
    """The solution, NaN if the matrix is singular, and the factors used."""
    lu, pivot, singular = scipy.linalg.lapack.dgetrf(matrix.T, overwrite_a=True)  # LAPACK's columns are numpy's rows
    if singular:
        return np.full_like(right_side, np.nan), (lu, pivot)
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


def _largest_loss(segments: Segments, step: Array, period: float) -> float:
    """The largest change of a distance between segments, over itself; inf if one of them or a width is lost."""
    n, r, distance = segments.centre.size, segments.half_width, distances_to_next(segments, period)
    growth, shift = step[-1 - n : -1], step[-1 - 2 * n : -1 - n]
    loss = (r * (growth + shift) + values_of_next(r * (growth - shift))) / distance
    if np.any(loss >= 1) or np.any(growth <= -1):
        return np.inf
    return float(np.abs(loss).max())


def apply_step(segments: Segments, step: Array, period: float) -> Segments:
    """The segments moved and widened by so many half-widths."""
    n, r = segments.centre.size, segments.half_width
    return move_segments(segments, segments.centre + step[:n] * r, r * (1 + step[n : 2 * n]), period)
