"""A method that is not of the package: half of the load for the compliance, exact by its own account."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.errors import NotApplicableError
from weier.methods.method import Method, Settings, Style
from weier.methods.plan_part import PartSolution, PlanPart, Task, make_part
from weier.surface.profile import Profile

MIN_LOAD = 0.05  # p_0*: it offers itself to plans from here on


class ToyCurve(NamedTuple):
    """Compliance in g_0, resistance in g_0/p_0*, each of shape (loads,)."""

    compliance: Array
    resistance: Array


def _solve(profile: Profile, loads: Array, fraction: float = 0.5) -> ToyCurve:
    return ToyCurve(fraction * loads, np.full(loads.size, fraction))


def _applies(profile: Profile) -> None:
    if profile.m == 1:
        raise NotApplicableError("the toy is for several waves, got m = 1: take westergaard")


def _candidates(task: Task) -> Iterator[PlanPart]:
    def solution(loads: Array) -> PartSolution:
        none = np.zeros(loads.size)
        return PartSolution(*_solve(task.profile, loads), none, none)

    error = np.where(task.mean_pressure >= MIN_LOAD, 0.0, np.inf)
    yield make_part(task, "toy", "it is free", solution, estimate=error)


def _variants(profile: Profile) -> Iterator[tuple[str, Settings]]:
    for fraction in (0.25, 0.5):
        yield f"{fraction:g}", {"fraction": fraction}


TOY = Method(
    name="toy",
    label="a toy",
    summary="half of the load; m > 1",
    solve=_solve,
    applies=_applies,
    style=Style("#123456", (7, 2), "p"),
    algorithms=({}, {"fraction": 0.1}),
    variants=_variants,
    candidates=_candidates,
)
