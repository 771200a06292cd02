"""Tables of W(xi), with rows independent of the loads to be solved (docs/layer.md, "Tables").

Part of every contact has a pressure below the first row, where W is a power of the load. That part is below e^-17 of
the mean pressure at the lightest load of the table (e^-9 at 1e-305), and carries less than this part of the load.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.layer.closure import Closure, closure_from_table, log_compression

BOTTOM_POSITIONS = math.asinh(-58), math.asinh(-711)  # first row: xi = e^-58 and e^-711
MIN_LOADS = 1e-18, 1e-305  # lightest loads for tables from these rows
MAX_POSITION = math.asinh(709)  # last row: double precision ends at e^709.8
CELL_LENGTH = 0.25  # initial spacing of the rows, in positions
MIN_CELL = 1e-3  # a shorter last cell, relative to the others, is merged with the previous one
MAX_HALVINGS = 30  # halvings of a cell; the smallest accuracy needs 17
MAX_ROWS = 100_000  # the smallest accuracy needs some thousands of rows


class Rows(NamedTuple):
    """ln W and its slope at increasing positions of ln xi, each of shape (rows,), and the waves solved for them.

    Positions are those of a closure of origin 0. The states of the waves and the slopes of these have the shape
    (rows, unknowns); there are no unknowns where W has a closed form.
    """

    position: Array
    log_compliance: Array
    slope: Array
    state: Array
    tangent: Array

    @property
    def closure(self) -> Closure:
        """W as the closure of a layer, in the units of its own coarsest wave."""
        return closure_from_table(
            self.position, np.maximum.accumulate(self.log_compliance), np.maximum(self.slope, 0)
        )


WaveMap = Callable[[Array, Array | None], Rows]  # takes increasing positions and initial states


def log_load_at(position: ArrayLike) -> Array:
    """Return ln xi at these positions."""
    return np.sinh(position)


def table_position(log_load: float) -> float:
    """Return the position of a ln xi."""
    return math.asinh(log_load)


def lattice(bottom: float, top: float) -> Array:
    """Return positions of the first rows, up to the top and ending there."""
    top = min(top, MAX_POSITION)
    position = bottom + CELL_LENGTH * np.arange(max(math.ceil((top - bottom) / CELL_LENGTH - MIN_CELL), 1))
    return np.append(position, top)


def tabulate(waves: WaveMap, first: Array, accuracy: float) -> Rows:
    """Return rows at the initial positions, refined until the cubics agree with the next midpoints."""
    rows = waves(first, None)
    left, right = first[:-1], first[1:]
    for _ in range(MAX_HALVINGS):
        between, errors = evaluate_midpoints(waves, rows, left, right)
        rows = merge(rows, between)
        # A row in the middle of a cell at least halves its error, even near a kink.
        wrong = ~(errors <= 2 * accuracy)
        if not np.any(wrong):
            return rows
        if rows.position.size > MAX_ROWS:
            break
        middle = between.position
        left, right = (np.stack(ends, 1)[wrong].ravel() for ends in ((left, middle), (middle, right)))
    raise accuracy_error(float(np.max(errors)), rows, accuracy)


def evaluate_midpoints(waves: WaveMap, rows: Rows, left: Array, right: Array) -> tuple[Rows, Array]:
    """Return rows in the middle of these cells, and the relative errors of the table there, of shape (cells,).

    The cubics must agree in slope as well: near a kink the value may agree by chance.
    """
    middle, half = (left + right) / 2, (right - left) / 2
    guess = scipy.interpolate.CubicHermiteSpline(rows.position, rows.state, rows.tangent)(middle)
    between = waves(middle, guess)
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
