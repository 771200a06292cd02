"""Reference curves that are independent of the method under test.

An estimate is compared with the sum that defines it (`ESTIMATE_REFERENCES`), and a solution of the series with the
exact contact: the closed form of one wave, or closed forms at first touch and at full contact, with contact patches
between them. The patches solve the profile shifted along x, so that no number agrees by construction.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache, partial
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np

from weier.accuracy import multiprecision
from weier.accuracy.cosines import shifted
from weier.accuracy.runner import Outcome, Run, Variant, attempt
from weier.kernels.arrays import Array
from weier.methods import layer, patches
from weier.methods.errors import ConvergenceError
from weier.methods.method import Method
from weier.surface.crests import find_crests
from weier.surface.expansions import expand
from weier.surface.limits import resolvable
from weier.surface.profile import Profile
from weier.surface.waves import Waves

# tried in turn, since the bound exceeds the first with many contacts
TOLERANCES = (1e-12, 1e-11, 1e-10)
MAX_REFERENCE_SECONDS = 60.0  # Slower references are left out, so that all extremes together take minutes.
ROUNDING, SLOPE_ROUNDING = 1e-15, 1e-11  # smallest uncertainty of h/G and of R
MAX_DIGITS = 16.0  # digits of a double, returned for an error of 0
TINY = float(np.finfo(float).tiny)  # Smaller values may underflow to 0.


class Reference(NamedTuple):
    """Reference values of compliance and resistance and their errors, in g_0 and g_0/p_0*, each of shape (2, loads).

    The values are floats or numbers of mpmath, NaN where nothing is known.
    """

    values: Any
    uncertainty: Any = 0.0


def deviation(values: Array, right: Any) -> Array:
    """Return the distance of each value from its reference; NaN if either is unknown."""
    with np.errstate(invalid="ignore"):  # numpy warns of NaN among objects
        return np.asarray(np.abs(values.astype(object) - right), np.float64)


def digits(values: Array, right: Any) -> Array:
    """Return the correct digits, -log10 of the relative error, from 0 to 16; NaN where unknown."""
    return np.vectorize(_digits, otypes=[float])(values.astype(object), right)


def _digits(value: float, right: Any) -> float:
    if not math.isfinite(value) or mp.isnan(right):
        return math.nan
    with mp.workdps(multiprecision.DIGITS):
        if abs(right) < TINY:
            return MAX_DIGITS if abs(value) <= TINY else 0.0
        error = abs(mp.mpf(value) / right - 1)
        return min(max(float(-mp.log10(error)), 0.0), MAX_DIGITS) if error else MAX_DIGITS


def _sums(terms: Callable[..., multiprecision.Pair], profile: Profile, loads: Array) -> Reference:
    """Return the sums that define an estimate, in many digits."""
    series = profile.D, float(profile.gamma), profile.m
    return Reference(np.array([terms(float(p), *series) for p in loads], object).T)


def _finer_layer(profile: Profile, loads: Array) -> Reference | None:
    """Return the layer on twice the points, with a quarter of the error; None for a series that takes minutes."""
    if 10 < profile.m < math.inf:  # more scales take minutes at this accuracy
        return None
    finer = layer.curve(profile, loads, points=2 * layer.POINTS, accuracy=1e-6)
    return Reference(np.stack([finer.compliance, finer.resistance]))


# reference of each estimate by name, which separates its numerical error from its model error
ESTIMATE_REFERENCES: dict[str, Callable[[Profile, Array], Reference | None]] = {
    "archard": partial(_sums, multiprecision.archard),
    "demelio": partial(_sums, multiprecision.demelio),
    "layer": _finer_layer,
}


def find_reference(method: Method, profile: Profile, loads: Array, result: Run) -> Reference:
    """Return the reference of a method at these loads; NaN without a result or an affordable reference.

    For one wave all methods are exact. Otherwise estimates have references of their own, and methods that are
    numerical or state errors are compared with the exact contact.
    """
    values, uncertainty = np.full((2, loads.size), mp.nan, object), np.zeros((2, loads.size))
    solved = result.outcome == Outcome.finite
    if solved.any() and (known := _look_up(method, profile, loads[solved], result)):
        values[:, solved], uncertainty[:, solved] = known
    return Reference(values, uncertainty)


def _look_up(method: Method, profile: Profile, loads: Array, result: Run) -> Reference | None:
    if profile.m != 1 and method.name in ESTIMATE_REFERENCES:
        with suppress(ConvergenceError):
            return ESTIMATE_REFERENCES[method.name](profile, loads)
        return None
    solves_series = profile.m == 1 or method.numerical or bool(np.isfinite(result.stated[0]).any())
    if not (solves_series and is_in_reach(profile, loads)):
        return None
    return contact_reference(profile, tuple(loads.tolist()))


def is_in_reach(profile: Profile, loads: Array) -> bool:
    """Return whether the exact contact of a profile takes less than `MAX_REFERENCE_SECONDS`."""
    if math.isinf(profile.m) or not resolvable(profile):
        return False
    return patches.METHOD.seconds(profile, loads) <= MAX_REFERENCE_SECONDS


@cache  # all methods on one profile share it
def contact_reference(profile: Waves, loads: tuple[float, ...]) -> Reference:
    """Return the exact curve of a finite series that can be resolved; NaN where the contact patches fail.

    The uncertainty is the distance from patches on the reflected profile, shifted as well, and rounding.
    """
    if isinstance(profile, Profile) and profile.m == 1:
        exact = _sums(lambda load, *_: multiprecision.westergaard(load), profile, np.array(loads)).values
        return Reference(exact, _rounding(profile, exact[1]))
    found = _by_patches(shifted(profile), np.array(loads), TOLERANCES)
    uncertainty = np.abs(found - _by_patches(shifted(profile, reflected=True), np.array(loads), TOLERANCES[1:]))
    values = np.vectorize(mp.mpf, otypes=[object])(found)
    # Above the computed load of full contact and its rounding, contact is certainly full.
    full_contact = profile.full_contact_load * (1 + 1e-12)
    for i, load in enumerate(loads):
        if not isinstance(profile, Profile):
            break
        if load >= full_contact:
            values[:, i], uncertainty[:, i] = (_total(profile), mp.mpf(0)), 0.0
        elif load <= 1e-20 and _single_crest(profile):  # Hertz's formula is exact to rounding: a few p, relatively.
            values[:, i], uncertainty[:, i] = _first_touch(profile, load), 0.0
    return Reference(values, uncertainty + _rounding(profile, values[1]))


def _by_patches(profile: Waves, loads: Array, tolerances: Sequence[float]) -> Array:
    """Return compliance and resistance by contact patches, shape (2, loads).

    Each load is solved to the smallest of the tolerances that can be met; the values are NaN where none can.
    """
    values = np.full((2, loads.size), np.nan)
    for tolerance in tolerances:
        if (left := np.isnan(values[0])).any():
            variant = Variant("patches", "patches", {"tolerance": tolerance})
            values[:, left] = attempt(variant, profile, loads[left]).values
    return values


def _rounding(profile: Waves, resistance: Any) -> Array:
    """Return the errors of rounding in compliance and resistance, shape (2, loads); near full contact R vanishes."""
    R = np.asarray(resistance, np.float64)
    return np.stack([np.full(R.size, ROUNDING * profile.total_amplitude), ROUNDING + SLOPE_ROUNDING * R])


def _single_crest(profile: Profile) -> bool:
    """Return whether the lightest loads rest on one crest in each lambda_0."""
    expansion = expand(profile.amplitude, profile.waves_per_period, profile.phase)
    height = find_crests(profile.amplitude, profile.waves_per_period, expansion).expansion[:, 0]
    # At such loads only crests within 1e-12 g_0 of the highest one touch.
    return profile.period == 1 and int((height > height.max() - 1e-12).sum()) == 1


def _first_touch(profile: Profile, load: float) -> multiprecision.Pair:
    """Return h = h_0 + p (1 - ln(4 pi^2 p/k)) for a small contact on a crest of curvature k.

    It is Hertzian, of half-width a = 2 sqrt(p/k); the limit of Westergaard's wave, of curvature 4 pi^2, is h = p (1 -
    ln p).
    """
    with mp.workdps(multiprecision.DIGITS):
        x = mp.mpf(profile.crest[0])
        for _ in range(8):  # refines a double by Newton's method
            x = x - _height(profile, x, 1) / _height(profile, x, 2)
        p = mp.mpf(load)
        R = -mp.log(4 * mp.pi**2 * p / -_height(profile, x, 2))
        return _total(profile) - _height(profile, x, 0) + p * (1 + R), R


def _height(profile: Profile, x: mp.mpf, order: int) -> mp.mpf:
    """Return the series, or its derivative of an order, at x."""
    falls, total = mp.mpf(float(profile.gamma)) ** (mp.mpf(profile.D) - 2), mp.mpf(0)
    for n, phase in enumerate(profile.phase):
        k = 2 * mp.pi * mp.mpf(float(profile.gamma)) ** n
        total += falls**n * k**order * mp.cos(k * x + mp.mpf(float(phase)) + order * mp.pi / 2)
    return total


def _total(profile: Profile) -> mp.mpf:
    with mp.workdps(multiprecision.DIGITS):
        falls = mp.mpf(float(profile.gamma)) ** (mp.mpf(profile.D) - 2)
        return mp.fsum(falls**n for n in range(profile.terms))
