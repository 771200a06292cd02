"""What the estimates of a whole series have in common: how they are run, and how they are offered to a plan.

Their expected errors are those of docs/planned.md, "Expected errors".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.error_model import estimate_error
from weier.methods.method import Estimate, Reference
from weier.methods.plan_part import COMPLIANCE, PartSolution, PlanPart, Task, make_part
from weier.surface.profile import Profile

Formula = Callable[[ArrayLike, ArrayLike, ArrayLike, ArrayLike], Array]  # The arguments are loads, D, gamma and m.


def solve_by(compliance: Formula, resistance: Formula) -> Callable[[Profile, Array], Estimate]:
    """The solver of a method that has closed forms for compliance and resistance."""

    def solve(profile: Profile, loads: Array) -> Estimate:
        series = profile.D, float(profile.gamma), profile.m
        return Estimate(compliance(loads, *series), resistance(loads, *series))

    return solve


def multiprecision_sums(name: str) -> Callable[[Profile, Array], Reference]:
    """The reference of an estimate: its sums, by the function of this name in `weier.methods.multiprecision`."""

    def reference(profile: Profile, loads: Array) -> Reference:
        from weier.methods import multiprecision  # mpmath, which only the stability report needs

        return multiprecision.reference(getattr(multiprecision, name), profile, loads)

    return reference


def offer(
    task: Task,
    method: str,
    relative_error: float,
    seconds: tuple[float, float],
    solve: Callable[[Profile, Array], Any],
) -> Iterator[PlanPart]:
    """An estimate of the compliance of a whole series, where its measured error is small enough.

    None is offered for the resistance: at loads on a few crests errors of 100 % were measured.

    Parameters
    ----------
    task : Task
        Of the plan.
    method : str
        The name of the method.
    relative_error : float
        Its largest error, over the amplitude of the terms after the first.
    seconds : float, float
        Expected to start, and of each load.
    solve : callable
        From a profile and loads to compliance and resistance.
    """
    profile = task.profile
    if task.quantity != COMPLIANCE or np.any(task.truncation > 0):
        return

    def error(loads: Array) -> Array:
        return estimate_error(relative_error, loads, profile.D, task.first_contact, profile.total_amplitude - 1)

    def solution(loads: Array) -> PartSolution:
        solved = solve(profile, loads)
        return PartSolution(solved.compliance, solved.resistance, error(loads), np.full(loads.size, np.inf))

    yield make_part(
        task,
        method,
        "an estimate whose measured error is small enough",
        solution,
        estimate=error(task.mean_pressure),
        seconds_start=seconds[0],
        seconds_load=np.full(task.mean_pressure.size, seconds[1]),
    )
