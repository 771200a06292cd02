"""Output of `weier solve` and `weier plot`: JSON, comma-separated values or netCDF."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd  # type: ignore[import-untyped]  # its stubs are a package more
import xarray as xr

from weier import units
from weier.cli.bodies import table_of
from weier.data import dataset
from weier.data.files import write_text
from weier.data.provenance import NORMALISED
from weier.data.variables import VARIABLES, Status
from weier.kernels.arrays import Array
from weier.methods.registry import find_method
from weier.pipeline import single
from weier.surface.profile import PARAMETERS
from weier.theory.conduction import BODIES

# The numbers that describe a profile.
PROFILE = tuple(
    name
    for name, entry in VARIABLES.items()
    if entry.dims in (("case",), ("case", "term")) and entry.dtype == "f8" and not entry.optional
)
# The reasons why a curve is missing, in words.
WHY = {
    Status.not_applicable: "does not apply",
    Status.not_converged: "missed its tolerance",
}


def write(data: xr.Dataset, path: Path) -> None:
    """Write the curves as netCDF or, where the name ends in .json or .csv, as such a text."""
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
    bodies = {name: data.attrs[name] for name in (*BODIES, "lambda_0", "g_0") if name in data.attrs}
    header = {"title": data.attrs["title"]} | ({"interface": bodies} if bodies else {"normalisation": NORMALISED})
    header |= {"units": own, **parameters, "mean_pressure": loads}
    if "mean_pressure_error" in case:
        header["mean_pressure_error"] = _plain(case["mean_pressure_error"].values)
    return json.dumps(header | {"methods": curves}, indent=1, allow_nan=False)


def _curves(case: xr.Dataset, method: str) -> dict[str, Any]:
    """Return the variables of one method that have values, without those of the profile and other methods."""
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


def check_same_profile(path: Path, profile: Mapping[str, Any]) -> None:
    """Refuse to overwrite a file that is not of this profile."""
    if not path.exists():
        return
    surface = single.surface_of(profile)
    labels = surface.labels
    own = {
        "phases": np.asarray(surface.listed_phases, float).tolist(),
        "trace_digest": labels.get("trace_digest", ""),
    }
    own |= {name: labels[name] for name in PARAMETERS}
    try:
        found = _labels_of(path)
    except Exception:  # a file of anything
        found = {}
    if any(not _alike(own[name], found.get(name)) for name in own):
        raise ValueError(f"{path} exists and is not of this profile: name another file, or overwrite it by --force")


def _labels_of(path: Path) -> dict[str, Any]:
    """Return what identifies the profile of a file that `write` wrote."""
    if path.suffix == ".json":
        found = json.loads(path.read_text(encoding="utf-8"))
        return found | {"m": math.inf if found["m"] == "inf" else found["m"]}
    if path.suffix == ".csv":
        row = {heading.partition(" (")[0]: value for heading, value in pd.read_csv(path).iloc[0].items()}
    else:
        with dataset.reading(path) as data:
            row = data.weier.table().iloc[0].to_dict()
    return row | {"phases": json.loads(row["phases"])}


def _alike(own: Any, other: Any) -> bool:
    """Return whether two labels are equal; texts keep fewer digits, and missing ones are NaN, None or empty."""
    if isinstance(own, list):
        known = [value for value in own if math.isfinite(value)]
        found = [value for value in other if value is not None] if isinstance(other, list) else None
        return found is not None and len(known) == len(found) and np.allclose(known, found)
    if isinstance(own, str) or other is None or isinstance(other, str):
        missing = own == "" or own != own
        return own == other or (missing and (other is None or other != other))
    return bool(np.isclose(own, other, equal_nan=True))


def check_solved(data: xr.Dataset) -> None:
    """Raise ValueError if a requested curve is missing."""
    numbers = zip(data["solution_method"].values.tolist(), data["status"].values[0].tolist(), strict=True)
    missing = [f"{method} {WHY[Status(number)]}" for method, number in numbers if number != Status.solved]
    if missing:
        raise ValueError(f"{', '.join(missing)}, for the reasons above; all other numbers were written")


TEXTS = {".json": as_json, ".csv": as_csv}  # The text formats by the suffix of a file.
