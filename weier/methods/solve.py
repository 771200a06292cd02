"""One profile, one method, many loads."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from time import perf_counter
from typing import Any

import numpy as np
import xarray as xr

from weier.data import dataset
from weier.kernels.arrays import Array
from weier.kernels.interruption import interruptible
from weier.kernels.jit import compiling_seconds
from weier.kernels.loads_done import counted_as
from weier.methods.method import Method
from weier.methods.settings import all_settings, checked_settings
from weier.theory.phases import RandomPhases
from weier.theory.profile import Profile

MAX_PHASES_LISTED = 1000  # of random ones, which the seed gives as well


def solve_curve(
    profile: Profile, loads: Array, method: Method, settings: Mapping[str, Any], contact_edges: bool = False
) -> xr.Dataset:
    """One curve with all that it depends on, as a dataset over mean_pressure; loads are checked already."""
    given = checked_settings(method, settings)
    solution, seconds = solve_checked(profile, loads, method, given)
    values = {name: value for name, value in solution._asdict().items() if contact_edges or np.ndim(value) < 2}
    labels = describe_profile(profile) | {"solution_method": method.name}
    return dataset.curve(loads, values | {"seconds": seconds}, labels, all_settings(method, given))


def describe_profile(profile: Profile) -> dict[str, Any]:
    """What tells a profile from others, by the names of coordinates: the seed is NaN where there is none."""
    drawn = isinstance(profile.phases, RandomPhases)
    short = not drawn or profile.m <= MAX_PHASES_LISTED
    phases = profile.phase.tolist() if drawn and short else profile.phases if short else None
    return {
        "D": profile.D,
        "gamma": float(profile.gamma),
        "m": float(profile.m),
        "seed": float(profile.phases.seed) if isinstance(profile.phases, RandomPhases) else math.nan,
        "phases": json.dumps(phases),
    }


@interruptible
def solve_checked(profile: Profile, loads: Array, method: Method, settings: Mapping[str, Any]) -> tuple[Any, float]:
    """What `solve` holds, as the method's own tuple of arrays and scalars, and the seconds without compiling.

    Loads and names of settings are checked already.
    """
    method.applies(profile)
    start, compiling = perf_counter(), compiling_seconds()
    with counted_as(loads.size):  # some methods solve all loads at once
        solution = method.solve(profile, loads, **settings)
    return solution, perf_counter() - start - (compiling_seconds() - compiling)
