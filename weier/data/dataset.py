"""Datasets in memory, and functions that write them to files and read them back.

A file holds `case` x `solution_method` x `mean_pressure`; the parameters of a case (D, gamma, m, phases) are
coordinates. `status` gives the reason where numbers are missing.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from weier.checks import checked_file
from weier.data import netcdf, provenance, variables
from weier.data.files import replacing
from weier.data.selection import NEEDED, as_cases, name_cases
from weier.data.si import marked
from weier.data.variables import COORDINATES, RUN, VARIABLES
from weier.kernels.arrays import Array
from weier.units import NORMALISED_PRESSURE


def curve(
    loads: Array, values: Mapping[str, Any], labels: Mapping[str, Any], settings: Mapping[str, Any]
) -> xr.Dataset:
    """Return one curve over mean_pressure, with its labels as coordinates.

    Scalars among the values become attributes, and so do the settings: each by itself, and all of them as JSON.
    """
    arrays = {name: value for name, value in values.items() if np.ndim(value) > 0}
    scalars = {name: value for name, value in values.items() if np.ndim(value) == 0}
    data: dict[str, Any] = {
        name: (_over_loads(name), value, variables.attributes(name) | variables.ancillary(name, arrays))
        for name, value in arrays.items()
    }
    coordinates: dict[str, Any] = {
        name: (("term",) * np.ndim(value), value, variables.attributes(name)) for name, value in labels.items()
    }
    coordinates["term"] = ("term", np.arange(len(labels["phases"]), dtype="i4"), variables.attributes("term"))
    coordinates["mean_pressure"] = ("mean_pressure", loads, variables.attributes("mean_pressure"))
    # netCDF has no booleans.
    plain = {
        name: json.dumps(value) if isinstance(value, bool) else value
        for name, value in {**settings, **scalars}.items()
    }
    plain["settings"] = json.dumps(dict(settings), sort_keys=True)
    return marked(xr.Dataset(data, coordinates, provenance.result_attributes() | plain))


def blank(
    cases: int,
    methods: Sequence[str],
    loads: Array,
    terms: int,
    edges: int = 0,
    returned: Collection[str] = (),
    unit: str = NORMALISED_PRESSURE,
) -> xr.Dataset:
    """Return an empty dataset of all variables, for these numbers of cases, terms and contact edges.

    It has those optional variables whose names the methods return. `unit` is that of the loads, p_0* or Pa.
    """
    dims = "case", "solution_method", "mean_pressure", "term", "edge"
    sizes = dict(zip(dims, (cases, len(methods), loads.size, terms, edges), strict=True))
    names = variables.curve_variables(returned, edges > 0)
    values = {name: variables.blank(name, [sizes[dim] for dim in VARIABLES[name].dims]) for name in names}
    return over_cases(values, methods, loads, unit)


def over_cases(values: Mapping[str, Any], methods: Sequence[str], loads: Array, unit: str) -> xr.Dataset:
    """Return variables of the table as a dataset over cases, methods and loads, in p_0* or Pa."""
    data = xr.Dataset({name: (VARIABLES[name].dims, own, variables.attributes(name)) for name, own in values.items()})
    data = data.set_coords([name for name in values if name in COORDINATES])
    data = data.assign_coords(
        solution_method=("solution_method", list(methods), variables.attributes("solution_method")),
        mean_pressure=("mean_pressure", loads, variables.attributes("mean_pressure", unit=unit)),
        term=("term", np.arange(data.sizes["term"], dtype="i4"), variables.attributes("term")),
    )
    return marked(data)


def write(data: xr.Dataset, path: str | Path, title: str, step: str = "written", scene: str = "") -> None:
    """Write a netCDF file atomically, with its title, the step that made the data and the text of its scene."""
    data = data.assign_attrs(provenance.attributes(title, step, scene, in_si="mu_1" in data.attrs))
    with replacing(path) as temporary:
        netcdf.write(data, temporary)


def read(path: str | Path) -> xr.Dataset:
    """Read a netCDF file of weier into memory; ValueError if it is truncated or was not written by weier."""
    with open_lazily(path) as data:
        try:
            return data.load()
        except RuntimeError as error:  # netCDF reports a wrong checksum as an HDF error
            raise netcdf.unreadable_error(path, error) from None


def open_lazily(path: str | Path) -> xr.Dataset:
    """Return a netCDF file of weier, opened lazily: its values are read on access."""
    checked_file(path)
    try:
        parts = xr.open_groups(path, engine="netcdf4", cache=False)
    except (OSError, ValueError, RuntimeError, AttributeError, TypeError, KeyError) as error:  # attributes raise too
        raise netcdf.unreadable_error(path, error) from None

    def close() -> None:
        for part in parts.values():
            part.close()

    data = xr.merge([*parts.values()], join="exact", compat="override", combine_attrs="override")
    data.set_close(close)
    if "key" not in data.variables and data.attrs.get("program") != provenance.FIXED["program"]:
        data.close()
        raise ValueError(f"{path} is a netCDF file, but not of weier: move it away and make yours again")
    for variable in data.variables.values():  # without stored widths, shorter texts can be written
        for width in ("char_dim_name", "original_shape"):
            variable.encoding.pop(width, None)
    return data


def open_dataset(path: str | Path) -> xr.Dataset:
    """Open a netCDF file of the pipeline or of a result of `weier.solve`; values are read on access.

    Parameters
    ----------
    path : path
        Such as results/paper/contact.nc.

    Returns
    -------
    Dataset
        Over case, solution_method and mean_pressure. The coordinate `case` has a name per case, such as
        "smooth: D = 1.25, gamma = 5, m = 3, phases = 1"; the accessor `weier.cases` selects cases by D, gamma, m,
        seed or study. Close it with `close` or a `with` statement.

    Raises
    ------
    FileNotFoundError
        If the file does not exist.
    ValueError
        If it is truncated or was not written by weier.

    Examples
    --------
    >>> import weier
    >>> with weier.open_dataset(path) as data:
    ...     curve = data.weier.cases(D=1.25, m=2).compliance.sel(solution_method="demelio")
    ...     print(curve.sel(mean_pressure=0.09, method="nearest").values.round(4))
    [0.4044]
    """
    data = open_lazily(path)
    if not set(NEEDED) <= data.variables.keys():  # the file has no curves
        return data
    try:
        named = name_cases(as_cases(data))
    except BaseException:
        data.close()
        raise
    named.set_close(data.close)  # The derived dataset would not close the file.
    return named


def _over_loads(name: str) -> tuple[str, ...]:
    return tuple(dim for dim in VARIABLES[name].dims if dim not in RUN)
