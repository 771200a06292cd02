"""The texts of curves on the command line: JSON, and tables with units in their headings."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from weier import units
from weier.data.curves import CONTACT_PRESSURE
from weier.data.ensembles import PERCENTILES
from weier.data.provenance import NORMALISED
from weier.data.si import INTERFACE_ATTRIBUTES
from weier.data.variables import VARIABLES, Status
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES

if TYPE_CHECKING:
    import pandas as pd

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
# end of a column name that follows the name of a quantity
STATISTIC_SUFFIX = re.compile(f"_(mean|deviation|{'|'.join(PERCENTILES)}|numerical_error)$")


def as_json(data: xr.Dataset, title: str) -> str:
    """Return the curves of one case as JSON, by method; null is a missing number or minus infinity."""
    case = data.isel(case=0)
    header: dict[str, Any] = {"title": title, "normalisation": NORMALISED}
    if bodies := {name: data.attrs[name] for name in INTERFACE_ATTRIBUTES if name in data.attrs}:
        header = {"title": title, "interface": bodies}
    numbers = {str(name): values for name, values in data.items() if values.dtype.kind == "f"}
    header["units"] = {name: units.unit_of(values) or units.NONE for name, values in numbers.items()}
    header |= {name: _plain(case[name].values) for name in PROFILE}
    header |= {str(name): case[name].item() for name in case.coords if str(name).startswith("trace")}
    methods = {method: _curves(case, method) for method in case["solution_method"].values.tolist()}
    header |= {"mean_pressure": case["mean_pressure"].values.tolist(), "methods": methods}
    return json.dumps(header, indent=1, allow_nan=False)


def _curves(case: xr.Dataset, method: str) -> dict[str, Any]:
    """Return the variables of one method that have values."""
    run = case.sel(solution_method=method).drop_vars([*PROFILE, "status"], errors="ignore")
    known = {name: (values != "" if values.dtype.kind in "UO" else values.notnull()) for name, values in run.items()}
    own = {str(name): _plain(run[name].values) for name, filled in known.items() if filled.any()}
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


def table_of(data: xr.Dataset, ensemble: bool = False) -> pd.DataFrame:
    """Return the table of curves, or of their ensembles, with units in headings, and errors called numerical."""
    table = data.weier.ensemble() if ensemble else data.weier.table()
    table = table.rename(columns={f"{name}_error": f"{name}_numerical_error" for name in QUANTITIES})
    known = {str(name): units.unit_of(values) for name, values in data.variables.items()}
    known[CONTACT_PRESSURE] = known["mean_pressure"]
    named = {name: known.get(name) or known.get(STATISTIC_SUFFIX.sub("", name)) or units.NONE for name in table}
    headings = {name: f"{name} ({unit})" for name, unit in named.items() if unit not in units.WITHOUT}
    return table.rename(columns=headings)
