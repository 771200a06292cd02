"""Datasets in memory, and functions that write them to netCDF-4 files and read them back.

A file holds `case` x `solution_method` x `mean_pressure`; the parameters of a case (D, gamma, m, phases) are
coordinates. `status` gives the reason where numbers are missing. Curves that may exceed memory are added one variable
at a time.

Deflate 4 instead of 1 saves 4 % and takes twice as long to write. Fletcher's checksum takes no time that could be
measured, and detects corruption on disk. Chunks are those of netCDF: chunks of one method took as much.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from weier.checks import checked_file, readable
from weier.data import provenance, variables
from weier.data.files import replacing
from weier.data.selection import as_cases, name_cases
from weier.data.si import marked
from weier.data.variables import COORDINATES, LOADS, RUN, VARIABLES
from weier.kernels.arrays import Array
from weier.units import NORMALISED_PRESSURE

PACKED: dict[str, Any] = {"zlib": True, "complevel": 1, "shuffle": True, "fletcher32": True}
# Variables over dimensions that no curve has are in a group, since a table of a whole file repeats each value over
# all dimensions. Readers without groups find the curves in the root.
GROUP, GROUPED = "details", ("edge", "claim")


def curve(
    loads: Array, values: Mapping[str, Any], labels: Mapping[str, Any], settings: Mapping[str, Any]
) -> xr.Dataset:
    """Return one curve over mean_pressure, with its labels as coordinates.

    Scalars among the values become attributes, and so do the settings: each by itself, and all of them as JSON.
    """
    scalars = {name: value for name, value in values.items() if np.ndim(value) == 0}
    terms = np.arange(len(labels["phases"]), dtype="i4")
    arrays = {**values, **labels, "term": terms, LOADS: loads}
    data = {
        name: (tuple(dim for dim in VARIABLES[name].dims if dim not in RUN), value, variables.attributes(name))
        for name, value in arrays.items()
        if name not in scalars
    }
    attributes = provenance.result_attributes() | {**settings, **scalars}
    attributes["settings"] = json.dumps(dict(settings), sort_keys=True)
    return marked(xr.Dataset(data, attrs=attributes).set_coords([*labels]))


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


def write(data: xr.Dataset, path: str | Path, title: str) -> None:
    """Write curves into a netCDF file atomically, with their title."""
    data = data.assign_attrs(provenance.attributes(title, "solved", in_si="mu_1" in data.attrs))
    with replacing(path) as temporary:
        write_file(data, temporary)


def write_file(data: xr.Dataset, path: Path) -> None:
    """Write a dataset into a new file."""
    grouped = [name for name, values in data.data_vars.items() if {*values.dims} & {*GROUPED}]
    details = data[grouped].reset_coords(drop=True).drop_attrs(deep=False)
    root = data.drop_vars(grouped).drop_dims(GROUPED, errors="ignore")
    root.to_netcdf(path, format="NETCDF4", engine="netcdf4", encoding=_encoding(root))
    if grouped:
        details.to_netcdf(path, "a", "NETCDF4", GROUP, "netcdf4", _encoding(details))


def _encoding(data: xr.Dataset) -> dict[Any, dict[str, Any]]:
    """Return the encoding of each variable; texts become characters, since netCDF does not compress strings."""
    found: dict[Any, dict[str, Any]] = {}
    for name, values in data.variables.items():
        is_text = values.dtype.kind in "UO"
        found[name] = (PACKED if is_text or values.ndim else {}) | ({"dtype": "S1"} if is_text else {})
        if name in data.coords:  # CF allows no missing values in coordinates
            found[name]["_FillValue"] = None
    return found


def append(values: xr.DataArray, path: Path, coordinates: Mapping[Any, xr.DataArray]) -> None:
    """Add a variable over cases to a file that has its coordinates."""
    data = values.drop_vars(values.coords).to_dataset()
    labels = sorted(str(name) for name, label in coordinates.items() if label.dims == values.dims[:1])
    data[values.name].attrs["coordinates"] = " ".join(labels)
    data.to_netcdf(path, "a", "NETCDF4", engine="netcdf4", encoding=_encoding(data))


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
    checked_file(path)
    try:
        tree = xr.open_datatree(path, engine="netcdf4", cache=False)
    except (PermissionError, TimeoutError):  # the file may be whole; the other is a time limit
        raise
    except (OSError, ValueError, RuntimeError, AttributeError, TypeError, KeyError) as error:  # attributes raise too
        raise ValueError(
            f"{readable(str(path))} is not a whole netCDF file ({error}): close it in a program that still writes "
            "it; if there is none, and weier made it, move it away and make it again"
        ) from None
    groups = [group.to_dataset(inherit=False) for group in tree.subtree]
    data = xr.merge(groups, join="exact", compat="override", combine_attrs="override")
    for variable in data.variables.values():  # without stored widths, shorter texts can be written
        for width in ("char_dim_name", "original_shape"):
            variable.encoding.pop(width, None)
    named = name_cases(as_cases(data))
    named.set_close(tree.close)  # The derived dataset would not close the file.
    return named
