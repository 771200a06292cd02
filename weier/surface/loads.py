"""Checks of loads: general ones, and narrower ones for scenes and commands."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from weier import units
from weier.checks import checked_number, checked_numbers
from weier.kernels.arrays import Array, Indices
from weier.surface.waves import Waves

MAX_PASCAL = 1e13  # Pa; exceeds any modulus
# Outside the range in p_0*, rounding leaves few digits of the compliance.
LOAD_RANGE = {units.NORMALISED_PRESSURE: (1e-12, 1e12), units.PASCAL: (0.0, MAX_PASCAL)}
SUSPECT_LOAD_RATIO = 100.0  # ratio to full contact above which loads are probably in Pa


def listed_loads(
    loads: ArrayLike, name: str = "mean_pressure", unit: str = units.NORMALISED_PRESSURE
) -> tuple[Array, Indices]:
    """Return the distinct loads in increasing order, and the position of each given load among them.

    ValueError is raised unless the loads, in any order, are positive and finite.
    """
    distinct, position = np.unique(positive_loads(loads, name, unit), return_inverse=True)
    return distinct, position


def positive_loads(loads: ArrayLike, name: str = "mean_pressure", unit: str = units.NORMALISED_PRESSURE) -> Array:
    """Return the loads as an array, if they are positive and finite, in the order given."""
    found = np.atleast_1d(checked_numbers(name, loads, unit=unit))
    if found.ndim != 1 or found.size == 0:
        raise ValueError(f"{name} must be a list of loads, got an array of shape {found.shape}")
    checked_numbers(name, found, "be finite", np.isfinite)
    checked_numbers(name, found, "be positive", lambda loads: loads > 0)
    return found


def checked_loads(mean_pressure: ArrayLike) -> Array:
    """Return the loads as an array, if they are positive, finite and increasing."""
    loads = positive_loads(mean_pressure)
    step = np.diff(loads)
    if (step <= 0).any():
        at = int((step <= 0).argmax())
        wrong = f"{loads[at]} before {loads[at + 1]}: sort the loads"
        if step[at] == 0:
            wrong = f"{loads[at]} at positions {at} and {at + 1}: give each load once"
        raise ValueError(f"mean_pressure must increase, got {wrong}")
    return loads


def checked_load(mean_pressure: float, name: str = "mean_pressure") -> float:
    """Return one load; ValueError unless it is positive and finite."""
    condition = "be one load, positive and finite"
    return checked_number(name, mean_pressure, condition, lambda load: 0 < load < np.inf, units.NORMALISED_PRESSURE)


def unit_doubt(profile: Waves, loads: Array, in_pascal: bool = False) -> str:
    """Return a warning if all loads, in p_0*, are far above full contact; otherwise empty.

    They may have been given in pascals, or, if they were meant to be, a value of the bodies may have a wrong unit.
    """
    if math.isinf(profile.m):
        return ""
    with np.errstate(over="ignore"):  # pressures of very long series overflow
        full = float(np.sum(profile.full_contact_pressure))  # upper bound on full contact
    if loads.min() <= SUSPECT_LOAD_RATIO * full or loads.max() > MAX_PASCAL:
        return ""
    remedy = "mean pressures are in p_0*, and weier.Interface converts them from and to Pa"
    if in_pascal:
        remedy = "is the unit right of the pressures, the moduli, or lambda_0 and g_0?"
    return (
        f"all loads lie far beyond full contact, which takes {full:.3g} p_0* at most, got {loads.min():.3g} p_0* and "
        f"more: {remedy}"
    )


def check_range(loads: Array, unit: str = units.NORMALISED_PRESSURE) -> None:
    """Refuse more loads than a scene may have, and loads outside of the range of their unit."""
    if loads.size > units.MAX_LISTED:
        raise ValueError(f"there must be at most {units.MAX_LISTED} loads, got {loads.size}")
    low, high = LOAD_RANGE[unit]
    if loads.min() < low or loads.max() > high:
        raise ValueError(f"loads must lie in [{low:g}, {high:g}] {unit}, got {loads.min():g} to {loads.max():g}")
