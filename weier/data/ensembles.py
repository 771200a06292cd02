"""Means and percentiles of ensembles: cases that differ only in their phases, seed or file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from weier import units
from weier.data.curves import CONTACT_PRESSURE
from weier.data.variables import CASE, CURVE
from weier.kernels.arrays import Array, Flags, Indices
from weier.surface.profile import PARAMETERS

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

AVERAGED = ("compliance", "resistance", "contact_fraction", CONTACT_PRESSURE)
PERCENTILES = {"percentile_10": 0.1, "median": 0.5, "percentile_90": 0.9}  # suffixes of columns
FITTED = ("trace_fit_D", "trace_fit_g_0")  # parameters of the series fitted to a trace
CLOSE = 1e-9  # Relative tolerance for equal labels, so that a typed 0.1 matches a computed 0.1.
# By default a trace is cut off at two of its steps, whose last digits differ between files of one instrument.
CLOSE_CUTOFFS = 0.01
CUTOFF = "trace_shortest"
# Labels that may differ within an ensemble: phases, and properties of a file.
FILE_LABELS = ("trace", "trace_digest", "trace_length", "trace_height", "trace_filled")
SCALES = ("trace_length", "trace_height")  # lambda_0 and g_0 of a trace
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
    fitted = [name for name in FITTED if name in data.coords]
    labels = _labels(data)

    case, method, load = (axis.ravel() for axis in np.indices([data.sizes[dim] for dim in CURVE]))
    values: dict[str, Any] = {
        name: data[name].values.ravel() for name in (*averaged, *(f"{name}_error" for name in with_error))
    }
    values |= {name: data[name].values[case] for fit in fitted for name in (fit, f"{fit}_error")}
    values |= {"ensemble": _ensembles(labels)[case], "method": method, "load": load, "case": case}
    values["settings"] = data["settings"].values[case, method] if "settings" in data.data_vars else ""
    by = ["ensemble", "method", "load", "settings"]
    rows = pd.DataFrame(values | {"surface": _surfaces(data)[case]}).dropna(subset=averaged, how="all")
    rows = rows.drop_duplicates([*by, "surface"])
    grouped = rows.groupby(by)
    _check_pressures(data, rows, grouped["case"].transform("first").to_numpy())

    table = grouped["case"].agg(["first", "size"]).reset_index()
    columns: dict[str, Any] = {name: own[table["first"]] for name, own in labels.items()}
    columns["solution_method"] = data["solution_method"].values[table["method"]]
    columns["mean_pressure"] = data["mean_pressure"].values[table["load"]]
    if rows.groupby(["ensemble", "method"])["settings"].nunique().gt(1).any():
        columns["settings"] = table["settings"]
    columns["cases"] = table["size"]
    for name in (*averaged, *fitted):
        columns[f"{name}_mean"], columns[f"{name}_deviation"] = grouped[name].mean(), grouped[name].std()
        if name in averaged:
            columns |= {f"{name}_{suffix}": grouped[name].quantile(share) for suffix, share in PERCENTILES.items()}
        if name in with_error:
            columns[f"{name}_numerical_error"] = grouped[f"{name}_error"].max()
        if name in fitted:
            columns[f"{name}_standard_error"] = grouped[f"{name}_error"].mean()
    if "trace_fit_remark" in data.coords:
        remarks = rows.assign(remark=data["trace_fit_remark"].values.astype(str)[rows["case"]]).groupby(by)["remark"]
        columns["trace_fits"] = grouped[FITTED[0]].count()
        columns["trace_fit_remarks"] = remarks.agg(lambda own: "; ".join(filter(None, dict.fromkeys(own))))
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


def _ensembles(labels: Mapping[str, NDArray[Any]]) -> Indices:
    """Return the ensemble number of each case, in order of appearance."""
    import pandas as pd

    codes = pd.DataFrame(
        {
            name: _clusters(values, CLOSE_CUTOFFS if name == CUTOFF else CLOSE)
            if values.dtype.kind in "fiu"
            else pd.factorize(values)[0]
            for name, values in labels.items()
        }
    )
    return np.asarray(codes.groupby(list(codes), sort=False).ngroup())


def _clusters(values: Array, tolerance: float) -> Indices:
    """Return the cluster number of each value; a relative step above the tolerance starts a new one."""
    order = np.argsort(values)  # NaN sorts last
    ordered = values[order]
    step = ordered[1:] > ordered[:-1] + tolerance * np.abs(ordered[:-1])
    step |= np.isnan(ordered[1:]) & ~np.isnan(ordered[:-1])
    code = np.empty(values.size, int)
    code[order] = np.append(0, np.cumsum(step))
    return code


def _surfaces(data: xr.Dataset) -> Indices:
    """Return the surface number of each case; equal numbers mean the same surface."""
    import pandas as pd

    nothing = np.full(data.sizes[CASE], np.nan)
    phases = data["phases"].values + 0.0 if "phases" in data.coords else nothing[:, None]  # -0 becomes 0
    seeds = data["seed"].values if "seed" in data.coords else nothing
    digests = data["trace_digest"].values if "trace_digest" in data.coords else np.full(nothing.size, "")
    unknown: Flags = np.asarray(np.isnan(phases).all(axis=1))
    names = np.empty(nothing.size, object)
    for number, digest in enumerate(digests.tolist()):
        if digest:
            names[number] = digest
        elif not unknown[number]:
            names[number] = phases[number].tobytes()
        else:  # the infinite series of a seed; a case without any of these labels has a surface of its own
            names[number] = ("case", number) if np.isnan(seeds[number]) else float(seeds[number])
    return np.asarray(pd.factorize(names)[0])


def _check_pressures(data: xr.Dataset, rows: pd.DataFrame, first: Indices) -> None:
    """Refuse traces of an ensemble whose units of pressure differ; `first` is the first case of each row's ensemble.

    Random lines of one length and height have one unit.
    """
    pressure = data["mean_pressure"]
    if units.unit_of(pressure) not in (*units.WITHOUT, *units.NORMALISED) or "trace_height" not in data.coords:
        return
    case = rows["case"].to_numpy()
    scales = [data[name].values for name in SCALES if name in data.coords]
    if any((np.abs(scale[case] - scale[first]) > CLOSE * scale[first]).any() for scale in scales):
        raise ValueError(COMMON_PRESSURES)
