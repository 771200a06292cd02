"""Means and percentiles of ensembles: cases that differ only in their phases, seed or file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from weier import units
from weier.data.curves import CONTACT_PRESSURE
from weier.data.variables import CASE, CURVE, LOADS
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
    averaged = [name for name in AVERAGED if name in data and data[name].dims == CURVE]
    errors = {name: f"{name}_error" for name in averaged if f"{name}_error" in data}
    cases = _cases(data)

    values = data if "settings" in data.data_vars else data.assign(settings="")
    values = values[[*averaged, *errors.values(), "settings"]].reset_coords(drop=True)
    rows = values.drop_vars(CASE, errors="ignore").to_dataframe(CURVE).reset_index()
    rows["position"] = rows.index % (data.sizes["solution_method"] * data.sizes[LOADS])  # of method and load
    rows = rows.dropna(subset=averaged, how="all").join(cases[["ensemble", "surface"]], on=CASE)
    by = ["ensemble", "position", "settings"]
    grouped = rows.drop_duplicates([*by, "surface"]).groupby(by)

    found = grouped[["solution_method", LOADS]].first()
    found["cases"] = grouped.size()
    for name in averaged:
        found[f"{name}_mean"], found[f"{name}_deviation"] = grouped[name].mean(), grouped[name].std()
        for suffix, share in PERCENTILES.items():
            found[f"{name}_{suffix}"] = grouped[name].quantile(share)
        if name in errors:
            found[f"{name}_numerical_error"] = grouped[errors[name]].max()
    found = found.reset_index()
    once = not found.duplicated(["ensemble", "position"]).any()
    labels = cases.drop(columns="surface").drop_duplicates("ensemble")
    found = labels.merge(found, on="ensemble").drop(columns=["ensemble", "position", *["settings"] * once])
    return found.dropna(axis="columns", how="all")


def _cases(data: xr.Dataset) -> pd.DataFrame:
    """Return the labels that divide cases into ensembles, the number of the ensemble and of the surface of each.

    A case of several studies occurs in each of them. m of a trace is a property of its file, and so are its length
    and height, which random lines of an ensemble have in common.
    """
    import pandas as pd

    known = pd.DataFrame({str(name): own.values for name, own in data.coords.items() if own.dims == (CASE,)})
    names = [name for name in known if name not in WITHIN]
    names.sort(key=lambda name: ("study", *PARAMETERS, name).index(name))
    cases = known[names].assign(m=known["m"].where(known["D"].notna()))
    if "trace_hurst" in cases:
        cases[SCALES] = known[SCALES].where(known["trace_hurst"].notna())
    codes = cases.apply(_clusters)
    cases["surface"] = known.get("surface_key", known.index)  # which single curves lack
    if "trace_digest" in known:
        cases["surface"] = known["trace_digest"].where(known["trace_digest"] != "", cases["surface"])
    if "study" in cases:
        cases["study"] = codes["study"] = cases["study"].str.split(", ")
        cases, codes = cases.explode("study"), codes.explode("study")
    cases["ensemble"] = codes.groupby(list(codes), sort=False).ngroup()
    if units.unit_of(data[LOADS]) in (*units.WITHOUT, *units.NORMALISED) and {*SCALES} <= {*known}:
        scales = known.loc[cases.index, SCALES].groupby(cases["ensemble"].to_numpy())
        if (scales.max() > (1 + CLOSE) * scales.min()).any(axis=None):
            raise ValueError(COMMON_PRESSURES)
    return cases


def _clusters(label: pd.Series) -> pd.Series:
    """Return the cluster of each value of a label: a relative step above the tolerance starts a new one."""
    if label.dtype.kind not in "fiu":
        return label.astype(str)
    ordered = label.fillna(np.inf).sort_values()
    below = ordered.shift()
    tolerance = CLOSE_CUTOFFS if label.name == CUTOFF else CLOSE
    return (ordered > below + tolerance * below.abs()).cumsum()
