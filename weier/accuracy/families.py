"""Families of hard series with their exact curves by contact patches.

A family is made of features: of the series, its phases, its loads, and the settings of boundary elements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from fractions import Fraction
from itertools import cycle
from typing import Any, NamedTuple

import click
import numpy as np
from numpy.random import Generator

from weier import ConvergenceError, Profile
from weier.accuracy.reference import TOLERANCES
from weier.kernels.arrays import Array
from weier.methods import patches

MAX_WAVES = 1000  # per period: at most a third of a second per load by contact patches
LOADS = 8  # loads per series
# Ratios of wavelengths whose periods are many lambda_0.
RATIOS = ("3/2", "5/2", "7/3", "5/3", "4/3", "7/2", "9/4", "8/5", "11/3", "6/5")


class Draw(NamedTuple):
    """A series with its loads and exact curve; NaN where contact patches fail.

    exact : compliance and resistance, shape (2, loads)
    settings : of boundary elements
    uncertainty : of h and R: the difference from patches on the reflected profile, plus the effect of the residual
    """

    family: str
    profile: Profile
    loads: Array
    settings: dict[str, Any]
    exact: Array
    uncertainty: Array


# Series: each of at most MAX_WAVES.


def usual(random: Generator) -> tuple[float, Fraction, int]:
    """Draw whole ratios to 10."""
    return random.uniform(1.02, 1.98), Fraction(int(random.integers(2, 11))), int(random.integers(1, 6))


def rational(random: Generator) -> tuple[float, Fraction, int]:
    """Draw ratios of whole numbers, whose periods are many lambda_0."""
    return random.uniform(1.02, 1.98), Fraction(str(random.choice(RATIOS))), int(random.integers(2, 6))


def coarse(random: Generator) -> tuple[float, Fraction, int]:
    """Draw ratios of 20 to 1000: a few crests of the first wave carry hundreds of contacts."""
    return random.uniform(1.02, 1.98), Fraction(round(np.exp(random.uniform(np.log(20), np.log(1000))))), 2


def long(random: Generator) -> tuple[float, Fraction, int]:
    """Draw five to seven terms."""
    return (
        random.uniform(1.02, 1.98),
        Fraction(str(random.choice(["3/2", "4/3", "2", "3"]))),
        int(random.integers(5, 8)),
    )


def extreme_dimension(random: Generator) -> tuple[float, Fraction, int]:
    """Draw D within 1e-9 to 1e-1 of 1 and 2."""
    _, gamma, m = (usual, rational)[random.integers(2)](random)
    distance = 10 ** random.uniform(-9, -1)
    return float(random.choice([1 + distance, 2 - distance])), gamma, m


# phases of a series


def any_phases(random: Generator, waves: Array) -> Array:
    """Draw phases anywhere."""
    return random.uniform(0, 2 * np.pi, waves.size)


def near_symmetry(random: Generator, waves: Array) -> Array:
    """Draw phases within 1e-15 to 1e-3 of 0 and pi."""
    distance = 10 ** random.uniform(-15, -3, waves.size) * random.choice([-1, 0, 1], waves.size)
    return np.pi * random.integers(0, 2, waves.size) + distance


def aligned(random: Generator, waves: Array) -> Array:
    """Return phases for which all crests, or all troughs, meet at one place: on a node, between two, or anywhere."""
    points = 32 * waves[-1]
    place = float(random.choice([0.0, 0.5, 0.25, random.random()])) / points
    return np.asarray(-2 * np.pi * waves * place + np.pi * float(random.random() < 0.2))


def twin_crests(random: Generator, waves: Array) -> Array:
    """Return an even profile, with crests in pairs, perturbed in one phase by 1e-12 to 1e-2."""
    phases = np.asarray(np.pi * random.integers(0, 2, waves.size), np.float64)
    phases[random.integers(waves.size)] += 10 ** random.uniform(-12, -2) * random.choice([-1, 1])
    return phases


# Loads.


def any_loads(random: Generator, profile: Profile) -> Array:
    """Draw loads from 1e-9 p_0* to full contact."""
    return np.exp(random.uniform(np.log(1e-9), np.log(profile.full_contact_load), LOADS))


def near_events(random: Generator, profile: Profile) -> Array:
    """Draw loads within a relative 1e-10 to 1e-1 of a birth or merger, on either side."""
    low, high = (profile.full_contact_load * 10 ** random.uniform(*decades) for decades in ((-7, -2), (-2, -1e-3)))
    count = _count(profile, low)
    if count == _count(profile, high):
        return any_loads(random, profile)
    while high / low > 1 + 1e-11:
        middle = np.sqrt(low * high)
        low, high = (middle, high) if _count(profile, middle) == count else (low, middle)
    return high * (1 + _near(random))


def _count(profile: Profile, load: float) -> int:
    return int(patches.curve(profile, [load], 1e-8).patch_count[0])


def near_full_contact(random: Generator, profile: Profile) -> Array:
    """Draw loads below full contact by a relative 1e-10 to 1e-1."""
    return profile.full_contact_load * (1 - np.abs(_near(random)))


def _near(random: Generator) -> Array:
    return np.asarray(random.choice([-1, 1], LOADS) * 10 ** random.uniform(-10, -1, LOADS))


# Settings.


def usual_settings(random: Generator, profile: Profile) -> dict[str, Any]:
    """Draw the default of 64 points per wave, or another number, such as the 12 of the paper."""
    return {"points": int(random.choice([12, 16, 32, 64, 64, 64, 128])) * profile.waves_per_period[-1]}


def odd_points(random: Generator, profile: Profile) -> dict[str, Any]:
    """Draw odd numbers of points per wave, or any number in the period."""
    waves = profile.waves_per_period[-1]
    if random.random() < 0.5:
        return {"points": (2 * int(random.integers(6, 51)) + 1) * waves}
    return {"points": int(random.integers(12 * waves, 65 * waves))}


def tolerances(random: Generator, profile: Profile) -> dict[str, Any]:
    """Draw residuals from 1e-6 to 1e-12 g_0."""
    return usual_settings(random, profile) | {"max_residual": 10 ** random.uniform(-12, -6)}


# The features of families.
SERIES = usual, rational, coarse, long, extreme_dimension
PHASES = any_phases, near_symmetry, aligned, twin_crests
PRESSURES = any_loads, near_events, near_full_contact
SETTINGS = usual_settings, odd_points, tolerances
Features = tuple[tuple[Callable[..., Any], ...], ...]  # the choices of series, phases, loads and settings


def _family(*features: Callable[..., Any]) -> Features:
    """Return the named features, with defaults for the others."""
    kinds: Features = (SERIES, PHASES, PRESSURES, SETTINGS)
    chosen = [tuple(f for f in features if f in kind) for kind in kinds]
    usual_of_kind: Features = tuple((feature,) for feature in (usual, any_phases, any_loads, usual_settings))
    return tuple(own or default for own, default in zip(chosen, usual_of_kind, strict=True))


FAMILIES: dict[str, Features] = {
    "usual": _family(),
    "rational gamma": _family(rational),
    "gamma 20 to 1000": _family(coarse, *PHASES),
    "m to 7": _family(long),
    "D near 1 and 2": _family(extreme_dimension),
    "phases near 0 and pi": _family(usual, rational, near_symmetry),
    "aligned crests": _family(usual, rational, aligned),
    "births and mergers": _family(usual, rational, any_phases, near_symmetry, near_events),
    "full contact": _family(usual, rational, near_full_contact),
    "twin crests": _family(usual, rational, twin_crests, near_events),
    "odd points": _family(usual, rational, odd_points),
    "tolerances": _family(usual, rational, tolerances),
    "all at once": (SERIES, PHASES, PRESSURES, SETTINGS),
}


def draw_one(random: Generator, family: str) -> Draw:
    """Return a new series of a family with its exact curve."""
    series, phases, loads, settings = (choices[random.integers(len(choices))] for choices in FAMILIES[family])
    profile = _profile(random, series, phases)
    pressures = _pressures(random, profile, loads)
    return Draw(family, profile, pressures, settings(random, profile), *solve_exactly(profile, pressures))


def _profile(random: Generator, series: Callable[..., Any], phases: Callable[..., Array]) -> Profile:
    while True:
        D, gamma, m = series(random)
        if gamma.numerator ** (m - 1) <= MAX_WAVES:
            break
    waves = np.array(Profile(D, gamma, m).waves_per_period, float)
    return Profile(D, gamma, m, tuple(phases(random, waves).tolist()))


def _pressures(random: Generator, profile: Profile, loads: Callable[[Generator, Profile], Array]) -> Array:
    """Return increasing loads near births and mergers, or any loads if there are none."""
    try:
        return np.unique(loads(random, profile))
    except ConvergenceError as error:
        click.echo(f"events of {profile!r}: {error}", err=True)
        return np.unique(any_loads(random, profile))


def solve_exactly(profile: Profile, loads: Array) -> tuple[Array, Array]:
    """Return h and R, shape (2, loads), and their uncertainty; NaN where patches find no solution."""
    reflected = Profile(profile.D, profile.gamma, profile.m, tuple((-profile.phase).tolist()))
    exact, twin, uncertainty = np.full((3, 2, loads.size), np.nan)
    for number, load in enumerate(loads):
        try:
            found, other = _solve(profile, load, TOLERANCES), _solve(reflected, load, TOLERANCES[1:])
        except ConvergenceError as error:
            click.echo(f"patches of {profile!r} at {load!r}: {error}", err=True)
            continue
        exact[:, number], twin[:, number] = ([c.compliance[0], c.resistance[0]] for c in (found, other))
        uncertainty[:, number] = found.residual[0] + 1e-15 * profile.total_amplitude, 1e-11 * found.resistance[0]
    return exact, np.abs(exact - twin) + uncertainty


def _solve(profile: Profile, load: float, tolerances: tuple[float, ...]) -> patches.PatchCurve:
    *tight, loosest = tolerances
    for tolerance in tight:
        with suppress(ConvergenceError):
            return patches.curve(profile, [load], tolerance)
    return patches.curve(profile, [load], loosest)


def draws(names: list[str], random: Generator, count: int) -> Iterator[Draw]:
    """Yield draws of the families in turn, with at least this number of loads."""
    for name in cycle(names):
        if count <= 0:
            return
        fresh = draw_one(random, name)
        count -= fresh.loads.size
        yield fresh
