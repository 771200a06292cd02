"""The infinite series: its closure is the fixed point of one scale, by Newton's method on all rows of its table.

The map T of `weier.methods.layer.scales`, applied again and again, converges only after hundreds of scales where D
is close to 2. But the linear equations of each wave tell how much the compression of the layer at each pressure
changes W (`weier.methods.layer.wave.shares`). So a few systems of linear equations over the rows give W,

    ln W - ln T W = 0,    J = d ln T W/d ln W >= 0.

The same matrix tells what errors add up to over all scales. If the table deviates from T of itself by relative errors
e, its own relative error is (I - J)^-1 e at most. The deviation is measured in the middle of every cell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods import archard
from weier.methods.errors import ConvergenceError
from weier.methods.layer.closure import POSITION_SCALE, Closure
from weier.methods.layer.rows import (
    MAX_HALVINGS,
    MAX_ROWS,
    Rows,
    accuracy_error,
    evaluate_midpoints,
    interpolate,
    interpolate_states,
    lattice,
    log_load_at,
    merge,
    position_of,
)
from weier.methods.layer.scales import ComplianceTable, Scale, Scaling, coarser_units
from weier.methods.layer.wave import Mesh, shares

TABLE_SHARE = 0.5  # of the accuracy is for the errors of the table, the rest for the residuals of the waves
MIN_ESTIMATED_LOAD = -8.0  # ln xi: the first guess takes heavier loads from Archard, lighter ones from these
MAX_GUESS_STEP = 0.1  # of ln W: Newton's method stops there where it only makes a guess
MAX_NEWTON_STEPS = 40  # 3 to 12 are usual
MAX_STEP = 10.0  # of ln W in Newton's method: beyond it the tangents mislead
MAX_HALVINGS_AT_ONCE = 3  # of a cell, as far as the fourth order of its cubic is trusted


class Table(NamedTuple):
    """Rows of the fixed point, and what deviations from it add up to over all scales, each of shape (rows,).

    gain : what deviations of 1, relative to W, would add up to
    error : what the measured deviations add up to, relative to W
    """

    rows: Rows
    gain: Array
    error: Array


class Spline(NamedTuple):
    """The slopes of a cubic spline, by_values @ values + by_first * first slope, of shapes (n, n) and (n,)."""

    by_values: Array
    by_first: Array


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
        """The units of the next finer wave in those of this one."""
        return Scaling.of(self.D, self.gamma)

    @property
    def amplitude(self) -> float:
        """The sum of all amplitudes."""
        return -1 / math.expm1(self.scaling.log_height)

    def waves(self, bottom: float, tops: list[float]) -> list[ComplianceTable]:
        """The waves for positions up to each of these increasing tops, each table a continuation of the one before.

        W at a load depends on W at lighter and heavier loads, since the pressure varies along the wave. But up to a
        top it depends on no load above that top.
        """
        self._limit(np.array([self.amplitude]))  # at heavy loads errors of ln W add up to as many at least
        nothing, states = np.zeros(0), np.zeros((0, self.mesh.rise.size + 1))
        table, tables = Table(Rows(nothing, nothing, nothing, states, states), nothing, nothing), []
        for top in tops:
            table = self._extend(table, lattice(bottom, top))
            tables.append(ComplianceTable(table.rows, self.amplitude, math.inf))
        return tables

    def _extend(self, known: Table, position: Array) -> Table:
        """The table with further rows up to the last of these positions. Its own rows do not change."""
        count = known.gain.size
        first, limit = max(count - 1, 0), self.accuracy
        rows = self._extrapolation(position, known.rows) if count else self._guess(position)
        for _ in range(MAX_HALVINGS):
            rows, size = self._converge(rows, count, math.sqrt(limit))
            gain = _accumulate(size, known.gain, np.ones(size.shape[0]))
            limit, cells = self._limit(gain), rows.position[first:]
            _, errors = evaluate_midpoints(self._scale(rows).rows, rows, cells[:-1], cells[1:])
            beside = np.maximum(np.append(errors, 0), np.append(0, errors))  # of the cells on either side of a row
            error = _accumulate(size, known.error, size[:, first:] @ beside)
            error[count:] += beside[count - first :]
            if np.max(error) <= TABLE_SHARE * self.accuracy:
                return Table(rows, gain, error)
            rows = refine(rows, cells, errors, limit)
            if rows.position.size > MAX_ROWS:
                break
        raise accuracy_error(float(np.max(errors)), rows, limit)

    def _limit(self, gain: Array) -> float:
        """The relative error of a table that adds up to its part of the accuracy."""
        limit = TABLE_SHARE * self.accuracy / (1 + float(np.max(gain)))
        if not limit >= self.tolerance:
            raise ConvergenceError(
                f"errors of the layer model add up over {np.max(gain):.1e} scales, which are too many for the "
                f"accuracy {self.accuracy:.1e}: choose a larger gamma, a smaller D or a larger accuracy",
                self.accuracy * self.tolerance / limit,
            )
        return limit

    def _scale(self, rows: Rows) -> Scale:
        """A wave on the layer that this table stands for."""
        closure = coarser_units(rows.closure, self.scaling)
        return Scale(closure, self.amplitude, math.inf, self.mesh, self.tolerance)

    def _guess(self, position: Array) -> Rows:
        """A table near the fixed point: heavier loads from Archard's estimate, then the lighter ones in turn.

        Contacts under light loads are small, and their pressures are heavy loads to the next finer wave. So each row
        follows from the heavier ones.
        """
        heavy = position[position >= position_of(MIN_ESTIMATED_LOAD)]
        log_W = np.log(archard.compliance(np.exp(log_load_at(heavy)), self.D, self.gamma, math.inf))
        rows, _ = self._converge(self._without_states(heavy, log_W, np.gradient(log_W, heavy)), 0, MAX_GUESS_STEP)
        for one in position[position < position_of(MIN_ESTIMATED_LOAD)][::-1]:
            rows = merge(self._scale(rows).rows(np.array([one]), None), rows)
        return rows

    def _extrapolation(self, position: Array, known: Rows) -> Rows:
        """The known rows, and further ones at the positions beyond them, on the power law that continues them."""
        further = position[position > known.position[-1]]
        log_W, slope = interpolate(known, further)
        return merge(known, self._without_states(further, np.minimum(log_W, math.log(self.amplitude)), slope))

    def _without_states(self, position: Array, log_W: Array, slope: Array) -> Rows:
        states = np.full((position.size, self.mesh.rise.size + 1), np.nan)
        return Rows(position, log_W, slope, states, states)

    def _converge(self, rows: Rows, known: int, limit: float) -> tuple[Rows, Array]:
        """The rows at the fixed point, the known ones unchanged, and the largest effect of an error at each row.

        These effects on the rows that are not known have the shape (rows not known, rows). The last step is the limit
        at most, and the error that remains is of the order of its square.
        """
        first, change = max(known - 1, 0), math.inf
        spline = slopes_of_spline(rows.position[first:], clamped=known > 0)
        for _ in range(MAX_NEWTON_STEPS):
            step, image, size = self._newton_step(rows, known, spline)
            change = float(np.max(np.abs(step)))
            log_W, slope = rows.log_compliance.copy(), rows.slope.copy()
            log_W[known:] = np.minimum(log_W[known:] + np.clip(step, -MAX_STEP, MAX_STEP), math.log(self.amplitude))
            slope[first:] = spline.by_values @ log_W[first:] + spline.by_first * slope[first]
            states = (np.concatenate([old[:known], new]) for old, new in zip(rows[3:], image[3:], strict=True))
            rows = Rows(rows.position, log_W, slope, *states)
            if change <= limit:
                return rows, size
        raise ConvergenceError(
            f"the layer model of the infinite series still changes by {change:.1e} of itself after "
            f"{MAX_NEWTON_STEPS} steps, above {limit:.1e}: choose a larger accuracy or other points",
            change,
        )

    def _newton_step(self, rows: Rows, known: int, spline: Spline) -> tuple[Array, Rows, Array]:
        """The change of ln W at the rows that are not known, T W there, and the effects of errors at each row."""
        scale, position = self._scale(rows), rows.position[known:]
        image = scale.rows(position, rows.state[known:])
        loads = log_load_at(position)
        by_value, by_slope, size = sensitivity(loads, image.log_compliance, image.state, scale.closure, self.mesh)
        fixed = spline.by_first.size - position.size  # 1 where the spline is clamped to a known row
        derivative = by_value[:, known:] + by_slope[:, known - fixed :] @ spline.by_values[:, fixed:]
        lacking = image.log_compliance - rows.log_compliance[known:]
        return np.asarray(np.linalg.solve(np.eye(position.size) - derivative, lacking)), image, size


def refine(rows: Rows, cells: Array, errors: Array, limit: float) -> Rows:
    """The rows, and more of them in cells whose error exceeds the limit: as many as its fourth order asks for."""
    halvings = np.ceil(np.log2(np.maximum(errors / limit, 1)) / 4)
    parts = 2 ** np.minimum(halvings, MAX_HALVINGS_AT_ONCE).astype(int)
    start, length = np.repeat(cells[:-1], parts - 1), np.repeat(np.diff(cells) / parts, parts - 1)
    number = np.arange(start.size) - np.repeat(np.cumsum(parts - 1) - (parts - 1), parts - 1)
    position = start + (number + 1) * length
    state = interpolate_states(rows, position)
    return merge(rows, Rows(position, *interpolate(rows, position), state, np.zeros_like(state)))


def _accumulate(size: Array, known: Array, source: Array) -> Array:
    """What the source adds up to over all scales: the sums at the known rows, then those at the others."""
    count = known.size
    total = np.linalg.solve(np.eye(source.size) - size[:, count:], source + size[:, :count] @ known)
    return np.append(known, total)


def slopes_of_spline(y: Array, clamped: bool) -> Spline:
    """The slopes of the cubic spline through values at increasing y.

    The first two cubics are the same, unless the spline is clamped to the first slope, and so are the last two.
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
    return Spline(np.asarray(np.linalg.solve(matrix, right)), np.asarray(np.linalg.solve(matrix, by_first)))


@kernel
def sensitivity(
    log_load: Array, log_compliance: Array, state: Array, closure: Closure, mesh: Mesh
) -> tuple[Array, Array, Array]:
    """Derivatives of ln T W of each wave by the values of ln W and by its slopes, each of shape (waves, rows).

    The third array, of the same shape, bounds the effect of relative errors that are linear between the rows.
    """
    v = closure.position
    by_value, by_slope, size = np.zeros((3, log_load.size, v.size))
    for i in range(log_load.size):
        share, log_pressure = shares(state[i], log_load[i], closure, mesh, math.exp(log_compliance[i]))
        for k in range(share.size):
            position = math.asinh((log_pressure[k] - closure.origin) / POSITION_SCALE)
            right = min(max(int(np.searchsorted(v, position)), 1), v.size - 1)
            left, length = right - 1, v[right] - v[right - 1]
            t = (position - v[left]) / length
            beyond = log_pressure[k] - closure.origin - POSITION_SCALE * math.sinh(v[left] if t < 0 else v[right])
            if t < 0:
                by_slope[i, left] += beyond / (POSITION_SCALE * math.cosh(v[left])) * share[k]
            elif t > 1:
                by_slope[i, right] += beyond / (POSITION_SCALE * math.cosh(v[right])) * share[k]
            t = min(max(t, 0.0), 1.0)
            by_value[i, left] += (1 + 2 * t) * (1 - t) ** 2 * share[k]
            by_value[i, right] += t * t * (3 - 2 * t) * share[k]
            by_slope[i, left] += t * (1 - t) ** 2 * length * share[k]
            by_slope[i, right] += t * t * (t - 1) * length * share[k]
            size[i, left] += (1 - t) * abs(share[k])
            size[i, right] += t * abs(share[k])
    return by_value, by_slope, size
