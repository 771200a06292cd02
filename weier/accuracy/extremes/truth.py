"""What is known of the curves apart from the method under examination, load by load."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np

from weier.accuracy.extremes.cases import SHALLOW, few_waves
from weier.accuracy.extremes.examine import examine
from weier.kernels.arrays import Array
from weier.methods import multiprecision as exact
from weier.methods.method import Variant
from weier.methods.patches.surface import Surface, surface_of
from weier.theory.profile import Profile

LIGHT = 1e-20  # p_0*: below, a contact is so small that its relative error as a Hertzian one is p, times few
TIGHTEST = 1e-12  # tolerance of the contact patches on the moved profile
MOVE = 0.3  # lambda_0, by which the profile is moved for it
LAYER: dict[str, Any] = {"points": 48, "accuracy": 1e-6}  # twice the points: a quarter of the error at most


class Truth(NamedTuple):
    """Compliance and resistance, shape (loads,), as numbers of mpmath, NaN where none is known; and whence."""

    compliance: list[mp.mpf]
    resistance: list[mp.mpf]
    source: str


def truth(method: str, profile: Profile, loads: Array) -> Truth:
    """What a method should give; for the planned one, what the series does."""
    series = profile.D, float(profile.gamma), profile.m
    if profile.m == 1:
        return _collected([exact.westergaard(p) for p in loads], "mpmath")
    if method == "archard":
        return _collected([exact.archard(p, *series) for p in loads], "mpmath")
    if method == "demelio":
        return _collected([exact.demelio(p, *series) for p in loads], "mpmath")
    if method == "layer" and profile.m > SHALLOW:
        return _unknown(loads)  # minutes a load
    if method == "layer":
        return _collected(_solved(Variant("layer", "layer", LAYER), profile, loads), "finer layer")
    if math.isinf(profile.m) or not few_waves(profile):
        return _unknown(loads)
    return _contact(profile, tuple(loads.tolist()))


def _collected(pairs: list[exact.Pair], source: str) -> Truth:
    return Truth([h for h, _ in pairs], [R for _, R in pairs], source)


def _unknown(loads: Array) -> Truth:
    return Truth([mp.nan] * loads.size, [mp.nan] * loads.size, "")


@lru_cache(maxsize=1)  # of one extreme by several methods
def _contact(profile: Profile, loads: tuple[float, ...]) -> Truth:
    """Closed forms at both ends; between them the contact patches of the moved profile at their tightest."""
    seen = surface_of(profile)
    single = int((seen.heights.crest_offset == 0).sum()) == 1 and profile.period == 1
    pairs = _solved(Variant("patches", "patches", {"tolerance": TIGHTEST}), _moved(profile), np.array(loads))
    for i, load in enumerate(loads):
        if load >= seen.full_contact_load * (1 + 1e-12):
            pairs[i] = _total(profile), mp.mpf(0)
        elif load <= LIGHT and single:
            pairs[i] = _first_touch(profile, seen, load)
    return _collected(pairs, "closed forms, patches 1e-12")


def _first_touch(profile: Profile, seen: Surface, load: float) -> exact.Pair:
    """One contact so small that only the curvature k of its crest matters: h = h_0 + p (1 - ln(4 pi^2 p/k)).

    It is Hertz's, of half-width a = 2 sqrt(p/k), and Westergaard's wave of curvature 4 pi^2 is the case
    h = p (1 - ln p).
    """
    x = seen.heights.crest_position[np.argmax(seen.heights.crest_offset)]
    with mp.workdps(exact.DIGITS):
        for _ in range(8):  # Newton's method from a double
            x = x - _height(profile, x, 1) / _height(profile, x, 2)
        p = mp.mpf(load)
        R = -mp.log(4 * mp.pi**2 * p / -_height(profile, x, 2))
        return _total(profile) - _height(profile, x, 0) + p * (1 + R), R


def _height(profile: Profile, x: mp.mpf, order: int) -> mp.mpf:
    """The series, or its derivative of an order, at x."""
    falls, total = mp.mpf(float(profile.gamma)) ** (mp.mpf(profile.D) - 2), mp.mpf(0)
    for n, phase in enumerate(profile.phase):
        k = 2 * mp.pi * mp.mpf(float(profile.gamma)) ** n
        total += falls**n * k**order * mp.cos(k * x + mp.mpf(float(phase)) + order * mp.pi / 2)
    return total


def _total(profile: Profile) -> mp.mpf:
    with mp.workdps(exact.DIGITS):
        falls = mp.mpf(float(profile.gamma)) ** (mp.mpf(profile.D) - 2)
        return mp.fsum(falls**n for n in range(profile.terms))


def _moved(profile: Profile) -> Profile:
    """The same profile, begun elsewhere: the same curves by other numbers."""
    cycles = MOVE * np.array(profile.wavenumber, float) / profile.period
    return Profile(profile.D, profile.gamma, profile.m, profile.phase + 2 * np.pi * (cycles - np.rint(cycles)))


def _solved(contender: Variant, profile: Profile, loads: Array) -> list[exact.Pair]:
    """What another solution gives, NaN where it gives nothing."""
    found = examine(contender, profile, loads)
    return [(mp.mpf(float(h)), mp.mpf(float(R))) for h, R in zip(found.compliance, found.resistance, strict=True)]
