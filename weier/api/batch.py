"""Many cases, solved into one dataset, sequentially or in several processes.

A solver runs Python code between its kernels, so that threads would wait for the interpreter lock. Other processes
receive tasks and return arrays instead.
"""

from __future__ import annotations

import json
import math
import os
import signal
import warnings
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context, parent_process
from threading import Thread
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from weier.api.progress import Progress, counted, shown_progress
from weier.api.rows import BOUNDS, curve_row, surface_row
from weier.api.task import CurveTask, Outcome
from weier.data import dataset
from weier.data.variables import CASE, LOADS, VARIABLES
from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.load_progress import keeping, reporting_to
from weier.methods.registry import find_method, returned_by
from weier.methods.settings import all_settings
from weier.scene.case import Case
from weier.scene.identity import short_keys
from weier.surface.waves import resolvable
from weier.units import NORMALISED_PRESSURE, PASCAL

# The message when the process pool breaks.
LOST = (
    "a process that was to solve curves has ended too early: a script must be a file that calls weier.solve below "
    '`if __name__ == "__main__":`, since each process imports it anew; if yours is, take fewer workers, since memory '
    "may have been short"
)


def solve_batch(
    cases: Iterable[Case],
    mean_pressure: ArrayLike,
    contact_edges: bool = False,
    workers: int = 1,
    own_loads: Sequence[Array] | None = None,
) -> xr.Dataset:
    """Solve cases under common loads, show the progress, and warn of curves that cannot be solved.

    Curves that do not depend on the phases are solved once for all cases that differ only in these. The result is
    over case, method, mean_pressure and term, with bounds on the infinite series and the seconds that each curve
    took; values that could not be solved are NaN, and status has the reason. An exception that stops the solution has
    the result so far as `curve`, up to the case that was being solved, or None.

    mean_pressure : increasing loads, in p_0*, or in Pa with `own_loads`, shape (loads,)
    contact_edges : whether to keep the edges of contact
    workers : number of processes
    own_loads : the loads of each case in p_0*, for loads in Pa
    """
    cases, loads = list(cases), np.asarray(mean_pressure, float)
    data = _blank(cases, loads, NORMALISED_PRESSURE if own_loads is None else PASCAL, contact_edges)
    rows = {str(name): variable.values for name, variable in data.variables.items()}  # faster to write into
    methods, curves = data["solution_method"].values.tolist(), list[tuple[int, CurveTask]]()
    for number, case in enumerate(cases):
        keys = {"key": case.key(loads), "surface_key": short_keys(np.array([case.surface_key]))[0]}
        _store(rows, {CASE: number}, surface_row(case.profile) | keys)
        own = loads if own_loads is None else own_loads[number]
        for name in case.methods:
            curves.append((number, CurveTask(case.profile, name, case.settings.get(name, {}), own)))

    def store(number: int, curve: CurveTask, row: Mapping[str, Any], solved: Array | None = None) -> None:
        """Write a curve with its settings into its row, or a part of it, at the solved loads."""
        settings = json.dumps(all_settings(find_method(curve.method), curve.settings), sort_keys=True)
        position = {CASE: number, "solution_method": methods.index(curve.method)}
        at = slice(None) if solved is None else np.searchsorted(curve.loads, solved)
        _store(rows, {**position, LOADS: at}, {**row, "settings": settings})

    def solved_so_far(part: tuple[Array, Curve] | None) -> xr.Dataset | None:
        """Return the solved curves and the solved part of the current one."""
        if part is not None:
            loads, solution = part
            store(number, curve, curve_row(curve._replace(loads=loads), (solution, math.nan)), loads)
        found = data.isel(case=slice(number + 1))
        return found if np.isfinite(found["compliance"]).any() else None

    to_solve = dict[object, CurveTask]()
    for position, (_, curve) in enumerate(curves):
        to_solve.setdefault(curve.series or position, curve)
    outcomes = dict[object, Outcome]()
    expected = sum(curve.expected for curve in to_solve.values()) / min(workers, len(to_solve))
    total = loads.size * len(to_solve)
    progress = shown_progress("weier.solve", total, counted(total, "load"), expected)
    with keeping(solved_so_far):
        new = solve_curves([*to_solve.values()], workers, progress)
        for position, (number, curve) in enumerate(curves):
            key = curve.series or position
            outcome = outcomes[key] if key in outcomes else outcomes.setdefault(key, next(new))
            if isinstance(outcome, Exception):
                reason = f"{curve.profile.describe()}, {curve.method}: {outcome}"
                warnings.warn(reason, stacklevel=4)  # points to the call of `weier.solve`
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


def _store(curves: Mapping[str, Any], position: Mapping[str, Any], values: Mapping[str, Any]) -> None:
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


def solve_curves(curves: Sequence[CurveTask], workers: int, progress: Progress) -> Iterator[Outcome]:
    """Yield the outcome of each curve, in the order of `curves`; `progress` counts their loads.

    Other processes are spawned, since a forked process could deadlock on locks held by threads of this one. The
    results are bitwise independent of their number.

    Raises
    ------
    ChildProcessError
        If a process ends unexpectedly.
    """
    if (workers := min(workers, len(curves))) > 1:
        try:
            with ProcessPoolExecutor(workers, get_context("spawn"), _begin) as pool:
                for curve, outcome in zip(curves, pool.map(CurveTask.outcome, curves), strict=True):
                    yield outcome
                    progress.reach(progress.done + curve.loads.size)
        except BrokenProcessPool:
            raise ChildProcessError(LOST) from None
        return
    done = 0
    for curve in curves:
        with reporting_to(progress):
            outcome = curve.outcome()
        done += curve.loads.size  # closed forms do not count their loads, and other methods solve some twice
        yield outcome
        progress.reach(done)


def _begin() -> None:
    """Prepare a process that solves curves: it ends with its parent, and silently by Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """End this process, even within a kernel, when its parent has ended or was killed."""
    if parent := parent_process():
        parent.join()
        os._exit(1)
