"""What the claims read from a case, or miss there, and how they put it in words."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import xarray as xr

from weier.kernels.arrays import Array, Flags
from weier.pipeline import curves

HALF = 0.5  # of the compliance at full contact: low loads lie below, high loads above
ROUNDING = 1e-9
MOST_CASES = 4  # that a text names one by one


class MissingError(ValueError):
    """The studies lack what a claim is about."""


def need(there: object, what: str) -> None:
    """Refuse to go on without something.

    Raises
    ------
    MissingError
        If it is not there.

    """
    if not there:
        raise MissingError(f"there are no {what}")


def curve(case: xr.Dataset, method: str, quantity: str = "compliance") -> Array:
    """The values of a quantity over the loads by one method.

    Raises
    ------
    MissingError
        If the method has none.

    """
    values = curves.curve(case, quantity, method)
    if values is None:
        raise MissingError(f"{describe(case)} has no {quantity} by {method}")
    return values


def numerical(case: xr.Dataset, quantity: str = "compliance") -> Array:
    """The values by the most accurate method that solved the case.

    Raises
    ------
    MissingError
        If none did.

    """
    values = curves.numerical(case, quantity)
    if values is None:
        raise MissingError(f"{describe(case)} has no numerical solution")
    return values


def loads_of(case: xr.Dataset) -> Array:
    """The mean pressures, in p_0*."""
    values: Array = case["mean_pressure"].values
    return values


def total_of(case: xr.Dataset) -> float:
    """The compliance at full contact, sum g_n, in g_0."""
    return float(case["total_amplitude"])


def partial(case: xr.Dataset) -> Flags:
    """At which loads the contact is partial.

    Raises
    ------
    MissingError
        If at none.

    """
    found: Flags = numerical(case, "contact_fraction") < 1 - ROUNDING
    need(found.any(), "loads of partial contact")
    return found


def low_and_high(case: xr.Dataset) -> tuple[Flags, Flags]:
    """The loads on either side of half the compliance at full contact; in full contact all methods agree.

    Raises
    ------
    MissingError
        If there are none on one side.

    """
    low = numerical(case) <= HALF * total_of(case)
    high = ~low & partial(case)
    need(low.any() and high.any(), "loads on both sides of half the compliance at full contact")
    return low, high


def extreme(values: Array) -> float:
    """The value farthest from 0, with its sign."""
    return float(values[np.abs(values).argmax()])


def describe(case: xr.Dataset) -> str:
    """The profile of a case in words."""
    return curves.profile(case).describe()


def span(values: Array) -> str:
    """From the least value to the largest."""
    return f"{values.min():+.2g} to {values.max():+.2g}"


def percent(values: Array) -> str:
    """From the least value to the largest, in percent."""
    return f"{values.min():+.0%} to {values.max():+.0%}"


def listed(texts: Iterable[str]) -> str:
    """What is said of each case, of the first few if there are many."""
    texts = list(texts)
    more = len(texts) - MOST_CASES
    return "; ".join(texts[:MOST_CASES]) + (f"; and {more} more cases." if more > 0 else ".")
