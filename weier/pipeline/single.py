"""Solution of one profile without a scene file, for `weier solve` and `weier plot`."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from weier.api.batch import solve_batch
from weier.api.solve import settings_by_method
from weier.api.task import Known
from weier.checks import readable
from weier.data.variables import Status, attributes
from weier.digests import numerics
from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.load_progress import converting
from weier.methods.registry import default_method, find_method
from weier.pipeline.forecast import forecast
from weier.scene import Case
from weier.scene.case import AGAINST, short_keys, trace_parameters
from weier.scene.yaml import write_yaml
from weier.surface.loads import check_range, unit_doubt
from weier.surface.measured.trace import Trace
from weier.surface.waves import Waves

CASE_KEYS = ("source", "name", "digest")  # keys of a trace in a case that scene files lack


def case_of(profile: Mapping[str, Any], methods: Sequence[str], settings: Mapping[str, Any]) -> Case:
    """Return the case of one profile.

    Parameters
    ----------
    profile : mapping
        D, gamma, m and phases or seed, or `trace`, as in a scene.
    methods : sequence of str
        As in `solve`.
    settings : mapping
        As of `weier.solve` for several methods.
    """
    return Case(_parameters(profile), tuple(methods), settings_by_method(methods, settings))


def solve_one(
    case: Case,
    loads: Array,
    workers: int = 1,
    max_seconds: float | None = None,
    known: Mapping[str, Known] | None = None,
) -> xr.Dataset:
    """Return the curves of one profile, as a dataset of one case with the seconds of each method.

    The reason why a method has no curve goes to standard error, or is raised if no method has one.

    Parameters
    ----------
    case : Case
        The profile with its methods and their settings.
    loads : ndarray, shape (loads,)
        Mean pressures, increasing, in p_0*.
    workers : int
        Number of processes.
    max_seconds : float, optional
        Limit of the time.
    known : mapping, optional
        Curves that are known under some of the loads, by method.

    Raises
    ------
    KeyboardInterrupt, TimeoutError
        If Ctrl-C or the limit ends the solution: `curve` has the curves of the loads that are solved, or is None.
    ConvergenceError
        If no method has a curve, or one whose curve is known in part fails: `curve` has what is solved, or is None.
    """
    check_range(loads)
    known, _ = known or {}, code()  # read the digest before the sources can change
    lacking = [~np.isin(loads, known[name].loads) if name in known else loads > 0 for name in case.methods]
    expected = forecast(case, loads[np.any(lacking, axis=0)])
    lines = [*filter(None, [unit_doubt(case.profile, loads)]), *expected]
    print(*lines, sep="\n", end="\n" * bool(lines), file=sys.stderr, flush=True)
    failures: list[str] = []

    def part(data: xr.Dataset) -> xr.Dataset:
        return _described(data.isel(mean_pressure=np.isfinite(data["compliance"].values).any(axis=(0, 1))), case)

    with converting(part):
        data = solve_batch([case], loads, False, failures.append, workers, known=known, max_seconds=max_seconds)
    missing = data["status"].values[0] != Status.solved
    if missing.all() or known.keys() & {*data["solution_method"].values[missing].tolist()}:
        error = (ConvergenceError if Status.not_converged in data["status"] else ValueError)("; ".join(failures))
        vars(error)["curve"] = None if missing.all() else part(data)
        raise error
    print(*failures, sep="\n", end="\n" * bool(failures), file=sys.stderr)
    return _described(data, case)


def applicable(
    profile: Mapping[str, Any], methods: Sequence[str], within_tolerance: bool = False
) -> tuple[list[str], list[str]]:
    """Return the methods that apply to a profile and the reasons why others do not; by default one method.

    If none of the given methods applies, all are returned, so that their solution raises the reasons.
    """
    surface = surface_of(profile)
    if not methods:
        return [default_method(surface, within_tolerance=within_tolerance)], []
    apply, refusals = list[str](), list[str]()
    if isinstance(surface, Trace):
        methods = [method for method in methods if find_method(method).takes_traces]
    for method in methods:
        try:
            find_method(method).check_applies(surface)
            apply.append(method)
        except ValueError as error:
            refusals.append(f"{method} is left out: {error}")
    return (apply, refusals) if apply else (list(methods), [])


def surface_of(profile: Mapping[str, Any]) -> Waves:
    """Return the surface of a profile or a trace, given as in a scene."""
    return Case(_parameters(profile), (), {}).profile


def _parameters(profile: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the parameters of a case: of a trace with its name and a digest of its heights."""
    if "trace" not in profile:
        return profile
    trace = {"source": readable(Path(profile["trace"]["file"]).name)} | profile["trace"]
    traces = trace_parameters(trace, Path())
    if len(traces) > 1:
        raise ValueError(
            f"one line is solved at a time, got {len(traces)}: name a file, and a line of a map by --line; a scene "
            "solves all"
        )
    return {"trace": traces[0]}


def _described(data: xr.Dataset, case: Case) -> xr.Dataset:
    """Return curves with digests of their surface, loads and code, and a scene that reproduces them."""
    loads = data["mean_pressure"].values
    keys = {"key": case.key(loads), "surface_key": surface_key(case)}
    named = {name: ("case", np.array([key], object), attributes(name)) for name, key in keys.items()}
    own = {"title": _title(case), "scene": scene_text(case, loads), "numerics": code()}
    return data.assign_coords(named).assign_attrs(own)


@cache
def code() -> str:
    """Return the digest of the code that this process runs; an empty text without its sources, as in a zip."""
    try:
        return numerics()
    except OSError:
        return ""


def surface_key(case: Case) -> str:
    """Return the digest of a surface in the form stored in files."""
    return short_keys(np.array([case.surface_key]))[0]


def _title(case: Case) -> str:
    described = str(case.profile.describe())
    return described if "trace" in case.parameters else f"Weierstrass profile, {described}"


def scene_text(case: Case, loads: Array) -> str:
    """Return the text of a scene file that reproduces the curves."""
    # a scene has one list of phases per profile
    product = {name: [value] if name == "phases" else value for name, value in case.parameters.items()}
    trace = {name: value for name, value in case.parameters.get("trace", {}).items() if name not in CASE_KEYS}
    scene = {"title": _title(case), "loads": loads.tolist(), "methods": list(case.methods)}
    scene |= {"settings": {name: dict(values) for name, values in case.settings.items()}} if case.settings else {}
    trace |= {name: readable(trace[name]) for name in ("file", AGAINST) if name in trace}
    studies = {"one": {"trace": trace} if trace else {"product": product}}
    return write_yaml(scene | {"studies": studies})
