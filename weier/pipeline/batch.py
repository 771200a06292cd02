"""Many cases in one process: a scene's batch, solved into one dataset, on as many threads as it is given."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.data import dataset
from weier.data.dataset import Status
from weier.data.variables import VARIABLES
from weier.methods.errors import ConvergenceError, NotApplicableError
from weier.methods.registry import method_named
from weier.methods.settings import all_settings
from weier.methods.solve import answer
from weier.scene.cases import Case, Scene
from weier.theory.limits import resolvable

Arrays = Mapping[str, NDArray[Any]]


def solve_batch(scene: Scene, cases: Iterable[Case], threads: int = 1) -> tuple[xr.Dataset, xr.Dataset]:
    """Solve cases of a scene, one line of progress each.

    Parameters
    ----------
    scene : Scene
        Whose loads and layout they share.
    cases : iterable of Case
        The rows of the result, in their order.
    threads : int
        Cases at a time: the kernels leave the interpreter to each other. The data do not depend on it.

    Returns
    -------
    data : Dataset
        Over case, method, mean_pressure and term; what could not be solved is NaN, and status says why.
    cost : Dataset
        Seconds for each case and method: apart, since they differ from run to run.

    """
    cases = list(cases)
    methods, terms, edges = scene.layout_of(cases)  # not the scene's: other cases may change
    data = dataset.blank(len(cases), methods, scene.loads, terms, edges)
    cost = dataset.blank_cost(len(cases), methods, terms)
    curves, costs = ({str(name): each.values for name, each in part.variables.items()} for part in (data, cost))

    def solve_case(number: int) -> None:
        case = cases[number]
        describe_case(data, number, case)
        for method in case.methods:
            _solve_into(curves, costs, {"case": number, "solution_method": methods.index(method)}, case, method)
        for name in costs.keys() & curves.keys() - data.sizes.keys():
            costs[name][number] = curves[name][number]
        seconds = np.nansum(costs["seconds"][number])
        print(f"case {number + 1}/{len(cases)}: {case.profile.describe()}, {seconds:.2f} s", file=sys.stderr)

    with ThreadPoolExecutor(threads) as pool:
        for _ in pool.map(solve_case, range(len(cases))):  # raises what a case raised
            pass
    return data, cost


def describe_case(data: xr.Dataset, number: int, case: Case) -> None:
    """Fill in the coordinates of a case."""
    profile = case.profile
    values = {"key": case.key, "D": profile.D, "gamma": float(profile.gamma), "m": profile.m}
    values |= {"total_amplitude": profile.total_amplitude, "tail_amplitude": profile.tail_amplitude}
    if np.isfinite(profile.m):
        if resolvable(profile):
            values["first_contact"] = profile.total_amplitude - profile.crest[1]
        data["phase"].values[number, : profile.terms] = profile.phase
    for name, value in values.items():
        data[name].values[number] = value


def _fitting(text: str) -> str:
    width = dataset.VARIABLES["settings"].dtype.removeprefix("U")
    if len(text) > int(width):
        raise ValueError(f"settings must be at most {width} characters long, got {len(text)}: {text}")
    return text


def _solve_into(curves: Arrays, costs: Arrays, place: Mapping[str, int], case: Case, method: str) -> None:
    """One curve, or why there is none, into its row of each array."""
    run = _row("status", place)
    given = case.settings.get(method, {})
    curves["settings"][run] = _fitting(json.dumps(all_settings(method_named(method), given), sort_keys=True))
    try:
        found, seconds = answer(case.profile, curves["mean_pressure"], method, given)
    except (NotApplicableError, ConvergenceError) as error:
        print(f"{case.profile.describe()}, {method}: {error}", file=sys.stderr)
        missed = isinstance(error, ConvergenceError)
        curves["status"][run] = Status.not_converged if missed else Status.not_applicable
        return
    for name, values in found._asdict().items():
        if name in curves:
            curves[name][_row(name, place, np.shape(values))] = values
    curves["status"][run] = Status.solved
    costs["seconds"][run] = seconds


def _row(name: str, place: Mapping[str, int], shape: tuple[int, ...] = ()) -> tuple[int | slice, ...]:
    """Where values of this shape go in the array of a variable: the first of those of a case and method."""
    sizes = iter(shape)
    return tuple(place[dim] if dim in place else slice(next(sizes, None)) for dim in VARIABLES[name].dims)
