"""Errors and seconds of every contender on every profile."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from time import process_time

import numpy as np
import xarray as xr

from weier.accuracy.tradeoff.contenders import REFERENCE, contenders
from weier.data import dataset, variables
from weier.data.dataset import Status
from weier.methods.errors import ConvergenceError
from weier.methods.method import Variant
from weier.methods.solve import solve
from weier.pipeline.batch import describe_case
from weier.scene import Case, Scene

REPEAT = 3  # and keep the least: what disturbs a run only adds to its time, processor time as it is;
ENOUGH = 0.5  # but a run of so many seconds is long enough to be its own mean

KEPT = (
    "total_amplitude", "tail_amplitude", "first_contact", "compliance", "resistance", "compliance_error",
    "resistance_error", "contact_fraction", "patch_count", "residual", "work", "points", "settings", "status",
)  # fmt: skip


def measure(scene: Scene) -> xr.Dataset:
    """Run all contenders on all cases of a scene, one after the other, on one core.

    Parameters
    ----------
    scene : Scene
        Its profiles and loads; its methods do not count. Finite series only.

    Returns
    -------
    Dataset
        As the dataset of a scene, with the names of the contenders for methods and `seconds` for all loads.
        compliance_error and resistance_error are the distances from the contact patches at a tolerance of 1e-12,
        which has none of its own. NaN where a contender would need too many points, or did not converge.

    """
    cases = list(scene.cases.values())
    names = _names(cases)
    data = dataset.blank(len(cases), names, scene.loads, scene.layout.terms)
    data["seconds"] = variables.blank("seconds", {"case": len(cases), "solution_method": len(names)})
    for number, case in enumerate(cases):
        print(f"case {number + 1}/{len(cases)}: {case.profile.describe()}", file=sys.stderr)
        describe_case(data, number, case)
        for contender in contenders(case.profile):
            _run(data, number, case, contender)
        _compare(data, number)
    return data.drop_vars(set(data.data_vars) - {*KEPT, "seconds"}).assign_attrs(reference_method=REFERENCE)


def _names(cases: Sequence[Case]) -> list[str]:
    """Of all contenders, in the order in which the profile with the most of them has them."""
    lists = sorted(([c.name for c in contenders(case.profile)] for case in cases), key=len, reverse=True)
    return list(dict.fromkeys(name for names in lists for name in names))


def _run(data: xr.Dataset, number: int, case: Case, contender: Variant) -> None:
    place = number, data["solution_method"].values.tolist().index(contender.name)
    loads = data["mean_pressure"].values
    try:
        seconds, curve = _timed(case, loads, contender)
    except ConvergenceError as error:
        print(f"{case.profile.describe()}, {contender.name}: {error}", file=sys.stderr)
        data["status"].values[place] = Status.not_converged
        return
    for name in curve.data_vars:
        if name in KEPT:
            data[str(name)].values[place] = curve[name].values
    data["settings"].values[place] = json.dumps(dict(contender.settings), sort_keys=True)
    data["points"].values[place] = curve.attrs.get("points", np.nan)
    data["status"].values[place] = Status.solved
    data["seconds"].values[place] = seconds


def _timed(case: Case, loads: np.ndarray, contender: Variant) -> tuple[float, xr.Dataset]:
    """The least seconds of processor time of some runs, and the curve."""
    solve(case.profile, loads[:1], contender.method, **contender.settings)  # loads compiled code
    least = np.inf
    for _ in range(REPEAT):
        start = process_time()
        curve = solve(case.profile, loads, contender.method, **contender.settings)
        least = min(least, process_time() - start)
        if least > ENOUGH:
            break
    return least, curve


def _compare(data: xr.Dataset, number: int) -> None:
    """Fill in the errors of a case."""
    reference = data["solution_method"].values.tolist().index(REFERENCE)
    for name in ("compliance", "resistance"):
        values = data[name].values[number]
        data[f"{name}_error"].values[number] = np.abs(values - values[reference])
        data[f"{name}_error"].values[number, reference] = np.nan
