"""The constants of error and cost models measured again, each beside the one that is shipped."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import nnls

from weier.accuracy.metrics import by_load
from weier.kernels.arrays import Array
from weier.methods import laws
from weier.methods.registry import method_named
from weier.methods.settings import all_settings
from weier.pipeline import curves
from weier.theory.profile import Profile


class Constant(NamedTuple):
    """A constant of an error or cost model: its name, the value shipped, and the one measured, NaN if it was not.

    The constant of an error (`bounds_error`) is the largest over profiles, settings and loads, which a shipped one
    must not fall below; that of seconds is the least squares of the relative misfit.
    """

    name: str
    shipped: float
    measured: float
    bounds_error: bool


class Sample(NamedTuple):
    """One method on one profile: its settings, the seconds for all loads, and contacts and errors at each load."""

    profile: Profile
    first_contact: float
    settings: dict[str, Any]
    seconds: float
    points: float
    loads: Array
    contacts: Array
    compliance_error: Array
    resistance_error: Array


def constants(data: xr.Dataset) -> list[Constant]:
    """What a measured trade says of each constant, NaN where it says nothing.

    Parameters
    ----------
    data : Dataset
        As `weier.accuracy.tradeoff.measure` returns it.
    """
    return [constant for name, fit in FITS.items() for constant in fit(list(_samples(data, name)))]


def _samples(data: xr.Dataset, method: str) -> Iterator[Sample]:
    """All runs of a method that is listed."""
    errors = [by_load(data, quantity) for quantity in ("compliance", "resistance")]
    run = np.isfinite(data["seconds"].values) & (data["solution_method"].values == method)
    for case, variant in np.argwhere(run):
        one = data.isel(case=case, variant=variant)
        yield Sample(
            curves.profile(one),
            float(one["first_contact"]),
            all_settings(method_named(method), json.loads(one["settings"].item())),
            float(one["seconds"]),
            float(one["points"]),
            one["mean_pressure"].values,
            one["patch_count"].values,
            *(error[case, variant] for error in errors),
        )


def _fit_boundary_elements(samples: Sequence[Sample]) -> list[Constant]:
    """Of grids solved to the default residual, with the resistance."""
    usual = all_settings(method_named("bem"), {})
    grids = [each for each in samples if each.settings | {"points": None} == usual]
    columns = []
    for each in grids:
        pairs = laws.fft_pairs(each.contacts)  # a start takes as long as START_LOADS of the heaviest loads
        columns.append(
            [each.loads.size + laws.START_LOADS, each.points * (pairs.sum() + laws.START_LOADS * pairs[-1])]
        )
    return [
        _bound("BEM_COMPLIANCE", [each.compliance_error.max() / _unresolved(each) for each in grids]),
        _bound("BEM_RESISTANCE", [_resistance_share(each) for each in grids]),
        *_costs(
            {"SECONDS_LOAD bem": laws.SECONDS_LOAD["bem"], "SECONDS_NODE bem": laws.SECONDS_NODE["bem"]},
            columns,
            [each.seconds - laws.SECONDS_START["bem"] for each in grids],
        ),
    ]


def _unresolved(grid: Sample) -> float:
    return laws.unresolved(grid.profile) * (grid.profile.wavenumber[-1] / grid.points) ** 2


def _resistance_share(grid: Sample) -> float:
    """Error of a resistance times points/waves, at the loads for which there is an error model."""
    modelled = grid.loads >= laws.bem_light_load(grid.profile, int(grid.points))
    return float(grid.resistance_error[modelled].max(initial=0.0)) * grid.points / grid.profile.wavenumber[-1]


def _fit_contact_patches(samples: Sequence[Sample]) -> list[Constant]:
    """At the tolerances that a plan may choose."""
    planned = [each for each in samples if each.settings["tolerance"] in laws.PATCHES_TOLERANCES]
    columns = [
        [each.loads.size, each.loads.size * each.profile.wavenumber[-1], np.sum(each.contacts**laws.CONTACT_POWER)]
        for each in planned
    ]
    shipped = {
        "SECONDS_LOAD patches": laws.SECONDS_LOAD["patches"],
        "SECONDS_WAVE": laws.SECONDS_WAVE,
        "SECONDS_CONTACT": laws.SECONDS_CONTACT,
    }
    return [
        _bound("PATCHES_COMPLIANCE", [_in_tolerances(each.compliance_error, each) for each in planned]),
        _bound("PATCHES_RESISTANCE", [_in_tolerances(each.resistance_error, each) for each in planned]),
        *_costs(shipped, columns, [each.seconds - laws.SECONDS_START["patches"] for each in planned]),
    ]


def _in_tolerances(error: Array, each: Sample) -> float:
    """The largest error beyond rounding, over the tolerance."""
    return float((error.max() - laws.ROUNDING) / each.settings["tolerance"])


def _fit_layer(samples: Sequence[Sample]) -> list[Constant]:
    """At the default settings."""
    usual = all_settings(method_named("layer"), {})
    return [_bound("LAYER", [_share(each) for each in samples if each.settings == usual and each.profile.m > 1])]


def _fit_demelio(samples: Sequence[Sample]) -> list[Constant]:
    return [_bound("DEMELIO", [_share(each) for each in samples if each.profile.m > 1])]


def _share(each: Sample) -> float:
    """Error of an estimate over the amplitude after the first term, where first contact alone does not explain it."""
    light = each.compliance_error / laws.unflattened(each.loads, laws.CROWDED, each.profile.D)
    beyond = light[light > each.first_contact]
    return float(beyond.max(initial=0.0)) / (each.profile.total_amplitude - 1)


def _bound(name: str, values: Sequence[float]) -> Constant:
    measured = float(max(0.0, *np.nan_to_num(values))) if values else np.nan
    return Constant(name, getattr(laws, name), measured, True)


def _costs(
    shipped: Mapping[str, float], columns: Sequence[Sequence[float]], seconds: Sequence[float]
) -> list[Constant]:
    """Factors of these columns, none negative, that leave the least squares of the relative misfit."""
    known = np.array(seconds)
    factors = nnls(np.array(columns) / known[:, None], np.ones(known.size))[0] if columns else [np.nan] * len(shipped)
    return [
        Constant(name, value, float(factor), False)
        for (name, value), factor in zip(shipped.items(), factors, strict=True)
    ]


# What the trade tells of a method's constants: their names, and how they follow from the runs of that method.
FITS: dict[str, Callable[[Sequence[Sample]], list[Constant]]] = {
    "bem": _fit_boundary_elements,
    "patches": _fit_contact_patches,
    "layer": _fit_layer,
    "demelio": _fit_demelio,
}
