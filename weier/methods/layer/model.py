"""The layer model of one series: which tables it takes, and which of them each load is solved on.

The tables for a load depend on that load alone, so that the other loads do not change its compliance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.layer.fixed_point import FixedPoint
from weier.methods.layer.rows import BOTTOM_POSITIONS, CELL_LENGTH, MAX_POSITION, MIN_LOADS, log_load_at, position_of
from weier.methods.layer.scales import ComplianceTable, Scaling, Solution, finer_waves, scale_on
from weier.methods.layer.wave import Mesh, midpoints
from weier.theory.series import tail_amplitude

MIN_TOLERANCE = 1e-13  # rounding allows no smaller one at the lightest loads
RESIDUAL_SHARE = 1e-5  # of the accuracy, for the waves of a table: their residuals add up over the scales
MAX_SCALES = 1000  # of a finite series that differs from the infinite one
TAIL_SHARE = 0.1  # of the accuracy: a series that is taken for infinite may differ from it by as much
FIRST_EXTENSION = 3  # cells from the first top of the tables to the second; each further one is twice as far


@dataclass(frozen=True)
class Model:
    """The layer model of a series of at least two terms."""

    D: float
    gamma: float
    m: float
    points: int
    accuracy: float
    tolerance: float

    @property
    def scaling(self) -> Scaling:
        """The units of the next finer wave in those of this one."""
        return Scaling.of(self.D, self.gamma)

    @property
    def log_full(self) -> float:
        """ln xi where all finer waves are in full contact, in the units of the second; no table goes on beyond."""
        log_ratio = self.scaling.log_pressure
        log_growth = log_ratio * (self.m - 1)
        return _log_expm1(log_growth) - _log_expm1(log_ratio) if math.isfinite(self.m) else math.inf

    @cached_property
    def mesh(self) -> Mesh:
        """The nodes of every wave."""
        return midpoints(self.points)

    @property
    def table_tolerance(self) -> float:
        """Largest relative residual of the waves in a table."""
        return max(min(self.tolerance, RESIDUAL_SHARE * self.accuracy), MIN_TOLERANCE)

    def solve(self, loads: Array) -> Solution:
        """The coarsest wave under these increasing loads, each on the smallest tables that are made for it."""
        light = int(np.searchsorted(loads, MIN_LOADS[0]))
        parts = []
        for bottom, some in zip(BOTTOM_POSITIONS, (loads[light:], loads[:light]), strict=True):
            if some.size:
                parts.append(self._solve(bottom, np.log(some)))
        return Solution(*(np.concatenate(columns) for columns in zip(*parts[::-1], strict=True)))

    def _solve(self, bottom: float, log_load: Array) -> Solution:
        tops = self.tops(float(log_load[-1]))
        group = np.minimum(np.searchsorted(log_load_at(np.array(tops)), log_load), len(tops) - 1)
        used, parts = np.unique(group), []
        for number, finer in zip(used, self.finer_waves(bottom, tops, used), strict=True):
            scale = scale_on(finer, self.scaling, self.mesh, self.tolerance)
            parts.append(scale.solve(log_load[group == number]))
        return Solution(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))

    def tops(self, log_load: float) -> list[float]:
        """The positions where tables may end, up to the first that reaches this ln xi or full contact.

        No pressure in a wave exceeds 1 + xi, which from the first top on is at most xi in the units of the next finer
        wave. So a table that reaches a load reaches all pressures under that load, at all scales.
        """
        self_contained = position_of(max(-_log_expm1(self.scaling.log_pressure), 0.0))
        cells, reach = math.ceil((self_contained - BOTTOM_POSITIONS[0]) / CELL_LENGTH), FIRST_EXTENSION
        tops = [min(BOTTOM_POSITIONS[0] + CELL_LENGTH * cells, MAX_POSITION)]
        enough = min(log_load, self.log_full)
        while log_load_at(tops[-1]) < enough and tops[-1] < MAX_POSITION:
            following = tops[-1] + CELL_LENGTH * reach
            tops.append(following if following < MAX_POSITION - CELL_LENGTH else MAX_POSITION)
            reach *= 2
        return tops

    def finer_waves(self, bottom: float, tops: list[float], used: Array) -> list[ComplianceTable]:
        """The waves finer than the first, on tables from the bottom up to those of the tops that are used."""
        infinite = FixedPoint(self.D, self.gamma, self.mesh, self.accuracy, self.table_tolerance)
        if self._may_be_infinite(bottom):
            tables = infinite.waves(bottom, tops)
            if self._is_infinite(tables[0]):
                return [tables[number] for number in used]
        if self.m > MAX_SCALES + 1:
            raise ConvergenceError(
                f"a series of {self.m} terms still differs from the infinite one, and the layer model takes at most "
                f"{MAX_SCALES} scales one by one: choose a smaller m, or m = inf",
                float(tail_amplitude(self.m, self.D, self.gamma) / tail_amplitude(0, self.D, self.gamma)),
            )
        arguments = self.scaling, self.mesh, self.accuracy, self.table_tolerance
        return [finer_waves(int(self.m), bottom, tops[number], *arguments) for number in used]

    def _may_be_infinite(self, bottom: float) -> bool:
        """Whether the tail may be negligible: ln W approaches -2 sqrt((2 - D) ln gamma |ln xi|) at light loads."""
        decay = -self.scaling.log_height
        lightest = 2 * math.sqrt(decay * -log_load_at(bottom))
        return self.m * decay >= lightest - math.log(TAIL_SHARE * self.accuracy)

    def _is_infinite(self, waves: ComplianceTable) -> bool:
        """Whether the tail is negligible: it changes no compliance by more than its amplitude."""
        if math.isinf(self.m):
            return True
        tail = float(tail_amplitude(self.m, self.D, self.gamma))
        return tail <= TAIL_SHARE * self.accuracy * math.exp(waves.rows.log_compliance[0])


def _log_expm1(x: float) -> float:
    """ln(e^x - 1) for x > 0, however large."""
    return x + math.log(-math.expm1(-x))
