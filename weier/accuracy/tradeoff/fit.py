"""The laws fitted again to what was measured: each constant beside the one that `weier.methods.laws` ships."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import nnls

from weier.accuracy.tradeoff.numbers import by_load, worst_over_loads
from weier.kernels.arrays import Array
from weier.methods import bem, demelio, error_model, patches
from weier.methods.bem.method import POINTS_COMPARED
from weier.methods.layer.method import LARGEST_ERROR
from weier.methods.patches.method import TOLERANCES_COMPARED
from weier.pipeline import curves
from weier.theory.profile import Profile

GRIDS = tuple(f"bem {count}" for count in POINTS_COMPARED)  # solved to the default residual
EXACT = tuple(f"patches {limit:.0e}" for limit in TOLERANCES_COMPARED if limit in patches.error_model.TOLERANCES)
ESTIMATES = {"LAYER": "layer 24", "DEMELIO": "demelio"}  # 24 points are the layer's own choice


SHIPPED = {
    "BEM_COMPLIANCE": bem.error_model.COMPLIANCE,
    "BEM_RESISTANCE": bem.error_model.RESISTANCE,
    "PATCHES_COMPLIANCE": patches.error_model.COMPLIANCE,
    "PATCHES_RESISTANCE": patches.error_model.RESISTANCE,
    "LAYER": LARGEST_ERROR,
    "DEMELIO": demelio.LARGEST_ERROR,
}


class Constant(NamedTuple):
    """A constant of weier.methods.laws: its name, the value shipped, and the one measured.

    Of an error the largest over profiles, settings and loads, which a shipped one must not fall below; of seconds
    (`bound` is False) the least squares of the relative misfit.
    """

    name: str
    shipped: float
    measured: float
    bound: bool


class Run(NamedTuple):
    """One contender on one profile: contacts and the error of R by load, that of h at worst."""

    profile: Profile
    points: float
    seconds: float
    contacts: Array
    compliance_error: float
    resistance_error: Array


def constants(data: xr.Dataset) -> list[Constant]:
    """What a measured trade says of each constant, NaN where it says nothing.

    Parameters
    ----------
    data : Dataset
        As `weier.accuracy.tradeoff.measure` returns it.
    """
    grids = [run for name in GRIDS for run in _runs(data, name)]
    exact = [(float(name.split()[1]), run) for name in EXACT for run in _runs(data, name)]
    errors = {
        "BEM_COMPLIANCE": [run.compliance_error / _missed(run) for run in grids],
        "BEM_RESISTANCE": [_resistance_missed(run, data["mean_pressure"].values) for run in grids],
        "PATCHES_COMPLIANCE": [
            (run.compliance_error - error_model.RESISTANCE_ROUNDING) / limit for limit, run in exact
        ],
        "PATCHES_RESISTANCE": [
            (run.resistance_error.max() - error_model.RESISTANCE_ROUNDING) / limit for limit, run in exact
        ],
        **{name: _shares(data, method) for name, method in ESTIMATES.items()},
    }
    bounds = [Constant(name, SHIPPED[name], _largest(values), True) for name, values in errors.items()]
    return [*bounds, *_grid_seconds(grids, data), *_patches_seconds([run for _, run in exact], data)]


def _largest(values: Sequence[float]) -> float:
    return float(max(0.0, *np.nan_to_num(values))) if len(values) else np.nan


def _runs(data: xr.Dataset, name: str) -> list[Run]:
    """A contender on all profiles it ran on."""
    methods = data["solution_method"].values.tolist()
    if name not in methods:
        return []
    at = methods.index(name)
    h, R = worst_over_loads(data, "compliance")[:, at], by_load(data, "resistance")[:, at]
    return [
        Run(
            curves.profile(data.isel(case=case)),
            float(data["points"].values[case, at]),
            float(data["seconds"].values[case, at]),
            data["patch_count"].values[case, at],
            float(h[case]),
            R[case],
        )
        for case in np.flatnonzero(np.isfinite(data["seconds"].values[:, at]))
    ]


def _missed(run: Run) -> float:
    return bem.error_model.curvature(run.profile) * (run.profile.wavenumber[-1] / run.points) ** 2


def _resistance_missed(run: Run, loads: Array) -> float:
    """Error of a resistance times points/waves, at the loads for which there is a law."""
    seen = loads >= bem.error_model.light_load(run.profile, int(run.points))
    return float(run.resistance_error[seen].max(initial=0.0)) * run.points / run.profile.wavenumber[-1]


def _shares(data: xr.Dataset, name: str) -> list[float]:
    """Error of an estimate over the amplitude after the first term, where first contact alone does not explain it."""
    error = data["compliance_error"].sel(solution_method=name).values
    found = []
    for case in np.flatnonzero(data["m"].values > 1):
        D, amplitude = float(data["D"][case]), float(data["total_amplitude"][case]) - 1
        light = error[case] / error_model.partial_share(data["mean_pressure"].values, error_model.CREST_LOAD, D)
        beyond = light[light > float(data["first_contact"][case])]
        found.append(float(beyond.max(initial=0.0)) / amplitude)
    return found


def _grid_seconds(grids: Sequence[Run], data: xr.Dataset) -> list[Constant]:
    """Sum of load + node points pairs over the loads, and three times the last; a start takes what is shipped."""
    loads = data.sizes["mean_pressure"] + bem.error_model.START_LOADS
    columns = []
    for run in grids:
        pairs = bem.error_model.fft_pairs(run.contacts)
        columns.append([loads, run.points * (pairs.sum() + bem.error_model.START_LOADS * pairs[-1])])
    load, node = _fitted(columns, [run.seconds - bem.error_model.SECONDS_START for run in grids])
    return [
        Constant("SECONDS_LOAD bem", bem.error_model.SECONDS_LOAD, load, False),
        Constant("SECONDS_NODE bem", bem.error_model.SECONDS_NODE, node, False),
    ]


def _patches_seconds(exact: Sequence[Run], data: xr.Dataset) -> list[Constant]:
    loads = data.sizes["mean_pressure"]
    columns = [
        [loads, loads * run.profile.wavenumber[-1], np.sum(run.contacts**patches.error_model.CONTACT_POWER)]
        for run in exact
    ]
    load, wave, contact = _fitted(columns, [run.seconds - patches.error_model.SECONDS_START for run in exact])
    return [
        Constant("SECONDS_LOAD patches", patches.error_model.SECONDS_LOAD, load, False),
        Constant("SECONDS_WAVE", patches.error_model.SECONDS_WAVE, wave, False),
        Constant("SECONDS_CONTACT", patches.error_model.SECONDS_CONTACT, contact, False),
    ]


def _fitted(columns: Sequence[Sequence[float]], seconds: Sequence[float]) -> Array:
    """Coefficients, none negative, that leave the least squares of the relative misfit."""
    known = np.array(seconds)
    found, _ = nnls(np.array(columns) / known[:, None], np.ones(known.size))
    return np.asarray(found)
