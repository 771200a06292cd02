"""What the claims read from a case, and how they put numbers and cases into words."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import xarray as xr

from weier.kernels.arrays import Array, Flags
from weier.methods.registry import find_method
from weier.pipeline import curves

LOW_COMPLIANCE = 0.5  # of the compliance at full contact: low loads lie below, high loads above
ROUNDING = 1e-9  # a difference that rounding may make, of numbers close to 1
MAX_CASES_IN_WORDS = 4


class MissingError(ValueError):
    """The studies lack what a claim is about."""


def need(available: object, what: str) -> None:
    """Raise MissingError if something that a claim needs is not available."""
    if not available:
        raise MissingError(f"there are no {what}")


def curve(case: xr.Dataset, method: str, quantity: str = "compliance") -> Array:
    """The values of a quantity over the loads by one method; raises MissingError if the method has none."""
    values = curves.curve(case, quantity, method)
    if values is None:
        raise MissingError(f"{describe(case)} has no {quantity} by {label(method)}")
    return values


def numerical(case: xr.Dataset, quantity: str = "compliance") -> Array:
    """The values by the most accurate method that solved the case; raises MissingError if none did."""
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


def partial_contact(case: xr.Dataset) -> Flags:
    """At which loads the contact is partial; raises MissingError if at none."""
    partial: Flags = numerical(case, "contact_fraction") < 1 - ROUNDING
    need(partial.any(), "loads of partial contact")
    return partial


def low_and_high_loads(case: xr.Dataset) -> tuple[Flags, Flags]:
    """Which loads are low and which are high, but for full contact, where all methods agree.

    Raises MissingError if there are no loads on one side.
    """
    low = numerical(case) <= LOW_COMPLIANCE * total_of(case)
    high = ~low & partial_contact(case)
    need(low.any() and high.any(), "loads on both sides of half the compliance at full contact")
    return low, high


def farthest_from_zero(values: Array) -> float:
    """The value of the largest size, with its sign."""
    return float(values[np.abs(values).argmax()])


def label(method: str) -> str:
    """The name of a method for people."""
    return find_method(method).label


def describe(case: xr.Dataset) -> str:
    """The profile of a case in words."""
    return curves.profile(case).describe()


def value_range(values: Array) -> str:
    """The least and the largest value."""
    return f"{values.min():+.2g} to {values.max():+.2g}"


def percent_range(values: Array) -> str:
    """The least and the largest value, in percent."""
    return f"{values.min():+.0%} to {values.max():+.0%}"


def join(texts: Iterable[str]) -> str:
    """One sentence of what the text of each case says: only the first few cases if there are many."""
    texts = list(texts)
    more = len(texts) - MAX_CASES_IN_WORDS
    return "; ".join(texts[:MAX_CASES_IN_WORDS]) + (f"; and {more} more cases" if more > 0 else "") + "."
