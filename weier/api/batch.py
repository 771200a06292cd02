"""Many cases, solved into one dataset."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from weier.api.progress import LOG_SECONDS
from weier.api.rows import BOUNDS, curve_row, surface_row
from weier.api.task import CurveTask, Known
from weier.api.workers import solve_curves
from weier.data import dataset
from weier.data.variables import LOADS, VARIABLES
from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.load_progress import keeping
from weier.methods.registry import find_method, returned_by
from weier.methods.settings import all_settings
from weier.scene.case import Case
from weier.surface.limits import resolvable
from weier.surface.loads import LoadsOf
from weier.units import NORMALISED_PRESSURE, PASCAL

Arrays = Mapping[str, NDArray[Any]]
Report = Callable[[str], None]


def _report(message: str) -> None:
    print(message, file=sys.stderr)


class Layout(NamedTuple):
    """The sizes and variables of the arrays for some cases.

    methods : of all cases, in order of appearance
    terms : of the longest finite series
    edges : the most edges of contact, two for each of the finest waves in a period; 0 if they are not kept
    optional : variables that not all files have: those that the methods return, and the labels of traces
    """

    methods: tuple[str, ...]
    terms: int
    edges: int
    optional: frozenset[str] = frozenset()


def layout_of(cases: Collection[Case], contact_edges: bool) -> Layout:
    """Return the sizes and variables of the arrays for these cases."""
    methods = dict.fromkeys(method for case in cases for method in case.methods)
    finite = [case.profile for case in cases if math.isfinite(case.profile.m)]
    resolved = filter(resolvable, finite) if contact_edges else ()
    edges = max((2 * profile.waves_per_period[-1] for profile in resolved), default=0)
    returned = [*returned_by(methods), *(BOUNDS if any(find_method(name).numerical for name in methods) else ())]
    optional = frozenset(returned).union(*(profile.labels for profile in finite))
    terms = max((2 if len(finite) < len(cases) else 1, *(profile.listed_terms for profile in finite)))
    return Layout(tuple(methods), terms, edges, optional)


def solve_batch(
    cases: Iterable[Case],
    mean_pressure: ArrayLike,
    contact_edges: bool = False,
    done: Report = _report,
    failed: Report = _report,
    pause: float = LOG_SECONDS,
    workers: int = 1,
    loads_of: LoadsOf | None = None,
    known: Mapping[str, Known] | None = None,
) -> xr.Dataset:
    """Solve cases under common loads, and report the progress every few seconds.

    Parameters
    ----------
    cases : iterable of Case
        The rows of the result, in their order.
    mean_pressure : array_like, shape (loads,)
        Increasing loads, in p_0*, or in Pa with `loads_of`.
    contact_edges : bool
        Whether to keep the edges of contact.
    done, failed : callable
        `done` is called with a line of progress every `pause` seconds and with the number of second attempts,
        `failed` with the reason why a method has no curve.
    pause : float
        Seconds between two lines of progress.
    workers : int
        Number of processes.
    loads_of : callable, optional
        From a surface to its loads in p_0*, for loads in Pa.
    known : mapping, optional
        Of a single case: the curves that are known under some of the loads, by method.

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
    methods, terms, edges, optional = layout_of(cases, contact_edges)
    unit = NORMALISED_PRESSURE if loads_of is None else PASCAL
    data = dataset.blank(len(cases), methods, loads, terms, edges, optional | {"seconds"}, unit)
    rows = arrays(data)
    own = [loads if loads_of is None else loads_of(case.profile) for case in cases]
    curves = [
        CurveTask(case.profile, name, case.settings.get(name, {}), loads, (known or {}).get(name))
        for case, loads in zip(cases, own, strict=True)
        for name in case.methods
    ]
    outcomes, position, again = iter(solve_curves(curves, workers, pause, done)), iter(curves), 0
    number, curve = 0, curves[0]

    def begun(part: tuple[Array, Curve] | None) -> xr.Dataset | None:
        """Return the solved curves and the solved part of the current one."""
        if part is not None:
            _store_curve(rows, number, methods, curve, _row_of_part(curve, part))
        found = data.isel(case=slice(number + 1))
        return found if np.isfinite(found["compliance"]).any() else None

    for one in curves:
        if one.known is not None:
            _store_curve(rows, number, methods, one, _row_of_part(one, one.known[:2]))
    with keeping(begun):
        for number, case in enumerate(cases):
            describe_case(rows, number, case, loads)
            for name in case.methods:
                curve = next(position)
                outcome = next(outcomes)
                if isinstance(outcome, Exception):
                    failed(f"{case.profile.describe()}, {name}: {outcome}")
                found = curve_row(curve, outcome)
                _store_curve(rows, number, methods, curve, found)
                again += found.get("second_attempts", 0)
    if again > 0:
        done(f"{again} of {sum(curve.loads.size for curve in curves)} loads took a second attempt")
    return data


def _store_curve(
    rows: Arrays, number: int, methods: Sequence[str], curve: CurveTask, found: Mapping[str, Any]
) -> None:
    """Write one curve with its settings into its row."""
    settings = json.dumps(all_settings(find_method(curve.method), curve.settings), sort_keys=True)
    position = {"case": number, "solution_method": methods.index(curve.method)}
    _store(rows, position, {**found, "settings": settings})


def _row_of_part(curve: CurveTask, part: tuple[Array, Curve]) -> dict[str, Any]:
    """Return an interrupted curve, with NaN at unsolved loads."""
    solved, solution = part
    found = curve_row(curve._replace(loads=solved), (solution, math.nan))
    for name, value in found.items():
        if name in VARIABLES and LOADS in VARIABLES[name].dims and np.ndim(value):
            whole = np.full((curve.loads.size, *np.shape(value)[1:]), np.nan)
            whole[np.searchsorted(curve.loads, solved)] = value
            found[name] = whole
    return found


def arrays(data: xr.Dataset) -> Arrays:
    """Return the arrays of all variables, since writing through the dataset is slower."""
    return {str(name): variable.values for name, variable in data.variables.items()}


def describe_case(values_of: Arrays, number: int, case: Case, loads: Array) -> None:
    """Fill in the coordinates of a case."""
    _store(values_of, {"case": number}, surface_row(case.profile) | {"key": case.key(loads)})


def _store(curves: Arrays, position: Mapping[str, int], values: Mapping[str, Any]) -> None:
    """Write one case, or one curve, into its row of each array.

    All values returned by a method are stored if they are in the table of variables, arrays over the loads as well as
    scalars, such as `chosen_method` and `chosen_terms`.
    """
    for name, value in values.items():
        if name in curves and np.size(value):  # a method may return no edges
            # The last method overwrites the edges of a case, and may find fewer contacts than the one before.
            if "edge" in VARIABLES[name].dims:
                curves[name][_row(name, position)] = np.nan
            curves[name][_row(name, position, np.shape(value))] = value


def _row(name: str, position: Mapping[str, int], shape: tuple[int, ...] = ()) -> tuple[int | slice, ...]:
    """Return the index of values of this shape in the array of a variable, for a case and method."""
    sizes = iter(shape)
    return tuple(position[dim] if dim in position else slice(next(sizes, None)) for dim in VARIABLES[name].dims)
