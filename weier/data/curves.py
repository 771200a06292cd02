"""Select the curves of a case by method, or by the most accurate method that solved it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.methods.registry import numerical_names
from weier.surface.profile import PARAMETERS, Profile, random_phases

if TYPE_CHECKING:
    import xarray as xr


Case: TypeAlias = Any  # a Dataset without the dimension `case`, or a row of arrays, by names of variables
CONTACT_PRESSURE = "contact_pressure"  # a column of tables only; results do not contain it
# Contact counts as full above this fraction of the compliance at full contact, as a linear axis shows no difference.
FULL_CONTACT_COMPLIANCE = 0.99


def cases(studies: Iterable[xr.Dataset]) -> list[xr.Dataset]:
    """Return the cases of the studies as separate datasets, without the dimension `case`."""
    return [study.isel(case=case) for study in studies for case in range(study.sizes["case"])]


def groups(cases: Iterable[Case], *names: str) -> list[list[Case]]:
    """Return the cases, grouped by the values of the named coordinates, in order of appearance."""
    members: dict[tuple[float, ...], list[Case]] = {}
    for case in cases:
        members.setdefault(tuple(float(case[name]) for name in names), []).append(case)
    return list(members.values())


def curve(case: Case, name: str, method: str | None) -> Array | None:
    """Return the values of a variable over the loads by one method, or None if it has none."""
    methods = np.asarray(case["solution_method"]).tolist()
    if method not in methods or name not in case:
        return None
    values: Array = np.asarray(case[name])[methods.index(method)]
    return values if np.isfinite(values).any() else None


def contact_pressure(mean_pressure: xr.DataArray, contact_fraction: xr.DataArray) -> xr.DataArray:
    """Return the mean pressure of the contacts, p/A, in the unit of p; NaN where there is no area."""
    return (mean_pressure / contact_fraction.where(contact_fraction > 0)).transpose(*contact_fraction.dims)


def with_contact_pressure(data: xr.Dataset) -> xr.Dataset:
    """Return curves with the mean pressure of the contacts as a further variable where they have an area."""
    if "contact_fraction" not in data:
        return data
    return data.assign({CONTACT_PRESSURE: contact_pressure(data["mean_pressure"], data["contact_fraction"])})


def most_accurate(study: Case) -> tuple[Flags, Indices]:
    """Return whether a numerical method solved each case of a study, and the column of the most accurate one."""
    methods, h = np.asarray(study["solution_method"]).tolist(), np.asarray(study["compliance"])
    columns = [methods.index(name) for name in numerical_names() if name in methods]
    if not columns:
        return np.zeros(len(h), bool), np.zeros(len(h), int)
    solved = np.isfinite(h[:, columns]).any(axis=-1)
    return solved.any(axis=1), np.array(columns)[np.argmax(solved, axis=1)]


def numerical_method(case: Case) -> str | None:
    """Return the most accurate numerical method that solved the case, or None."""
    return next((method for method in numerical_names() if curve(case, "compliance", method) is not None), None)


def full_contact_loads(study: xr.Dataset) -> Array:
    """Return the first load at which each case is close to full contact, or the last load, shape (cases,)."""
    loads, h = study["mean_pressure"].values, study["compliance"].values
    solved, best = most_accurate(study)
    known = np.isfinite(h).any(axis=-1)
    known[solved] = np.arange(h.shape[1]) == best[solved, None]
    close = h >= FULL_CONTACT_COMPLIANCE * study["total_amplitude"].values[:, None, None]
    full = (close | ~known[..., None]).all(axis=1) & known.any(axis=1)[:, None]
    return np.where(full.any(axis=1), loads[np.argmax(full, axis=1)], loads[-1])


def profile(case: Case) -> Profile:
    """Return the profile of a case from its coordinates; for m = inf the seed or one phase defines the phases."""
    listed = np.asarray(case["phases"])
    series: dict[str, Any] = {name: float(case[name]) for name in PARAMETERS}
    phase = float(listed[:2][-1])
    if np.isfinite(series["m"]):
        return Profile(**series, phases=tuple(listed[: int(series["m"])].tolist()))
    return Profile(**series, phases=phase if np.isfinite(phase) else random_phases(int(case["seed"])))


def phase_angle(case: Case) -> float:
    """Return the phase of the second term, from 0 to pi, where the first has its crest at x = 0.

    The mirror image of a profile, -phi, has the same curves.
    """
    phase = np.asarray(case["phases"])
    if phase.size < 2 or not np.isfinite(phase[1]):
        return 0.0
    return float(np.arccos(np.cos(phase[1] - float(case["gamma"]) * phase[0])))
