"""Tables of W(xi), with rows independent of the loads to be solved, and the closure w(p) of a layer as such a table.

docs/layer.md derives the formulas: "One scale" defines w, "Tables" its interpolation. Part of every contact has a
pressure below the first row, where W is a power of the load. That part is below e^-17 of the mean pressure at the
lightest load of the table (e^-9 at 1e-305), and carries less than this part of the load.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError

BOTTOM_POSITIONS = math.asinh(-58), math.asinh(-711)  # first row: xi = e^-58 and e^-711
MIN_LOADS = 1e-18, 1e-305  # lightest loads for tables from these rows
MAX_POSITION = math.asinh(math.floor(math.log(sys.float_info.max)))  # last row: the largest float is e^709.8
CELL_LENGTH = 0.25  # largest initial spacing of the rows, in positions
MAX_ROWS = 100_000  # the smallest accuracy needs some thousands of rows


class Closure(NamedTuple):
    """ln w - `log_height` as cubics over the position asinh(ln p - origin); outside, w is a power of p.

    In this variable the curvature of ln w is uniform over hundreds of decades.
    """

    cubics: scipy.interpolate.PPoly
    origin: float
    log_height: float


def closure_from_table(position: Array, log_compression: Array, slope: Array) -> Closure:
    """Return the closure of a table: ln w and its slope at increasing positions, each of shape (rows,).

    The two slopes of a cubic are limited to three times its chord.
    """
    length = np.diff(position)
    chord = np.diff(log_compression) / length
    # A cubic is monotone up to slopes of three times its chord (Fritsch and Carlson 1980).
    first, last = (np.minimum(at_end, 3 * chord) for at_end in (slope[:-1], slope[1:]))
    quadratic, cubic = (3 * chord - 2 * first - last) / length, (first + last - 2 * chord) / length**2
    return Closure(scipy.interpolate.PPoly([cubic, quadratic, first, log_compression[:-1]], position), 0.0, 0.0)


def position_in(closure: Closure, log_pressure: Array) -> tuple[Array, Array]:
    """Return positions of ln p, clipped to the rows, and the excess beyond both ends, linear in ln p."""
    position = np.arcsinh(log_pressure - closure.origin)
    inside = np.clip(position, *closure.cubics.x[[0, -1]])
    excess = log_pressure - closure.origin - np.sinh(inside)
    return inside, np.where(inside == position, 0.0, excess / np.cosh(inside))


def log_compression(closure: Closure, log_pressure: Array) -> tuple[Array, Array]:
    """Return ln w and d ln w/d ln p at each ln p."""
    position, excess = position_in(closure, log_pressure)
    slope = closure.cubics(position, 1)
    log_w = closure.log_height + closure.cubics(position) + slope * excess
    return log_w, slope / np.cosh(position)


class Rows(NamedTuple):
    """ln W and its slope at increasing positions of ln xi, each of shape (rows,), and the waves solved for them.

    Positions are those of a closure of origin 0. The states of the waves have the shape (rows, unknowns); there are
    no unknowns where W has a closed form.
    """

    position: Array
    log_compliance: Array
    slope: Array
    state: Array

    @property
    def closure(self) -> Closure:
        """W as the closure of a layer, in units of its coarsest wave."""
        return closure_from_table(
            self.position, np.maximum.accumulate(self.log_compliance), np.maximum(self.slope, 0)
        )


WaveMap = Callable[[Array, Array | None], Rows]  # takes increasing positions and initial states


def log_load_at(position: ArrayLike) -> Array:
    """Return ln xi at these positions."""
    return np.sinh(position)


def lattice(bottom: float, top: float) -> Array:
    """Return positions of the first rows, equally spaced from the bottom to the top."""
    top = min(top, MAX_POSITION)
    return np.linspace(bottom, top, math.ceil((top - bottom) / CELL_LENGTH) + 1)


def tabulate(waves: WaveMap, first: Array, accuracy: float) -> Rows:
    """Tabulate at initial positions and bisect cells until the cubics agree with W at all midpoints."""
    rows = waves(first, None)
    left, right = first[:-1], first[1:]
    while rows.position.size <= MAX_ROWS:
        between, errors = evaluate_midpoints(waves, rows, left, right)
        rows = merge(rows, between)
        # A row in the middle of a cell at least halves its error, even near a kink.
        wrong = ~(errors <= 2 * accuracy)
        if not np.any(wrong):
            return rows
        middle = between.position
        left, right = (np.stack(ends, 1)[wrong].ravel() for ends in ((left, middle), (middle, right)))
    raise accuracy_error(float(np.max(errors)), rows, accuracy)


def evaluate_midpoints(waves: WaveMap, rows: Rows, left: Array, right: Array) -> tuple[Rows, Array]:
    """Return rows at the middles of cells, and the relative errors of the table there, shape (cells,).

    The cubics must agree in slope as well: near a kink the value may agree by chance.
    """
    middle, half = (left + right) / 2, (right - left) / 2
    # Cubics overshoot where a contact becomes full within a cell.
    between = waves(middle, scipy.interpolate.make_interp_spline(rows.position, rows.state, k=1)(middle))
    log_W, power = log_compression(rows.closure, log_load_at(middle))
    # A cubic is wrong by 4/27 of a slope error times half the spacing.
    by_slope = 0.25 * half * np.abs(between.slope - power * np.cosh(middle))
    return between, np.maximum(np.abs(between.log_compliance - log_W), by_slope)


def merge(rows: Rows, more: Rows) -> Rows:
    """Return the rows of both tables in order of position."""
    order = np.argsort(np.concatenate([rows.position, more.position]))
    return Rows(*(np.concatenate(pair)[order] for pair in zip(rows, more, strict=True)))


def accuracy_error(error: float, rows: Rows, accuracy: float) -> ConvergenceError:
    """Return the exception for a table that does not reach its accuracy."""
    return ConvergenceError(
        f"a table of the layer model is still off by {error:.1e} of itself after {rows.position.size} rows, above "
        f"{accuracy:.1e}, its part of the accuracy: choose a larger accuracy",
        error,
    )
