"""The curves of some studies: arrays of values, and a table with a row for each curve, for figures of many cases."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from weier import units
from weier.data import curves
from weier.data.bodies import Bodies, scales_of
from weier.figures import lines, style
from weier.figures.traces import names_of_traces
from weier.kernels.arrays import Array, Flags, Indices
from weier.methods.curve import COMPLIANCE, QUANTITIES, RESISTANCE
from weier.methods.registry import numerical_names
from weier.surface.profile import PARAMETERS

UNITS = "p_0*", "g_0", "g_0/p_0*"  # units of load, compliance and resistance


class Extent(NamedTuple):
    """The loads and values of a figure: the first load and full contact, the least positive value and the largest.

    The least value is taken over the numerical curves, if any, since an estimate may vanish long before the contact
    is full. The largest value is taken over the methods of the paper and the numerical ones, if any.
    """

    first_load: float
    full_contact: float
    least: float
    largest: float


class Values:
    """The values of a quantity of one study.

    known : whether there is a curve, shape (cases, methods)
    best : the column of the most accurate numerical method of each case, or -1
    loads, h, slope : in p_0*, g_0 and g_0/p_0*; with an interface in the unit of the loads, m, and m over this unit
    factor : resistance over slope; M (rho_1 + rho_2) with an interface
    values : compliances or resistances, shape (cases, methods, loads)
    """

    def __init__(self, study: xr.Dataset, quantity: str, interface: Bodies | None) -> None:
        self.study, self._quantity, self._interface = study, quantity, interface
        self.methods: list[str] = study["solution_method"].values.tolist()
        self.loads: Array = study["mean_pressure"].values
        self.h, self.slope, self.factor = study["compliance"].values, study["resistance"].values, 1.0
        if interface:
            scales = [np.broadcast_to(scales_of(interface, study)[unit][0], study.sizes["case"]) for unit in UNITS]
            pressure, height, resistance = (scale[:, None, None] for scale in scales)
            pressure = pressure / units.factor("loads", units.unit_of(study["mean_pressure"]), units.PASCAL)
            self.h, self.slope = self.h * height, self.slope * (height / pressure)
            self.factor = float((resistance * pressure / height).flat[0])
        curves_of = {COMPLIANCE: self.h, RESISTANCE: self.slope * self.factor if interface else self.slope}
        self.values: Array = curves_of[quantity] if quantity in curves_of else study[quantity].values
        self.known: Flags = np.asarray(np.isfinite(self.values).any(axis=-1))
        solved, best = curves.most_accurate(study)
        self.best: Indices = np.where(solved, best, -1)

    def case(self, row: int) -> xr.Dataset:
        """Return one case, in the units of the figure."""
        case = self.study.isel(case=row).drop_vars(
            "contact_fraction", errors="ignore"
        )  # the warning of yield was already given
        return self._interface.at(case).in_si(case) if self._interface else case

    def line(self, row: int, column: int, points: bool = False) -> tuple[Array, Array]:
        """Return one curve, at its loads and between them, or as points."""
        if points or self._quantity not in QUANTITIES:
            return self.loads, self.values[row, column]
        loads, values = lines.between_loads(self._quantity, self.loads, self.h[row, column], self.slope[row, column])
        return loads, values if self._quantity == COMPLIANCE else values * self.factor


def values_of(studies: Sequence[xr.Dataset], quantity: str, interface: Bodies | None = None) -> list[Values]:
    """Return the values of some studies."""
    return [Values(study, quantity, interface) for study in studies]


def table_of(tables: Sequence[Values]) -> pd.DataFrame:
    """Return a table with a row for each curve.

    Columns are the case, its study and row, the method and its column, whether it is the most accurate one or another
    numerical one, and the parameters: equal phases as one number, phases in place of an unknown seed, and None for
    the parameters of a trace, which its name identifies.
    """
    parts, first = [pd.DataFrame(columns=["case", "method"])], 0
    for number, (own, names) in enumerate(zip(tables, _names_of_traces(tables), strict=True)):
        study, size = own.study, len(names)
        phases = [_phases(row) for row in study["phases"].values[:, 1:].round(9)]
        seeds = study["seed"].values.astype(float) if "seed" in study.variables else np.full(size, np.nan)
        columns: dict[str, Any] = {"case": first + np.arange(size), "study": number, "row": np.arange(size)}
        for name in PARAMETERS:
            values = study[name].values.astype(float).tolist()
            columns[name] = _objects(None if trace else value for trace, value in zip(names, values, strict=True))
        columns |= {"trace": _objects(names), "phases": _objects(phases), "seeded": np.isfinite(seeds)}
        pairs = zip(seeds.tolist(), phases, strict=True)
        columns["seed"] = _objects(seed if np.isfinite(seed) else phase for seed, phase in pairs)
        cases, first = pd.DataFrame(columns), first + size
        for column, method in enumerate(own.methods):
            best = own.best == column
            other = ~best & (method in numerical_names())
            made = cases.assign(method=method, column=column, best=best, other_numerical=other)
            parts.append(made[own.known[:, column]])
    return pd.concat([part for part in parts if len(part)] or parts[:1], ignore_index=True)


def _objects(values: Any) -> pd.Series:
    return pd.Series(list(values), dtype=object)


def _phases(row: Array) -> Hashable:
    """Return the phases of the further terms of a case: a number if they are equal."""
    phases = row[np.isfinite(row)].tolist()
    return phases[0] if len(set(phases)) == 1 else tuple(phases)


def extent(tables: Sequence[Values]) -> Extent:
    """Return the loads and values of all cases that have a curve."""
    drawn = [(own, rows) for own in tables if (rows := own.known.any(axis=1)).any()]
    first = min(float(own.loads[0]) for own, _ in drawn)
    full = max(float(curves.full_contact_loads(own.study)[rows].max()) for own, rows in drawn)
    least, largest, numerical = np.inf, 0.0, np.inf
    for own, rows in drawn:
        counting = np.array([style.counts(method) for method in own.methods], bool)
        counting |= not own.known[rows][:, counting].any()
        values = own.values[rows][:, counting]
        shown = (own.loads >= first) & (own.loads <= full)
        least = min(least, values.min(initial=np.inf, where=shown & (values > 0)))
        largest = max(largest, values.max(initial=0.0, where=shown & (values > 0)))
        best = own.best[rows]
        exact = own.values[rows, best]
        numerical = min(numerical, exact.min(initial=np.inf, where=(best >= 0)[:, None] & shown & (exact > 0)))
    return Extent(first, full, float(numerical if np.isfinite(numerical) else least), float(largest))


def _names_of_traces(tables: Sequence[Values]) -> list[list[str]]:
    """Return a name for the trace of each case of each study, empty for a series."""
    digests, first = [], dict[str, xr.Dataset]()
    for own in tables:
        study, empty = own.study, np.full(own.study.sizes["case"], "")
        digests.append((study["trace_digest"].values if "trace_digest" in study.variables else empty).astype(str))
        for digest, row in zip(*np.unique(digests[-1], return_index=True), strict=True):
            first.setdefault(str(digest), study.isel(case=int(row)))
    known = dict(zip(first, names_of_traces(first.values()), strict=True))
    return [[known[digest] for digest in own.tolist()] for own in digests]
