"""Any finite sum of waves as a surface, for measurements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from weier.kernels.arrays import Array
from weier.surface.waves import Waves


class Cosines(Waves):
    """The surface sum a_n cos(2 pi k_n x/L + phi_n)."""

    def __init__(
        self, amplitude: Array, waves_per_period: Sequence[int], phase: Array | float = 0.0, period: int = 1
    ) -> None:
        """Take a_n, in g_0, k_n, ascending, phi_n and the period L, in lambda_0."""
        self._amplitude, self._waves, self.period = np.asarray(amplitude), list(waves_per_period), period
        self.m, self._phase = self._amplitude.size, np.broadcast_to(phase, self._amplitude.shape)
        self.total_amplitude, self.parameters, self.labels = float(np.abs(amplitude).sum()), {}, {}

    def describe(self) -> str:
        """Return the surface in a few words."""
        return f"sum of {self.m} waves"

    def __repr__(self) -> str:
        """Return the expression that makes the surface."""
        numbers = self.amplitude.tolist(), self.waves_per_period, self.phase.tolist(), self.period
        return f"Cosines({', '.join(map(str, numbers))})"


def shifted(surface: Waves, reflected: bool = False) -> Cosines:
    """Return a surface shifted by 0.3 lambda_0, or its reflection, which has the same curves but other phases."""
    cycles = 0.3 * np.array(surface.waves_per_period, float) / surface.period
    phase = (-1.0 if reflected else 1.0) * surface.phase + 2 * np.pi * (cycles - np.rint(cycles))
    waves = surface.amplitude, surface.waves_per_period, np.remainder(phase, 2 * np.pi), surface.period
    return Cosines(*waves)
