"""Many cases in one process: a scene's batch, solved into one dataset, on as many threads as it is given."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.data import dataset
from weier.data.dataset import Status
from weier.data.variables import VARIABLES
from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError, NotApplicableError
from weier.methods.method import Method
from weier.methods.progress import telling
from weier.methods.registry import find_method
from weier.methods.settings import all_settings
from weier.methods.solve import solve_checked
from weier.pipeline.bounds import first_contact, infinite_series_bounds
from weier.pipeline.progress import LOG_SECONDS, Loads
from weier.scene.case import Case
from weier.scene.cases import Scene
from weier.theory.limits import resolvable
from weier.theory.profile import Profile

Arrays = Mapping[str, NDArray[Any]]
Report = Callable[[str], None]


class _Solver:
    """Solves the profiles of cases under the same loads.

    It keeps the last curve of each method that does not depend on the phases: the next case may differ in them alone.
    """

    def __init__(self, loads: Array) -> None:
        self.loads = loads
        self._last: dict[str, tuple[object, tuple[Any, float]]] = {}

    def solve(self, profile: Profile, method: Method, settings: Mapping[str, Any]) -> tuple[Any, float]:
        """What a method says of a profile, and the seconds that it took."""
        if method.uses_phases:
            return solve_checked(profile, self.loads, method, settings)
        method.check_applies(profile)  # a trace has no D
        wanted = profile.D, profile.gamma, profile.m, settings
        known, solved = self._last.get(method.name, (None, None))
        if solved is None or known != wanted:
            solved = solve_checked(profile, self.loads, method, settings)
            self._last[method.name] = wanted, solved
        return solved


def _tell(message: str) -> None:
    print(message, file=sys.stderr)


def solve_batch(
    scene: Scene,
    cases: Iterable[Case],
    threads: int = 1,
    done: Report = _tell,
    failed: Report = _tell,
    pause: float = LOG_SECONDS,
) -> tuple[xr.Dataset, xr.Dataset]:
    """Solve cases of a scene, and say every few seconds how far it is.

    Parameters
    ----------
    scene : Scene
        Whose loads and layout they share.
    cases : iterable of Case
        The rows of the result, in their order.
    threads : int
        Cases at a time: the kernels leave the interpreter to each other. The data do not depend on it.
    done, failed : callable
        Take a line of how many loads are done, every few seconds, and one that says why a method has no curve.
    pause : float
        These few seconds.

    Returns
    -------
    data : Dataset
        Over case, method, mean_pressure and term, with bounds on the infinite series; what could not be solved is
        NaN, and status says why.
    cost : Dataset
        Seconds for each case and method: apart, since they differ from run to run.

    """
    cases = list(cases)
    methods, terms, edges, optional = scene.layout_of(cases)  # not the scene's: other cases may change
    data = dataset.blank(len(cases), methods, scene.loads, terms, edges, optional)
    cost = dataset.blank_cost(len(cases), methods, terms)
    curves, costs = arrays(data), arrays(cost)
    solver, curves_asked = _Solver(scene.loads), sum(len(case.methods) for case in cases)
    loads = Loads(curves_asked * scene.loads.size, scene.loads.size, pause, done)

    def solve_case(number: int) -> None:
        case = cases[number]
        describe_case(curves, number, case)
        for method in case.methods:
            position = {"case": number, "solution_method": methods.index(method)}
            with telling(loads):
                why = _solve_into(curves, costs, position, case, find_method(method), solver)
            loads.end_curve()
            if why:
                failed(f"{case.profile.describe()}, {method}: {why}")
        for name in costs.keys() & curves.keys() - data.sizes.keys():
            costs[name][number] = curves[name][number]

    if threads == 1:  # in this thread, which Ctrl-C reaches
        for number in range(len(cases)):
            solve_case(number)
    else:
        _solve_side_by_side(solve_case, len(cases), threads)
    return data, cost


def _solve_side_by_side(solve_case: Callable[[int], None], count: int, threads: int) -> None:
    pool = ThreadPoolExecutor(threads)
    try:
        for _ in pool.map(solve_case, range(count)):  # raises what a case raised
            pass
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def arrays(data: xr.Dataset) -> Arrays:
    """The values of each variable, to be filled in: a dataset takes longer to find them."""
    return {str(name): variable.values for name, variable in data.variables.items()}


def describe_case(values_of: Arrays, number: int, case: Case) -> None:
    """Fill in the coordinates of a case."""
    profile = case.profile
    values = {"key": case.key, **profile.labels}
    del values["phases"]  # as text
    values |= {"total_amplitude": profile.total_amplitude, "tail_amplitude": profile.tail_amplitude}
    if np.isfinite(profile.m):
        if resolvable(profile):
            values["first_contact"] = first_contact(profile)
        values_of["phases"][number, : profile.listed_terms] = profile.phase[: profile.listed_terms]
    for name, value in values.items():
        values_of[name][number] = value


def _solve_into(
    curves: Arrays, costs: Arrays, position: Mapping[str, int], case: Case, method: Method, solver: _Solver
) -> str:
    """Write one curve into its row of each array, and say why if there is none.

    Whatever a method returns is stored if the table of variables knows it, as arrays over the loads or as one number:
    so a plan brings along what it expected, `planned_seconds` and `planned_error`.
    """
    run = _row("status", position)
    given = case.settings.get(method.name, {})
    curves["settings"][run] = _settings_text(all_settings(method, given))
    try:
        solution, seconds = solver.solve(case.profile, method, given)
    except (NotApplicableError, ConvergenceError) as error:
        failed = isinstance(error, ConvergenceError)
        curves["status"][run] = Status.not_converged if failed else Status.not_applicable
        return str(error)
    bounds = _bounds(case.profile, curves["mean_pressure"], method, solution)
    for name, values in (solution._asdict() | bounds).items():
        if name in curves and np.size(values):  # a method may tell no edges of contact
            if "edge" in VARIABLES[name].dims:  # one row of a case, of its last method, which may find fewer contacts
                curves[name][_row(name, position)] = np.nan
            curves[name][_row(name, position, np.shape(values))] = values
    curves["status"][run] = Status.solved
    costs["seconds"][run] = seconds
    return ""


def _bounds(profile: Profile, loads: Array, method: Method, solution: Any) -> dict[str, Array]:
    """Bounds on the infinite series, from the curve of a truncated one by a method whose error is known."""
    if method.solution_error is None or math.isinf(profile.m) or math.isnan(profile.tail_amplitude):
        return {}
    return infinite_series_bounds(profile, loads, solution.compliance, method.solution_error(profile, solution))


def _settings_text(settings: Mapping[str, Any]) -> str:
    text = json.dumps(settings, sort_keys=True)
    width = VARIABLES["settings"].dtype.removeprefix("U")
    if len(text) > int(width):
        raise ValueError(f"settings must be at most {width} characters long, got {len(text)}: {text}")
    return text


def _row(name: str, position: Mapping[str, int], shape: tuple[int, ...] = ()) -> tuple[int | slice, ...]:
    """Where values of this shape go in the array of a variable: the first of those of a case and method."""
    sizes = iter(shape)
    return tuple(position[dim] if dim in position else slice(next(sizes, None)) for dim in VARIABLES[name].dims)
