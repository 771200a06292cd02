"""A surface as a finite sum of waves: common interface of the Weierstrass series and of traces.

Lengths along x are in lambda_0, heights in g_0, pressures in p_0* = 2 pi M g_0/lambda_0; each surface defines its
lambda_0 and g_0.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier.checks import checked_count, checked_numbers, shown
from weier.kernels.arrays import Array
from weier.surface.crests import highest_crest, sample

MAX_POINTS = 10**7  # points of a sampled period or grid: 80 MB
MAX_WAVES = 100_000  # finest waves per period: 6.4 million nodes by default, 1.2 GB
MAX_X = 1e15  # lambda_0; rounding of larger positions is of the order of a wavelength


class Waves(ABC):
    """The periodic surface z(x) = sum_n a_n cos(2 pi k_n x/L + phi_n), with k_n waves in a period L.

    Attributes
    ----------
    m : float
        The number of waves; a series may have inf.
    amplitude : ndarray, shape (m,)
        Amplitudes a_n, in g_0.
    phase : ndarray, shape (m,)
        Phases phi_n, in radians.
    waves_per_period : list of int
        Waves k_n of each term in one period: exact integers, ascending, m of them.
    period : int
        Length L after which the surface repeats, in lambda_0.
    total_amplitude : float
        Height of the datum of the compliance above the mean plane, in g_0; the compliance at full contact.
    tail_amplitude : float
        Sum of the amplitudes of finer waves that are left out, in g_0; NaN if unknown.
    parameters : dict
        Parameters of this surface as a scene has them, as plain values.
    labels : dict
        Labels that distinguish this surface from others, by the names of coordinates.
    """

    m: float
    period: int
    total_amplitude: float
    tail_amplitude: float = math.nan
    parameters: dict[str, Any]
    labels: dict[str, Any]
    _amplitude: Array
    _phase: Array
    _waves: list[int]

    @abstractmethod
    def describe(self) -> str:
        """The surface in a few words."""

    def __repr__(self) -> str:
        """Return the surface in a few words."""
        return f"<{self.describe()}>"

    # The copies are for users: a surface altered in place would equal the unaltered one. A read-only array would be
    # another type for kernels.
    @property
    def amplitude(self) -> Array:
        """Amplitudes a_n, shape (m,), in g_0 (20)."""
        return self._amplitude.copy()

    @property
    def phase(self) -> Array:
        """Phases phi_n, shape (m,), in radians."""
        return self._phase.copy()

    @property
    def waves_per_period(self) -> list[int]:
        """Waves of each term in one period: exact integers, ascending, m of them."""
        return list(self._waves)

    @property
    def full_contact_pressure(self) -> Array:
        """Mean pressures p_n* that flatten each wave alone, shape (m,), in p_0*."""
        return self.amplitude * self._waves_per_length

    @property
    def finest(self) -> float:
        """Waves of the finest kind in one period; inf if they are more than a float holds."""
        return float(self.waves_per_period[-1])

    @property
    def terms(self) -> int:
        """The number of waves."""
        return int(self.m)

    @property
    def listed_terms(self) -> int:
        """Waves whose phases are listed in results."""
        return self.terms

    @property
    def listed_phases(self) -> Array:
        """Phases that results list, shape (terms,), in radians: one NaN if there are none."""
        return self.phase[: self.listed_terms] if self.listed_terms else np.full(1, np.nan)

    def height(self, x: ArrayLike) -> Array:
        """Return height z(x), in g_0, for x in lambda_0 of any shape (1)."""
        return self._sum(x, self.amplitude, np.cos)

    def slope(self, x: ArrayLike) -> Array:
        """Return slope z'(x), in g_0/lambda_0, for x in lambda_0 of any shape."""
        return self._sum(x, -self.amplitude * self._wavenumber, np.sin)

    def curvature(self, x: ArrayLike) -> Array:
        """Return second derivative z''(x), in g_0/lambda_0^2, for x in lambda_0 of any shape."""
        return self._sum(x, -self.amplitude * self._wavenumber**2, np.cos)

    def sampled_height(self, points: int, terms: int | None = None) -> Array:
        """Return heights of the first `terms`, or all, at `points` equidistant nodes of a period, in g_0."""
        terms = self.terms if terms is None else checked_count("terms", terms, 1, self.terms)
        points = checked_count("points", points, 1, MAX_POINTS)
        return sample(self.amplitude[:terms], self.waves_per_period[:terms], self.phase[:terms], points)

    @property
    def rms(self) -> tuple[float, float, float]:
        """Root mean squares of height, slope and curvature: roots of the moments m_0, m_2 and m_4 of the spectrum.

        In g_0, g_0/lambda_0 and g_0/lambda_0^2.
        """
        squares = (0.5 * np.sum((self.amplitude * self._wavenumber**order) ** 2) for order in range(3))
        height, slope, curvature = (math.sqrt(square) for square in squares)
        return height, slope, curvature

    @cached_property
    def crest(self) -> tuple[float, float]:
        """Location x and height z of the highest point, in lambda_0 and g_0: the place of first contact."""
        return highest_crest(self.amplitude, self.waves_per_period, self.phase, self.period)

    @cached_property
    def full_contact_load(self) -> float:
        """Smallest mean pressure p of full contact, in p_0*: p + sum p_n* cos(...) vanishes at one point."""
        return highest_crest(-self.full_contact_pressure, self.waves_per_period, self.phase, self.period)[1]

    @cached_property
    def _wavenumber(self) -> Array:
        return 2 * np.pi * self._waves_per_length

    @cached_property
    def _waves_per_length(self) -> Array:
        """Waves of each term in lambda_0, shape (m,)."""
        try:
            return np.array([k / self.period for k in self.waves_per_period])
        except OverflowError:
            raise ValueError(
                f"the finest wave of {self.describe()} is too short for a float: take fewer terms"
            ) from None

    def _sum(self, x: ArrayLike, coefficient: Array, wave: np.ufunc) -> Array:
        x = checked_numbers("x", x, f"lie in [-{MAX_X:g}, {MAX_X:g}]", lambda x: np.abs(x) <= MAX_X, "lambda_0")
        total = np.zeros_like(x)
        for c, k, phi in zip(coefficient, self._waves_per_length, self.phase, strict=True):
            cycles = x * k
            total += c * wave(2 * np.pi * (cycles - np.rint(cycles)) + phi)
        return total


def checked_surface(profile: Waves, name: str = "profile") -> Waves:
    """Return the surface; TypeError if it is none. `name` is the argument's name."""
    if not isinstance(profile, Waves):
        raise ValueError(f"{name} must be a weier.Profile or a weier.Trace, got {shown(profile)}")
    return profile


def resolvable(profile: Waves) -> bool:
    """Return whether the waves of one period can be sampled."""
    return profile.finest <= MAX_WAVES


def check_resolvable(profile: Waves) -> None:
    """Refuse a surface that has more finest waves per period than a computer can hold."""
    if not resolvable(profile):
        raise ValueError(
            f"the finest wave must fit at most {MAX_WAVES} times into the period, which {profile.describe()} "
            "exceeds: take fewer terms, a gamma of smaller numbers, such as 5/2, or a method that does not resolve "
            "every wave"
        )
