"""The infinite series: its closure is the fixed point of one scale, by Newton's method on all rows of its table.

Applied again and again, the map T of `weier.layer.scales` takes hundreds of scales where D is close to 2. But how much
the compression of the layer at each pressure changes W is known from the wave's own linear equations
(`weier.layer.wave.shares`), so W follows from a few systems of linear equations over the rows,

    ln W - ln T W = 0,    J = d ln T W/d ln W >= 0.

The same matrix says what errors add up to over all scales: where T W, computed from the table, is off by a relative
error e at most, W is off by (I - J)^-1 e at most.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier import archard
from weier.errors import ConvergenceError
from weier.jit import kernel
from weier.layer.closure import SCALE, Closure
from weier.layer.rows import (
    MAX_HALVINGS,
    MAX_ROWS,
    Rows,
    cubics,
    interpolated_states,
    lattice,
    log_load_at,
    merged,
    midway,
    missed,
    position_of,
)
from weier.layer.scales import Scale, Scaling, Waves, coarser_units
from weier.layer.wave import Mesh, shares

Array = NDArray[np.float64]

TABLE_SHARE = 0.5  # of the accuracy, for the errors of the table; residuals of the waves have the rest
LIGHT = -8.0  # ln xi from which downwards a first guess takes one row after the other
START = 0.1  # last step of Newton's method on the heavier of the first rows alone
MAX_NEWTON_STEPS = 40  # 3 to 12 are usual
MAX_STEP = 10.0  # of ln W: further away the tangents mislead
MIN_SHARE = 1e-12  # of a table's relative error: below it the cubics' own rounding adds up over the scales
MAX_HALVINGS_AT_ONCE = 3  # of a cell, by the fourth order of its cubic


class Table(NamedTuple):
    """Rows of the fixed point, and what errors add up to there, each of shape (rows,).

    gain : of relative errors of 1 in all of the table, relative to W
    error : of the errors that the table has, relative to W
    """

    rows: Rows
    gain: Array
    error: Array


@dataclass(frozen=True)
class FixedPoint:
    """The infinite series of one D and gamma, on one mesh."""

    D: float
    gamma: float
    mesh: Mesh
    accuracy: float
    tolerance: float

    @property
    def scaling(self) -> Scaling:
        """Of the next finer wave."""
        return Scaling.of(self.D, self.gamma)

    @property
    def amplitude(self) -> float:
        """The sum of all amplitudes."""
        return -1 / math.expm1(self.scaling.log_height)

    def waves(self, bottom: float, tops: list[float]) -> list[Waves]:
        """The waves for positions up to each of these increasing tops, each table a continuation of the one before.

        W at a load depends on lighter and heavier ones, since the pressure varies along the wave, but up to the first
        top on no load above it, and so for every further one.

        Raises
        ------
        ConvergenceError
            If errors add up over so many scales that no table meets the accuracy.
        """
        table, found = None, []
        for top in tops:
            table = self._continued(table, lattice(bottom, top))
            found.append(Waves(table.rows, self.amplitude, math.inf))
        return found

    def _continued(self, known: Table | None, position: Array) -> Table:
        """The table with rows up to the last of these positions; those that it has stay as they are."""
        count = known.rows.position.size if known else 0
        rows = self._extrapolation(position, known.rows) if known else self._guess(position)
        limit = self.accuracy
        for _ in range(MAX_HALVINGS):
            rows, size = self._converged(rows, count, math.sqrt(limit))
            gain = _sums(size, known.gain if known else rows.position[:0], np.ones(size.shape[0]))
            limit = self._limit(gain)
            cells = rows.position[max(count - 1, 0) :]
            _, errors = midway(self._scale(rows).waves, rows, cells[:-1], cells[1:])
            at_rows = np.maximum(np.append(errors, 0), np.append(0, errors))
            error = _sums(size, known.error if known else rows.position[:0], size[:, max(count - 1, 0) :] @ at_rows)
            if np.max(error[max(count - 1, 0) :] + at_rows) <= TABLE_SHARE * self.accuracy:
                return Table(rows, gain, error)
            rows = refined(rows, cells, errors, limit)
            if rows.position.size > MAX_ROWS:
                break
        raise missed(float(np.max(errors)), rows, limit)

    def _limit(self, gain: Array) -> float:
        """The relative error of a table that adds up to its part of the accuracy."""
        limit = TABLE_SHARE * self.accuracy / (1 + float(np.max(gain)))
        if not limit >= MIN_SHARE:
            raise ConvergenceError(
                f"errors of the layer model add up over {np.max(gain):.1e} scales, too many for the accuracy "
                f"{self.accuracy:.1e}: choose a larger gamma, a smaller D or a larger accuracy",
                self.accuracy * MIN_SHARE / limit,
            )
        return limit

    def _scale(self, rows: Rows) -> Scale:
        """A wave on the layer that this table stands for."""
        closure = coarser_units(rows.closure, self.scaling)
        return Scale(closure, self.amplitude, math.inf, self.mesh, self.tolerance)

    def _guess(self, position: Array) -> Rows:
        """A table near the fixed point: heavier loads from Archard's estimate, then the lighter ones in turn.

        Under light loads the contacts are so small that their pressures are among the heavier loads of the next wave.
        """
        heavy = position[position >= position_of(LIGHT)]
        log_W = np.log(archard.compliance(np.exp(log_load_at(heavy)), self.D, self.gamma, math.inf))
        rows, _ = self._converged(self._without_states(heavy, log_W, np.gradient(log_W, heavy)), 0, START)
        for one in position[position < position_of(LIGHT)][::-1]:
            rows = merged(self._scale(rows).waves(np.array([one]), None), rows)
        return rows

    def _extrapolation(self, position: Array, known: Rows) -> Rows:
        """The known rows, and the power law beyond them at the positions that are further."""
        further = position[position > known.position[-1]]
        log_W, slope = cubics(known, further)
        return merged(known, self._without_states(further, np.minimum(log_W, math.log(self.amplitude)), slope))

    def _without_states(self, position: Array, log_W: Array, slope: Array) -> Rows:
        states = np.full((position.size, self.mesh.rise.size + 1), np.nan)
        return Rows(position, log_W, slope, states, states)

    def _converged(self, rows: Rows, known: int, limit: float) -> tuple[Rows, Array]:
        """The rows at the fixed point, the known ones as they are, and how much errors at each row move the others.

        That matrix has the shape (rows that are not known, rows). The last step is the limit at most, and what is left
        is of the order of its square.
        """
        first, change = max(known - 1, 0), math.inf
        position = rows.position[known:]
        by_values, by_first = slopes_of_spline(rows.position[first:], clamped=known > 0)
        inner = by_values[:, known - first :]
        for _ in range(MAX_NEWTON_STEPS):
            scale = self._scale(rows)
            image = scale.waves(position, rows.state[known:])
            by_value, by_slope, size = sensitivity(log_load_at(position), image.log_compliance, image.state, scale.closure, scale.mesh)
            derivative = by_value[:, known:] + by_slope[:, first:] @ inner
            step = np.linalg.solve(np.eye(position.size) - derivative, image.log_compliance - rows.log_compliance[known:])
            change = float(np.max(np.abs(step)))
            log_W, slope = rows.log_compliance.copy(), rows.slope.copy()
            log_W[known:] = np.minimum(log_W[known:] + np.clip(step, -MAX_STEP, MAX_STEP), math.log(self.amplitude))
            slope[first:] = by_values @ log_W[first:] + by_first * slope[first]
            states = (np.concatenate([old[:known], new]) for old, new in zip(rows[3:], image[3:], strict=True))
            rows = Rows(rows.position, log_W, slope, *states)
            if change <= limit:
                return rows, size
        raise ConvergenceError(
            f"the layer model of the infinite series still changes by {change:.1e} of itself after "
            f"{MAX_NEWTON_STEPS} steps, above {limit:.1e}: choose a larger accuracy or other points",
            change,
        )


def refined(rows: Rows, cells: Array, errors: Array, limit: float) -> Rows:
    """The rows with more of them in the cells where errors are over the limit, as many as the fourth order asks for."""
    halvings = np.ceil(np.log2(np.maximum(errors / limit, 1)) / 4)
    parts = 2 ** np.minimum(halvings, MAX_HALVINGS_AT_ONCE).astype(int)
    start, length = np.repeat(cells[:-1], parts - 1), np.repeat(np.diff(cells) / parts, parts - 1)
    number = np.arange(start.size) - np.repeat(np.cumsum(parts - 1) - (parts - 1), parts - 1)
    position = start + (number + 1) * length
    state = interpolated_states(rows, position)
    return merged(rows, Rows(position, *cubics(rows, position), state, np.zeros_like(state)))


def _sums(size: Array, known: Array, source: Array) -> Array:
    """What errors of this source add up to over all scales at the rows that are not known, after those that are."""
    count = known.size
    total = np.linalg.solve(np.eye(source.size) - size[:, count:], source + size[:, :count] @ known)
    return np.append(known, total)


def slopes_of_spline(y: Array, clamped: bool) -> tuple[Array, Array]:
    """The slopes of a cubic spline: a matrix for its values, shape (n, n), and a vector for its first slope, (n,).

    Where it is not clamped to the first slope, and at the last row, two cubics are one (not-a-knot).
    """
    n, h = y.size, np.diff(y)
    chord = np.diff(np.eye(n), axis=0) / h[:, None]
    matrix, right, by_first = np.zeros((n, n)), np.zeros((n, n)), np.zeros(n)
    i = np.arange(1, n - 1)
    matrix[i, i - 1], matrix[i, i], matrix[i, i + 1] = 1 / h[:-1], 2 / h[:-1] + 2 / h[1:], 1 / h[1:]
    right[i] = 3 * (chord[:-1] / h[:-1, None] + chord[1:] / h[1:, None])
    for end, inwards in ((0, 1), (n - 1, -1)):
        outer, inner = (0, 1) if end == 0 else (n - 2, n - 3)
        ratio = (h[outer] / h[inner]) ** 2
        matrix[end, [end, end + inwards, end + 2 * inwards]] = 1, 1 - ratio, -ratio
        right[end] = 2 * (chord[outer] - ratio * chord[inner])
    if clamped:
        matrix[0], right[0], by_first[0] = by_first, 0, 1
        matrix[0, 0] = 1
    return np.linalg.solve(matrix, right), np.linalg.solve(matrix, by_first)


@kernel
def sensitivity(
    log_load: Array, log_compliance: Array, state: Array, closure: Closure, mesh: Mesh
) -> tuple[Array, Array, Array]:
    """Derivatives of ln T W of each wave by the values of ln W and by its slopes, each of shape (waves, rows).

    And, of that shape, how much relative errors at the rows move T W at most, where they are linear between the rows.
    """
    v = closure.position
    by_value, by_slope, size = np.zeros((3, log_load.size, v.size))
    for i in range(log_load.size):
        share, log_pressure = shares(state[i], log_load[i], closure, mesh, math.exp(log_compliance[i]))
        for k in range(share.size):
            position = math.asinh((log_pressure[k] - closure.origin) / SCALE)
            right = min(max(np.searchsorted(v, position), 1), v.size - 1)
            left, length = right - 1, v[right] - v[right - 1]
            t = (position - v[left]) / length
            beyond = log_pressure[k] - closure.origin - SCALE * math.sinh(v[left] if t < 0 else v[right])
            if t < 0:
                by_slope[i, left] += beyond / (SCALE * math.cosh(v[left])) * share[k]
            elif t > 1:
                by_slope[i, right] += beyond / (SCALE * math.cosh(v[right])) * share[k]
            t = min(max(t, 0.0), 1.0)
            by_value[i, left] += (1 + 2 * t) * (1 - t) ** 2 * share[k]
            by_value[i, right] += t * t * (3 - 2 * t) * share[k]
            by_slope[i, left] += t * (1 - t) ** 2 * length * share[k]
            by_slope[i, right] += t * t * (t - 1) * length * share[k]
            size[i, left] += (1 - t) * abs(share[k])
            size[i, right] += t * abs(share[k])
    return by_value, by_slope, size
