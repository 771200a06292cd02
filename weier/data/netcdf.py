"""Datasets as netCDF-4 files, created first and filled block by block, so that a file may be larger than memory.

Chunks and compression are measured on 4800 cases of 4 methods at 40 loads, 61 MB of ten variables, uncompressed
read in 0.24 s: with chunks of one method and deflate 1 they take 9.2 MB, 0.40 s to write and 0.16 s to read. Chunks
of a megabyte hold 16 000 cases at 8 loads, of which docs/cluster.md has the seconds. Deflate 4 saves 4 % and takes
twice as long to write; a chunk a case takes 23 MB. Fletcher's checksum takes 4 bytes a chunk and no time that could
be measured, and detects corruption on disk. A variable takes 4 to 6 kB by itself, which is most of a file of one
case: 3 for the index of its chunks, 1 for its header, and 2 where it has more than six attributes. One without
values has no chunks, and so no index.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Container, Hashable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import netCDF4
import numpy as np
from numpy.typing import NDArray

from weier.data.provenance import FIXED
from weier.data.variables import ancillary

if TYPE_CHECKING:
    import xarray as xr

CHUNK_BYTES = 2**20  # of whole cases by one method, before compression
CACHE_BYTES = 2**22  # For each variable. The default of the library, 16 MB, would dominate the memory.
# The last line of a file: a name, and a digest of all bytes before it.
SEAL = re.compile(rb"\nweier (?P<name>\S+) sha256:(?P<digest>[0-9a-f]{64})\n\Z")
UNNAMED = "-"
BLOCK = 2**20  # bytes, read at a time
MAX_VERIFIED = 2**26  # Files are digested when they are opened if they are smaller, which takes 0.1 s.
REMAKE = "delete it and make it again"
HDF5 = b"\x89HDF\r\n\x1a\n"  # the first bytes of a file
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


def fill(file: netCDF4.Dataset, data: xr.Dataset, cases: slice | None = None) -> None:
    """Write the values of a dataset into a file made by `create`: into these cases, or, if None, into all of it."""
    for name, values in data.variables.items():
        stored = _stored_as(file, str(name), values)
        if (cases is None or "case" in values.dims) and not _missing(stored, values):
            stored[... if cases is None else cases] = _encoded_for(stored, values)


def read(path: str | Path, names: Container[str], cases: slice) -> dict[str, tuple[tuple[str, ...], NDArray[Any]]]:
    """Return the dimensions and values of variables of a verified file made by `create`, for a range of its cases.

    xarray would take 40 ms to open a file. Equal texts are one object.
    """
    found, known = {}, dict[bytes, str]()
    with netCDF4.Dataset(path) as file:
        for group in (file, *file.groups.values()):
            for name, stored in group.variables.items():
                if name in names:
                    stored.set_auto_mask(False)
                    stored.set_auto_chartostring(False)
                    dims, values = stored.dimensions, stored[cases]
                    if stored.dtype == "S1":
                        dims, values = dims[:-1], _decoded(values, known)
                    found[name] = dims, values
    return found


def seal(path: str | Path, name: str = UNNAMED) -> None:
    """Append a line with a name and a digest of the file, which HDF5 ignores, and removes when it writes.

    The checksums of HDF5 cover chunks of values only, and not the header or the index of chunks.
    """
    with Path(path).open("r+b") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
        file.seek(0, os.SEEK_END)
        file.write(f"\nweier {name} sha256:{digest}\n".encode())


def sealed_name(path: str | Path) -> str | None:
    """Return the name in the last line of a file; None if it has no such line, or there is no such file."""
    try:
        with Path(path).open("rb") as file:
            found = SEAL.search(_last_bytes(file))
    except FileNotFoundError:
        return None
    return found["name"].decode() if found else None


def check_sealed(path: str | Path, name: str = "") -> None:
    """Refuse a file that was not written by weier under this name, or that has changed since.

    Raises
    ------
    ValueError
        If the file is not whole, is another one, or was changed by another program or the disk.
    OSError
        If it cannot be read.
    """
    found = _seal_of(path)
    if found is None:
        check_whole(path)
        raise _changed_error(path, "another program")
    if not found.whole:
        raise _changed_error(path, "another program or the disk")
    if name and found.name != name:
        raise ValueError(f"{path} is another file than its name says: {REMAKE}")


def check_intact(path: str | Path) -> None:
    """Refuse a file that has changed since it was sealed; larger ones have the checksums of HDF5 alone."""
    if os.path.getsize(path) < MAX_VERIFIED and (found := _seal_of(path)) and not found.whole:
        raise _changed_error(path, "another program or the disk", f"move it away, since it may be good, or {REMAKE}")


def _changed_error(path: str | Path, by: str, advice: str = REMAKE) -> Exception:
    """Return the error for a file whose bytes have changed, as they do while another process has it open."""
    return _locked_error(path) or ValueError(f"{path} is not as weier wrote it, but changed by {by}: {advice}")


def _locked_error(path: str | Path) -> OSError | None:
    """Return the error for a file that is open for writing; None if it is not."""
    with Path(path).open("rb") as file:
        locked = _is_locked(file)
    return OSError(f"{path} is open in another program, which may write it: close it there") if locked else None


class Seal(NamedTuple):
    """The last line of a file: its name, and whether its digest is that of all before it."""

    name: str
    whole: bool


def _seal_of(path: str | Path) -> Seal | None:
    try:
        with Path(path).open("rb") as file:
            if not (found := SEAL.search(_last_bytes(file))):
                return None
            left, actual = os.path.getsize(path) - len(found[0]), hashlib.sha256()
            file.seek(0)
            while part := file.read(min(left, BLOCK)):
                actual.update(part)
                left -= len(part)
    except OSError as error:
        raise _unreadable(path, error) from None
    return Seal(found["name"].decode(), actual.hexdigest() == found["digest"].decode())


def _last_bytes(file: BinaryIO) -> bytes:
    file.seek(max(0, os.fstat(file.fileno()).st_size - 256))  # The line is shorter.
    return file.read()


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
        if locked := _locked_error(path):
            return locked
        with Path(path).open("rb") as file:
            head = file.read(len(HDF5))
        found = _seal_of(path)
    except OSError as why:
        return why if str(path) in str(why) else _unreadable(path, why)
    if found and found.whole:
        return OSError(f"{path} is whole, but cannot be opened now ({error}): try again")
    if head.strip(b"\0") and not head.startswith((HDF5, b"CDF")):
        return ValueError(f"{path} is no netCDF file: name another one, or move it away and make it again")
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


def texts_of_files(paths: Iterable[str | Path]) -> tuple[list[str], dict[str, int]]:
    """Return the distinct histories of some files, and the most bytes that each variable of text has in them."""
    histories, widths = dict[str, None](), dict[str, int]()
    for path in paths:
        with netCDF4.Dataset(path) as file:
            histories[getattr(file, "history", "")] = None
            for name, stored in file.variables.items():
                if stored.dtype == "S1":
                    widths[name] = max(widths.get(name, 1), stored.shape[-1])
    return list(histories), widths


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


def _missing(stored: netCDF4.Variable[Any], values: xr.Variable) -> bool:
    """Return whether all values are the fill value, so that nothing has to be written."""
    return "_FillValue" in stored.ncattrs() and bool(np.isnan(values.values).all())


def _encoded_for(stored: netCDF4.Variable[Any], values: xr.Variable) -> NDArray[Any]:
    """Return the values as stored in the file: texts are characters along a dimension of their own."""
    if values.dtype.kind not in "UO":
        return values.values
    stored.set_auto_chartostring(False)
    width, encoded = stored.shape[-1], _encoded(values.values)
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


def _decoded(characters: NDArray[np.bytes_], known: dict[bytes, str]) -> NDArray[np.object_]:
    """Return texts from their characters along the last dimension; equal ones are one object, kept in `known`."""
    texts = np.ascontiguousarray(characters).view(f"S{characters.shape[-1]}")[..., 0]
    flat = texts.ravel().tolist()
    known |= {text: text.decode() for text in set(flat) - known.keys()}
    return np.array([known[text] for text in flat], object).reshape(texts.shape)
