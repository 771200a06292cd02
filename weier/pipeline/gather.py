"""One study: its cases, gathered from the batches they were solved in, with bounds on what truncation left out.

Block by block of cases from file to file, so that a study may be larger than memory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.data import dataset, netcdf, provenance
from weier.data.files import replacing
from weier.methods import bem, error_model
from weier.methods.registry import numerical_names
from weier.theory.bounds import complete_bounds, resistance_bounds
from weier.theory.profile import Profile

BLOCK = 64  # cases in memory: the bounds take loads^2 numbers for each


def gather(
    files: Sequence[str | Path],
    keys: Sequence[str],
    path: str | Path,
    title: str,
    *,
    step: str = "gathered",
    scene: str = "",
    change: Callable[[xr.Dataset], xr.Dataset] | None = None,
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
    change : callable, optional
        What to do with each block of cases on the way; it may not change their shape.
    more : Dataset, optional
        Variables of no case, to write as well.

    Raises
    ------
    ValueError
        If a case is in none of the files, or the files differ in loads.

    """
    if not files:
        raise ValueError("there must be files to gather from, got none")
    place = {key: row for row, key in enumerate(keys)}
    like, histories = _layout(files, set(keys))
    whole = like.merge(more) if more is not None else like
    whole = whole.assign_attrs(provenance.attributes(title, step, scene, histories))
    with replacing(path) as beside, netCDF4.Dataset(beside, "w") as file:
        netcdf.create(file, whole, {"case": len(keys)}, netcdf.text_widths(whole))
        netcdf.fill(file, whole.drop_dims("case"))
        for block in _blocks(files, place):
            wide = dataset.widened(block, *_together(like, block))
            _put(file, change(wide) if change else wide, place)


def add_bounds(data: xr.Dataset) -> xr.Dataset:
    """Fill in the bounds on compliance and resistance of the endless series, where its first terms are solved.

    What a solution is off widens the band of the terms left out. That the band holds is a theorem, and so is what a
    grid misses at first touch, z'' dx^2/8; that a grid is off by no more under load was measured
    (`python -m benchmarks.planned`).
    """
    data = data.copy(deep=True)
    exact = np.flatnonzero(np.isin(data["solution_method"].values, numerical_names()))
    loads = data["mean_pressure"].values
    h = data["compliance"].values[:, exact]
    names = ("total_amplitude", "tail_amplitude", "first_contact")
    total, tail, first = (data[name].values[:, None] for name in names)
    off = _solution_error(data)[:, exact]
    for quantity, sides in (
        ("compliance", complete_bounds(h, tail[..., None], (total + tail)[..., None], off[..., None])),
        ("resistance", resistance_bounds(loads, h, tail + off, first)),
    ):
        for side, values in zip(("lower", "upper"), sides, strict=True):
            data[f"{quantity}_{side}"].values[:, exact] = values
    return data


def _solution_error(data: xr.Dataset) -> NDArray[np.float64]:
    """What grid and residual leave of the compliance, in g_0, shape (cases, methods); NaN without a solution."""
    off = error_model.RESIDUAL * data["residual"].max("mean_pressure").values
    for case, method in np.argwhere(np.isfinite(data["points"].values)):
        one = data.isel(case=case)
        profile = Profile(float(one["D"]), float(one["gamma"]), float(one["m"]))
        off[case, method] += bem.error_model.compliance_error(profile, int(one["points"][method]))
    return np.asarray(off)


def keys_of(files: Sequence[str | Path]) -> list[str]:
    """The keys of all cases of some files, each once, in order of appearance."""
    found: dict[str, None] = {}
    for path in files:
        with dataset.reading(path) as data:
            found |= dict.fromkeys(data["key"].values.tolist())
    return list(found)


def _layout(files: Sequence[str | Path], missing: set[str]) -> tuple[xr.Dataset, list[str]]:
    """The first case, as wide as the whole will be, and the histories of the files."""
    like, histories, strangers = xr.Dataset(), dict[str, None](), list[str]()
    wanted = missing
    for path in files:
        with dataset.reading(path) as data:
            like = like if like.sizes else data.isel(case=slice(1)).load()
            if not like["mean_pressure"].equals(data["mean_pressure"]):
                raise ValueError(f"{path} and {files[0]} differ in loads: delete the older one, and make it again")
            like = dataset.widened(like, *_together(like, data))
            histories[data.attrs.get("history", "")] = None
            keys = set(data["key"].values.tolist())
            missing = missing - keys
            strangers += [str(path)] if wanted.isdisjoint(keys) else []
    if missing:
        raise ValueError(
            f"{len(missing)} cases are in none of the files, the first with the key {min(missing)}: "
            f"delete {', '.join(strangers) or 'the older files'} and make it again"
        )
    return like, list(histories)


def _together(one: xr.Dataset, other: xr.Dataset) -> tuple[list[str], int, int]:
    """Methods, terms and edges of contact that have room for both."""
    methods = dict.fromkeys([*one["solution_method"].values.tolist(), *other["solution_method"].values.tolist()])
    terms, edges = (max(data.sizes.get(dim, 0) for data in (one, other)) for dim in ("term", "edge"))
    return list(methods), terms, edges


def _blocks(files: Sequence[str | Path], place: Mapping[str, int]) -> Iterator[xr.Dataset]:
    """All wanted cases, some at a time; a case of several files comes from the first."""
    seen: set[str] = set()
    for path in files:
        with dataset.reading(path) as data:
            keys = data["key"].values.tolist()
            wanted = [row for row, key in enumerate(keys) if key in place and key not in seen]
            seen.update(keys)
            for start in range(0, len(wanted), BLOCK):
                rows = wanted[start : start + BLOCK]
                whole = rows[-1] - rows[0] == len(rows) - 1  # a slice is read in half the time of a list
                yield data.isel(case=slice(rows[0], rows[-1] + 1) if whole else rows).load()


def _put(file: netCDF4.Dataset, block: xr.Dataset, place: Mapping[str, int]) -> None:
    """Write cases to their places: neighbours together, since each write touches every variable."""
    rows = [place[key] for key in block["key"].values.tolist()]
    for _, run in groupby(enumerate(rows), lambda pair: pair[1] - pair[0]):
        found = list(run)
        (first, start), (last, _) = found[0], found[-1]
        netcdf.fill(file, block.isel(case=slice(first, last + 1)), slice(start, start + len(found)))
