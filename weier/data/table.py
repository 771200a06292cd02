"""Curves as a table: one row for each case, method and load, for spreadsheets and statistics."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from weier.data.dataset import Status, as_cases
from weier.data.variables import CURVE
from weier.kernels.arrays import Array

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]


def as_table(data: xr.Dataset) -> pd.DataFrame:
    """The curves of a dataset, one row for each case, method and load that was solved.

    Parameters
    ----------
    data : Dataset
        As `weier.solve` returns it, or `data` of `weier.open`.

    Returns
    -------
    DataFrame
        The labels of the case, `solution_method` and `mean_pressure` first, then all quantities that have a value.
    """
    data = as_cases(data)
    phases = [json.dumps(row[np.isfinite(row)].tolist()) for row in data["phase"].values]
    curves = data[[name for name, values in data.data_vars.items() if values.dims == CURVE]]
    frame = curves.assign_coords(phases=("case", phases)).to_dataframe(dim_order=CURVE).reset_index()
    labels = [name for name, values in data.coords.items() if values.dims == ("case",)]
    first = [*labels, "phases", *CURVE[1:]]
    others = [name for name in frame if name not in ("case", *first)]
    frame = frame[_solved(data)][first + others]
    return frame.dropna(axis="columns", how="all").reset_index(drop=True)


def _solved(data: xr.Dataset) -> Array:
    """Whether there is a curve, for each row of the table."""
    if "status" not in data:
        return np.ones(int(np.prod([data.sizes[dim] for dim in CURVE])), bool)
    return np.repeat((data["status"].transpose(*CURVE[:2]).values == Status.solved).ravel(), data.sizes[CURVE[2]])
