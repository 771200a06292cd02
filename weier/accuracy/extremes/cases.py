"""The extremes, as data: profiles, the loads at which each is hard, and the methods that meet it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier.accuracy.comparison import Comparison
from weier.accuracy.reference import is_in_reach
from weier.kernels.arrays import Array
from weier.methods import bem, registry
from weier.methods.errors import NotApplicableError
from weier.methods.fields import events
from weier.methods.method import Method, Settings, Variant
from weier.scene import Case
from weier.theory.limits import resolvable
from weier.theory.profile import Profile

MAX_RUN_SECONDS = 60.0  # that a method may take for an extreme, as one curve and then once more, load by load
MIN_NODES, MAX_NODES = 3, 2**20
DISTANCES = (1e-12, 1e-8, 1e-4)  # of loads from an event, relative to it
EVENT_STEP = 3  # of the births and merges, one in so many

SWEEP = 10.0 ** np.array(
    [*range(-300, -20, 50), -30, -20, *range(-15, -3, 2), -3, -2.5, -2, -1.5, -1, -0.5, 0, 0.5, 1, 2, 6, 12,
     *range(50, 301, 50)]
)  # fmt: skip
USUAL = np.geomspace(1e-6, 100, 25)


def extremes() -> Iterator[Comparison]:
    """All of them; some loads stand beside events that are looked up on the way."""
    one, three = _case(1.25, "5", 1), _case(1.25, "5", 3, [0.0, 1.0, 2.0])
    infinite = _case(1.25, "5", math.inf)
    yield _extreme("one wave, loads 1e-300 to 1e300", one, SWEEP)
    yield _extreme("three waves, loads 1e-300 to 1e300", three, SWEEP)
    yield _extreme("m = inf, loads 1e-300 to 1e300", infinite, SWEEP)
    yield _extreme("one wave, xi one ulp from 1", one, beside(1.0))
    # p_n* = 1 and 3, g_n = 1 and 1/3, and full contact at 4: numbers that a float has or rounds to.
    yield _extreme("p one ulp from p_n* and full contact", _case(1.5, "9", 2, [0.0, 0.0]), beside(1.0, 3.0, 4.0))
    for text, D, gamma in (
        ("D = 1 + 1e-9", 1 + 1e-9, "5"),
        ("D = 2 - 1e-9", 2 - 1e-9, "5"),
        ("gamma = 1 + 1e-6", 1.5, "1000001/1000000"),
        ("gamma = 1e6", 1.5, "1000000"),
    ):
        yield _extreme(f"{text}, m = 3", _case(D, gamma, 3, [0.0, 1.0, 2.0]), USUAL)
        yield _extreme(f"{text}, m = inf", _case(D, gamma, math.inf), USUAL)
        yield _extreme(f"{text}, m = 1000", _case(D, gamma, 1000), USUAL)
        yield _extreme(f"{text}, m = 1000, one load", _case(D, gamma, 1000), np.array([0.1]))  # for slow methods
    yield _extreme("m = 1000, loads 1e-300 to 1e300", _case(1.5, "2", 1000), SWEEP)
    yield _extreme("m = 1000, one load", _case(1.5, "2", 1000), np.array([0.1]))
    yield _extreme("about to merge, just merged", *_with_events([0.0, 1.0, 2.0]))
    yield _extreme("phases 0, births in pairs", *_with_events([0.0, 0.0, 0.0], 1e-3))
    yield _extreme("phases pi, births in pairs", *_with_events([0.0, math.pi, math.pi], 1e-3))
    yield _extreme("two crests of one height", _case(1.25, "2", 2, [0.0, math.pi]), SWEEP)
    yield _extreme("two crests, 1e-15 apart in height", _case(1.25, "2", 2, [0.0, math.pi + 1e-15]), SWEEP)
    yield _extreme("a wave of 1e-3 on one of 1", _case(1 + 1e-9, "1000", 2, [0.0, 1.0]), USUAL)
    yield _extreme("finer waves flat to rounding", _case(1 + 1e-9, "1000000", 1000), USUAL)
    yield _extreme("waves that cancel to 1 %", _case(1 + 1e-9, "101/100", 2, [0.0, math.pi]), USUAL)
    yield Comparison("3 nodes", one, USUAL, _on_nodes(MIN_NODES))
    yield Comparison("2^20 nodes, one wave", one, USUAL, _on_nodes(MAX_NODES))
    yield Comparison("2^20 nodes, three waves", three, USUAL, _on_nodes(MAX_NODES))


def beside(*loads: float) -> Array:
    """Each load, and those one and two units in its last place below and above."""
    below = np.nextafter(loads, 0)
    above = np.nextafter(loads, np.inf)
    return np.unique([np.nextafter(below, 0), below, loads, above, np.nextafter(above, np.inf)])


def around(loads: ArrayLike) -> Array:
    """Each load, and those a little below and above."""
    steps = np.array([*(-distance for distance in DISTANCES), 0.0, *DISTANCES])
    return np.unique(np.multiply.outer(np.asarray(loads, float), 1 + steps))


def variants(profile: Profile, loads: Array) -> tuple[Variant, ...]:
    """All methods that meet an extreme, each with all its algorithms: those that take the profile and end in time."""
    return tuple(
        Variant(_name(method, algorithm), method.name, settings)
        for method in registry.METHODS
        if _meets(method, profile, loads)
        for algorithm, settings in _algorithms(method, profile, loads)
    )


def _meets(method: Method, profile: Profile, loads: Array) -> bool:
    try:
        method.applies(profile)
    except NotApplicableError:
        return False
    except ValueError:  # a profile out of range: to say so takes no time, and is what the extreme is for
        return True
    each = sum(method.seconds(profile, loads[i : i + 1]) for i in range(loads.size))
    return method.seconds(profile, loads) + each <= MAX_RUN_SECONDS


def _algorithms(method: Method, profile: Profile, loads: Array) -> Iterator[tuple[Settings, Settings]]:
    """Each algorithm with all its settings: the default, and others where a reference for them is in reach.

    Those may be slow, as dense matrices are, and nothing tells the seconds that they take: they have the coarsest of
    the settings that the trade compares.
    """
    default, *others = method.algorithms
    yield default, default
    for algorithm in others:
        if not resolvable(profile):
            yield algorithm, algorithm
        elif is_in_reach(profile, loads):
            coarsest = next(iter(method.named_variants(profile)))
            yield algorithm, {**coarsest.settings, **algorithm}


def _name(method: Method, algorithm: Settings) -> str:
    return " ".join([method.name, *map(str, algorithm.values())])


def _with_events(phases: list[float], apart: float = 0.0) -> tuple[Case, Array]:
    """Three waves, and the loads around births and merges of their contacts.

    Those that come in pairs are looked up where the symmetry is broken: the last phase is this much `apart`.
    """
    case, other = (_case(1.5, "3", 3, [*phases[:2], phases[2] + change]) for change in (0.0, apart))
    return case, around(events(other.profile, 1e-3, 100.0)["mean_pressure"].values[::EVENT_STEP])


def _case(D: float, gamma: str, m: float, phases: list[float] | None = None) -> Case:
    parameters: dict[str, Any] = {"D": D, "gamma": gamma, "m": m}
    return Case(parameters if phases is None else parameters | {"phases": phases}, (), {})


def _extreme(name: str, case: Case, loads: Array) -> Comparison:
    return Comparison(name, case, loads, variants(case.profile, loads))


def _on_nodes(points: int) -> tuple[Variant, ...]:
    """Boundary elements on so many nodes, by each of their algorithms."""
    method = bem.METHOD
    return tuple(
        Variant(_name(method, algorithm), method.name, {**algorithm, "points": points})
        for algorithm in method.algorithms
    )
