"""One profile, one method, many loads."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from time import perf_counter
from typing import Any

import numpy as np
import xarray as xr

from weier.data import dataset
from weier.kernels.arrays import Array
from weier.kernels.jit import COMPILING_SECONDS
from weier.methods.method import Method, unsolved
from weier.methods.settings import all_settings, checked_settings
from weier.theory.waves import Waves


def solve_curve(
    profile: Waves, loads: Array, method: Method, settings: Mapping[str, Any], contact_edges: bool = False
) -> xr.Dataset:
    """One curve with all that it depends on, as a dataset over mean_pressure; loads are checked already."""
    given = checked_settings(method, settings)
    solution, seconds = solve_checked(profile, loads, method, given)
    if why := unsolved(solution):
        warnings.warn(why, stacklevel=4)  # at the call of `weier.solve`
    values = {name: value for name, value in solution._asdict().items() if contact_edges or np.ndim(value) < 2}
    labels = profile.labels | {"phases": profile.listed_phases, "solution_method": method.name}
    return dataset.curve(loads, values | {"seconds": seconds}, labels, all_settings(method, given))


def solve_checked(profile: Waves, loads: Array, method: Method, settings: Mapping[str, Any]) -> tuple[Any, float]:
    """What `solve` holds, as the method's own tuple of arrays and scalars, and the seconds without compiling.

    Loads and names of settings are checked already.
    """
    method.check_applies(profile)
    start, compiling = perf_counter(), COMPILING_SECONDS.get()
    solution = method.solve(profile, loads, **settings)
    return solution, perf_counter() - start - (COMPILING_SECONDS.get() - compiling)
