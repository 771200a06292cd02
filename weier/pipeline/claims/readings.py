"""What the claims read from a case, and how they name methods and cases."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.methods.registry import find_method
from weier.pipeline import curves

if TYPE_CHECKING:
    import xarray as xr

LOW_COMPLIANCE = 0.5  # of the compliance at full contact: low loads lie below, high loads above
ROUNDING = 1e-9  # a difference that rounding may make, of numbers close to 1


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


def between_compliances(case: xr.Dataset, values: Array, low: float, high: float) -> tuple[Array, Array]:
    """Loads, and values there, where the numerical compliance lies in a range, in parts of that at full contact.

    The ends of the range are interpolated, so that they do not depend on the spacing of the loads. A range up to
    full contact ends at the last load of partial contact, since all methods agree above. MissingError is raised if
    the loads do not reach across half of the range.
    """
    loads, relative = loads_of(case), numerical(case) / total_of(case)
    partial = partial_contact(case)
    loads, relative, values = loads[partial], relative[partial], values[partial]
    middle = (low + high) / 2
    need(relative[0] < middle < relative[-1], f"loads across {middle:.0%} of the compliance at full contact")
    ends = np.interp([low, high], relative, loads)
    inside = (loads > ends[0]) & (loads < ends[1])
    within = np.concatenate([ends[:1], loads[inside], ends[1:]])
    return within, np.interp(within, loads, values)


def mean_over_loads(loads: Array, values: Array) -> float:
    """The mean of the values over the load, by the trapezoidal rule."""
    return float(np.trapezoid(values, loads) / (loads[-1] - loads[0]))


def largest_size(values: Array) -> float:
    """The largest size of a value."""
    return float(np.abs(values).max())


def label(method: str) -> str:
    """The name of a method for people."""
    return find_method(method).label


def describe(case: xr.Dataset) -> str:
    """The profile of a case in words."""
    return curves.profile(case).describe()
