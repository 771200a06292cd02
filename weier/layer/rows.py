"""Tables of the compliance of a wave over its load, at rows that do not depend on the loads asked for.

A table begins at the same lightest load whatever is asked for, its rows first stand on a fixed lattice, and
a cell between two rows is halved by what is found in that cell alone. So a table that reaches heavier loads continues
a shorter one and changes none of its numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.errors import ConvergenceError
from weier.layer.closure import SCALE, Closure, compressions

Array = NDArray[np.float64]

BOTTOMS = -3.375, -5.875  # positions of the first row: for loads from 1e-18, and for all others
LIGHTEST = 1e-18, 1e-305  # loads that these tables are for: far enough above the first row that it bears nothing
CELL = 0.25  # of the lattice, in positions; a last cell of a thousandth of it is joined to the one before
SLOPE_SHARE = 0.25  # of a slope over half the distance between rows; a cubic is off by 4/27 of it
MAX_HALVINGS = 30  # of a cell, and rows of a table: the smallest accuracy took 17 halvings
MAX_ROWS = 100_000


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
        return Closure(self.position, np.maximum.accumulate(self.log_compliance), np.maximum(self.slope, 0), 0.0)


WaveMap = Callable[[Array, Array | None], Rows]  # of increasing positions and states to start from


def log_load_at(position: Array) -> Array:
    """ln xi at these positions."""
    return np.asarray(SCALE * np.sinh(position))


def position_of(log_load: float) -> float:
    """The position of a ln xi."""
    return math.asinh(log_load / SCALE)


def lattice(bottom: float, top: float) -> Array:
    """The fixed positions where tables have rows, up to the top and ending there."""
    position = bottom + CELL * np.arange(max(math.ceil((top - bottom) / CELL - 1e-3), 1))
    return np.append(position, top)


def tabulated(waves: WaveMap, first: Array, accuracy: float) -> Rows:
    """Rows at the first loads, and between them as many as the cubics need to meet the next midpoints.

    They must meet the slope too: beside a kink a cubic may meet the value by chance.

    Raises
    ------
    ConvergenceError
        If 30 halvings of a cell or 100 000 rows do not suffice.
    """
    rows = waves(first, None)
    left, right = first[:-1], first[1:]
    for _ in range(MAX_HALVINGS):
        between, errors = midway(waves, rows, left, right)
        rows = merged(rows, between)
        wrong = ~(errors <= accuracy)
        if not np.any(wrong):
            return rows
        if rows.position.size > MAX_ROWS:
            break
        left, right = halves(left[wrong], right[wrong])
    raise missed(float(np.max(errors)), rows, accuracy)


def midway(waves: WaveMap, rows: Rows, left: Array, right: Array) -> tuple[Rows, Array]:
    """The rows in the middle of these cells, and the relative errors of the table there, each of shape (cells,)."""
    middle, half = (left + right) / 2, (right - left) / 2
    between = waves(middle, interpolated_states(rows, middle))
    log_W, slope = cubics(rows, middle)
    by_slope = SLOPE_SHARE * half * np.abs(between.slope - slope)
    return between, np.maximum(np.abs(between.log_compliance - log_W), by_slope)


def halves(left: Array, right: Array) -> tuple[Array, Array]:
    """The cells cut in two: their ends, in order."""
    middle = (left + right) / 2
    return np.stack([left, middle], 1).ravel(), np.stack([middle, right], 1).ravel()


def merged(rows: Rows, more: Rows) -> Rows:
    """All rows in order."""
    order = np.argsort(np.concatenate([rows.position, more.position]))
    return Rows(*(np.concatenate(pair)[order] for pair in zip(rows, more, strict=True)))


def missed(error: float, rows: Rows, accuracy: float) -> ConvergenceError:
    """What to raise where a table misses its accuracy."""
    return ConvergenceError(
        f"a table of the layer model is still off by {error:.1e} of itself after {rows.position.size} rows, above "
        f"{accuracy:.1e}, its share of the accuracy: choose a larger accuracy or a smaller tolerance",
        error,
    )


def cubics(rows: Rows, position: Array) -> tuple[Array, Array]:
    """ln W and its slope between the rows, at positions of shape (n,)."""
    log_W, power = compressions(rows.closure, log_load_at(position))
    return log_W, power * SCALE * np.cosh(position)


def interpolated_states(rows: Rows, position: Array) -> Array:
    """States at these positions, of shape (n, unknowns), from the cubics through states and tangents."""
    right = np.clip(np.searchsorted(rows.position, position), 1, rows.position.size - 1)
    left = right - 1
    length = (rows.position[right] - rows.position[left])[:, None]
    t = (position - rows.position[left])[:, None] / length
    by_value = rows.state[left] + t * t * (3 - 2 * t) * (rows.state[right] - rows.state[left])
    by_slope = length * t * (1 - t) * ((1 - t) * rows.tangent[left] - t * rows.tangent[right])
    return np.asarray(by_value + by_slope)
