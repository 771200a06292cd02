"""Families of hard series, with the variants of methods that are compared on them.

Phases, loads and settings of boundary elements are drawn from several kinds as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import cycle
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.random import Generator

from weier import ConvergenceError, Profile
from weier.accuracy.cosines import Cosines
from weier.accuracy.runner import MAX_POINTS, Variant, run
from weier.kernels.arrays import Array
from weier.methods import bem
from weier.methods.method import Settings
from weier.surface.waves import Waves

MAX_WAVES = 1000  # per period; contact patches then take at most a third of a second per load
LOADS = 8  # loads per series
SHAPE_SAMPLES = 4096  # samples that define a smooth surface
VARIANTS = "bem", "bem with staircase", "patches"
Kind = TypeVar("Kind")


class Draw(NamedTuple):
    """A series of a family with its loads, and the variants that are compared under them, by name."""

    family: str
    profile: Waves
    loads: Array
    variants: dict[str, Variant]


class Family(NamedTuple):
    """Ratios of wavelengths, the smallest and largest number of terms, and whether D is next to 1 or 2."""

    gamma: Sequence[str]
    few: int
    many: int
    extreme_dimension: bool = False


WHOLE = tuple(map(str, range(2, 11)))
LONG_PERIODS = ("3/2", "5/2", "7/3", "5/3", "4/3", "7/2", "9/4", "8/5", "11/3", "6/5")  # many lambda_0
COARSE = tuple(f"{ratio:.0f}" for ratio in np.geomspace(20, MAX_WAVES, 40))  # some crests carry hundreds of contacts
SERIES = {
    "usual": Family(WHOLE, 1, 5),
    "rational gamma": Family(LONG_PERIODS, 2, 5),
    "gamma 20 to 1000": Family(COARSE, 2, 2),
    "m to 7": Family(("4/3", "3/2", "2", "3"), 5, 7),
    "D near 1 and 2": Family((*WHOLE, *LONG_PERIODS), 1, 5, extreme_dimension=True),
}
FAMILIES = (*SERIES, "smooth")


def draws(names: Iterable[str], random: Generator, count: int) -> Iterator[Draw]:
    """Yield draws of the families in turn, with at least this number of loads."""
    for name in cycle(names):
        if count <= 0:
            return
        profile = _choice(random, (power_law, shape))(random) if name not in SERIES else _series(random, SERIES[name])
        loads = np.unique(_choice(random, (any_loads, near_events, near_full_contact))(random, profile))
        grid = _choice(random, (points, tolerances))(random, profile)
        tolerance = {"tolerance": 10 ** random.uniform(-10, -2)}  # the reference is not finer than 1e-10 g_0
        settings = grid, {**grid, "staircase": "kept"}, tolerance
        variants = (Variant(name.split()[0], own) for name, own in zip(VARIANTS, settings, strict=True))
        yield Draw(name, profile, loads, dict(zip(VARIANTS, variants, strict=True)))
        count -= loads.size


def _choice(random: Generator, kinds: Sequence[Kind]) -> Kind:
    return kinds[int(random.integers(len(kinds)))]


def _series(random: Generator, family: Family) -> Profile:
    """Draw a series of at most `MAX_WAVES` waves per period."""
    while True:
        gamma, m = _choice(random, family.gamma), int(random.integers(family.few, family.many + 1))
        if Fraction(gamma).numerator ** (m - 1) <= MAX_WAVES:
            break
    distance = 10 ** random.uniform(-9, -1)
    extremes = 1 + distance, 2 - distance
    D = _choice(random, extremes) if family.extreme_dimension else random.uniform(1.02, 1.98)
    waves = np.array(Profile(D, gamma, m).waves_per_period, float)
    phases = _choice(random, (any_phases, near_symmetry, aligned))(random, waves)
    return Profile(D, gamma, m, tuple(phases.tolist()))


# Smooth surfaces: each contact spans many of the finest waves.


def power_law(random: Generator) -> Waves:
    """Draw amplitudes k^-s of all or of the odd waves, s = 1.5 to 4, such as the triangular wave, s = 2."""
    k = np.arange(1.0, random.integers(6, 60), random.integers(1, 3))
    phase = random.choice([0.0, 1.0, 2 * np.pi]) * random.random(k.size)
    return Cosines(k ** -float(random.choice([2.0, random.uniform(1.5, 4)])), k.astype(int).tolist(), phase)


def shape(random: Generator) -> Waves:
    """Draw bumps, steps or grooves: smooth functions of cosines, with all waves above rounding."""
    x, sharpness = 2 * np.pi / SHAPE_SAMPLES * np.arange(SHAPE_SAMPLES), np.exp(random.uniform(0, np.log(30)))
    slow = np.cos(x) + float(random.choice([0.0, 0.3])) * np.cos(2 * x + random.uniform(0, 6))
    shapes = np.exp(sharpness * slow), np.tanh(sharpness**0.5 * slow), 1 / (1 + (sharpness * np.sin(0.5 * x)) ** 2)
    z = shapes[random.integers(3)] * float(random.choice([-1, 1]))
    wave = np.fft.rfft(z / np.abs(z).max())[1 : MAX_WAVES // 2] / (SHAPE_SAMPLES // 2)
    kept = np.flatnonzero(np.abs(wave) > 1e-14 * np.abs(wave).max())
    return Cosines(np.abs(wave[kept]), (kept + 1).tolist(), np.angle(wave[kept]))


# Phases.


def any_phases(random: Generator, waves: Array) -> Array:
    """Draw phases anywhere."""
    return random.uniform(0, 2 * np.pi, waves.size)


def near_symmetry(random: Generator, waves: Array) -> Array:
    """Draw phases within 1e-15 to 1e-3 of 0 and pi."""
    distance = 10 ** random.uniform(-15, -3, waves.size) * random.choice([-1, 0, 1], waves.size)
    return np.pi * random.integers(0, 2, waves.size) + distance


def aligned(random: Generator, waves: Array) -> Array:
    """Return phases for which all crests, or all troughs, meet at one place: on a node, between two, or anywhere."""
    place = float(random.choice([0.0, 0.5, 0.25, random.random()])) / (32 * waves[-1])
    return np.asarray(-2 * np.pi * waves * place + np.pi * float(random.random() < 0.2))


# Loads.


def any_loads(random: Generator, profile: Waves) -> Array:
    """Draw loads from 1e-9 p_0* to full contact."""
    return np.exp(random.uniform(np.log(1e-9), np.log(profile.full_contact_load), LOADS))


def near_events(random: Generator, profile: Waves) -> Array:
    """Draw loads within a relative 1e-10 to 1e-1 of a birth or merger, on either side; any loads if none is found."""
    low, high = (profile.full_contact_load * 10 ** random.uniform(*decades) for decades in ((-7, -2), (-2, -1e-3)))
    try:
        count = _count(profile, low)
        if count == _count(profile, high):
            return any_loads(random, profile)
        while high / low > 1 + 1e-11:
            middle = np.sqrt(low * high)
            low, high = (middle, high) if _count(profile, middle) == count else (low, middle)
    except ConvergenceError:
        return any_loads(random, profile)
    return high * (1 + _near(random))


def _count(profile: Waves, load: float) -> int:
    found = run(Variant("patches", {"tolerance": 1e-8}), profile, np.array([load]))
    return int(found.others["patch_count"][0])


def near_full_contact(random: Generator, profile: Waves) -> Array:
    """Draw loads below full contact by a relative 1e-10 to 1e-1."""
    return profile.full_contact_load * (1 - np.abs(_near(random)))


def _near(random: Generator) -> Array:
    return np.asarray(random.choice([-1, 1], LOADS) * 10 ** random.uniform(-10, -1, LOADS))


# Settings of boundary elements.


def points(random: Generator, profile: Waves) -> Settings:
    """Draw the default of 64 points per wave, or another number, such as the 12 of the paper, or an odd one."""
    return {"points_per_wave": int(random.choice([12, 13, 16, 32, 37, 64, 64, 64, 101, 128]))}


def tolerances(random: Generator, profile: Waves) -> Settings:
    """Draw tolerances of 1e-6 to 0.1 g_0, which give any number of points."""
    while True:
        tolerance = 10 ** random.uniform(-6, -1)
        if bem.points_of(profile, tolerance) <= MAX_POINTS:
            return {"tolerance": tolerance}
