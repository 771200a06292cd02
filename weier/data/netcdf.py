"""Datasets as netCDF-4 files, created first and filled one variable at a time, so that it may exceed memory.

Chunks and compression are measured on 4800 cases of 4 methods at 40 loads, 61 MB of ten variables, uncompressed
read in 0.24 s: with chunks of one method and deflate 1 they take 9.2 MB, 0.40 s to write and 0.16 s to read. Chunks
of a megabyte hold 16 000 cases at 8 loads, of which docs/cluster.md has the seconds. Deflate 4 saves 4 % and takes
twice as long to write; a chunk a case takes 23 MB. Fletcher's checksum takes 4 bytes a chunk and no time that could
be measured, and detects corruption on disk. A variable takes 4 to 6 kB by itself, which is most of a file of one
case: 3 for the index of its chunks, 1 for its header, and 2 where it has more than six attributes. One without
values has no chunks, and so no index.
"""

from __future__ import annotations

from collections.abc import Container, Hashable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import netCDF4
import numpy as np
from numpy.typing import NDArray

from weier.data.provenance import FIXED
from weier.data.variables import ancillary

if TYPE_CHECKING:
    import xarray as xr

CHUNK_BYTES = 2**20  # of whole cases by one method, before compression
CACHE_BYTES = 2**22  # For each variable. The default of the library, 16 MB, would dominate the memory.
REMAKE = "delete it and make it again"
# Variables over dimensions that no curve has are in a group, since a table of a whole file repeats each value over
# all dimensions. Readers without groups find the curves in the root.
GROUP, GROUPED = "details", ("edge", "claim")


def create(file: netCDF4.Dataset, like: xr.Dataset, sizes: Mapping[str, int], widths: Mapping[str, int]) -> None:
    """Give an empty file the dimensions, variables and attributes of a dataset, without values.

    Parameters
    ----------
    file : netCDF4.Dataset
        Open for writing.
    like : Dataset
        Dataset with the dimensions, variables and attributes of the file.
    sizes : mapping of int
        Sizes of dimensions that are to be larger than in `like`, such as all cases.
    widths : mapping of int
        Bytes of each variable of text: see `text_widths`.
    """
    for dim, size in {**{str(dim): size for dim, size in like.sizes.items()}, **sizes}.items():
        _group(file, [dim]).createDimension(dim, size)
    for name, values in like.variables.items():
        _create_variable(file, str(name), values, str(name) in like.coords, widths)
    _relate_coordinates(file, like)
    for name in like.data_vars:
        _stored_as(file, str(name), like[name]).setncatts(ancillary(str(name), like.data_vars))
    file.setncatts(like.attrs)


def fill(file: netCDF4.Dataset, data: xr.Dataset) -> None:
    """Write the values of a dataset into a file made by `create`."""
    for name, values in data.variables.items():
        stored = _stored_as(file, str(name), values)
        if not _missing(stored, values.values):
            stored[...] = _encoded_for(stored, values.values)


def fill_column(file: netCDF4.Dataset, name: str, column: int, values: NDArray[Any]) -> None:
    """Write the values of a variable of curves by one method into a file made by `create`."""
    stored = file[name]
    if not _missing(stored, values):
        stored[:, column] = _encoded_for(stored, values)


def check_whole(path: str | Path) -> None:
    """Refuse a file that is missing, truncated or not of weier; its values are not read."""
    try:
        with netCDF4.Dataset(path) as file:
            names, program = list(file.variables), getattr(file, "program", "")
    except (OSError, RuntimeError) as error:
        raise damaged_error(path, error) from None
    check_origin(path, names, program)


def check_origin(path: str | Path, names: Container[object], program: str) -> None:
    """Refuse a file of these variables and this program that is not of weier."""
    if "key" not in names and program != FIXED["program"]:
        raise ValueError(f"{path} is a netCDF file, but not of weier: move it away and make yours again")


def damaged_error(path: str | Path, error: Exception) -> Exception:
    """Return the error for a file that cannot be opened; only an incomplete one that was read is damaged."""
    if isinstance(error, TimeoutError):  # of a program with a time limit, which says nothing about the file
        return error
    if not str(path).isprintable() or not Path(path).is_file():
        return FileNotFoundError(f"there is no file {path if str(path).isprintable() else repr(path)}: make it first")
    try:
        with Path(path).open("rb") as file:
            if _is_locked(file):
                return OSError(f"{path} is locked by another process, which writes it: close it there")
    except OSError as why:
        return _unreadable(path, why)
    return ValueError(f"{path} is not a whole netCDF file: if weier made it, {REMAKE} ({error})")


def _unreadable(path: str | Path, error: OSError) -> OSError:
    if isinstance(error, FileNotFoundError):
        return FileNotFoundError(f"there is no file {path}: make it first")
    if isinstance(error, TimeoutError):
        return error
    return OSError(f"{path} cannot be opened ({error.strerror}), and may be whole: open it for reading")


def _is_locked(file: BinaryIO) -> bool:
    """Return whether another process holds the lock that HDF5 takes on files that it writes."""
    try:
        import fcntl  # which Windows does not have
    except ImportError:
        return False
    try:
        fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:  # of a disk without locks
        return False
    return False


def text_widths(data: xr.Dataset) -> dict[str, int]:
    """Return the bytes of the longest text in each variable of text, which xarray writes again without a warning."""
    texts = {str(name): values for name, values in data.variables.items() if values.dtype.kind in "UO"}
    return {name: max(1, _encoded(values.values).itemsize) for name, values in texts.items()}


def _group(file: netCDF4.Dataset, dims: Iterable[Hashable]) -> netCDF4.Dataset | netCDF4.Group:
    """Return the group of the variables over some dimensions, or the file itself."""
    return file.createGroup(GROUP) if _grouped(dims) else file


def _grouped(dims: Iterable[Hashable]) -> bool:
    return any(dim in GROUPED for dim in dims)


def _stored_as(file: netCDF4.Dataset, name: str, values: xr.Variable | xr.DataArray) -> netCDF4.Variable[Any]:
    """Return a variable of the file, in its group."""
    return _group(file, values.dims)[name]


def _create_variable(
    file: netCDF4.Dataset, name: str, values: xr.Variable, coordinate: bool, widths: Mapping[str, int]
) -> None:
    text = values.dtype.kind in "UO"
    dims = [str(dim) for dim in values.dims]
    group = _group(file, dims)
    if text:
        # Characters, not netCDF strings: those are not compressed, and no coordinate of CF.
        dims.append(f"string{widths[name]}")
        if dims[-1] not in group.dimensions:
            group.createDimension(dims[-1], widths[name])
    dtype: Any = "S1" if text else "i1" if values.dtype.kind == "b" else values.dtype
    sizes = {**file.dimensions, **group.dimensions}
    shape = [sizes[dim].size for dim in dims]
    missing = np.nan if values.dtype.kind == "f" and not coordinate else None
    made = group.createVariable(
        name,
        dtype,
        dims,
        fill_value=missing,
        shuffle=True,
        complevel=1,  # Higher levels take twice as long to write, as measured above.
        zlib=True,
        fletcher32=True,
        chunksizes=_chunks(dims, shape, np.dtype(dtype).itemsize),
        chunk_cache=CACHE_BYTES,
    )
    made.setncatts(values.attrs | ({"_Encoding": "utf-8"} if text else {}))


def _chunks(dims: list[str], shape: list[int], itemsize: int) -> list[int]:
    chunk = [1 if dim == "solution_method" and len(dims) > 1 else size for dim, size in zip(dims, shape, strict=True)]
    if dims[0] == "case":
        row = itemsize * int(np.prod(chunk[1:]))
        chunk[0] = min(shape[0], max(1, CHUNK_BYTES // row))
    return chunk


def _relate_coordinates(file: netCDF4.Dataset, data: xr.Dataset) -> None:
    """Write the attribute `coordinates` of variables as in CF, and that of the file for the others as in xarray."""
    auxiliary = sorted(str(name) for name in data.coords if name not in data.dims)
    related = set()
    for name, values in data.data_vars.items():
        mine = [other for other in auxiliary if set(data[other].dims) <= set(values.dims)]
        if mine and not _grouped(values.dims):
            file[str(name)].coordinates = " ".join(mine)
        related.update(mine)
    alone = [name for name in auxiliary if name not in related]
    if alone:
        file.coordinates = " ".join(alone)


def _missing(stored: netCDF4.Variable[Any], values: NDArray[Any]) -> bool:
    """Return whether all values are the fill value, so that nothing has to be written."""
    return "_FillValue" in stored.ncattrs() and bool(np.isnan(values).all())


def _encoded_for(stored: netCDF4.Variable[Any], values: NDArray[Any]) -> NDArray[Any]:
    """Return the values as stored in the file: texts are characters along a dimension of their own."""
    if values.dtype.kind not in "UO":
        return values
    stored.set_auto_chartostring(False)
    width, encoded = stored.shape[-1], _encoded(values)
    if encoded.itemsize > width:
        raise ValueError(f"{stored.name} must have at most {width} characters, got {encoded.itemsize}: shorten it")
    return encoded.astype(f"S{width}")[..., None].view("S1")


def _encoded(texts: NDArray[Any]) -> NDArray[np.bytes_]:
    """Return texts in UTF-8, padded to the length of the longest; ValueError if a value is not a text."""
    try:
        return np.array([str.encode(text) for text in texts.ravel().tolist()], "S").reshape(texts.shape)
    except (TypeError, ValueError):
        wrong = next((text for text in texts.flat if not isinstance(text, str)), texts)
        raise ValueError(f"a variable of text must hold text only, got {wrong!r:.80}") from None
