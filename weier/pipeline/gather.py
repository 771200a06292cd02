"""Curves from the batches that they were solved in: of all cases into one file, or of some into memory.

A file is written block by block of cases, so that it may be larger than memory.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.data import dataset, netcdf, provenance
from weier.data.files import replacing
from weier.pipeline.batches import Solutions
from weier.pipeline.labels import case_labels
from weier.scene.case import Case
from weier.scene.cases import Layout

BLOCK_BYTES = 2**25  # of cases in memory: more at a time are no faster


def read_study(solutions: Solutions, study: str) -> xr.Dataset:
    """The cases of a study, in memory; a ValueError if one is not solved."""
    cases = list(solutions.scene.study(study))
    return _read(solutions, cases, solutions.scene.layout_of(cases))


def read_cost(solutions: Solutions) -> xr.Dataset:
    """The seconds that each method took for each case of a scene."""
    cases, (methods, terms, *_) = list(solutions.scene.distinct), solutions.scene.layout
    folder = solutions.folder.parent / "cost"
    return _filled(dataset.blank_cost(len(cases), methods, terms), solutions, cases, folder)


def gather(solutions: Solutions, path: str | Path, step: str = "gathered", more: xr.Dataset | None = None) -> None:
    """Write all cases of a scene, in its order, with what tells them apart, and variables of no case.

    Parameters
    ----------
    solutions : Solutions
        The scene, and where its curves are.
    path : path
        The file to write, whole or not at all.
    step : str
        As in `dataset.write`; the history goes on from that of the batches.
    more : Dataset, optional
        Variables of no case, to write as well.
    """
    scene, cases = solutions.scene, solutions.scene.distinct
    labels, first = case_labels(scene), _read(solutions, cases[:1], scene.layout)
    whole = first.assign_coords(labels.isel(case=slice(1)).coords)
    whole = whole.merge(more) if more is not None else whole
    whole = whole.assign_attrs(provenance.attributes(scene.title, step, scene.text, _histories(solutions, cases)))
    size = max(1, BLOCK_BYTES // first.nbytes)
    with replacing(path) as beside, netCDF4.Dataset(beside, "w") as file:
        netcdf.create(file, whole, {"case": len(cases)}, netcdf.text_widths(whole) | netcdf.text_widths(labels))
        netcdf.fill(file, whole.drop_dims("case"))
        netcdf.fill(file, labels, slice(0, len(cases)))
        for start in range(0, len(cases), size):
            block = list(cases[start : start + size])
            netcdf.fill(file, _read(solutions, block, scene.layout), slice(start, start + len(block)))


def _histories(solutions: Solutions, cases: Sequence[Case]) -> list[str]:
    """Those of all files of these cases, each once."""
    files = {place.batch.with_suffix(".nc") for case in cases for place in solutions.places(case).values()}
    found = dict[str, None]()
    for path in sorted(files):
        with dataset.reading(path) as data:
            found[data.attrs.get("history", "")] = None
    return list(found)


def _read(solutions: Solutions, cases: Sequence[Case], layout: Layout) -> xr.Dataset:
    """Some cases in memory, as wide as the layout says."""
    methods, terms, edges, optional = layout
    blank = dataset.blank(len(cases), methods, solutions.scene.loads, terms, edges, optional)
    return _filled(blank, solutions, cases, solutions.folder)


def _filled(blank: xr.Dataset, solutions: Solutions, cases: Sequence[Case], folder: Path) -> xr.Dataset:
    """These cases with the curves that the batches in a folder hold of them."""
    wanted: dict[Path, dict[str, list[tuple[int, int]]]] = {}  # rows there and here, by file and method
    for number, case in enumerate(cases):
        for method, place in solutions.places(case).items():
            file = folder / f"{place.batch.stem}.nc"
            wanted.setdefault(file, {}).setdefault(method, []).append((place.row, number))
    parts = {file: _Rows(file, {row for rows in own.values() for row, _ in rows}) for file, own in wanted.items()}
    for method in blank[
        "solution_method"
    ].values.tolist():  # the edges of contact, of which a case has one set, are those of its last method
        for file, own in wanted.items():
            if method in own:
                _copy(blank, parts[file], method, *zip(*own[method], strict=True))
    blank["key"].values[:] = [case.key for case in cases]
    return blank


class _Rows:
    """Some rows of a file in memory, by their numbers in the file."""

    def __init__(self, file: Path, rows: Collection[int]) -> None:
        first, last = min(rows), max(rows)
        contiguous = last - first == len(rows) - 1  # a slice is read in half the time of a list
        with dataset.reading(file) as data:
            self.data = data.isel(case=slice(first, last + 1) if contiguous else sorted(rows)).load()
        self._number = {row: number for number, row in enumerate(sorted(rows))}

    def values(self, name: str, rows: Sequence[int], method: str) -> NDArray[Any]:
        """A variable of some rows, by one method where it has methods."""
        variable, numbers = self.data.variables[name], [self._number[row] for row in rows]
        if "solution_method" not in variable.dims:
            return variable.values[numbers]
        return variable.values[numbers, self.data["solution_method"].values.tolist().index(method)]


def _copy(blank: xr.Dataset, part: _Rows, method: str, there: Sequence[int], here: Sequence[int]) -> None:
    """Copy the curves of a method, and what describes their cases, from rows there to rows here."""
    column = blank["solution_method"].values.tolist().index(method)
    for name in blank.variables.keys() & part.data.variables.keys() - blank.sizes.keys():
        target, values, rows = blank.variables[name], part.values(str(name), there, method), np.array(here)
        if "edge" in target.dims:
            known = np.isfinite(values).any(axis=(1, 2))
            values, rows = values[known], rows[known]
            target.values[rows] = np.nan  # the method before may have found more
        run = (rows, column) if "solution_method" in target.dims else (rows,)
        rest = zip(values.shape[1:], target.shape[len(run) :], strict=True)  # as wide as other cases are
        within = tuple(slice(min(sizes)) for sizes in rest)
        target.values[(*run, *within)] = values[(slice(None), *within)]
