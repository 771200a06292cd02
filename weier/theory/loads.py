"""What a list of loads must be: anywhere, and in a scene or a command."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array

MAX_LOADS = 10_000  # of a scene or a command
LOAD_RANGE = 1e-12, 1e12  # p_0*


def checked_loads(mean_pressure: ArrayLike) -> Array:
    """The loads as an array, if they are positive, finite and increasing."""
    loads = np.atleast_1d(np.asarray(mean_pressure, float))
    if loads.ndim != 1 or loads.size == 0:
        raise ValueError(f"mean_pressure must be a list of loads, got an array of shape {loads.shape}")
    for wrong, what in ((~np.isfinite(loads), "finite"), (loads <= 0, "positive")):
        if wrong.any():
            raise ValueError(f"mean_pressure must be {what}, got {loads[wrong][0]} at position {wrong.argmax()}")
    falls = np.diff(loads) <= 0
    if falls.any():
        at = int(falls.argmax())
        raise ValueError(f"mean_pressure must increase, got {loads[at]} before {loads[at + 1]}: sort the loads")
    return loads


def checked_load(mean_pressure: float) -> float:
    """The load, if there is only one and it is positive and finite."""
    loads = checked_loads(mean_pressure)
    if loads.size != 1:
        raise ValueError(f"mean_pressure must be one load, got {loads.size}: ask for the fields of each by itself")
    return float(loads[0])


def check_range(loads: Array) -> None:
    """Refuse more loads than a scene may have, and loads so light or heavy that rounding leaves nothing of them."""
    if loads.size > MAX_LOADS:
        raise ValueError(f"there must be at most {MAX_LOADS} loads, got {loads.size}")
    low, high = LOAD_RANGE
    if loads[0] < low or loads[-1] > high:
        raise ValueError(f"loads must lie in [{low:g}, {high:g}] p_0*, got {loads[0]:g} to {loads[-1]:g}")
