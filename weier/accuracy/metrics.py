"""Errors of curves: deviations, correct digits, errors by number of terms, and the Pareto front of a tradeoff."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mpmath as mp
import numpy as np
import xarray as xr

from weier.accuracy.multiprecision import DIGITS
from weier.kernels.arrays import Array

MAX_DIGITS = 16.0  # digits of a double, returned for an error of 0
TINY = float(np.finfo(float).tiny)  # Smaller values may underflow to 0.
MEASURED, STATED = "deviation", "error"  # suffixes of the variables of measured and stated errors


def deviation(values: Array, right: Sequence[Any]) -> Array:
    """Return the distance of each value from its reference (mpmath numbers or floats); NaN if either is unknown."""
    return np.array([float(abs(mp.mpf(float(value)) - true)) for value, true in zip(values, right, strict=True)])


def digits(values: Array, right: Sequence[Any]) -> Array:
    """Return the correct digits, -log10 of the relative error, from 0 to 16; NaN where unknown."""
    return np.array([_digits(float(value), true) for value, true in zip(values, right, strict=True)])


def _digits(value: float, right: Any) -> float:
    if not math.isfinite(value) or mp.isnan(right):
        return math.nan
    with mp.workdps(DIGITS):
        if abs(right) < TINY:
            return MAX_DIGITS if abs(value) <= TINY else 0.0
        error = abs(mp.mpf(value) / right - 1)
        return min(max(float(-mp.log10(error)), 0.0), MAX_DIGITS) if error else MAX_DIGITS


def by_load(data: xr.Dataset, quantity: str, kind: str = MEASURED) -> Array:
    """Return measured or stated errors of a tradeoff, shape (case, variant, mean_pressure); NaN where there are none.

    Errors of the compliance are in g_0, errors of R relative to the larger of R and 1 g_0/p_0*. R falls from several
    g_0/p_0* at light loads to 0 at full contact, so that relative errors are meaningless near full contact, and
    absolute ones at light loads.
    """
    error = data[f"{quantity}_{kind}"].values
    if quantity == "resistance":
        error = error / np.maximum(data["reference_resistance"].values[:, None], 1)
    return np.asarray(error)


def worst_over_loads(data: xr.Dataset, quantity: str, kind: str = MEASURED) -> Array:
    """Return the largest errors over the loads, shape (case, variant)."""
    return np.fmax.reduce(by_load(data, quantity, kind), axis=-1)


def seconds_per_load(data: xr.Dataset) -> Array:
    """Return the seconds per load of each case and variant, shape (case, variant)."""
    return np.asarray(data["seconds"].values / data.sizes["mean_pressure"])


def by_resolved_terms(case: xr.Dataset) -> tuple[Array, Array]:
    """Return the largest half-width of the bounds on h over the loads, and the largest error of the estimate; or NaN.

    The error is the distance from the estimate with the most terms.
    """
    h, low, high = (case[f"compliance{part}"].values for part in ("", "_lower", "_upper"))
    last = max(np.flatnonzero(np.isfinite(h).all(axis=1)), default=-1)
    error = np.abs(h - h[last]).max(axis=1)
    error[last] = np.nan
    return (high - low).max(axis=1) / 2, error


def pareto(cost: Array, error: Array) -> list[int]:
    """Return the Pareto front by increasing cost, as indices: no other entry is cheaper and more accurate."""
    front: list[int] = []
    for number in np.lexsort((error, cost)):
        if np.isfinite(cost[number] + error[number]) and (not front or error[number] < error[front[-1]]):
            front.append(int(number))
    return front
