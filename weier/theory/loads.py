"""What a list of loads must be: anywhere, and in a scene or a command."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.theory.arguments import checked_number, checked_numbers

MAX_LOADS = 10_000  # of a scene or a command
LOAD_RANGE = 1e-12, 1e12  # p_0*


def checked_loads(mean_pressure: ArrayLike) -> Array:
    """The loads as an array, if they are positive, finite and increasing."""
    loads = np.atleast_1d(checked_numbers("mean_pressure", mean_pressure))
    if loads.ndim != 1 or loads.size == 0:
        raise ValueError(f"mean_pressure must be a list of loads, got an array of shape {loads.shape}")
    checked_numbers("mean_pressure", loads, "be finite", np.isfinite)
    checked_numbers("mean_pressure", loads, "be positive", lambda loads: loads > 0)
    step = np.diff(loads)
    if (step <= 0).any():
        at = int((step <= 0).argmax())
        wrong = f"{loads[at]} before {loads[at + 1]}: sort the loads"
        if step[at] == 0:
            wrong = f"{loads[at]} at positions {at} and {at + 1}: give each load once"
        raise ValueError(f"mean_pressure must increase, got {wrong}")
    return loads


def checked_load(mean_pressure: float, name: str = "mean_pressure") -> float:
    """The load, if there is only one and it is positive and finite."""
    return checked_number(name, mean_pressure, "be one load, positive and finite", lambda load: 0 < load < np.inf)


def check_range(loads: Array) -> None:
    """Refuse more loads than a scene may have, and loads so light or heavy that rounding leaves nothing of them."""
    if loads.size > MAX_LOADS:
        raise ValueError(f"there must be at most {MAX_LOADS} loads, got {loads.size}")
    low, high = LOAD_RANGE
    if loads[0] < low or loads[-1] > high:
        raise ValueError(f"loads must lie in [{low:g}, {high:g}] p_0*, got {loads[0]:g} to {loads[-1]:g}")
