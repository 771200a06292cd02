"""Studies as arrays over their cases, so that a figure of many cases reduces arrays, not a dataset of each case."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier import units
from weier.data import curves
from weier.data.bodies import Bodies, scales_of
from weier.figures import lines, style
from weier.figures.traces import names_of_traces
from weier.kernels.arrays import Array, Flags, Indices
from weier.methods.curve import COMPLIANCE, QUANTITIES, RESISTANCE
from weier.methods.registry import numerical_names
from weier.surface.profile import PARAMETERS

MISSING = 1e300  # In place of NaN, which numpy does not compare with itself.
UNITS = "p_0*", "g_0", "g_0/p_0*"  # of loads, compliance and resistance


class Extent(NamedTuple):
    """The loads and values of a figure: the first load and full contact, the least positive value and the largest.

    The least is that of the numerical curves, if there are any, since an estimate may vanish long before the contact
    is full. The largest is that of the methods of the paper and of numerical ones, if there are any.
    """

    first_load: float
    full_contact: float
    least: float
    largest: float


class Table:
    """The curves of a quantity of one study.

    known : whether there is a curve, shape (cases, methods)
    best : the column of the most accurate numerical method of each case, or -1
    beside : whether a curve is by another numerical method than that, shape (cases, methods)
    columns : arrays over the cases: codes of parameters, equal for equal values
    loads, h, slope : in p_0*, g_0 and g_0/p_0*; with an interface in the unit of the loads, m, and m over this unit
    factor : resistance over slope; M (rho_1 + rho_2) with an interface
    values : compliances or resistances, shape (cases, methods, loads)
    """

    def __init__(self, study: xr.Dataset, quantity: str, names: Sequence[str], interface: Bodies | None) -> None:
        self.study, self._quantity, self._interface = study, quantity, interface
        self.size = study.sizes["case"]
        self.methods: list[str] = study["solution_method"].values.tolist()
        self.loads: Array = study["mean_pressure"].values
        self.h, self.slope, self.factor = study["compliance"].values, study["resistance"].values, 1.0
        if interface:
            scales = [np.broadcast_to(scales_of(interface, study)[unit][0], self.size) for unit in UNITS]
            pressure, height, resistance = (scale[:, None, None] for scale in scales)
            pressure = pressure / units.factor("loads", units.unit_of(study["mean_pressure"]), units.PASCAL)
            self.h, self.slope = self.h * height, self.slope * (height / pressure)
            self.factor = float((resistance * pressure / height).flat[0])
        resistance = self.slope * self.factor if interface else self.slope
        curves_of = {COMPLIANCE: self.h, RESISTANCE: resistance}
        self.values: Array = curves_of[quantity] if quantity in curves_of else study[quantity].values
        self.known: Flags = np.asarray(np.isfinite(self.values).any(axis=-1))
        solved, best = curves.most_accurate(study)
        self.best: Indices = np.where(solved, best, -1)
        numerical = np.array([method in numerical_names() for method in self.methods], bool)
        self.beside: Flags = numerical & (self.best[:, None] != np.arange(len(self.methods)))
        self.names = np.array(names, object)
        self.columns: dict[str, NDArray[Any]] = {}

    def case(self, row: int) -> xr.Dataset:
        """Return one case, in the units of the figure."""
        case = self.study.isel(case=row).drop_vars("contact_fraction", errors="ignore")  # no warning of yield again
        return self._interface.at(case).in_si(case) if self._interface else case

    def line(self, row: int, method: str, points: bool = False) -> tuple[Array, Array]:
        """Return one curve, at its loads and between them, or as points."""
        column = self.methods.index(method)
        if points or self._quantity not in QUANTITIES:
            return self.loads, self.values[row, column]
        loads, values = lines.between_loads(self._quantity, self.loads, self.h[row, column], self.slope[row, column])
        return loads, values if self._quantity == "compliance" else values * self.factor

    def parameters(self, row: int) -> dict[str, Hashable]:
        """Return the values of a case for grouping: equal phases as one number, a seed instead of its phases."""
        phase = self.phases[row]
        phase = phase[phase != MISSING]
        phases = float(phase[0]) if phase.size and np.ptp(phase) == 0 else tuple(phase.tolist())
        trace, seed = self.names[row], float(self.seeds[row])
        numbers = {name: None if trace else float(self.study[name].values[row]) for name in PARAMETERS}
        own = {"": None, "case": int(self.columns["case"][row]), **numbers, "trace": trace}
        return own | {"phases": phases, "seed": seed if np.isfinite(seed) else phases}

    @cached_property
    def phases(self) -> Array:
        """Phases of all terms but the first, rounded, and MISSING where there is no term."""
        phases = self.study["phases"].values[:, 1:]
        return np.where(np.isfinite(phases), phases.round(9), MISSING)

    @cached_property
    def seeds(self) -> Array:
        """The seed of each case, or NaN."""
        seeds = self.study["seed"].values if "seed" in self.study.variables else np.full(self.size, np.nan)
        return np.asarray(seeds, float)


def tables_of(studies: Sequence[xr.Dataset], quantity: str, interface: Bodies | None = None) -> list[Table]:
    """Return the tables of some studies, with codes of parameters that they have in common."""
    named = _names_of_traces(studies)
    tables = [Table(study, quantity, names, interface) for study, names in zip(studies, named, strict=True)]
    if not tables:
        return []
    terms = max(table.phases.shape[1] for table in tables)
    padded = [
        np.pad(table.phases, ((0, 0), (0, terms - table.phases.shape[1])), constant_values=MISSING)
        for table in tables
    ]
    seeds = np.concatenate([table.seeds for table in tables])
    names = np.concatenate([table.names.astype(str) for table in tables])
    phases = codes(np.zeros(seeds.size), *np.concatenate(padded).T)  # of one wave there are none
    columns: dict[str, NDArray[Any]] = {
        "case": np.arange(phases.size),
        "trace": codes(names),
        "phases": phases,
        "seed": np.where(np.isfinite(seeds), seeds, -1.0 - phases),
        "seeded": np.isfinite(seeds),
        "waves": np.concatenate([table.study["m"].values for table in tables]),
    }
    for name in PARAMETERS:
        values = np.concatenate([np.asarray(table.study[name].values, float) for table in tables])
        values[names != ""] = MISSING  # the name of a trace says all
        columns[name] = codes(np.where(np.isnan(values), MISSING, values))
    ends = np.cumsum([table.size for table in tables])
    for table, end in zip(tables, ends, strict=True):
        table.columns = {name: values[end - table.size : end] for name, values in columns.items()}
    return tables


def codes(*columns: NDArray[Any]) -> Indices:
    """Return a number for each row of these columns, the same for the same values.

    A product of parameters repeats its values in runs, of which only the first ones are sorted.
    """
    new = np.ones(len(columns[0]), bool)
    new[1:] = np.any([values[1:] != values[:-1] for values in columns], axis=0)
    first = [values[new] for values in columns]
    order = np.lexsort(first)
    changes = np.any([values[order[1:]] != values[order[:-1]] for values in first], axis=0)
    code = np.empty(order.size, int)
    code[order] = np.append(0, np.cumsum(changes))
    return code[np.cumsum(new) - 1]


def extent(tables: Sequence[Table]) -> Extent:
    """Return the loads and values of all cases that have a curve."""
    first, full = np.inf, -np.inf
    drawn = [(table, rows) for table in tables if (rows := table.known.any(axis=1)).any()]
    for table, rows in drawn:
        first = min(first, float(table.loads[0]))
        full = max(full, float(curves.full_contact_loads(table.study)[rows].max()))
    least, largest, numerical = np.inf, 0.0, np.inf
    for table, rows in drawn:
        counting = np.array([style.counts(method) for method in table.methods], bool)
        counting |= not table.known[rows][:, counting].any()
        values = table.values[rows][:, counting]
        shown = (table.loads >= first) & (table.loads <= full)
        positive = shown & (values > 0)
        least = min(least, values.min(initial=np.inf, where=positive))
        largest = max(largest, values.max(initial=0.0, where=positive))
        best = table.best[rows]
        own, there = table.values[rows, best], (best >= 0)[:, None]
        numerical = min(numerical, own.min(initial=np.inf, where=there & shown & (own > 0)))
    return Extent(first, full, float(numerical if np.isfinite(numerical) else least), float(largest))


def _names_of_traces(studies: Sequence[xr.Dataset]) -> list[list[str]]:
    """Return a name for the trace of each case of each study, empty for a series."""
    first: dict[str, xr.Dataset] = {}
    for study in studies:
        for digest, row in zip(*np.unique(_digests(study), return_index=True), strict=True):
            first.setdefault(str(digest), study.isel(case=int(row)))
    known = dict(zip(first, names_of_traces(first.values()), strict=True))
    return [[known[str(digest)] for digest in _digests(study)] for study in studies]


def _digests(study: xr.Dataset) -> NDArray[Any]:
    """Return the digest of the trace of each case, empty for a series."""
    given = study["trace_digest"].values if "trace_digest" in study.variables else np.full(study.sizes["case"], "")
    return np.asarray(given, str)
