"""The error of a curve: load by load, and as one number."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]


def by_load(data: xr.Dataset, quantity: str) -> Array:
    """Errors, shape (case, method, mean_pressure); that of R relative to the larger of itself and 1. NaN if not run.

    The resistance falls from some g_0/p_0* at light loads to 0 at full contact: an error relative to itself has no
    meaning at one end, one in g_0/p_0* little at the other.
    """
    error = data[f"{quantity}_error"].values
    if quantity == "resistance":
        exact = data["resistance"].sel({"method": data.attrs["reference_method"]}).values
        error = error / np.maximum(exact, 1)[:, None]
    return np.asarray(error)


def worst_over_loads(data: xr.Dataset, quantity: str) -> Array:
    """The largest of them over the loads, shape (case, method)."""
    return np.fmax.reduce(by_load(data, quantity), axis=-1)
