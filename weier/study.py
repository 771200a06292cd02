"""One study: its cases, gathered from the batches they were solved in, with bounds on what truncation left out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from weier.bounds import compliance_bounds, resistance_bounds

EXACT = ("bem", "patches")  # solve the truncated series itself, so that the bounds theorem applies to their curves


def gather(parts: Sequence[xr.Dataset], keys: Sequence[str]) -> xr.Dataset:
    """The cases with these keys, in this order, from datasets that hold them among others.

    Raises
    ------
    ValueError
        If a case is in none of them.

    """
    whole = xr.concat(parts, "case", data_vars="minimal", coords="minimal", compat="override", join="exact")
    position = {key: case for case, key in enumerate(whole["key"].values)}
    missing = [key for key in keys if key not in position]
    if missing:
        raise ValueError(f"{len(missing)} cases are in none of the files, the first with the key {missing[0]}")
    return whole.isel(case=[position[key] for key in keys])


def add_bounds(data: xr.Dataset) -> xr.Dataset:
    """Fill in the bounds on compliance and resistance of the endless series, for the methods that are exact."""
    data = data.copy(deep=True)
    exact = np.flatnonzero(np.isin(data["method"].values, EXACT))
    loads = data["mean_pressure"].values
    h = data["compliance"].values[:, exact]
    tail, first = (data[name].values[:, None] for name in ("tail_amplitude", "first_contact"))
    for quantity, (lower, upper) in (
        ("compliance", compliance_bounds(h, tail)),
        ("resistance", resistance_bounds(loads, h, tail, first)),
    ):
        data[f"{quantity}_lower"].values[:, exact] = lower
        data[f"{quantity}_upper"].values[:, exact] = upper
    return data
