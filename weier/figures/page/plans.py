"""What a scene with a tolerance planned, against what it took and how far off it was."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from weier.methods.errors import OutOfReachError
from weier.methods.registry import PLANNED
from weier.methods.segment import QUANTITIES
from weier.pipeline.plan import plan
from weier.scene import Scene

EXACT = "patches"  # what measures the error, where a scene runs it beside its plans
NOTE = (
    "By what was planned to solve them: seconds of all cases together, on one core, and the largest errors, "
    "in g_0 of a compliance, in the larger of itself and 1 g_0/p_0* of a resistance. An error is measured where the "
    f"scene runs {EXACT} beside its plans."
)
HEADER = ("planned", "cases", "planned, s", "took, s", "took/planned", "allowed error", "expected", "measured")
OUT_OF_REACH = "out of reach"


class Outcome(NamedTuple):
    """One case: what was planned for it, what it took, and its largest error, NaN if nobody measured it."""

    way: str
    planned: float
    took: float
    allowed: float
    expected: float
    measured: float


def rows(scene: Scene, data: xr.Dataset, costs: Sequence[xr.Dataset]) -> list[list[object]]:
    """A row of the table for each way of solving that was planned, and one for all; none without a tolerance."""
    found = list(_outcomes(scene, data, costs))
    ways = list(dict.fromkeys(each.way for each in found))
    table = [_row(way, [each for each in found if each.way == way]) for way in ways]
    return [*table, _row("all", found)] if len(ways) > 1 else table


def _outcomes(scene: Scene, data: xr.Dataset, costs: Sequence[xr.Dataset]) -> Iterator[Outcome]:
    seconds = {key: took for cost in costs for key, took in _seconds(cost)}
    numbers = {key: number for number, key in enumerate(data["key"].values.tolist())}
    planned = any(PLANNED in case.methods for case in scene.cases.values())
    for key, made in plan(scene).cases.items() if planned else ():
        wanted = scene.cases[key].settings[PLANNED]
        measured = _error(data.isel(case=numbers[key]), wanted.get("quantity", QUANTITIES[0]))
        if isinstance(made, OutOfReachError):
            yield Outcome(OUT_OF_REACH, np.nan, np.nan, wanted["tolerance"], np.nan, np.nan)
        else:
            way = " and ".join(dict.fromkeys(segment.method for segment in made.segments))
            yield Outcome(way, made.seconds, seconds.get(key, np.nan), made.tolerance, made.error, measured)


def _seconds(cost: xr.Dataset) -> Iterator[tuple[str, float]]:
    if PLANNED in cost["solution_method"].values:
        values = cost["seconds"].sel(solution_method=PLANNED).values.tolist()
        yield from zip(cost["key"].values.tolist(), values, strict=True)


def _error(case: xr.Dataset, quantity: str) -> float:
    """The largest distance from the exact curve over the loads, NaN where there is none."""
    if EXACT not in case["solution_method"].values:
        return np.nan
    found, exact = (case[quantity].sel(solution_method=method).values for method in (PLANNED, EXACT))
    scale = np.maximum(exact, 1) if quantity == "resistance" else 1.0
    off = np.abs(found - exact) / scale
    return float(np.nanmax(off)) if np.isfinite(off).any() else np.nan


def _row(way: str, found: Sequence[Outcome]) -> list[object]:
    planned, took, *errors = np.array([each[1:] for each in found]).T
    sums = np.nansum(planned), np.nansum(took)
    ratio = f"{float(f'{sums[1] / sums[0]:.2g}'):g}" if all(sums) else ""
    return [way, len(found), *(f"{each:.3g}" for each in sums), ratio, *map(_largest, errors)]


def _largest(errors: np.ndarray) -> str:
    known = errors[np.isfinite(errors)]
    return f"{known.max():.1e}" if known.size else "unknown"
