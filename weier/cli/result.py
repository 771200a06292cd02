"""Output of `weier solve` and `weier plot`: JSON, comma-separated values or netCDF."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from weier import units
from weier.cli.bodies_file import table_of
from weier.data import dataset
from weier.data.files import write_text
from weier.data.provenance import NORMALISED
from weier.data.si import INTERFACE_ATTRIBUTES
from weier.data.variables import VARIABLES, Status
from weier.kernels.arrays import Array
from weier.methods.registry import find_method

# The numbers that describe a profile.
PROFILE = tuple(
    name
    for name, entry in VARIABLES.items()
    if entry.dims in (("case",), ("case", "term")) and entry.dtype == "f8" and not entry.optional
)
# Reason in words for each status of a missing curve.
WHY = {
    Status.not_applicable: "does not apply",
    Status.not_converged: "missed its tolerance",
}


def write(data: xr.Dataset, path: Path) -> None:
    """Write the curves as netCDF, or as JSON or CSV if the file name ends in .json or .csv."""
    if path.suffix in TEXTS:
        write_text(path, TEXTS[path.suffix](data) + "\n")
    else:
        dataset.write(data, path, data.attrs["title"], "solved", data.attrs["scene"])


def as_csv(data: xr.Dataset) -> str:
    """Return the curves as comma-separated values, one row for each method and load; missing values are empty."""
    return str(table_of(data).to_csv(index=False)).rstrip("\n")


def as_json(data: xr.Dataset) -> str:
    """Return the curves of one case as JSON, by method; null is a missing number or minus infinity."""
    case = data.isel(case=0)
    parameters = {name: _plain(case[name].values) for name in PROFILE}
    parameters |= {str(name): case[name].item() for name in case.coords if str(name).startswith("trace")}
    curves = {method: _curves(case, method) for method in case["solution_method"].values.tolist()}
    loads = case["mean_pressure"].values.tolist()
    measured = {name: values for name, values in data.items() if values.dtype.kind == "f"}
    own = {str(name): units.unit_of(values) or units.NONE for name, values in measured.items()}
    bodies = {name: data.attrs[name] for name in INTERFACE_ATTRIBUTES if name in data.attrs}
    header = {"title": data.attrs["title"]} | ({"interface": bodies} if bodies else {"normalisation": NORMALISED})
    header |= {"units": own, **parameters, "mean_pressure": loads}
    if "mean_pressure_error" in case:
        header["mean_pressure_error"] = _plain(case["mean_pressure_error"].values)
    return json.dumps(header | {"methods": curves}, indent=1, allow_nan=False)


def _curves(case: xr.Dataset, method: str) -> dict[str, Any]:
    """Return the variables of one method that have values; omit variables of the profile and of other methods."""
    run, returned = case.sel(solution_method=method), {*find_method(method).returns, "seconds"}
    own = {
        str(name): _plain(values.values)
        for name, values in run.items()
        if (name in returned or not VARIABLES[str(name)].optional) and values.notnull().any()
        if (name not in PROFILE if values.dtype.kind == "f" else name in returned)
    }
    return own | {"settings": json.loads(str(run["settings"].values))}


def _plain(values: Array) -> Any:
    """Return numbers and texts for JSON, which has no nan and no inf."""
    if values.dtype.kind in "UO":
        return values.tolist()
    plain = values.astype(object)
    plain[~np.isfinite(values)] = None
    plain[np.isposinf(values)] = "inf"
    return plain.tolist()


def check_solved(data: xr.Dataset) -> None:
    """Raise ValueError if a requested curve is missing."""
    methods = data["solution_method"].values.tolist()
    numbers = [pair for case in data["status"].values.tolist() for pair in zip(methods, case, strict=True)]
    missing = [f"{method} {WHY[Status(number)]}" for method, number in numbers if number != Status.solved]
    if missing:
        raise ValueError(
            f"{', '.join(dict.fromkeys(missing))}, for the reasons above; all other numbers were written"
        )


TEXTS = {".json": as_json, ".csv": as_csv}  # The text formats by the suffix of a file.
