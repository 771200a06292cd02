"""Many cases, solved into one dataset."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from weier.api.progress import counted, showing
from weier.api.rows import BOUNDS, curve_row, surface_row
from weier.api.task import CurveTask, Known, distinct
from weier.api.workers import solve_curves
from weier.data import dataset
from weier.data.variables import CASE, LOADS, VARIABLES
from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.load_progress import keeping
from weier.methods.registry import find_method, returned_by
from weier.methods.settings import all_settings
from weier.scene.case import Case
from weier.scene.identity import short_keys
from weier.surface.loads import LoadsOf
from weier.surface.waves import resolvable
from weier.units import NORMALISED_PRESSURE, PASCAL

Arrays = Mapping[str, NDArray[Any]]


def _report(message: str) -> None:
    print(message, file=sys.stderr)


def solve_batch(
    cases: Iterable[Case],
    mean_pressure: ArrayLike,
    contact_edges: bool = False,
    failed: Callable[[str], None] = _report,
    workers: int = 1,
    loads_of: LoadsOf | None = None,
    known: Mapping[str, Known] | None = None,
    max_seconds: float | None = None,
) -> xr.Dataset:
    """Solve cases under common loads, and show the progress.

    Curves that do not depend on the phases are solved once for all cases that differ only in these.

    Parameters
    ----------
    cases : iterable of Case
        The rows of the result, in their order.
    mean_pressure : array_like, shape (loads,)
        Increasing loads, in p_0*, or in Pa with `loads_of`.
    contact_edges : bool
        Whether to keep the edges of contact.
    failed : callable
        Called with the reason why a method has no curve.
    workers : int
        Number of processes.
    loads_of : callable, optional
        From a surface to its loads in p_0*, for loads in Pa.
    known : mapping, optional
        Of a single case: the curves that are known under some of the loads, by method.
    max_seconds : float, optional
        Limit of the time.

    Returns
    -------
    Dataset
        Over case, method, mean_pressure and term, with bounds on the infinite series and the seconds that each curve
        took; values that could not be solved are NaN, and status has the reason.

    Raises
    ------
    KeyboardInterrupt, TimeoutError
        If the solution is stopped: `curve` is the result so far, up to the case that was being solved, or None.
    """
    cases, loads = list(cases), np.asarray(mean_pressure, float)
    data = _blank(cases, loads, NORMALISED_PRESSURE if loads_of is None else PASCAL, contact_edges)
    rows, methods = arrays(data), data["solution_method"].values.tolist()
    own_loads = [loads if loads_of is None else loads_of(case.profile) for case in cases]
    curves = [
        (number, CurveTask(case.profile, name, case.settings.get(name, {}), own, (known or {}).get(name)))
        for number, (case, own) in enumerate(zip(cases, own_loads, strict=True))
        for name in case.methods
    ]

    def store(number: int, curve: CurveTask, row: Mapping[str, Any], solved: Array | None = None) -> None:
        """Write a curve with its settings into its row, or a part of it, at the solved loads."""
        settings = json.dumps(all_settings(find_method(curve.method), curve.settings), sort_keys=True)
        position = {CASE: number, "solution_method": methods.index(curve.method)}
        at = slice(None) if solved is None else np.searchsorted(curve.loads, solved)
        _store(rows, {**position, LOADS: at}, {**row, "settings": settings})

    def store_part(number: int, curve: CurveTask, solved: Array, solution: Curve) -> None:
        store(number, curve, curve_row(curve._replace(loads=solved), (solution, math.nan)), solved)

    def solved_so_far(part: tuple[Array, Curve] | None) -> xr.Dataset | None:
        """Return the solved curves and the solved part of the current one."""
        if part is not None:
            store_part(number, curve, *part)
        found = data.isel(case=slice(number + 1))
        return found if np.isfinite(found["compliance"]).any() else None

    for number, curve in curves:
        if curve.known is not None:
            store_part(number, curve, curve.known.loads, curve.known.curve)
    to_solve = distinct(curve for _, curve in curves)
    outcomes: dict[object, Any] = {}
    expected = sum(curve.expected for curve in to_solve) / min(workers, len(to_solve))
    total = loads.size * len(to_solve)
    with (
        showing("weier.solve", total, counted(total, "load"), max_seconds, expected) as progress,
        keeping(solved_so_far),
    ):
        new = solve_curves(to_solve, workers, progress)
        for number, curve in curves:
            if curve.method == cases[number].methods[0]:
                describe_case(rows, number, cases[number], loads)
            outcome = outcomes[series] if (series := curve.series) in outcomes else next(new)
            if series is not None:
                outcomes[series] = outcome
            if isinstance(outcome, Exception):
                failed(f"{curve.profile.describe()}, {curve.method}: {outcome}")
            store(number, curve, curve_row(curve, outcome))
    return data


def _blank(cases: Collection[Case], loads: Array, unit: str, contact_edges: bool) -> xr.Dataset:
    """Return a dataset without values for these cases.

    It has room for the terms of the longest finite series and for two contact edges for each of the finest waves in a
    period. Its optional variables are the quantities returned by the methods, and the labels of traces.
    """
    methods = list(dict.fromkeys(method for case in cases for method in case.methods))
    finite = [case.profile for case in cases if math.isfinite(case.profile.m)]
    resolved = filter(resolvable, finite) if contact_edges else ()
    edges = max((2 * profile.waves_per_period[-1] for profile in resolved), default=0)
    returned = {"seconds", *returned_by(methods)}.union(*(profile.labels for profile in finite))
    if any(find_method(name).numerical for name in methods):
        returned |= {*BOUNDS}
    terms = max((2 if len(finite) < len(cases) else 1, *(profile.listed_terms for profile in finite)))
    return dataset.blank(len(cases), methods, loads, terms, edges, returned, unit)


def arrays(data: xr.Dataset) -> Arrays:
    """Return the arrays of all variables, since writing through the dataset is slower."""
    return {str(name): variable.values for name, variable in data.variables.items()}


def describe_case(values_of: Arrays, number: int, case: Case, loads: Array) -> None:
    """Fill in the coordinates of a case."""
    keys = {"key": case.key(loads), "surface_key": short_keys(np.array([case.surface_key]))[0]}
    _store(values_of, {CASE: number}, surface_row(case.profile) | keys)


def _store(curves: Arrays, position: Mapping[str, Any], values: Mapping[str, Any]) -> None:
    """Write one case, or one curve, into its row of each array.

    All values returned by a method are stored if they are in the table of variables, arrays over the loads as well as
    scalars, such as `chosen_method` and `chosen_terms`.
    """
    for name, value in values.items():
        if name in curves and np.size(value):  # a method may return no edges
            dims = VARIABLES[name].dims
            if "edge" in dims:  # a previous method may have found more contacts
                curves[name][tuple(position.get(dim, slice(None)) for dim in dims)] = np.nan
            width = slice(np.shape(value)[-1] if np.ndim(value) else None)  # number of terms or edges
            curves[name][tuple(position.get(dim, width) for dim in dims)] = value
