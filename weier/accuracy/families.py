"""Families of hard series, with the variants of methods that are compared on them.

Phases, loads and settings of boundary elements are drawn from several kinds as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import cycle
from typing import TypeVar

import numpy as np
from numpy.random import Generator

from weier import ConvergenceError, Profile
from weier.accuracy.cosines import Cosines
from weier.accuracy.runner import MAX_POINTS, Problem, Variant, run
from weier.kernels.arrays import Array
from weier.methods import bem
from weier.methods.method import Settings
from weier.surface.waves import Waves

MAX_WAVES = 1000  # per period; contact patches then take at most a third of a second per load
LOADS = 8  # loads per series
SHAPE_SAMPLES = 4096  # samples that define a smooth surface
VARIANTS = "bem", "bem with staircase", "patches"
Kind = TypeVar("Kind")


WHOLE = tuple(map(str, range(2, 11)))
LONG_PERIODS = ("3/2", "5/2", "7/3", "5/3", "4/3", "7/2", "9/4", "8/5", "11/3", "6/5")  # many lambda_0
COARSE = tuple(f"{ratio:.0f}" for ratio in np.geomspace(20, MAX_WAVES, 40))  # some crests carry hundreds of contacts
# Ratios of wavelengths, and numbers of terms.
SERIES = {
    "usual": (WHOLE, range(1, 6)),
    "rational gamma": (LONG_PERIODS, range(2, 6)),
    "gamma 20 to 1000": (COARSE, range(2, 3)),
    "m to 7": (("4/3", "3/2", "2", "3"), range(5, 8)),
    "D near 1 and 2": ((*WHOLE, *LONG_PERIODS), range(1, 6)),
}
FAMILIES = (*SERIES, "smooth")


def draws(names: Iterable[str], methods: Sequence[str], random: Generator, count: int) -> Iterator[Problem]:
    """Yield draws of the families in turn, with at least this number of loads, for some of `VARIANTS`."""
    for name in cycle(names):
        if count <= 0:
            return
        profile = _choice(random, (power_law, shape))(random) if name not in SERIES else _series(random, name)
        loads = np.unique(_choice(random, (any_loads, near_events, near_full_contact))(random, profile))
        grid = mesh(random, profile)
        tolerance = {"tolerance": 10 ** random.uniform(-10, -2)}  # the reference is not finer than 1e-10 g_0
        settings = dict(zip(VARIANTS, (grid, {**grid, "staircase": "kept"}, tolerance), strict=True))
        yield Problem(name, profile, loads, {own: Variant(own.split()[0], settings[own]) for own in methods})
        count -= loads.size


def _choice(random: Generator, kinds: Sequence[Kind]) -> Kind:
    return kinds[int(random.integers(len(kinds)))]


def _series(random: Generator, name: str) -> Profile:
    """Draw a series of at most `MAX_WAVES` waves per period."""
    ratios, terms = SERIES[name]
    while True:
        gamma, m = _choice(random, ratios), int(random.integers(terms.start, terms.stop))
        if Fraction(gamma).numerator ** (m - 1) <= MAX_WAVES:
            break
    distance = 10 ** random.uniform(-9, -1)
    near = 1 + distance, 2 - distance
    D = _choice(random, near) if name == "D near 1 and 2" else random.uniform(1.02, 1.98)
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


def mesh(random: Generator, profile: Waves) -> Settings:
    """Draw points per wave, as the default of 64, the 12 of the paper, or an odd number, or a tolerance."""
    if random.integers(2) == 0:
        return {"points_per_wave": int(random.choice([12, 13, 16, 32, 37, 64, 64, 64, 101, 128]))}
    while True:
        tolerance = 10 ** random.uniform(-6, -1)
        if bem.points_of(profile, tolerance) <= MAX_POINTS:
            return {"tolerance": tolerance}
