"""The curves of a study, one case at a time: which methods have solved it, and which of them is the most accurate."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.registry import numerical_names
from weier.theory.profile import PARAMETERS, Profile

if TYPE_CHECKING:
    import xarray as xr

# Contact counts as full above this part of the compliance at full contact: a linear axis shows no more change.
FULL_CONTACT_COMPLIANCE = 0.99


def cases(studies: Iterable[xr.Dataset]) -> list[xr.Dataset]:
    """Each case of the studies as a dataset of its own, without the dimension `case`."""
    return [study.isel(case=case) for study in studies for case in range(study.sizes["case"])]


def groups(cases: Iterable[xr.Dataset], *names: str) -> list[list[xr.Dataset]]:
    """The cases that share the values of the named coordinates, together, in order of appearance."""
    members: dict[tuple[float, ...], list[xr.Dataset]] = {}
    for case in cases:
        members.setdefault(tuple(float(case.variables[name]) for name in names), []).append(case)
    return list(members.values())


def curve(case: xr.Dataset, name: str, method: str | None) -> Array | None:
    """The values of a variable over the loads by one method, or None if it has none."""
    variables = case.variables  # A dataset takes ten times as long for each of them, to find its coordinates.
    methods = variables["solution_method"].values.tolist()
    if method not in methods:
        return None
    values: Array = variables[name].values[methods.index(method)]
    return values if np.isfinite(values).any() else None


def numerical_methods(case: xr.Dataset) -> list[str]:
    """The methods that solved the case itself, not an estimate of it, the most accurate first."""
    return [method for method in numerical_names() if curve(case, "compliance", method) is not None]


def numerical_method(case: xr.Dataset) -> str | None:
    """The most accurate method that solved the case itself, or None."""
    return next(iter(numerical_methods(case)), None)


def numerical(case: xr.Dataset, name: str) -> Array | None:
    """The values of a variable by the most accurate method, or None if no numerical method has any."""
    return curve(case, name, numerical_method(case))


def full_contact_load(cases: Iterable[xr.Dataset]) -> float:
    """The first load at which all cases are close to full contact, or the last load there is."""
    return max((_full_contact_load(case) for case in cases), default=np.nan)


def first_load(cases: Sequence[xr.Dataset]) -> float:
    """The lightest load of all cases."""
    return float(min(case["mean_pressure"].values[0] for case in cases))


def profile(case: xr.Dataset) -> Profile:
    """The profile of a case, from its coordinates alone."""
    m = float(case["m"])
    phases = case["phases"].values[: int(m)] if np.isfinite(m) else 0.0
    series: dict[str, Any] = {name: float(case[name]) for name in PARAMETERS}
    return Profile(**series, phases=phases)


def phase_angle(case: xr.Dataset) -> float:
    """The phase of the second term, from 0 to pi: the mirror image of a profile, -phi, has the same curves."""
    phase = case["phases"].values
    return float(np.arccos(np.cos(phase[1]))) if phase.size > 1 and np.isfinite(phase[1]) else 0.0


def _full_contact_load(case: xr.Dataset) -> float:
    loads = case["mean_pressure"].values
    h = numerical(case, "compliance")
    known = case["compliance"].values if h is None else h[None]
    solved = known[np.isfinite(known).any(axis=1)]
    full = (solved >= FULL_CONTACT_COMPLIANCE * float(case["total_amplitude"])).all(axis=0)
    return float(loads[np.argmax(full)] if solved.size and full.any() else loads[-1])
