"""Solution of one profile without a scene file, for `weier solve` and `weier plot`."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from weier.api.batch import solve_batch
from weier.api.progress import TERMINAL_SECONDS, Watch, waiting
from weier.api.solve import settings_by_method
from weier.checks import readable
from weier.data.variables import Status
from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.progress import converting, reporting_to
from weier.methods.registry import default_method, find_method
from weier.pipeline.forecast import forecast
from weier.scene import Case
from weier.scene.case import trace_parameters
from weier.scene.yaml import write_yaml
from weier.surface.loads import check_range, unit_doubt
from weier.surface.measured.trace import Trace
from weier.surface.waves import Waves

OF_CASES = ("source", "name", "digest")  # parameters of a trace that cases have and scene files do not


def solve_one(
    profile: Mapping[str, Any],
    loads: Array,
    methods: Sequence[str],
    settings: Mapping[str, Any],
    workers: int = 1,
    max_seconds: float | None = None,
) -> xr.Dataset:
    """Return the curves of one profile, as a dataset of one case with the seconds of each method.

    The reason why a method has no curve goes to standard error, or is raised if no method has one.

    Parameters
    ----------
    profile : mapping
        D, gamma, m and phases or seed, or `trace`, as in a scene.
    loads : ndarray, shape (loads,)
        Mean pressures, increasing, in p_0*.
    methods : sequence of str
        As in `solve`.
    settings : mapping
        As of `weier.solve` for several methods.
    workers : int
        Number of processes.
    max_seconds : float, optional
        Limit of the time.

    Raises
    ------
    KeyboardInterrupt, TimeoutError
        If Ctrl-C or the limit ends the solution: `curve` has the curves of the loads that are solved, or is None.
    """
    check_range(loads)
    case = Case(_parameters(profile), tuple(methods), settings_by_method(methods, settings))
    case.check_ranges()
    lines = [*filter(None, [unit_doubt(case.profile, loads)]), *forecast(case, loads)]
    print(*lines, sep="\n", end="\n" * bool(lines), file=sys.stderr, flush=True)
    title = case.profile.describe() if "trace" in profile else f"Weierstrass profile, {case.profile.describe()}"
    failures: list[str] = []

    def described(data: xr.Dataset) -> xr.Dataset:
        return data.assign_attrs(title=title, scene=_text(title, case, data["mean_pressure"].values))

    def part(data: xr.Dataset) -> xr.Dataset:
        return described(data.isel(mean_pressure=np.isfinite(data["compliance"].values).any(axis=(0, 1))))

    watch = Watch(loads.size, 0.0, max_seconds, silent=True)
    with waiting(f"solving by {', '.join(methods)}") as show, reporting_to(watch), converting(part):
        data = solve_batch([case], loads, done=show, failed=failures.append, pause=TERMINAL_SECONDS, workers=workers)
    if not (data["status"] == Status.solved).any():
        raise (ConvergenceError if Status.not_converged in data["status"] else ValueError)("; ".join(failures))
    print(*failures, sep="\n", end="\n" * bool(failures), file=sys.stderr)
    return described(data)


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


def _text(title: str, case: Case, loads: Array) -> str:
    """Return a scene file that gives the same curves."""
    # a scene has one list of phases per profile
    product = {name: [value] if name == "phases" else value for name, value in case.parameters.items()}
    trace = {name: value for name, value in case.parameters.get("trace", {}).items() if name not in OF_CASES}
    scene = {"title": title, "loads": loads.tolist(), "methods": list(case.methods)}
    scene |= {"settings": {name: dict(values) for name, values in case.settings.items()}} if case.settings else {}
    trace |= {"file": readable(trace["file"])} if trace else {}
    studies = {"one": {"trace": trace} if trace else {"product": product}}
    return write_yaml(scene | {"studies": studies})
