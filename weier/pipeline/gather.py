"""Collect curves from batches: of all cases into one file, or of some cases into memory.

A file is written in blocks of cases, so that it may be larger than memory. The labels of cases beside their profiles,
which are studies and settings that differ, come from the scene. So no batch is solved again when a study is renamed.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import compress
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.data import dataset, netcdf, provenance, variables
from weier.data.files import replacing
from weier.data.variables import LABEL
from weier.kernels.arrays import Indices
from weier.methods.registry import find_method
from weier.methods.settings import all_settings, defaults
from weier.pipeline.batches import Solutions
from weier.scene.case import Case
from weier.scene.cases import Layout, Scene, layout_of

BLOCK_BYTES = 2**25  # Larger blocks of cases are no faster.


def read_study(solutions: Solutions, study: str) -> xr.Dataset:
    """The cases of a study in memory; ValueError if one is not solved."""
    cases = list(solutions.scene.study(study))
    return _read(solutions, cases, layout_of(cases, solutions.scene.contact_edges))


def read_cost(solutions: Solutions) -> xr.Dataset:
    """The seconds that each method took for each case of a scene."""
    cases, methods = list(solutions.scene.distinct), solutions.scene.layout.methods
    sizes = {"case": len(cases), "solution_method": len(methods)}
    blank = xr.Dataset({name: variables.blank(name, sizes) for name in ("key", "seconds")})
    return _filled(blank.assign_coords(solution_method=list(methods)), solutions, cases)


def gather(solutions: Solutions, path: str | Path, step: str = "gathered", more: xr.Dataset | None = None) -> None:
    """Write all cases of a scene in their order, with their labels, and further variables.

    Parameters
    ----------
    solutions : Solutions
        The scene with its solved curves.
    path : path
        The file, which is written atomically.
    step : str
        As in `dataset.write`; it is appended to the history of the batches.
    more : Dataset, optional
        Further variables, without the dimension case.
    """
    scene, cases = solutions.scene, solutions.scene.distinct
    labels, first = case_labels(scene), _read(solutions, cases[:1], scene.layout)
    header = first.merge(labels.isel(case=slice(1))).merge(more or {})
    header = header.assign_attrs(provenance.attributes(scene.title, step, scene.text, _histories(solutions, cases)))
    size = max(1, BLOCK_BYTES // first.nbytes)
    with replacing(path) as beside, netCDF4.Dataset(beside, "w") as file:
        netcdf.create(file, header, {"case": len(cases)}, netcdf.text_widths(header) | netcdf.text_widths(labels))
        netcdf.fill(file, header.drop_dims("case"))
        netcdf.fill(file, labels, slice(0, len(cases)))
        for start in range(0, len(cases), size):
            block = list(cases[start : start + size])
            netcdf.fill(file, _read(solutions, block, scene.layout), slice(start, start + len(block)))


def case_labels(scene: Scene) -> xr.Dataset:
    """The labels of the cases of a scene, in its order.

    `study` holds the names of the studies of each case, with commas between. `study_NAME`, such as `study_smooth`, is
    1 for the cases of a study and 0 for others; it is not a coordinate, so that files of other studies can be joined.
    `METHOD_SETTING`, such as `bem_points`, exists for each setting that differs between cases. It is NaN or an empty
    text where the method is not run, or chooses the setting itself.
    """
    studies = np.array([", ".join(names) for names in scene.studies_of_cases])
    columns: dict[str, tuple[NDArray[Any], str]] = {"study": (studies, "studies of the case")}
    for name in scene.layout.methods:
        method, run = find_method(name), [name in product.methods for product in scene.products]
        own = [all_settings(method, product.settings.get(name, {})) for product in scene.products]
        for setting in defaults(method):
            values = [settings[setting] for settings in own]
            if len(set(map(json.dumps, compress(values, run)))) > 1:
                column = _column([value if ran else None for value, ran in zip(values, run, strict=True)])
                columns[f"{name}_{setting}"] = column[scene.product_of_cases], f"setting {setting} of method {name}"
    flags = {
        f"study_{name}": ("case", np.array([name in home for home in scene.studies_of_cases], "i1"), _of_study(name))
        for name in scene.studies
    }
    return xr.Dataset(
        flags,
        coords={
            name: ("case", values, {"long_name": meaning, "coverage_content_type": LABEL})
            for name, (values, meaning) in columns.items()
        },
    )


def _of_study(name: str) -> dict[str, Any]:
    """The attributes of the flag of a study."""
    meanings = {"flag_values": np.array([0, 1], "i1"), "flag_meanings": "other_study this_study"}
    return {
        "long_name": f"whether the case is of study {name}",
        "coverage_content_type": LABEL,
        **meanings,
    }


def _column(values: list[Any]) -> NDArray[Any]:
    """Numbers with NaN, or texts with "", where there is None."""
    if any(isinstance(value, str | bool) for value in values):
        return np.array([json.dumps(value) if isinstance(value, bool) else value or "" for value in values])
    return np.array(values, float)


def _histories(solutions: Solutions, cases: Sequence[Case]) -> list[str]:
    """The distinct histories of the files of these cases."""
    found = dict[str, None]()
    for batch in sorted({place.batch for case in cases for place in solutions.places(case).values()}):
        with dataset.reading(batch.with_suffix(".nc")) as data:
            found[data.attrs.get("history", "")] = None
    return list(found)


def _read(solutions: Solutions, cases: Sequence[Case], layout: Layout) -> xr.Dataset:
    """Some cases in memory, in arrays of this layout."""
    methods, terms, edges, optional = layout
    blank = dataset.blank(len(cases), methods, solutions.scene.loads, terms, edges, optional)
    return _filled(blank, solutions, cases)


def _filled(blank: xr.Dataset, solutions: Solutions, cases: Sequence[Case]) -> xr.Dataset:
    """The cases with their curves from the batches.

    They are filled in method by method, so that a case has the edges of contact of its last method.
    """
    methods = blank["solution_method"].values.tolist()
    wanted = dict[tuple[int, Path], list[tuple[int, int]]]()  # rows there and here, by method and file
    for number, case in enumerate(cases):
        for method, place in solutions.places(case).items():
            key = methods.index(method), place.batch.with_suffix(".nc")
            wanted.setdefault(key, []).append((place.row, number))
    rows_of = dict[Path, list[int]]()
    for (_, file), rows in wanted.items():
        rows_of.setdefault(file, []).extend(row for row, _ in rows)
    parts = {file: _read_rows(file, min(rows), max(rows) + 1, blank) for file, rows in rows_of.items()}
    for (column, file), rows in sorted(wanted.items()):
        there, here = np.array(rows).T
        own = parts[file]["solution_method"].values.tolist().index(methods[column])
        _copy(blank, parts[file].isel(case=there - min(rows_of[file]), solution_method=own), here, column)
    blank["key"].values[:] = [case.key for case in cases]
    return blank


def _read_rows(file: Path, start: int, end: int, like: xr.Dataset) -> xr.Dataset:
    """Cases of a file in memory, with the variables of `like`; a range is read faster than single cases."""
    with dataset.reading(file) as data:
        return data.drop_vars(data.variables.keys() - like.variables.keys()).isel(case=slice(start, end)).load()


def _copy(blank: xr.Dataset, part: xr.Dataset, rows: Indices, column: int) -> None:
    """Copy the curves of a method, and the parameters of their cases, into these rows."""
    for name in blank.variables.keys() & part.variables.keys() - blank.sizes.keys():
        target, values, here = blank.variables[name], part.variables[name].values, rows
        if "edge" in target.dims:
            known = np.isfinite(values).any(axis=(1, 2))
            values, here = values[known], rows[known]
            target.values[here] = np.nan  # The previous method may have found more edges.
        run = (here, column) if "solution_method" in target.dims else (here,)
        rest = zip(values.shape[1:], target.shape[len(run) :], strict=True)  # Sizes differ between batches.
        within = tuple(slice(min(sizes)) for sizes in rest)
        target.values[(*run, *within)] = values[(slice(None), *within)]
