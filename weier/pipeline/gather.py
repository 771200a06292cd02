"""Solved curves of a scene as a dataset: of some cases in memory, or of all in a file, one variable at a time.

The studies of a case come from the scene, so that renaming a study solves nothing again.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.api.rows import BOUNDS
from weier.data import provenance, variables
from weier.data.dataset import append, over_cases, write_file
from weier.data.files import replacing
from weier.data.si import converted, with_pressures_in
from weier.data.variables import CASE, CURVE, LABEL, LOADS, VARIABLES
from weier.kernels.arrays import Indices
from weier.methods.registry import find_method, returned_by
from weier.pipeline.needed_curves import Curves, Part
from weier.pipeline.store import ORIGIN
from weier.scene.cases import Scene
from weier.scene.identity import short_keys
from weier.units import NORMALISED_PRESSURE, PASCAL

Values = NDArray[Any]
Own = tuple[Part, Indices, Indices]  # a part, its rows in a dataset, and those in the store


class Solved:
    """Cases of a scene, by their numbers, with their solved curves over case, method and the union of their loads."""

    def __init__(self, curves: Curves, cases: Indices | None = None) -> None:
        self.scene, self._store = curves.scene, curves.store
        self.cases = np.arange(self.scene.count) if cases is None else cases
        self._surfaces, found = ([*self._among(parts)] for parts in (curves.surfaces, curves.parts))
        self.methods = list(dict.fromkeys(part.kind.method for part, *_ in found))
        self._parts = sorted(found, key=lambda own: self.methods.index(own[0].kind.method))
        self.loads = np.unique(np.concatenate([part.product.loads for part, *_ in self._surfaces]))

    def _among(self, parts: Iterable[Part]) -> Iterable[Own]:
        """Yield each part with its rows in the dataset, reduced to these cases, and their rows in the store."""
        for part in parts:
            number = self.cases - part.cases[0]  # case numbers of a part are consecutive
            rows = np.flatnonzero((number >= 0) & (number < len(part.positions)))
            if rows.size:
                own = part.only(number[rows])
                yield own, rows, self._store.rows(own.kind, own.keys)

    @cached_property
    def names(self) -> list[str]:
        """The variables that these cases have, in the order of the table."""
        numerical = any(find_method(method).numerical for method in self.methods)
        returned = {"origin", *returned_by(self.methods), *(BOUNDS if numerical else ())}
        if not provenance.source_date():
            returned.add("seconds")
        if any("trace" in part.product.axes for part, *_ in self._surfaces):
            returned |= {name for name in VARIABLES if name.startswith("trace")}
        return [
            name
            for name in variables.curve_variables(returned, self.scene.contact_edges)
            if name not in ("solution_method", "mean_pressure", "term")
        ]

    @cached_property
    def origins(self) -> list[str]:
        """The programs and processors that solved these curves, in alphabetical order."""
        read = (self._store.read(part.kind, stored, ORIGIN) for part, _, stored in self._parts)
        return sorted({origin for found in read if found is not None for origin in found.tolist()})

    def values(self, name: str) -> Values:
        """Return a variable of the table, shape (cases, ...) or (cases, methods, ...)."""
        if name == "key":
            return np.array(short_keys(self.scene.keys_of_cases[self.cases]), object)
        dims = VARIABLES[name].dims
        by_method = "solution_method" in dims
        found = list[tuple[tuple[Any, ...], Values]]()
        for part, rows, stored in self._parts if by_method or "edge" in dims else self._surfaces:
            if (values := self._read(name, part, stored)) is not None:
                found.append(((rows, self.methods.index(part.kind.method)) if by_method else (rows,), values))
        sizes = {LOADS: self.loads.size, "term": 1}
        own = [sizes.get(dim, 0) for dim in dims if dim not in (CASE, "solution_method")]
        shape = np.max([own, *(values.shape[1:] for _, values in found)], axis=0).astype(int)
        joined = variables.blank(name, (len(self.cases), *[len(self.methods)] * by_method, *shape))
        for place, values in found:
            if "edge" in dims:  # those of the last method that found some, and none of another one behind them
                told = np.isfinite(values).any((1, 2))
                place, values = (place[0][told],), values[told]
                joined[place] = np.nan
            joined[(*place, *map(slice, values.shape[1:]))] = values
        return joined

    def _read(self, name: str, part: Part, stored: Indices) -> Values | None:
        """Return a variable of the curves of a part, NaN at loads that it does not have."""
        if name == "settings":
            return np.full(len(part.cases), json.dumps(part.kind.settings, sort_keys=True), object)
        if name == "surface_key":
            return np.array(short_keys(part.keys), object)
        values = self._store.read(part.kind, stored, name)
        if values is None:
            return None
        if name == ORIGIN:
            number = {origin: number for number, origin in enumerate(self.origins)}
            return np.array([number[origin] for origin in values.tolist()])
        loads = part.product.loads
        if LOADS not in VARIABLES[name].dims or loads.size == self.loads.size:
            return values
        spread = np.full((len(values), self.loads.size, *values.shape[2:]), np.nan)
        spread[:, np.searchsorted(self.loads, loads)] = values
        return spread

    def dataset(self, without: Collection[str] = ()) -> xr.Dataset:
        """Return the cases in memory, in normalised units but for the loads, without some variables."""
        found = {name: self.values(name) for name in self.names if name not in without}
        unit = PASCAL if self.scene.in_si else NORMALISED_PRESSURE
        return with_pressures_in(over_cases(found, self.methods, self.loads, unit), self.scene.load_unit)


def read_study(curves: Curves, study: str, without: Collection[str] = ()) -> xr.Dataset:
    """Return the cases of a study in memory, without some variables; ValueError if a case is not solved."""
    return Solved(curves, curves.scene.cases_of_study(study)).dataset(without)


def read_cases(curves: Curves, cases: Indices, without: Collection[str] = ()) -> xr.Dataset:
    """Return some cases of the file of a scene in memory, by their numbers, without some variables."""
    data = in_units_of(curves.scene, Solved(curves, cases).dataset(without))
    return data.merge(case_labels(curves.scene).isel(case=cases))


def write(curves: Curves, path: str | Path, step: str, more: xr.Dataset) -> None:
    """Write all cases of a scene in their order, with their labels and `more` variables without cases, atomically.

    `step` is the step that made the data, for the history of the file. Of the variables over loads only one is in
    memory at a time, so that a file may be larger than memory.
    """
    scene, solved = curves.scene, Solved(curves)
    over_loads = [name for name in solved.names if VARIABLES[name].dims == CURVE]
    in_memory = solved.dataset(without=over_loads)
    about = provenance.attributes(scene.title, step, scene.text, in_si=scene.in_si)
    about |= {f"origin_{number}": text for number, text in enumerate(solved.origins)}
    data = in_units_of(scene, in_memory).merge(case_labels(scene)).merge(more).assign_attrs(about)
    labels = in_memory[["total_amplitude"]]  # with all coordinates, which have the scales of traces
    with replacing(path) as temporary:
        write_file(data, temporary)
        for name in over_loads:
            one = labels.assign({name: (CURVE, solved.values(name), variables.attributes(name))})
            append(in_units_of(scene, one)[name], temporary, data.coords)
        if scene.in_si and scene.interface:
            names = {"compliance", "contact_fraction"}.intersection(solved.names)
            own = {name: (CURVE, solved.values(name)) for name in names}
            scene.interface.warn_of_yield(xr.Dataset(own, {LOADS: (LOADS, solved.loads, {"units": PASCAL})}))


def in_units_of(scene: Scene, data: xr.Dataset) -> xr.Dataset:
    """Return data of a scene in SI units, with its bodies as attributes, if its loads are in Pa."""
    if not scene.in_si or not (bodies := scene.interface):
        return data
    return converted(data, bodies.scales(data)).drop_attrs(deep=False).assign_attrs(bodies.given)


def case_labels(scene: Scene) -> xr.Dataset:
    """Return the names of the studies of each case of a scene, in its order, with commas between."""
    attributes = {"long_name": "studies of the case", "coverage_content_type": LABEL}
    return xr.Dataset(coords={"study": (CASE, np.array(scene.studies_of_cases), attributes)})
