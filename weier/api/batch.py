"""A batch of a scene: many cases, solved into one dataset."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from weier.api.progress import LOG_SECONDS
from weier.api.task import CurveTask
from weier.api.workers import Outcome, solve_curves
from weier.data import dataset
from weier.data.variables import LOADS, VARIABLES, Status
from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.method import Method
from weier.methods.progress import STOPS
from weier.methods.registry import find_method
from weier.methods.settings import all_settings
from weier.scene.case import Case
from weier.scene.cases import layout_of
from weier.surface.limits import resolvable
from weier.surface.loads import LoadsOf
from weier.theory.bounds import first_contact, infinite_series_bounds
from weier.units import NORMALISED_PRESSURE, PASCAL

Arrays = Mapping[str, NDArray[Any]]
Report = Callable[[str], None]


def _report(message: str) -> None:
    print(message, file=sys.stderr)


def solve_batch(
    cases: Iterable[Case],
    mean_pressure: ArrayLike,
    contact_edges: bool = False,
    done: Report = _report,
    failed: Report = _report,
    pause: float = LOG_SECONDS,
    workers: int = 1,
    loads_of: LoadsOf | None = None,
    known: xr.Dataset | None = None,
    keep: Callable[[xr.Dataset], None] | None = None,
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
    known : Dataset, optional
        The result for the first cases, which are not solved again.
    keep : callable, optional
        Called with the result for the first cases if Ctrl-C interrupts the solution.

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
    first = 0 if known is None else known.sizes["case"]
    if known is not None:
        for variable in data.data_vars.keys() | data.coords.keys() - data.sizes.keys():
            rows[str(variable)][:first] = known[variable].values
    own = [loads if loads_of is None else loads_of(case.profile) for case in cases[first:]]
    curves = [
        CurveTask(case.profile, name, case.settings.get(name, {}), loads)
        for case, loads in zip(cases[first:], own, strict=True)
        for name in case.methods
    ]
    outcomes, number, again = iter(solve_curves(curves, workers, pause, done)), first, 0
    try:
        for number, case in enumerate(cases[first:], first):
            describe_case(rows, number, case)
            for name in case.methods:
                found = _found(case, name, next(outcomes), own[number - first], failed)
                _store(rows, {"case": number, "solution_method": methods.index(name)}, found)
                again += found.get("second_attempts", 0)
    except STOPS as stop:
        if (part := getattr(stop, "curve", None)) is not None:
            found = _found_of_part(case, name, part, own[number - first])
            _store(rows, {"case": number, "solution_method": methods.index(name)}, found)
        if keep is not None and number > first and isinstance(stop, KeyboardInterrupt):
            keep(data.isel(case=slice(number)))
        begun = data.isel(case=slice(number + 1))
        vars(stop)["curve"] = begun if np.isfinite(begun["compliance"]).any() else None
        raise
    if again > 0:
        done(f"{again} of {sum(curve.loads.size for curve in curves)} loads took a second attempt")
    return data


def _found(case: Case, name: str, outcome: Outcome, loads: Array, failed: Report) -> dict[str, Any]:
    """Return the stored values of a curve; `failed` is called with the reason if there is none."""
    method, given = find_method(name), case.settings.get(name, {})
    found = {"settings": json.dumps(all_settings(method, given), sort_keys=True), "status": Status.solved}
    if isinstance(outcome, Exception):
        unconverged = isinstance(outcome, ConvergenceError)
        failed(f"{case.profile.describe()}, {name}: {outcome}")
        return found | {"status": Status.not_converged if unconverged else Status.not_applicable}
    solution, seconds = outcome
    return found | solution._asdict() | _bounds(case, method, solution, loads) | {"seconds": seconds}


def _found_of_part(case: Case, name: str, part: tuple[Array, Any], loads: Array) -> dict[str, Any]:
    """Return the stored values of a curve that was stopped: NaN at the loads that are not solved."""
    solved, solution = part
    found = _found(case, name, (solution, math.nan), solved, _report)
    for variable, value in found.items():
        if variable in VARIABLES and LOADS in VARIABLES[variable].dims and np.ndim(value):
            whole = np.full((loads.size, *np.shape(value)[1:]), np.nan)
            whole[np.searchsorted(loads, solved)] = value
            found[variable] = whole
    return found


def arrays(data: xr.Dataset) -> Arrays:
    """Return the values of each variable, to be filled in, since access through the dataset is slower."""
    return {str(name): variable.values for name, variable in data.variables.items()}


def describe_case(values_of: Arrays, number: int, case: Case) -> None:
    """Fill in the coordinates of a case."""
    profile = case.profile
    values = profile.labels | {"key": case.key, "phases": profile.listed_phases}
    values |= {"total_amplitude": profile.total_amplitude, "tail_amplitude": profile.tail_amplitude}
    if np.isfinite(profile.m) and resolvable(profile):
        values["first_contact"] = first_contact(profile)
    _store(values_of, {"case": number}, values)


def _store(curves: Arrays, position: Mapping[str, int], values: Mapping[str, Any]) -> None:
    """Write one case, or one curve, into its row of each array.

    All values returned by a method are stored if they are in the table of variables, arrays over the loads as well as
    scalars, such as `chosen_method` and `chosen_terms`.
    """
    for name, value in values.items():
        if name in curves and np.size(value):  # a method may return no edges
            # A case has one row of edges, of its last method, which may find fewer contacts than the one before.
            if "edge" in VARIABLES[name].dims:
                curves[name][_row(name, position)] = np.nan
            curves[name][_row(name, position, np.shape(value))] = value


def _bounds(case: Case, method: Method, solution: Any, loads: Array) -> dict[str, Array]:
    """Return bounds on the infinite series, from the curve of a truncated one by a method that solves it."""
    profile = case.profile
    if not method.numerical or math.isinf(profile.m) or math.isnan(profile.tail_amplitude):
        return {}
    return infinite_series_bounds(profile, loads, solution.compliance, solution.compliance_error)


def _row(name: str, position: Mapping[str, int], shape: tuple[int, ...] = ()) -> tuple[int | slice, ...]:
    """Return the index of values of this shape in the array of a variable, for a case and method."""
    sizes = iter(shape)
    return tuple(position[dim] if dim in position else slice(next(sizes, None)) for dim in VARIABLES[name].dims)
