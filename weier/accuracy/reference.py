"""Reference curves that are independent of the method under test.

An estimate is compared with the sum that defines it (`ESTIMATE_REFERENCES`), and a solution of the series with the
exact contact: the closed form of one wave, or contact patches on the profile shifted along x, so that no number
agrees by construction.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from weier.accuracy import multiprecision
from weier.accuracy.cosines import shifted
from weier.accuracy.runner import Run, Variant, attempt
from weier.kernels.arrays import Array
from weier.methods import layer, patches
from weier.methods.errors import ConvergenceError
from weier.methods.registry import find_method
from weier.surface.profile import Profile
from weier.surface.waves import Waves, resolvable

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
    """Return the correct digits, log10 of value over error, from 0 to 16; NaN where unknown."""
    size = np.abs(np.asarray(right, np.float64))
    with np.errstate(divide="ignore"):
        found = np.clip(np.log10(np.maximum(size, TINY) / deviation(values, right)), 0.0, MAX_DIGITS)
    return np.where((size < TINY) & (np.abs(values) <= TINY), MAX_DIGITS, found)


def _sums(terms: Callable[..., multiprecision.Pair], profile: Profile, loads: Array) -> Reference:
    """Return the sums that define an estimate, in many digits."""
    series = profile.D, float(profile.gamma), profile.m
    return Reference(np.array([terms(float(p), *series) for p in loads], object).T)


def _finer_layer(profile: Profile, loads: Array) -> Reference | None:
    """Return the layer on twice the points, with a quarter of the error; None if it fails or takes minutes."""
    if 10 < profile.m < math.inf:  # more scales take minutes at this accuracy
        return None
    with suppress(ConvergenceError):
        finer = layer.curve(profile, loads, points=2 * layer.POINTS, accuracy=1e-6)
        return Reference(np.stack([finer.compliance, finer.resistance]))
    return None


# reference of each estimate by name, which separates its numerical error from its model error
ESTIMATE_REFERENCES: dict[str, Callable[[Any, Array], Reference | None]] = {
    "archard": partial(_sums, multiprecision.archard),
    "demelio": partial(_sums, multiprecision.demelio),
    "layer": _finer_layer,
}


def own_reference(variant: Variant, profile: Waves, loads: Array, result: Run) -> Reference:
    """Return the reference of a method; NaN at loads that it refuses, and where no reference is affordable.

    For one wave all methods are exact. Otherwise estimates have references of their own, and methods that are
    numerical or state errors are compared with the exact contact.
    """
    method, solved = find_method(variant.method), result.solved
    values, uncertainty, p = np.full((2, loads.size), math.nan, object), np.zeros((2, loads.size)), loads[solved]
    known: Reference | None = None
    if p.size and profile.m != 1 and method.name in ESTIMATE_REFERENCES:
        known = ESTIMATE_REFERENCES[method.name](profile, p)
    elif p.size and (profile.m == 1 or method.numerical or bool(np.isfinite(result.stated[0]).any())):
        in_reach = math.isfinite(profile.m) and resolvable(profile)
        if in_reach and patches.METHOD.seconds(profile, p) <= MAX_REFERENCE_SECONDS:
            known = contact_reference(profile, tuple(p.tolist()))
    if known:
        values[:, solved], uncertainty[:, solved] = known
    return Reference(values, uncertainty)


@cache  # all methods on one profile share it
def contact_reference(profile: Waves, loads: tuple[float, ...]) -> Reference:
    """Return the exact curve of a finite series that can be resolved; NaN where the contact patches fail.

    The uncertainty is the distance from patches on the reflected profile, shifted as well, and rounding.
    """
    p, uncertainty = np.array(loads), np.array(0.0)
    if isinstance(profile, Profile) and profile.m == 1:
        values = _sums(lambda load, *_: multiprecision.westergaard(load), profile, p).values
    else:
        values = _by_patches(shifted(profile), p, TOLERANCES)
        uncertainty = np.abs(values - _by_patches(shifted(profile, reflected=True), p, TOLERANCES[1:]))
    R = np.asarray(values[1], np.float64)
    rounding = [np.full(R.size, ROUNDING * profile.total_amplitude), ROUNDING + SLOPE_ROUNDING * R]
    return Reference(values, uncertainty + rounding)


def _by_patches(profile: Waves, loads: Array, tolerances: Sequence[float]) -> Array:
    """Return compliance and resistance by contact patches, shape (2, loads).

    Each load is solved to the smallest of the tolerances that can be met; the values are NaN where none can.
    """
    values = np.full((2, loads.size), np.nan)
    for tolerance in tolerances:
        if (left := np.isnan(values[0])).any():
            values[:, left] = attempt(Variant("patches", {"tolerance": tolerance}), profile, loads[left]).values
    return values
