"""Collect curves from batches: of all cases into one file, or of some cases into memory.

A file is written in blocks of cases, so that it may be larger than memory. The studies and differing settings of a
case come from the scene, so that renaming a study solves nothing again.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Collection, Mapping
from contextlib import suppress
from itertools import compress
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.data import dataset, netcdf, provenance
from weier.data.files import replacing
from weier.data.variables import LABEL, attributes
from weier.kernels.arrays import Array, Indices
from weier.methods.registry import find_method
from weier.methods.settings import all_settings, defaults
from weier.pipeline.batches import Solutions
from weier.scene.case import short_keys
from weier.scene.cases import Layout, Scene
from weier.surface.spectrum import fit

Values = tuple[tuple[str, ...], NDArray[Any]]  # dimensions and values of a variable
DATES_OF_VALUES = ("date_created", "date_modified")
BLOCK_BYTES = 2**26  # A batch is opened for each block that it reaches into; larger blocks save little time.


def read_study(solutions: Solutions, study: str, without: Collection[str] = ()) -> xr.Dataset:
    """Return the cases of a study in memory, without some variables; ValueError if a case is not solved."""
    scene = solutions.scene
    cases = scene.cases_of_study(study)
    return Reader(solutions, scene.layout_of(study), (study,), without).read(cases)


def read_cases(solutions: Solutions, cases: Indices, without: Collection[str] = ()) -> xr.Dataset:
    """Return some cases of the file of a scene in memory, by their numbers, without some variables."""
    scene = solutions.scene
    curves = in_units_of(scene, Reader(solutions, scene.layout, None, without).read(cases))
    return curves.merge(case_labels(scene).isel(case=cases))


def gather(
    solutions: Solutions,
    path: str | Path,
    step: str = "gathered",
    more: xr.Dataset | None = None,
    name: str = netcdf.UNNAMED,
) -> None:
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
    name : str
        As in `dataset.write`.
    """
    scene, count = solutions.scene, len(solutions.scene.distinct)
    layout = scene.layout if provenance.source_date() else scene.layout.having("seconds")
    reader, labels = Reader(solutions, layout), case_labels(scene)
    histories, widths = netcdf.texts_of_files(reader.files())
    first = in_units_of(scene, reader.read(np.arange(1)))
    header = first.merge(labels.isel(case=slice(1))).merge(more or {})
    about = provenance.attributes(scene.title, step, scene.text, histories, in_si=scene.in_si)
    header = header.assign_attrs(about)
    for text, width in (netcdf.text_widths(header) | netcdf.text_widths(labels)).items():
        widths[text] = max(width, widths.get(text, 0))
    size = max(1, BLOCK_BYTES // first.nbytes)
    with replacing(path) as beside:
        with netCDF4.Dataset(beside, "w") as file:
            netcdf.create(file, header, {"case": count}, widths)
            netcdf.fill(file, header.drop_dims("case"))
            netcdf.fill(file, labels, slice(0, count))
            for start in range(0, count, size):
                block = np.arange(start, min(start + size, count))
                netcdf.fill(file, in_units_of(scene, reader.read(block)), slice(start, start + len(block)))
        netcdf.seal(beside, name)


def describe_again(scene: Scene, path: str | Path, step: str, name: str) -> None:
    """Give a file of `gather` the title and text of a scene that has the same cases, atomically; its values stay."""
    netcdf.check_sealed(path)
    with replacing(path) as beside:
        shutil.copyfile(path, beside)
        with netCDF4.Dataset(beside, "a") as file:
            about = provenance.attributes(scene.title, step, scene.text, [file.history], in_si=scene.in_si)
            file.setncatts({key: value for key, value in about.items() if key not in DATES_OF_VALUES})
        netcdf.seal(beside, name)


def in_units_of(scene: Scene, data: xr.Dataset) -> xr.Dataset:
    """Return data of a scene in SI units, with its bodies as attributes, if its loads are in Pa."""
    if not scene.in_si or scene.interface is None:
        return data
    own = {name: value for name, value in vars(scene.interface).items() if value is not None}
    return scene.interface.in_si(data).drop_attrs(deep=False).assign_attrs(own)


def case_labels(scene: Scene) -> xr.Dataset:
    """Return the labels of the cases of a scene, in its order.

    `study` holds the names of the studies of each case, with commas between. `study_NAME`, such as `study_smooth`, is
    1 for the cases of a study and 0 for others; it is not a coordinate, so that files of other studies can be joined.
    `METHOD_SETTING`, as `layer_points`, exists for each setting that differs between cases. It is NaN or an empty
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
        }
        | {name: ("case", values, attributes(name)) for name, values in _fits(scene).items()},
    )


def _fits(scene: Scene) -> dict[str, Array]:
    """The fit of a series to each trace, with its standard errors; NaN where no series has its spectrum."""
    if not any("trace" in product.axes for product in scene.products):
        return {}
    names = "trace_fit_D", "trace_fit_D_error", "trace_fit_g_0", "trace_fit_g_0_error"
    found = np.full((len(names), len(scene.distinct)), np.nan)
    for number, case in enumerate(scene.distinct):
        if "trace" in case.parameters:
            with suppress(ValueError):
                fitted = fit(case.profile)
                found[:, number] = fitted.D, fitted.D_error, fitted.g_0, fitted.g_0_error
    return dict(zip(names, found, strict=True))


def _of_study(name: str) -> dict[str, Any]:
    """Return the attributes of the flag of a study."""
    meanings = {"flag_values": np.array([0, 1], "i1"), "flag_meanings": "other_study this_study"}
    return {
        "long_name": f"whether the case is of study {name}",
        "coverage_content_type": LABEL,
        **meanings,
    }


def _column(values: list[Any]) -> NDArray[Any]:
    """Return numbers or texts, with NaN or "" in place of None."""
    if any(isinstance(value, str | bool) for value in values):
        return np.array([json.dumps(value) if isinstance(value, bool) else value or "" for value in values])
    return np.array(values, float)


class Reader:
    """Reads cases of a scene from its batches, each of which is verified once.

    Parameters
    ----------
    solutions : Solutions
        The scene with its solved curves.
    layout : Layout
        Of the arrays to read into.
    studies : tuple of str, optional
        The studies whose cases are read; others need not be solved yet. By default, all.
    without : collection of str, optional
        Variables that are not read.
    """

    def __init__(
        self,
        solutions: Solutions,
        layout: Layout,
        studies: tuple[str, ...] | None = None,
        without: Collection[str] = (),
    ) -> None:
        methods, terms, edges, optional = layout.having("numerics")
        scene = solutions.scene
        blank = dataset.blank(1, methods, scene.loads, terms, edges, optional, scene.load_unit)
        self._blank = blank.drop_vars(without, errors="ignore")
        self._keys, self._store = scene.keys_of_cases, solutions.store
        self._places = {method: solutions.places(method, studies) for method in methods}
        self._verified = set[int]()

    def read(self, cases: Indices) -> xr.Dataset:
        """Return some cases, by their numbers among all of the scene.

        Method by method: a case has the contact edges of its last method.
        """
        one = self._blank
        found = {str(name): variable.values for name, variable in one.variables.items() if "case" in variable.dims}
        # Views of the blank case take no memory where there are no values.
        found = {name: np.broadcast_to(blank[:1], (len(cases), *blank.shape[1:])) for name, blank in found.items()}
        read = found.keys() - {"key"}  # Keys are those of the scene, and texts take long to decode.
        of_curves = {name for name in read if {"solution_method", "edge"} & {*one[name].dims}}
        known = np.zeros(len(cases), bool)
        for column, places in enumerate(self._places.values()):
            batches, rows, code = (values[cases] for values in places)
            if known.all():  # All methods have the same parameters of a case.
                read = of_curves
            known |= batches >= 0
            order = np.argsort(batches, kind="stable")
            for here in np.split(order, np.flatnonzero(np.diff(batches[order])) + 1):
                if here.size and (batch := int(batches[here[0]])) >= 0:
                    start = int(rows[here].min())
                    part = netcdf.read(self._file(batch), read, slice(start, int(rows[here].max()) + 1))
                    _copy(found, part, rows[here] - start, here, column)
            if "numerics" in found:
                _writable(found, "numerics")[:, column] = code
        found["key"] = np.array(short_keys(self._keys[cases]), object)
        filled = {
            name: (one[name].dims, values, one[name].attrs, one[name].encoding) for name, values in found.items()
        }
        return one.isel(case=0, drop=True).assign(filled).set_coords(list(one.coords))

    def files(self) -> list[Path]:
        """Return the batches, which are verified."""
        used = {int(number) for batches, _, _ in self._places.values() for number in np.unique(batches)}
        return [self._file(batch) for batch in sorted(used) if batch >= 0]

    def _file(self, batch: int) -> Path:
        file = self._store.batches[batch].with_suffix(".nc")
        if batch not in self._verified:
            netcdf.check_sealed(file, file.stem)
            self._verified.add(batch)
        return file


def _writable(arrays: dict[str, NDArray[Any]], name: str) -> NDArray[Any]:
    """Return an array to write to, in place of a view of the blank case."""
    if not arrays[name].flags.writeable:
        arrays[name] = arrays[name].copy()
    return arrays[name]


def _copy(
    found: dict[str, NDArray[Any]], part: Mapping[str, Values], there: Indices, rows: Indices, column: int
) -> None:
    """Copy curves of a method and the parameters of their cases from rows of a batch to these rows."""
    for name, (dims, read) in part.items():
        values, here = read[there], rows
        if values.dtype.kind == "f" and np.isnan(values).all():
            continue
        target = _writable(found, name)
        if "solution_method" in dims:
            values = values[:, 0]
        if "edge" in dims:
            has = np.isfinite(values).any(axis=(1, 2))
            values, here = values[has], rows[has]
            target[here] = np.nan  # The previous method may have found more edges.
        run = (here, column) if "solution_method" in dims else (here,)
        rest = zip(values.shape[1:], target.shape[len(run) :], strict=True)  # Sizes differ between batches.
        within = tuple(slice(min(sizes)) for sizes in rest)
        target[(*run, *within)] = values[(slice(None), *within)]
