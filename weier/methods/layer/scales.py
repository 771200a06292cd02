"""Scales of a series: each wave bears on a layer that represents all finer waves (4.3).

docs/layer.md: "One scale" for the map T and full contact, "The whole series" for successive scales. W(xi) is the
compliance of a wave with all finer ones, in that wave's units, tabulated as ln W over ln xi. T does not amplify
relative errors, so that the errors of m - 1 tables at most add up; each has an equal part of the accuracy.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.layer.scaling_tables import Closure, Rows, lattice, log_load_at, tabulate
from weier.methods.layer.wave import Mesh, Solutions, attainable, midpoints, reference_heights, solve_waves

MAX_SCALES = 5000  # beyond, the compliance depends on loads of finer waves below the first row of a table


class Model(NamedTuple):
    """A series with the mesh, the accuracy of the tables and the tolerance of its solution."""

    D: float
    gamma: float
    m: float
    mesh: Mesh
    accuracy: float
    tolerance: float

    @property
    def log_pressure(self) -> float:
        """Logarithm of p* of the next finer wave, in units of this one: ln gamma^(D-1)."""
        return (self.D - 1) * math.log(self.gamma)

    @property
    def log_height(self) -> float:
        """Logarithm of g of the next finer wave: ln gamma^(D-2)."""
        return (self.D - 2) * math.log(self.gamma)

    @property
    def infinite_amplitude(self) -> float:
        """Sum of the amplitudes of the infinite series."""
        return -1 / math.expm1(self.log_height)


def model_of(D: float, gamma: float, m: float, points: int, accuracy: float) -> Model:
    """Return the model of a series with a mesh of this number of points and tables of this accuracy.

    Residuals, relative to the compression at the edge of contact, add up over `MAX_SCALES` to a quarter of it.
    """
    return Model(D, gamma, m, midpoints(points), accuracy, accuracy / 4 / MAX_SCALES)


class ComplianceTable(NamedTuple):
    """The compliance W(xi) of a wave with all finer ones, its limit, and the ln xi at which it is reached."""

    rows: Rows
    amplitude: float
    log_full: float


class Scale(NamedTuple):
    """One scale: a wave on the layer of all finer ones.

    closure : closure of that layer, in the units of this wave
    amplitude, log_full : the limit of W, and the ln xi at which it is reached
    """

    model: Model
    closure: Closure
    amplitude: float
    log_full: float

    def rows(self, position: Array, guess: Array | None) -> Rows:
        """Return rows of W at these positions below full contact, from the guessed states."""
        solved = self._solved(log_load_at(position), guess)
        h = np.minimum(solved.compliance, self.amplitude)
        return Rows(position, np.log(h), solved.rate / h * np.cosh(position), solved.state)

    def solve(self, log_load: Array) -> tuple[Array, Array, Array]:
        """Return h, dh/d ln xi and residual in g under loads of any order, each of shape (loads,)."""
        h, (rate, residual) = np.full(log_load.size, self.amplitude), np.zeros((2, log_load.size))
        partial = log_load < self.log_full  # contact is full at heavier loads, and h is exact
        if partial.any():
            waves = self._solved(log_load[partial], None)
            h[partial], rate[partial] = np.minimum(waves.compliance, self.amplitude), waves.rate
            residual[partial] = waves.residual * reference_heights(waves.state[:, -1]).total
        return h, rate, residual

    def _solved(self, log_load: Array, guess: Array | None) -> Solutions:
        tolerance = self.model.tolerance
        solved = solve_waves(log_load, self.closure, self.model.mesh, tolerance, guess)
        over = np.flatnonzero(~(solved.residual <= attainable(log_load, tolerance)))
        if over.size:
            worst, load = float(solved.residual[over[0]]), math.exp(log_load[over[0]])
            raise ConvergenceError(
                f"a wave of the layer model stopped at a relative residual of {worst:.1e} under the mean pressure "
                f"{load:.6g} in its own p*, above {tolerance:.1e}: try other points, or take another method",
                worst,
            )
        return solved


def scale_on(finer: ComplianceTable, model: Model) -> Scale:
    """Return the next coarser wave on a layer of the given waves."""
    amplitude = 1 + math.exp(model.log_height) * finer.amplitude
    # The pressure in the troughs is at least xi - 1, which must flatten the finer waves.
    log_full = float(np.logaddexp(0, model.log_pressure + finer.log_full))
    return Scale(model, coarser_units(finer.rows.closure, model), amplitude, log_full)


def coarser_units(closure: Closure, model: Model) -> Closure:
    """Return W of a wave as the closure of the layer under the next coarser one, in the units of that one."""
    return closure._replace(
        origin=closure.origin + model.log_pressure, log_height=closure.log_height + model.log_height
    )


def finest_wave(bottom: float, accuracy: float) -> ComplianceTable:
    """Return Westergaard's wave (12)."""

    def waves(position: Array, _: Array | None) -> Rows:
        y = np.minimum(log_load_at(position), 0)
        slope = -y / (1 - y) * np.cosh(position)
        return Rows(position, y + np.log1p(-y), slope, np.zeros((y.size, 0)))  # h = xi (1 - ln xi)

    return ComplianceTable(tabulate(waves, lattice(bottom, 0.0), accuracy), 1.0, 0.0)


def finer_waves(model: Model, bottom: float) -> ComplianceTable:
    """Return the waves finer than the first of m, in the units of the second, on tables to full contact."""
    accuracy = model.accuracy / (model.m - 1)
    waves = finest_wave(bottom, accuracy)
    for _ in range(int(model.m) - 2):
        scale = scale_on(waves, model)
        first = lattice(bottom, math.asinh(scale.log_full))
        waves = ComplianceTable(tabulate(scale.rows, first, accuracy), scale.amplitude, scale.log_full)
    return waves
