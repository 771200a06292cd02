"""What a measured trade says: errors load by load and at worst, seconds, and who is worth them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from weier.kernels.arrays import Array


def by_load(data: xr.Dataset, quantity: str) -> Array:
    """Errors, shape (case, method, mean_pressure); that of R relative to the larger of itself and 1. NaN if not run.

    The resistance falls from some g_0/p_0* at light loads to 0 at full contact: an error relative to itself has no
    meaning at one end, one in g_0/p_0* little at the other.
    """
    error = data[f"{quantity}_error"].values
    if quantity == "resistance":
        exact = data["resistance"].sel(solution_method=data.attrs["reference_method"]).values
        error = error / np.maximum(exact, 1)[:, None]
    return np.asarray(error)


def worst_over_loads(data: xr.Dataset, quantity: str) -> Array:
    """The largest of them over the loads, shape (case, method)."""
    return np.fmax.reduce(by_load(data, quantity), axis=-1)


def seconds_per_load(data: xr.Dataset) -> Array:
    """Seconds a load of each case and contender, shape (case, method)."""
    return np.asarray(data["seconds"].values / data.sizes["mean_pressure"])


def pareto(cost: Array, error: Array) -> list[int]:
    """Which are worth their cost: no other is both cheaper and more accurate; by rising cost. NaN never is."""
    front: list[int] = []
    for number in np.lexsort((error, cost)):
        if np.isfinite(cost[number] + error[number]) and (not front or error[number] < error[front[-1]]):
            front.append(int(number))
    return front


def typical(values: Array) -> Array:
    """Median over the cases, shape (method,), of what was run on all of them; NaN for the others."""
    return np.asarray(np.median(values, axis=0))  # NaN if one is
