"""Means and percentiles of ensembles: cases that differ only in their phases, seed or file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from weier import units
from weier.data.curves import CONTACT_PRESSURE
from weier.data.variables import CASE, CURVE
from weier.kernels.arrays import Indices
from weier.surface.profile import PARAMETERS

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

AVERAGED = ("compliance", "resistance", "contact_fraction", CONTACT_PRESSURE)
PERCENTILES = {"percentile_10": 0.1, "median": 0.5, "percentile_90": 0.9}  # suffixes of columns
CLOSE = 1e-9  # Relative tolerance for equal labels, so that a typed 0.1 matches a computed 0.1.
# By default a trace is cut off at two of its steps, whose last digits differ between files of one instrument.
CLOSE_CUTOFFS = 0.01
CUTOFF = "trace_shortest"
# Labels that may differ within an ensemble: phases, and properties of a file.
FILE_LABELS = ("trace", "trace_digest", "trace_length", "trace_height", "trace_filled")
SCALES = ["trace_length", "trace_height"]  # lambda_0 and g_0 of a trace
WITHIN = ("case", "key", "surface_key", "seed", *FILE_LABELS)
COMMON_PRESSURES = (
    "an ensemble must have common pressures, and each trace has its own unit of pressure: solve the traces by "
    "weier.Interface(...).solve([trace, ...], pressures in Pa)"
)


def means(data: xr.Dataset) -> pd.DataFrame:
    """Return mean and median curves of the result of `as_cases`: one row per ensemble, method and load.

    ValueError is raised if the cases of an ensemble have no common pressures.
    """
    import pandas as pd

    data = _by_study(data)
    averaged = [name for name in AVERAGED if name in data and data[name].dims == CURVE]
    with_error = [name for name in averaged if f"{name}_error" in data]
    labels = _labels(data)
    ensembles = _ensembles(labels)
    _check_pressures(data, ensembles)

    case, method, load = (axis.ravel() for axis in np.indices([data.sizes[dim] for dim in CURVE]))
    rows = pd.DataFrame({"ensemble": ensembles[case], "method": method, "load": load, "case": case})
    rows["settings"] = data["settings"].values[case, method] if "settings" in data.data_vars else ""
    for name in (*averaged, *(f"{name}_error" for name in with_error)):
        rows[name] = data[name].values.ravel()
    by = ["ensemble", "method", "load", "settings"]
    rows = rows.assign(surface=_surfaces(data)[case]).dropna(subset=averaged, how="all")
    rows = rows.drop_duplicates([*by, "surface"])
    grouped = rows.groupby(by)

    table = grouped["case"].agg(["first", "size"]).reset_index()
    columns: dict[str, Any] = {name: own[table["first"]] for name, own in labels.items()}
    columns["solution_method"] = data["solution_method"].values[table["method"]]
    columns["mean_pressure"] = data["mean_pressure"].values[table["load"]]
    if rows.groupby(["ensemble", "method"])["settings"].nunique().gt(1).any():
        columns["settings"] = table["settings"]
    columns["cases"] = table["size"]
    for name in averaged:
        columns[f"{name}_mean"], columns[f"{name}_deviation"] = grouped[name].mean(), grouped[name].std()
        columns |= {f"{name}_{suffix}": grouped[name].quantile(share) for suffix, share in PERCENTILES.items()}
        if name in with_error:
            columns[f"{name}_numerical_error"] = grouped[f"{name}_error"].max()
    found = pd.DataFrame({name: np.asarray(own) for name, own in columns.items()})
    return found.dropna(axis="columns", how="all")


def _by_study(data: xr.Dataset) -> xr.Dataset:
    """Return the cases with one study each: a case of several studies occurs in each of them."""
    if "study" not in data.coords:
        return data
    pairs = [(case, name) for case, names in enumerate(data["study"].values) for name in str(names).split(", ")]
    cases, studies = zip(*pairs, strict=True)
    return data.isel({CASE: list(cases)}).assign_coords(study=(CASE, np.array(studies, object)))


def _labels(data: xr.Dataset) -> dict[str, NDArray[Any]]:
    """Return the labels that the cases of an ensemble have in common; m of a trace is a property of its file.

    Random lines of an ensemble also have the same length and height.
    """
    names = [str(name) for name in data.coords if data[name].dims == (CASE,)]
    names = [name for name in names if name not in WITHIN and not name.startswith("trace_fit_")]
    names.sort(key=lambda name: ("study", *PARAMETERS, name).index(name))
    labels = {name: data[name].values for name in names}
    if "trace_hurst" in labels:
        random = np.isfinite(labels["trace_hurst"])
        labels |= {name: np.where(random, data[name].values, np.nan) for name in SCALES if name in data.coords}
    return labels | {"m": np.where(np.isnan(labels["D"]), np.nan, labels["m"])}


def _ensembles(labels: dict[str, NDArray[Any]]) -> Indices:
    """Return the ensemble number of each case, in order of appearance."""
    import pandas as pd

    codes = pd.DataFrame({name: _clusters(name, values) for name, values in labels.items()})
    return np.asarray(codes.groupby(list(codes), sort=False).ngroup())


def _clusters(name: str, values: NDArray[Any]) -> Indices:
    """Return the cluster number of each value of a label: a relative step above the tolerance starts a new one."""
    if values.dtype.kind not in "fiu":
        return np.unique(values.astype(str), return_inverse=True)[1]
    known = np.where(np.isnan(values), np.inf, values)
    order = np.argsort(known)
    above = known[order] + (CLOSE_CUTOFFS if name == CUTOFF else CLOSE) * np.abs(known[order])
    code = np.empty(values.size, int)
    code[order] = np.append(0, np.cumsum(known[order][1:] > above[:-1]))
    return code


def _surfaces(data: xr.Dataset) -> NDArray[Any]:
    """Return what tells surfaces apart: the digest of a trace, or a key, which single curves lack."""
    found = data["surface_key"].values if "surface_key" in data.coords else range(data.sizes[CASE])
    digests = data["trace_digest"].values if "trace_digest" in data.coords else ""
    return np.where(np.asarray(digests, str) == "", np.asarray(found, str), digests)


def _check_pressures(data: xr.Dataset, ensembles: Indices) -> None:
    """Refuse traces of an ensemble whose units of pressure differ; random lines of one length and height have one."""
    normalised = units.unit_of(data["mean_pressure"]) in (*units.WITHOUT, *units.NORMALISED)
    if normalised and {*SCALES} <= {*data.coords}:
        scales = data.reset_coords()[SCALES].to_dataframe()[SCALES].groupby(ensembles)
        if (scales.max() > (1 + CLOSE) * scales.min()).any(axis=None):
            raise ValueError(COMMON_PRESSURES)
