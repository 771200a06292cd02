"""Westergaard's solution of one wave of any length L as a state of contact, in closed form."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.chebyshev import gauss_rule
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.segments import ContactState, make_segments
from weier.methods.patches.surface import CosineSeries, make_series

NODES = 48

KINDS = CONTACTS, GAPS


class OneWave(NamedTuple):
    """The wave cos(2 pi x/L + phi), in g_0, whose crest at c is in contact on [c - a, c + a].

    Full contact takes p* = 1/L, in p_0*. With alpha = pi a/L and xi = sin^2 alpha, the load is xi p*.
    """

    period: float
    half_width: float
    crest: float

    @property
    def alpha(self) -> float:
        """pi a/L."""
        return np.pi * self.half_width / self.period

    @property
    def fraction(self) -> float:
        """xi, the load over that of full contact."""
        return float(np.sin(self.alpha) ** 2)

    @property
    def load(self) -> float:
        """The mean pressure, in p_0*."""
        return self.fraction / self.period

    @property
    def compliance(self) -> float:
        """h = xi (1 - ln xi)."""
        return float(self.fraction * (1 - np.log(self.fraction)))

    @property
    def resistance(self) -> float:
        """R = -L ln xi."""
        return float(-self.period * np.log(self.fraction))

    @property
    def strength(self) -> float:
        """A of the pressure A s^(1/2)."""
        angle = self.alpha
        return float(
            2 / self.period * np.cos(angle) * np.sqrt(2 * np.pi / self.period * np.sin(angle) * np.cos(angle))
        )

    @property
    def tangent_strength(self) -> float:
        """B of the increment B/s^(1/2)."""
        return float(np.sqrt(self.period / (2 * np.pi) / np.tan(self.alpha)))

    def pressure(self, x: Array) -> Array:
        """p(x) at a distance x from the crest, in contact."""
        y = np.pi / self.period * x
        return np.asarray(2 / self.period * np.cos(y) * np.sqrt(np.sin(self.alpha - y) * np.sin(self.alpha + y)))

    def gap(self, x: Array) -> Array:
        """g(x) at a distance x from the crest, out of contact."""
        u, s = abs(np.sin(np.pi / self.period * x)), np.sin(self.alpha)
        root = np.sqrt((u - s) * (u + s))
        return np.asarray(2 * (u * root - s * s * np.log((u + root) / s)))

    def slope(self, x: Array) -> Array:
        """g'(x) at a distance x from the crest, in (a, L - a)."""
        y = np.pi / self.period * x
        return np.asarray(
            4 * np.pi / self.period * np.cos(y) * np.sqrt(np.sin(y - self.alpha) * np.sin(y + self.alpha))
        )

    def series(self, dual: bool) -> CosineSeries:
        """The heights or, dual, the tensions of full contact."""
        amplitude = np.array([-1 / self.period if dual else 1.0])
        return make_series(amplitude, [1], np.array([-2 * np.pi * self.crest / self.period]), self.period)

    def state(self, dual: bool, nodes: int = NODES) -> ContactState:
        """The contact, or the gap (dual), with its resistance."""
        r = 0.5 * self.period - self.half_width if dual else self.half_width
        middle = self.crest + 0.5 * self.period if dual else self.crest
        rule = gauss_rule(nodes, True)
        density = self.slope(0.5 * self.period + r * rule.node) if dual else self.pressure(r * rule.node)
        phi = density / np.sqrt((1 - rule.node) * (1 + rule.node))
        origin = self.series(dual).crest_position
        segments = make_segments(
            np.zeros(1, int), origin, np.array([middle]) - origin, np.array([r]), np.array([nodes])
        )
        approach = self.compliance - 1 if dual else self.compliance
        strength = np.full((1, 2), self.tangent_strength)
        state = ContactState(KINDS[dual], self.load, approach, segments, rule.expansion @ phi)
        return state._replace(resistance=self.resistance, tangent_strength=strength, edge_move=np.zeros((1, 2)))


# Periods of 1 and 9, and contacts or gaps from narrow ones to those wider than half a period.
WAVES = [OneWave(period, part * period, 0.2 * period) for period in (1.0, 9.0) for part in (0.02, 0.2, 0.4)]
