"""Plans for the cases of a scene with a tolerance, with their actual times and errors."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import pandas as pd  # type: ignore[import-untyped]  # its stubs are a package more
import xarray as xr

from weier.data.variables import Status
from weier.methods.registry import PLANNED, numerical_names
from weier.tables import largest, significant

REFERENCE = numerical_names()[0]  # Errors are measured against this method if a scene runs it.
NOTE = (
    "Each row is for the cases whose plans have the methods in its first column. The seconds are those of all these "
    "cases together, on one core. The errors are the largest ones: of a compliance in g_0, of a resistance relative "
    f"to the larger of itself and 1 g_0/p_0*. They are measured if the scene also runs {REFERENCE}."
)
HEADER = ("planned", "cases", "planned, s", "took, s", "took/planned", "allowed error", "expected", "measured")
# Of one case: the methods, seconds planned and taken, and errors allowed, expected and measured, NaN where unknown.
Outcome = tuple[str, float, float, float, float, float]
# Results of cases without a solution, by status.
UNSOLVED = {Status.not_applicable: "out of reach", Status.not_converged: "not converged"}


def rows(data: xr.Dataset, cost: xr.Dataset) -> list[list[object]]:
    """A row of the table for each combination of planned methods, and one for all cases; none without plans.

    The columns are those of HEADER.
    """
    outcomes = pd.DataFrame(_outcomes(data, cost), columns=range(6)).set_index(0)
    found = [_row(methods, group) for methods, group in outcomes.groupby(0, sort=False)]
    return found if len(found) < 2 else [*found, _row("all", outcomes)]


def _outcomes(data: xr.Dataset, cost: xr.Dataset) -> Iterator[Outcome]:
    """The plan and the result of each case."""
    if PLANNED not in data["solution_method"].values:
        return
    of_plans = cost["seconds"].reindex(solution_method=[PLANNED]).values[:, 0].tolist()
    seconds = dict(zip(cost["key"].values.tolist(), of_plans, strict=True))
    planned = data.sel(solution_method=PLANNED)
    for number in np.flatnonzero(planned["status"].values != Status.not_requested):
        case = planned.isel(case=number)
        status, wanted = Status(int(case["status"])), json.loads(str(case["settings"].values))
        took = np.nan if status in UNSOLVED else seconds.get(str(case["key"].values), np.nan)
        planned_seconds, expected = float(case["planned_seconds"]), float(case["planned_error"])
        measured = _error(data.isel(case=number), wanted["quantity"])
        methods = UNSOLVED.get(status) or " and ".join(dict.fromkeys(case["planned_method"].values.tolist()))
        yield methods, planned_seconds, took, wanted["tolerance"], expected, measured


def _error(case: xr.Dataset, quantity: str) -> float:
    """The largest distance from the curve of the reference over the loads, NaN where there is none."""
    planned, reference = case[quantity].reindex(solution_method=[PLANNED, REFERENCE])
    scale = reference.clip(min=1) if quantity == "resistance" else 1.0
    return float((np.abs(planned - reference) / scale).max())


def _row(methods: str, outcomes: pd.DataFrame) -> list[object]:
    planned, took, *errors = outcomes.to_numpy().T
    sums = np.nansum(planned), np.nansum(took)
    ratio = significant(sums[1] / sums[0], 2) if all(sums) else ""
    in_seconds = (f"{seconds:.3g}" for seconds in sums)
    largest_errors = (largest(values, "unknown") for values in errors)
    return [methods, len(outcomes), *in_seconds, ratio, *largest_errors]
