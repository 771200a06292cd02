"""The contacts under one load, and pressure, gap and displacement at any place."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from weier.kernels.jit import kernel
from weier.methods.patches.fields import State, clearance, density, opening
from weier.methods.patches.segments import spaces
from weier.methods.patches.surface import Surface
from weier.methods.patches.waves import Waves, excess, from_summit

Array = NDArray[np.float64]


class Solution(NamedTuple):
    """Contacts [centre - half_width, centre + half_width] in one period, in lambda_0, from left to right.

    mean_pressure : p, in p_0*
    centre, half_width : shape (patches,); both empty in full contact
    edge_strength : shape (patches, 2), at the left and right edges, in p_0*/lambda_0^(1/2): at the distance s
        from an edge p = A s^(1/2) within and gap = (4 pi/3) A s^(3/2) outside, with no singularity of stress
    mean_gap : d, in g_0
    surface, state : the series and the Chebyshev coefficients behind; state is None in full contact
    """

    mean_pressure: float
    centre: Array
    half_width: Array
    edge_strength: Array
    mean_gap: float
    surface: Surface
    state: State | None

    @property
    def edges(self) -> Array:
        """Left and right edges, shape (patches, 2), in lambda_0; a right edge may lie beyond the period."""
        return np.stack([self.centre - self.half_width, self.centre + self.half_width], axis=1)

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure p(x), in p_0*, for x in lambda_0 of any shape; 0 outside the contacts."""
        if self.state is None:
            return self.mean_pressure - self._heights(self.surface.pressures, x)
        state, waves = self.state, self.surface.of(self.state.dual)
        flat = np.ravel(np.asarray(x, float))
        return np.maximum(_pressures(state, waves, flat), 0.0).reshape(np.shape(x))

    def gap(self, x: ArrayLike) -> Array:
        """Gap between flat and surface, in g_0, for x in lambda_0 of any shape; 0 on the contacts."""
        if self.state is None:
            return np.zeros(np.shape(x))
        state, waves = self.state, self.surface.of(self.state.dual)
        flat = np.ravel(np.asarray(x, float))
        return np.maximum(_gaps(state, waves, flat), 0.0).reshape(np.shape(x))

    def displacement(self, x: ArrayLike) -> Array:
        """Elastic displacement u(x) away from the flat, in g_0, of mean 0: gap = d - z + u."""
        return self.gap(x) + self._heights(self.surface.heights, x) - self.mean_gap

    @staticmethod
    def _heights(waves: Waves, x: ArrayLike) -> Array:
        return _series(waves, np.ravel(np.asarray(x, float))).reshape(np.shape(x))


def solution(surface: Surface, state: State | None, mean_pressure: float) -> Solution:
    """What a user sees of a state."""
    if state is None:
        none = np.empty(0)
        return Solution(mean_pressure, none, none, np.empty((0, 2)), 0.0, surface, None)
    segments, period = state.segments, surface.heights.period
    first = segments.first
    ends = np.array([_ends(state.coefficient[a:b]) for a, b in pairwise(first)])
    strength = ends * np.sqrt(2 / segments.half_width)[:, None]
    left = segments.origin + (segments.centre - segments.half_width)
    half_width, mean_gap = segments.half_width, surface.heights.top - state.approach
    if state.dual:  # contact j lies between gap j and the next
        left, half_width = left + 2 * half_width, 0.5 * spaces(segments, period)
        strength = np.stack([-strength[:, 1], np.roll(strength[:, 0], -1)], axis=1) / (2 * np.pi)
        mean_gap = -state.approach
    left = left - period * np.floor(left / period)
    order = np.argsort(left)
    left, half_width, strength = left[order], half_width[order], strength[order]
    return Solution(mean_pressure, left + half_width, half_width, strength, mean_gap, surface, state)


def _ends(coefficient: Array) -> tuple[float, float]:
    """phi(-1) and phi(1): U_k(1) = k + 1."""
    k = np.arange(coefficient.size)
    return float(coefficient @ ((k + 1) * (-1.0) ** k)), float(coefficient @ (k + 1.0))


@kernel
def _pressures(state: State, waves: Waves, x: Array) -> Array:
    p = np.zeros(x.size)
    for i in range(x.size):
        summit, y = from_summit(waves, x[i])
        if not state.dual:
            p[i] = density(state, waves.period, waves.place[summit], y)
        elif opening(state, waves.period, waves.place[summit], y) == 0:
            p[i] = clearance(state, waves, summit, y)
    return p


@kernel
def _gaps(state: State, waves: Waves, x: Array) -> Array:
    gap = np.zeros(x.size)
    for i in range(x.size):
        summit, y = from_summit(waves, x[i])
        if state.dual:
            gap[i] = opening(state, waves.period, waves.place[summit], y)
        elif density(state, waves.period, waves.place[summit], y) == 0:
            gap[i] = clearance(state, waves, summit, y)
    return gap


@kernel
def _series(waves: Waves, x: Array) -> Array:
    value = np.empty(x.size)
    for i in range(x.size):
        summit, y = from_summit(waves, x[i])
        value[i] = waves.top + excess(waves, summit, y)[0]
    return value
