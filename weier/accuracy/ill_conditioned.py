"""The table of extremes: profiles with ill-conditioned loads, and the methods that are run on them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from weier.accuracy.runner import Variant
from weier.api.fields import events
from weier.kernels.arrays import Array
from weier.methods import bem, registry
from weier.methods.errors import NotApplicableError
from weier.methods.method import Method
from weier.surface.profile import Profile


class Extreme(NamedTuple):
    """A profile, its increasing loads in p_0*, and the methods and settings that are run on it."""

    name: str
    profile: Profile
    loads: Array
    variants: tuple[Variant, ...]


# Loads over the whole range of floats, and usual loads.
SWEEP = 10.0 ** np.array(
    [*range(-300, -20, 50), -30, -20, *range(-15, -3, 2), *np.arange(-3, 1.5, 0.5), 2, 6, 12, *range(50, 301, 50)]
)
USUAL = np.geomspace(1e-6, 100, 25)
ONE_LOAD = np.array([0.1])


def extremes() -> Iterator[Extreme]:
    """Yield all extremes with their loads and variants; loads near events are computed here."""
    for name, profile, chosen in EXTREMES:
        loads = chosen(profile) if callable(chosen) else chosen
        yield Extreme(name, profile, loads, variants(profile, loads))
    for name, profile, points in GRIDS:
        yield Extreme(name, profile, USUAL, (Variant(bem.METHOD.name, {"points_per_wave": points}),))


def neighbours(*loads: float) -> Array:
    """Return each load and its neighbours, one and two units in the last place (ulp) away."""
    below = np.nextafter(loads, 0)
    above = np.nextafter(loads, np.inf)
    return np.unique([np.nextafter(below, 0), below, loads, above, np.nextafter(above, np.inf)])


def variants(profile: Profile, loads: Array) -> tuple[Variant, ...]:
    """Return all methods that give compliance and resistance of the profile in affordable time."""
    methods = (method for method in registry.METHODS if method.stiffness)
    return tuple(Variant(method.name) for method in methods if _is_affordable(method, profile, loads))


def _is_affordable(method: Method, profile: Profile, loads: Array) -> bool:
    try:
        method.check_applies(profile)
    except NotApplicableError:  # refusals are quick and are examined, too
        return method.numerical and math.isfinite(profile.m)
    try:
        method.check(profile)
    except ValueError:  # the tolerance is out of reach
        return True
    load_by_load = sum(method.seconds(profile, loads[i : i + 1]) for i in range(loads.size))
    # A method is left out if it takes longer for a curve and for its loads one by one.
    return method.seconds(profile, loads) + load_by_load <= 60.0


def around_events(profile: Profile) -> Array:
    """Return loads at and around every third birth or merger of contacts, which bounds the time."""
    births = events(profile, 1e-3, 100.0)["mean_pressure"].values[::3]
    return np.unique(np.multiply.outer(births, 1 + np.array([-1e-4, -1e-8, -1e-12, 0, 1e-12, 1e-8, 1e-4])))


def _end_of_range(text: str, D: float, gamma: str) -> Iterator[tuple[str, Profile, Array]]:
    """Yield series with D or gamma at one end of its range; slow methods are run at a single load."""
    long = Profile(D, gamma, 1000)
    yield f"{text}, m = 3", Profile(D, gamma, 3, [0.0, 1.0, 2.0]), USUAL
    yield f"{text}, m = inf", Profile(D, gamma, math.inf), USUAL
    yield f"{text}, m = 1000", long, USUAL
    yield f"{text}, m = 1000, one load", long, ONE_LOAD


ONE_WAVE, THREE_WAVES = Profile(1.25, "5", 1), Profile(1.25, "5", 3, [0.0, 1.0, 2.0])
EXTREMES: tuple[tuple[str, Profile, Array | Callable[[Profile], Array]], ...] = (
    ("one wave, loads 1e-300 to 1e300", ONE_WAVE, SWEEP),
    ("three waves, loads 1e-300 to 1e300", THREE_WAVES, SWEEP),
    ("m = inf, loads 1e-300 to 1e300", Profile(1.25, "5", math.inf), SWEEP),
    ("one wave, xi one ulp from 1", ONE_WAVE, neighbours(1.0)),
    # p_n* = 1 and 3, g_n = 1 and 1/3, and full contact at 4 are floats or round to one.
    ("p one ulp from p_n* and full contact", Profile(1.5, "9", 2, [0.0, 0.0]), neighbours(1.0, 3.0, 4.0)),
    *_end_of_range("D = 1 + 1e-9", 1 + 1e-9, "5"),
    *_end_of_range("D = 2 - 1e-9", 2 - 1e-9, "5"),
    *_end_of_range("gamma = 1 + 1e-6", 1.5, "1000001/1000000"),
    *_end_of_range("gamma = 1e6", 1.5, "1000000"),
    ("m = 1000, loads 1e-300 to 1e300", Profile(1.5, "2", 1000), SWEEP),
    ("m = 1000, one load", Profile(1.5, "2", 1000), ONE_LOAD),
    ("about to merge, just merged", Profile(1.5, "3", 3, [0.0, 1.0, 2.0]), around_events),
    ("phases 0, births in pairs", Profile(1.5, "3", 3, [0.0, 0.0, 0.0]), around_events),
    ("phases pi, births in pairs", Profile(1.5, "3", 3, [0.0, math.pi, math.pi]), around_events),
    ("two crests of one height", Profile(1.25, "2", 2, [0.0, math.pi]), SWEEP),
    ("two crests, 1e-15 apart in height", Profile(1.25, "2", 2, [0.0, math.pi + 1e-15]), SWEEP),
    ("a wave of 1e-3 on one of 1", Profile(1 + 1e-9, "1000", 2, [0.0, 1.0]), USUAL),
    ("finer waves flat to rounding", Profile(1 + 1e-9, "1000000", 1000), USUAL),
    ("waves that cancel to 1 %", Profile(1 + 1e-9, "101/100", 2, [0.0, math.pi]), USUAL),
)
# points per wave of boundary elements: the fewest, and a million nodes
GRIDS = (
    ("3 nodes", ONE_WAVE, 3),
    ("10^6 nodes, one wave", ONE_WAVE, 1_000_000),
    ("10^6 nodes, three waves", THREE_WAVES, 40_000),
)
