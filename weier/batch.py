"""Many cases in one process: a scene's batch, solved into one dataset."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from time import perf_counter

import numpy as np
import xarray as xr

from weier import dataset
from weier.dataset import Status
from weier.errors import ConvergenceError
from weier.limits import resolvable
from weier.scene import Case, Scene
from weier.solve import NotApplicableError, all_settings, solve
from weier.variables import PLANNED


def solve_batch(scene: Scene, cases: Iterable[Case]) -> tuple[xr.Dataset, xr.Dataset]:
    """Solve cases of a scene, one line of progress each.

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
    for number, case in enumerate(cases):
        start = perf_counter()
        describe_case(data, number, case)
        for method in case.methods:
            _solve_into(data, cost, (number, methods.index(method)), case, method)
        _copy_case(data, cost, number)
        seconds = perf_counter() - start
        print(f"case {number + 1}/{len(cases)}: {case.profile.describe()}, {seconds:.2f} s", file=sys.stderr)
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


def _copy_case(data: xr.Dataset, cost: xr.Dataset, number: int) -> None:
    for name in cost.variables.keys() & data.variables.keys() - data.sizes.keys():
        cost[name].values[number] = data[name].values[number]


def _fitting(text: str) -> str:
    width = dataset.VARIABLES["settings"].dtype.removeprefix("U")
    if len(text) > int(width):
        raise ValueError(f"settings must be at most {width} characters long, got {len(text)}: {text}")
    return text


def _solve_into(data: xr.Dataset, cost: xr.Dataset, place: tuple[int, int], case: Case, method: str) -> None:
    settings = all_settings(method, case.settings.get(method, {}))
    data["settings"].values[place] = _fitting(json.dumps(settings, sort_keys=True))
    try:
        curve = solve(case.profile, data["mean_pressure"].values, method, **case.settings.get(method, {}))
    except NotApplicableError:
        data["status"].values[place] = Status.not_applicable
        return
    except ConvergenceError as error:
        print(f"{case.profile.describe()}, {method}: {error}", file=sys.stderr)
        data["status"].values[place] = Status.not_converged
        return
    for name in curve.data_vars:
        if name != "contact_edge":
            whose = number if name in PLANNED else place
            data[str(name)].values[whose] = curve[name].values
    if "contact_edge" in data and "contact_edge" in curve:
        data["contact_edge"].values[place[0], :, : curve.sizes["edge"]] = curve["contact_edge"].values
    data["points"].values[place] = curve.attrs.get("points", np.nan)
    data["status"].values[place] = Status.solved
    cost["seconds"].values[place] = curve.attrs["seconds"]
