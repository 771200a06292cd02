"""The extremes, as data: profiles, the loads at which each is hard, and the methods that meet it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods import patches
from weier.methods.method import Variant
from weier.scene import Case
from weier.theory.limits import resolvable
from weier.theory.profile import Profile

SHALLOW = 10  # terms, of which the layer has a curve in a second; each load of a deeper stack takes some
MOST_WAVES = 300  # of the finest term in a period, for dense matrices
PAPER_POINTS = 12  # for each of the finest waves, of the dense solver
SMALLEST_GRID, LARGEST_GRID = 3, 2**20
NEAR = (1e-12, 1e-8, 1e-4)  # relative distances of loads from an event
THINNED = 3  # of the births and merges, one in so many

SWEEP = 10.0 ** np.array(
    [*range(-300, -20, 50), -30, -20, *range(-15, -3, 2), -3, -2.5, -2, -1.5, -1, -0.5, 0, 0.5, 1, 2, 6, 12,
     *range(50, 301, 50)]
)  # fmt: skip
USUAL = np.geomspace(1e-6, 100, 25)


class Extreme(NamedTuple):
    """A profile at the edge of what there is.

    name : in a few words
    case : the profile, by the parameters of a scene
    loads : mean pressures, shape (loads,), increasing, in p_0*
    contenders : methods and settings that are run on it
    """

    name: str
    case: Case
    loads: Array
    contenders: tuple[Variant, ...]


def extremes() -> Iterator[Extreme]:
    """All of them; some loads stand beside events that are looked up on the way."""
    one, three, endless = _case(1.25, "5", 1), _case(1.25, "5", 3, [0.0, 1.0, 2.0]), _case(1.25, "5", math.inf)
    yield _extreme("one wave, loads 1e-300 to 1e300", one, SWEEP)
    yield _extreme("three waves, loads 1e-300 to 1e300", three, SWEEP)
    yield _extreme("endless, loads 1e-300 to 1e300", endless, SWEEP)
    for load in (SWEEP[0], SWEEP[-1]):
        yield _slow(f"endless, load {load:.0e}", endless, load)
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
        for m, many in ((1000, "m = 1000"), (math.inf, "endless")):
            yield _extreme(f"{text}, {many}", _case(D, gamma, m), USUAL)
            yield _slow(f"{text}, {many}, one load", _case(D, gamma, m), 0.1)
    yield _extreme("m = 1000, loads 1e-300 to 1e300", _case(1.5, "2", 1000), SWEEP)
    yield _slow("m = 1000, one load", _case(1.5, "2", 1000), 0.1)
    yield _extreme("about to merge, just merged", *_eventful([0.0, 1.0, 2.0]))
    yield _extreme("phases 0, births in pairs", *_eventful([0.0, 0.0, 0.0], 1e-3))
    yield _extreme("phases pi, births in pairs", *_eventful([0.0, math.pi, math.pi], 1e-3))
    yield _extreme("two crests of one height", _case(1.25, "2", 2, [0.0, math.pi]), SWEEP)
    yield _extreme("two crests, 1e-15 apart in height", _case(1.25, "2", 2, [0.0, math.pi + 1e-15]), SWEEP)
    yield _extreme("a wave of 1e-3 on one of 1", _case(1 + 1e-9, "1000", 2, [0.0, 1.0]), USUAL)
    yield _extreme("finer waves flat to rounding", _case(1 + 1e-9, "1000000", 1000), USUAL)
    yield _extreme("waves that cancel to 1 %", _case(1 + 1e-9, "101/100", 2, [0.0, math.pi]), USUAL)
    yield Extreme("3 nodes", one, USUAL, _on_points(SMALLEST_GRID))
    yield Extreme("2^20 nodes, one wave", one, USUAL, _on_points(LARGEST_GRID))
    yield Extreme("2^20 nodes, three waves", three, USUAL, _on_points(LARGEST_GRID))


def beside(*loads: float) -> Array:
    """Each load, and those one and two units in its last place below and above."""
    below = np.nextafter(loads, 0)
    above = np.nextafter(loads, np.inf)
    return np.unique([np.nextafter(below, 0), below, loads, above, np.nextafter(above, np.inf)])


def around(loads: ArrayLike) -> Array:
    """Each load, and those a little below and above."""
    steps = np.array([*(-distance for distance in NEAR), 0.0, *NEAR])
    return np.unique(np.multiply.outer(np.asarray(loads, float), 1 + steps))


def _eventful(phases: list[float], apart: float = 0.0) -> tuple[Case, Array]:
    """Three waves, and the loads around births and merges of their contacts.

    Those that come in pairs are looked up where the symmetry is broken: the last phase is this much `apart`.
    """
    case, beside = (_case(1.5, "3", 3, [*phases[:2], phases[2] + change]) for change in (0.0, apart))
    return case, around(patches.events(beside.profile, 1e-3, 100.0).mean_pressure[::THINNED])


def _case(D: float, gamma: str, m: float, phases: list[float] | None = None) -> Case:
    parameters: dict[str, Any] = {"D": D, "gamma": gamma, "m": m}
    return Case(parameters if phases is None else parameters | {"phases": phases}, (), {})


def _extreme(name: str, case: Case, loads: Array) -> Extreme:
    names = ["westergaard"] if case.profile.m == 1 else []
    names += ["archard", "demelio"]
    names += ["layer"] if case.profile.m <= SHALLOW else []
    names += ["bem", "planned"] if math.isfinite(case.profile.m) else []
    found = [Variant(method, method, {}) for method in names]
    if math.isfinite(case.profile.m) and (few_waves(case.profile) or not resolvable(case.profile)):
        direct = {"solver": "direct", **_paper_points(case.profile)}
        found += [Variant("bem direct", "bem", direct), Variant("patches", "patches", {})]
    return Extreme(name, case, loads, tuple(found))


def few_waves(profile: Profile) -> bool:
    """Whether a dense matrix of all contacts of a finite series is one of seconds."""
    return resolvable(profile) and profile.wavenumber[-1] <= MOST_WAVES


def _slow(name: str, case: Case, load: float) -> Extreme:
    """A long series by the methods that take seconds for it."""
    return Extreme(name, case, np.array([load]), tuple(Variant(name, name, {}) for name in ("layer", "planned")))


def _paper_points(profile: Profile) -> dict[str, int]:
    return {"points": PAPER_POINTS * profile.wavenumber[-1]} if resolvable(profile) else {}


def _on_points(points: int) -> tuple[Variant, ...]:
    return (
        Variant("bem", "bem", {"points": points}),
        Variant("bem direct", "bem", {"solver": "direct", "points": points}),
    )
