"""The Weierstrass series (1) with its phases: waves, tail, heights and slopes.

Lengths along x are in lambda_0, heights in g_0, pressures in p_0* = 2 pi M g_0/lambda_0.
"""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from numbers import Rational
from typing import Any

import numpy as np

from weier import units
from weier.checks import checked_count, checked_number, checked_numbers, shown
from weier.kernels.arrays import Array
from weier.surface import series
from weier.surface.waves import Waves

# parameters of a series besides its phases: fields of a profile and coordinates of data
PARAMETERS = ("D", "gamma", "m")
# largest integer in the fraction of a float gamma: 1.1 is 11/10, and pi is refused
MAX_DENOMINATOR = 10**6
ROUNDING = 1e-9  # relative rounding of phases of 2 pi
MAX_WHOLE_RADIANS = 10  # larger whole numbers are probably degrees
# largest seed: data hold seeds as floats, which have all integers up to here
MAX_SEED = 2**53 - 1


@dataclass(frozen=True)
class RandomPhases:
    """Independent phases, uniform in [0, 2 pi): `first(m)` are the first m of an infinite sequence."""

    seed: int

    def first(self, m: int) -> Array:
        """Return the first m phases, shape (m,), in radians."""
        return np.random.default_rng(self.seed).uniform(0, 2 * np.pi, m)


def random_phases(seed: int) -> RandomPhases:
    """Return random phases of a seed; a longer series extends a shorter one of the same seed.

    Raises
    ------
    ValueError
        If `seed` is not a non-negative integer up to 2^53 - 1.

    Examples
    --------
    >>> import weier
    >>> weier.Profile(D=1.25, gamma=5, m=2, phases=weier.random_phases(7)).phase.round(3)
    array([3.928, 5.637])
    """
    if isinstance(seed, bool | np.timedelta64) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ValueError(f"seed must be a non-negative integer, got {shown(seed)}")
    if seed > MAX_SEED:
        raise ValueError(f"seed must be at most 2^53 - 1 = {MAX_SEED}, got {shown(seed)}: data hold no larger one")
    return RandomPhases(int(seed))


Phases = float | tuple[float, ...] | RandomPhases


@dataclass(frozen=True)
class Profile(Waves):
    """Weierstrass profile z(x) = sum_n g_n cos(2 pi gamma^n x + phi_n), n = 0..m-1 (1), in g_0.

    Parameters
    ----------
    D : float
        Fractal dimension, 1 < D < 2.
    gamma : int, Fraction, str or float
        Ratio of successive wavelengths, > 1: 5, Fraction(5, 2), "5/2", 2.5. A float that is no ratio of integers up
        to 10^6 gives a profile without a period, for methods that need none.
    m : int or inf
        Number of terms. An infinite series has no heights and is for methods that do not resolve the finest wave.
    phases : float, sequence of m floats, or RandomPhases
        Phases, in radians. A number is phi_n for every n >= 1, with phi_0 = 0.
    seed : int, optional
        Seed of random phases, instead of `phases`, at most 2^53 - 1.

    Raises
    ------
    ValueError
        If a parameter is out of range; the message gives the range.

    Examples
    --------
    >>> import weier
    >>> profile = weier.Profile(D=1.5, gamma="5/2", m=3, phases=1.0)
    >>> print(profile.describe(), profile.period, profile.height([0.0, 0.5]).round(4))
    D = 1.5, gamma = 5/2, m = 3 4 [ 1.5578 -1.6174]
    """

    D: float
    gamma: Fraction
    m: float
    phases: Phases = 0.0

    # A generated __init__ would accept only the types of the fields.
    def __init__(
        self,
        D: float,
        gamma: int | float | str | Fraction,
        m: float,
        phases: float | Sequence[float] | Array | RandomPhases = 0.0,
        *,
        seed: int | None = None,
    ) -> None:
        if seed is not None:
            if not (isinstance(phases, float) and phases == 0):
                raise ValueError(f"phases must be left out where there is a seed, got {shown(phases)}")
            phases = random_phases(seed)
        m = series.checked_terms(m)
        fields = {"D": series.checked_dimension(D), "gamma": checked_ratio(gamma), "m": m}
        # A frozen dataclass refuses assignments.
        vars(self).update(fields, phases=checked_phases(phases, m))

    def __repr__(self) -> str:
        """Return the call that creates this profile."""
        gamma = int(self.gamma) if self.gamma.denominator == 1 else str(self.gamma)
        m = 'float("inf")' if math.isinf(self.m) else int(self.m)
        phases = f"seed={self.phases.seed}" if isinstance(self.phases, RandomPhases) else f"phases={self.phases!r}"
        return f"Profile(D={self.D!r}, gamma={gamma!r}, m={m}, {phases})"

    @property
    def terms(self) -> int:
        """The number of terms; ValueError if m = inf."""
        if math.isinf(self.m):
            raise ValueError("m = inf has no last term: choose a finite m, or an estimate that has a limit")
        return int(self.m)

    @property
    def full_contact_pressure(self) -> Array:
        """Full-contact pressures p_n*, shape (m,), in p_0* (16)."""
        return self._full_contact_pressure.copy()

    @cached_property
    def _amplitude(self) -> Array:
        return series.amplitude(np.arange(self.terms), self.D, float(self.gamma))

    @cached_property
    def _full_contact_pressure(self) -> Array:
        return series.full_contact_pressure(np.arange(self.terms), self.D, float(self.gamma))

    @cached_property
    def _phase(self) -> Array:
        if isinstance(self.phases, RandomPhases):
            return self.phases.first(self.terms)
        if isinstance(self.phases, tuple):
            return np.array(self.phases)
        return np.where(np.arange(self.terms) == 0, 0.0, self.phases)

    @cached_property
    def total_amplitude(self) -> float:
        """Sum of all g_n, in g_0: the compliance at full contact (22)."""
        if math.isinf(self.m):
            return float(series.tail_amplitude(0, self.D, float(self.gamma)))
        return math.fsum(self.amplitude)

    @property
    def rms(self) -> tuple[float, float, float]:
        """Root mean squares of height, slope and curvature; the last two may be inf, as for m = inf.

        As of `Waves`: sums of squared amplitudes times powers of the wavenumber, which are geometric.
        """
        with np.errstate(over="ignore"):
            sums = series.leading_amplitude(self.m, 2 * (self.D + np.arange(3)) - 2, float(self.gamma))
        height, slope, curvature = ((2 * np.pi) ** np.arange(3) * np.sqrt(sums / 2)).tolist()
        return height, slope, curvature

    @property
    def tail_amplitude(self) -> float:
        """Sum G_m of the amplitudes that the truncation leaves out, in g_0 (27)."""
        return float(series.tail_amplitude(self.m, self.D, float(self.gamma)))

    def truncated(self, terms: int) -> Profile:
        """Return the first `terms` of the series, as a profile."""
        terms = checked_count("terms", terms, 1, self.m)
        phases = self.phases[:terms] if isinstance(self.phases, tuple) else self.phases
        shorter = object.__new__(Profile)  # without __init__, whose checks and warnings have run for the whole series
        vars(shorter).update(D=self.D, gamma=self.gamma, m=terms, phases=phases)
        return shorter

    def amplitude_beyond(self, terms: float) -> float:
        """Sum of the amplitudes of this series after the first `terms`, in g_0."""
        terms = checked_number("terms", terms, f"lie in [1, m = {self.m}]", lambda terms: 1 <= terms <= self.m)
        return 0.0 if terms == self.m else self.total_amplitude - self.truncated(int(terms)).total_amplitude

    @cached_property
    def period(self) -> int:
        """Length after which the truncated series repeats, in lambda_0: denominator(gamma)^(m-1)."""
        return int(self.gamma.denominator ** (self.terms - 1))

    @cached_property
    def _waves(self) -> list[int]:
        a, b, last = self.gamma.numerator, self.gamma.denominator, self.terms - 1
        return [a**n * b ** (last - n) for n in range(self.terms)]

    @property
    def finest(self) -> float:
        """Waves of the finest term in one period; inf if they are more than a float holds."""
        try:
            return float(self.gamma.numerator) ** (self.m - 1)
        except OverflowError:
            return math.inf

    @property
    def listed_phases(self) -> Array:
        """Phases that results list, in radians; for the infinite series, those of two terms unless random."""
        if math.isfinite(self.m):
            return self.phase
        return np.full(1, np.nan) if isinstance(self.phases, RandomPhases) else np.array([0.0, self.phases])

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters of this series as a scene has them: see `Profile`."""
        phases = {"seed": self.phases.seed} if isinstance(self.phases, RandomPhases) else {"phases": self.phases}
        return {"D": self.D, "m": self.m, "gamma": str(self.gamma), **phases}

    @property
    def labels(self) -> dict[str, Any]:
        """The labels that distinguish this series, by the names of coordinates; NaN if there is no seed."""
        seed: float = math.nan
        phases: Any = self.phases
        if isinstance(self.phases, RandomPhases):
            seed, phases = float(self.phases.seed), None
            if self.m <= 1000:  # the seed defines random phases, so labels omit them
                phases = self.phase.tolist()
        own = {name: float(getattr(self, name)) for name in PARAMETERS}
        return own | {"seed": seed, "phases": json.dumps(phases)}

    def describe(self) -> str:
        """Return the parameters in a few words, as in `D = 1.25, gamma = 5, m = 3`."""
        gamma = self.gamma if self.gamma.denominator <= MAX_DENOMINATOR else float(self.gamma)
        return f"D = {self.D:g}, gamma = {gamma}, m = {self.m}"


def checked_phases(phases: float | Sequence[float] | Array | RandomPhases, m: float) -> Phases:
    """Return the phases; ValueError unless they are finite, and one for all terms or one for each of m."""
    if isinstance(phases, RandomPhases):
        return phases
    values = checked_numbers("phases", phases, "be finite numbers in radians", np.isfinite, units.RADIAN)
    if values.ndim > 1:
        raise ValueError(f"phases must be finite numbers in radians, a number or one list, got {shown(phases)}")
    others = np.abs(values[values != 0])
    beyond = others > 2 * math.pi * (1 + ROUNDING)
    # A translation adds multiples of other numbers to some phases, but rarely whole numbers.
    if others.size and (beyond.all() or (np.all(others % 1 == 0) and others.max() > MAX_WHOLE_RADIANS)):
        warnings.warn(
            f"{'all phases that are not 0' if beyond.all() else 'some phases'} exceed 2 pi, got {shown(phases)}: "
            "phases are in radians, and numpy.radians converts them from degrees",
            stacklevel=3,  # the warning points at the call of Profile
        )
    if values.ndim == 0:
        return float(values)
    if values.size != m:
        raise ValueError(
            f"phases must be one number for all terms or one for each of the m = {m:g} terms, got {values.size}"
        )
    return tuple(values.tolist())


def checked_ratio(gamma: int | float | str | Fraction) -> Fraction:
    """Return the ratio of successive wavelengths as a fraction; ValueError if it is none: see `Profile`."""
    ratio = _ratio(gamma)
    if ratio is None:
        raise ValueError(f'gamma must be a finite number or a fraction such as "5/2", got {shown(gamma)}')
    if ratio <= 1:
        raise ValueError(f"gamma must exceed 1, so that each term is finer than the one before, got {shown(gamma)}")
    return ratio


def _ratio(gamma: Any) -> Fraction | None:
    """Return the exact ratio; for a float, a fraction of small integers that rounds to it, if there is one."""
    if isinstance(gamma, np.floating):
        gamma = float(gamma)  # a Fraction takes no other floats of NumPy than float64
    if isinstance(gamma, bool | np.bool_ | np.timedelta64) or not isinstance(gamma, str | Rational | float | Decimal):
        return None
    try:
        if isinstance(gamma, str) and "/" not in gamma and not math.isfinite(float(gamma)):
            return None  # A Fraction would expand all the digits of 1e999999999.
        given = Fraction(gamma)
        float(given)
    except (ValueError, OverflowError, ZeroDivisionError):
        return None
    # A Fraction keeps integers of NumPy, whose powers overflow without a warning.
    ratio = Fraction(int(given.numerator), int(given.denominator))
    near = ratio.limit_denominator(MAX_DENOMINATOR)
    return near if isinstance(gamma, float) and float(near) == gamma else ratio


def terms_within(profile: Profile, waves: float) -> int:
    """Return the number of terms, at least one, whose finest wave fits at most `waves` times into the period."""
    terms = 1
    while terms < profile.m and profile.gamma.numerator**terms <= waves:
        terms += 1
    return terms
