"""One number for the error of a curve."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]


def worst_over_loads(data: xr.Dataset, quantity: str) -> Array:
    """Largest error over the loads, shape (case, method); that of R relative to the larger of itself and 1.

    NaN where not run. The resistance falls from some g_0/p_0* at light loads to 0 at full contact: an error
    relative to itself has no meaning at one end, one in g_0/p_0* little at the other.
    """
    error = data[f"{quantity}_error"].values
    if quantity == "resistance":
        exact = data["resistance"].sel({"method": data.attrs["reference_method"]}).values
        error = error / np.maximum(exact, 1)[:, None]
    return np.fmax.reduce(error, axis=-1)
