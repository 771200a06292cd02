"""Cases from the batches that they were solved in: together into one file, or a study of them into memory.

A file is written block by block of cases, so that it may be larger than memory.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path

import netCDF4
import xarray as xr

from weier.data import dataset, netcdf, provenance
from weier.data.files import replacing
from weier.scene.cases import Scene

BLOCK_BYTES = 2**25  # of cases in memory: more at a time are no faster


def gather(
    files: Sequence[str | Path],
    keys: Sequence[str],
    path: str | Path,
    title: str,
    *,
    step: str = "gathered",
    scene: str = "",
    labels: xr.Dataset | None = None,
    more: xr.Dataset | None = None,
) -> None:
    """Write the cases with these keys, in this order, from files that hold them among others.

    Parameters
    ----------
    files : sequence of path
        netCDF files of weier, of the same loads; what one lacks of the methods, terms and edges of contact of the
        others stays blank.
    keys : sequence of str
        Which cases, each once.
    path : path
        The file to write, whole or not at all.
    title, step, scene : str
        As in `dataset.write`; the history goes on from that of the files.
    labels : Dataset, optional
        Further coordinates of the cases, in the order of the keys.
    more : Dataset, optional
        Variables of no case, to write as well.
    """
    position = {key: row for row, key in enumerate(keys)}
    like, histories = _layout(files, position)
    labels = xr.Dataset() if labels is None else labels
    whole = like.assign_coords(labels.isel(case=slice(1)).coords) if labels.coords else like
    whole = whole.merge(more) if more is not None else whole
    whole = whole.assign_attrs(provenance.attributes(title, step, scene, histories))
    with replacing(path) as beside, netCDF4.Dataset(beside, "w") as file:
        netcdf.create(file, whole, {"case": len(keys)}, netcdf.text_widths(whole) | netcdf.text_widths(labels))
        netcdf.fill(file, whole.drop_dims("case"))
        netcdf.fill(file, labels, slice(0, len(keys)))
        for block in _blocks(files, position):
            _write_rows(file, dataset.widen(block, *_common_layout(like, block)), position)


def read_study(scene: Scene, study: str, batches: Path) -> xr.Dataset:
    """The cases of a study, in memory, from the folder of its batches; a ValueError if one is missing."""
    keys = [case.key for case in scene.study(study)]
    return read([batch_file(batches, batch) for batch in scene.batches_of(study)], keys)


def batch_file(batches: Path, batch: str) -> Path:
    """The file of a batch in a folder of them."""
    return batches / f"{batch}.nc"


def read(files: Sequence[str | Path], keys: Sequence[str]) -> xr.Dataset:
    """The cases with these keys, in this order, in memory; files and errors as of `gather`."""
    position = {key: row for row, key in enumerate(keys)}
    like, _ = _layout(files, position)
    blocks = [dataset.widen(block, *_common_layout(like, block)) for block in _blocks(files, position)]
    data = xr.concat(
        blocks, "case", data_vars="minimal", coords="minimal", compat="override", join="override",
        combine_attrs="override",
    )  # fmt: skip
    rows = {key: row for row, key in enumerate(data["key"].values.tolist())}
    return data.isel(case=[rows[key] for key in keys])


def _layout(files: Sequence[str | Path], keys: Collection[str]) -> tuple[xr.Dataset, list[str]]:
    """The first case, as wide as the whole will be, and the histories of the files."""
    if not files:
        raise ValueError("there must be files to gather from, got none")
    like, histories, missing, foreign = xr.Dataset(), dict[str, None](), set(keys), list[str]()
    for path in files:
        with dataset.reading(path) as data:
            like = like if like.sizes else data.isel(case=slice(1)).load()
            if not like["mean_pressure"].equals(data["mean_pressure"]):
                raise ValueError(f"{path} and {files[0]} differ in loads: delete the older one, and make it again")
            like = dataset.widen(like, *_common_layout(like, data))
            histories[data.attrs.get("history", "")] = None
            own = set(data["key"].values.tolist())
            missing -= own
            foreign += [str(path)] if own.isdisjoint(keys) else []
    if missing:
        raise ValueError(
            f"{len(missing)} cases are in none of the files, the first with the key {min(missing)}: "
            f"delete {', '.join(foreign) or 'the older files'} and make it again"
        )
    return like, list(histories)


def _common_layout(one: xr.Dataset, other: xr.Dataset) -> tuple[list[str], int, int, set[str]]:
    """Methods, terms and edges of contact that hold both, and the names of the variables of both."""
    methods = dict.fromkeys([*one["solution_method"].values.tolist(), *other["solution_method"].values.tolist()])
    terms, edges = (max(data.sizes.get(dim, 0) for data in (one, other)) for dim in ("term", "edge"))
    return list(methods), terms, edges, {str(name) for data in (one, other) for name in data.variables}


def _blocks(files: Sequence[str | Path], keys: Collection[str]) -> Iterator[xr.Dataset]:
    """All cases with these keys, some at a time; a case of several files comes from the first."""
    done: set[str] = set()
    for path in files:
        with dataset.reading(path) as data:
            own = data["key"].values.tolist()
            wanted = [row for row, key in enumerate(own) if key in keys and key not in done]
            done.update(own)
            size = max(1, BLOCK_BYTES * len(own) // data.nbytes)
            for start in range(0, len(wanted), size):
                rows = wanted[start : start + size]
                contiguous = rows[-1] - rows[0] == len(rows) - 1  # a slice is read in half the time of a list
                yield data.isel(case=slice(rows[0], rows[-1] + 1) if contiguous else rows).load()


def _write_rows(file: netCDF4.Dataset, block: xr.Dataset, position: Mapping[str, int]) -> None:
    """Write cases to their positions: neighbours together, since each write touches every variable."""
    rows = [position[key] for key in block["key"].values.tolist()]
    for _, neighbours in groupby(enumerate(rows), lambda pair: pair[1] - pair[0]):
        run = list(neighbours)
        (first, start), (last, _) = run[0], run[-1]
        netcdf.fill(file, block.isel(case=slice(first, last + 1)), slice(start, start + len(run)))
