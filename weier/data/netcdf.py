"""Datasets as netCDF-4 files, by xarray; curves that may exceed memory are added one variable at a time.

Chunks and compression are measured on 4800 cases of 4 methods at 40 loads, 61 MB of ten variables, uncompressed
read in 0.24 s: with chunks of one method and deflate 1 they take 9.2 MB, 0.40 s to write and 0.16 s to read. Chunks
of a megabyte hold 16 000 cases at 8 loads, of which docs/cluster.md has the seconds. Deflate 4 saves 4 % and takes
twice as long to write; a chunk a case takes 23 MB. Fletcher's checksum takes 4 bytes a chunk and no time that could
be measured, and detects corruption on disk.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from weier.checks import readable
from weier.data.variables import ancillary

if TYPE_CHECKING:
    import xarray as xr

CHUNK_BYTES = 2**20  # uncompressed size of a chunk: whole cases, one method
PACKED: dict[str, Any] = {"zlib": True, "complevel": 1, "shuffle": True, "fletcher32": True}
# Variables over dimensions that no curve has are in a group, since a table of a whole file repeats each value over
# all dimensions. Readers without groups find the curves in the root.
GROUP, GROUPED = "details", ("edge", "claim")


def write(data: xr.Dataset, path: Path) -> None:
    """Write a dataset into a new file."""
    data = data.copy()
    for name in data.data_vars:
        data[name].attrs |= ancillary(str(name), data.data_vars)
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
        if values.dtype.kind in "UO":
            found[name] = PACKED | {"dtype": "S1"}
        elif values.ndim:
            found[name] = PACKED | {"chunksizes": _chunks(values.dims, values.shape, values.dtype.itemsize)}
        else:
            found[name] = {}
        if name in data.coords:  # CF allows no missing values in coordinates
            found[name]["_FillValue"] = None
    return found


def _chunks(dims: Iterable[Any], shape: Iterable[int], itemsize: int) -> list[int]:
    """Return chunks of whole cases by one method."""
    dims = list(dims)
    chunk = [1 if dim == "solution_method" and len(dims) > 1 else size for dim, size in zip(dims, shape, strict=True)]
    if dims[0] == "case":
        chunk[0] = min(chunk[0], max(1, CHUNK_BYTES // (itemsize * int(np.prod(chunk[1:])))))
    return [max(1, size) for size in chunk]


def append(values: xr.DataArray, path: Path, coordinates: Mapping[Any, xr.DataArray]) -> None:
    """Add a variable over cases to a file that has its coordinates."""
    data = values.drop_vars(values.coords).to_dataset()
    labels = sorted(str(name) for name, label in coordinates.items() if label.dims == values.dims[:1])
    data[values.name].attrs["coordinates"] = " ".join(labels)
    data.to_netcdf(path, "a", "NETCDF4", engine="netcdf4", encoding=_encoding(data))


def unreadable_error(path: str | Path, error: Exception) -> Exception:
    """Return an error that explains why netCDF cannot open or read the file, since its own error does not."""
    if isinstance(error, TimeoutError):  # the caller's time limit, no fault of the file
        return error
    name = readable(str(path))
    if not os.access(path, os.R_OK):
        return PermissionError(f"{name} may be whole, but is closed to reading: open it for reading")
    return ValueError(
        f"{name} is not a whole netCDF file ({error}): close it in a program that still writes it; if there is none, "
        "and weier made it, delete it and make it again"
    )
