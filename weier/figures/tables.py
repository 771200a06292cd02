"""The curves of some studies: arrays of values, and a table with a row for each curve, for figures of many cases."""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Sequence
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier import units
from weier.data import curves
from weier.data.bodies import Bodies
from weier.figures import style
from weier.kernels.arrays import Array, Flags, Indices
from weier.methods.curve import COMPLIANCE, RESISTANCE
from weier.surface.profile import PARAMETERS

PIECES = 8  # segments between two loads that look smooth in print
UNITS = "p_0*", "g_0", "g_0/p_0*"  # units of load, compliance and resistance


class Values:
    """The values of a quantity of one study, normalised or, with an interface, in SI units.

    known : whether there is a curve, shape (cases, methods)
    best : the column of the most accurate numerical method of each case, or -1
    loads : mean pressures in the unit of the study
    values, stated : the quantity and its stated errors, if any, shape (cases, methods, loads)
    slope : that of the compliance over the loads
    """

    def __init__(self, study: xr.Dataset, quantity: str, interface: Bodies | None = None) -> None:
        self.study, self._quantity = study, quantity
        self.methods: list[str] = study["solution_method"].values.tolist()
        self.loads: Array = study["mean_pressure"].values
        pressure = height = resistance = np.ones((1, 1, 1))
        if interface:
            scales = interface.scales(study)
            pressure, height, resistance = (np.reshape(scales[unit][0], (-1, 1, 1)) for unit in UNITS)
            pressure = pressure / units.factor("loads", units.unit_of(study["mean_pressure"]), units.PASCAL)

        def scaled(name: str, scale: Array) -> Array:
            if name not in study:  # such as the contact fraction, which estimates do not return
                return np.full(study[COMPLIANCE].shape, np.nan)
            values: Array = study[name].values
            return values * scale if interface else values  # no copy of a large study

        self.slope = scaled("resistance", height / pressure)
        scale = {COMPLIANCE: height, RESISTANCE: resistance}.get(quantity, np.ones(1))
        self.values, error = scaled(quantity, scale), f"{quantity}_error"
        self.stated = scaled(error, scale) if error in study else None
        self.known: Flags = np.asarray(np.isfinite(self.values).any(axis=-1))
        solved, best = curves.most_accurate(study)
        self.best: Indices = np.where(solved, best, -1)

    def line(self, row: int, column: int) -> tuple[Array, Array]:
        """Return one curve, at its loads and between them."""
        values = self.values[row, column]
        smooth = smooth_compliance(self.loads, values, self.slope[row, column])
        if self._quantity != COMPLIANCE or smooth is None:
            return self.loads, values
        fine = refined_loads(self.loads)
        return fine, smooth(fine)


def common_loads(tables: Sequence[Values]) -> Array:
    """Return the loads that curves of a mean or median have in common; raise ValueError if they have others."""
    loads = tables[0].loads
    if not all(np.array_equal(own.loads, loads) for own in tables):
        raise ValueError("a mean or median takes curves under the same loads: draw studies of other loads apart")
    return loads


def panels_of_series(
    studies: Sequence[xr.Dataset], title: str, quantity: str, *names: str
) -> tuple[Figure, list[tuple[Axes, list[Values]]]]:
    """Return a single-column figure of curves over the load: a panel for each series, with its solved cases.

    A series is a set of values of the named parameters.
    """
    solved = [case for case in curves.cases(studies) if curves.numerical_method(case)]
    title, series = style.limit_panels(title, curves.groups(solved, *names), "series")
    figure, panels = style.column(title, [style.describe(cases[0], *names) for cases in series])
    for axes in panels:
        axes.set_ylabel(style.LABELS[quantity])
    panels[-1].set_xlabel(style.LABELS["mean_pressure"])
    own = [[Values(case.reset_coords().expand_dims("case"), quantity) for case in cases] for cases in series]
    return figure, list(zip(panels, own, strict=True))


def smooth_compliance(loads: Array, h: Array, slope: Array) -> Callable[[Array], Array] | None:
    """Return compliances as a function of the load, with the resistance as slope; None if either is unknown.

    These are the cubic polynomials of scipy.interpolate.CubicHermiteSpline, which takes 0.3 s to import.
    """
    if loads.size < 2 or not np.isfinite(h).all() or not np.isfinite(slope).all():
        return None

    def smooth(at: Array) -> Array:
        left = np.clip(np.searchsorted(loads, at, "right") - 1, 0, loads.size - 2)
        width = loads[left + 1] - loads[left]
        t = (at - loads[left]) / width
        low, high = (1 - t) ** 2, t**2
        ends = (1 + 2 * t) * low * h[..., left] + (3 - 2 * t) * high * h[..., left + 1]
        return np.asarray(ends + width * (t * low * slope[..., left] - (1 - t) * high * slope[..., left + 1]))

    return smooth


def refined_loads(loads: Array) -> Array:
    """Return the loads and others between them, in equal ratios, shape (PIECES (loads - 1) + 1,)."""
    ratio = (loads[1:] / loads[:-1])[:, None] ** (np.arange(PIECES) / PIECES)
    return np.append((loads[:-1, None] * ratio).ravel(), loads[-1])


def table_of(tables: Sequence[Values]) -> pd.DataFrame:
    """Return a table with a row for each curve.

    Columns are the case, its study and row, the method and its column, whether it is the most accurate numerical one,
    and the parameters: the phases as `_phases` returns them, also in place of an unknown seed, and None for the
    parameters of a trace, which its name identifies.
    """
    parts, first = [], 0
    for number, (own, names) in enumerate(zip(tables, _names_of_traces(tables), strict=True)):
        study, size = own.study, len(names)
        rows = np.nan_to_num(study["phases"].values.round(9), nan=np.inf).tolist()
        phases = list(map(cache(_phases), map(tuple, rows)))  # cases of one seed have the same phases
        seeds = study["seed"].values.astype(float) if "seed" in study.variables else np.full(size, np.nan)
        columns: dict[str, Any] = {"case": first + np.arange(size), "study": number, "row": np.arange(size)}
        traced, seeded = np.array([name != "" for name in names]), np.isfinite(seeds)
        for name in PARAMETERS:
            columns[name] = study[name].values.astype(float).astype(object)
            columns[name][traced] = None
        columns |= {"trace": _objects(names), "phases": _objects(phases), "seeded": seeded}
        columns["seed"] = np.where(seeded, seeds, columns["phases"])
        cases, first = pd.DataFrame(columns), first + size
        for column, method in enumerate(own.methods):
            best = own.best == column
            made = cases.assign(method=method, column=column, best=best)
            parts.append(made[own.known[:, column]])
    return pd.concat([part for part in parts if len(part)] or parts[:1], ignore_index=True)


def _objects(values: Sequence[Any]) -> pd.Series:
    return pd.Series(values, dtype=object)


def _phases(row: tuple[float, ...]) -> Hashable:
    """Return the phases of a case, inf if missing: a number if the first is 0 and the others are equal.

    A single wave has none, since its phase changes no curve.
    """
    phases = tuple(phase for phase in row if phase != np.inf)
    if len(phases) < 2:
        return ()
    return phases[1] if phases[0] == 0 and len(set(phases[1:])) == 1 else phases


def extent(tables: Sequence[Values]) -> tuple[float, float, float, float]:
    """Return the first load, the load of full contact, the least positive value and the largest of all curves.

    The least value is taken over the numerical curves, if any, since an estimate may vanish long before the contact
    is full. The largest value is taken over the methods of the paper and the numerical ones, if any.
    """
    drawn = [(own, rows) for own in tables if (rows := own.known.any(axis=1)).any()]
    first = min(float(own.loads[0]) for own, _ in drawn)
    full = max(float(curves.full_contact_loads(own.study)[rows].max()) for own, rows in drawn)
    least, largest, numerical = np.inf, 0.0, np.inf
    for own, rows in drawn:
        counting = np.array([style.sets_axes(method) for method in own.methods], bool)
        counting |= not own.known[rows][:, counting].any()
        values = own.values[rows][:, counting]
        shown = (own.loads >= first) & (own.loads <= full)
        least = min(least, values.min(initial=np.inf, where=shown & (values > 0)))
        largest = max(largest, values.max(initial=0.0, where=shown & (values > 0)))
        best = own.best[rows]
        exact = own.values[rows, best]
        numerical = min(numerical, exact.min(initial=np.inf, where=(best >= 0)[:, None] & shown & (exact > 0)))
    return first, full, float(numerical if np.isfinite(numerical) else least), float(largest)


def _names_of_traces(tables: Sequence[Values]) -> list[list[str]]:
    """Return a unique name for the trace of each case of each study, empty for a series.

    It consists of the path relative to the common folder and, for several traces of one path, the shortest wavelength
    or, if these agree, the digest.
    """
    missing = {"trace": "", "trace_digest": "", "trace_shortest": np.nan}
    parts = []
    for own in (own.study for own in tables):
        lacking = {name: np.full(own.sizes["case"], value) for name, value in missing.items() if name not in own}
        parts.append(pd.DataFrame(lacking | {name: own[name].values for name in missing if name in own}))
    traces = pd.concat(parts).drop_duplicates("trace_digest").query("trace_digest != ''").set_index("trace_digest")
    folder = os.path.commonprefix(traces["trace"].tolist()).rfind("/") + 1  # noqa: RUF071 - of names, not of folders
    names = traces["trace"].str[folder:].replace("", "trace").str.replace("$", r"\$")
    shortest = (1e6 * traces["trace_shortest"]).map(", shortest {:.4g} \u00b5m".format)
    for more in (shortest, ", " + names.index):
        names = names.mask(names.duplicated(keep=False), names + more)
    names = names.str.replace(r"^_", " _", regex=True)  # matplotlib hides "_..."
    texts = {"": ""} | names.to_dict()
    return [[texts[digest] for digest in part["trace_digest"]] for part in parts]
