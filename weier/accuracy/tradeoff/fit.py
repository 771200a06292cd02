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
from weier.methods import bem, curves, demelio, error_model, layer, patches
from weier.methods.registry import find_method
from weier.methods.settings import all_settings, defaults
from weier.theory.profile import Profile


class Constant(NamedTuple):
    """A constant of an error or cost model: its name, the value shipped, and the one measured, NaN if it was not.

    The constant of an error is the largest over profiles, settings and loads, which a shipped one
    must not fall below; that of seconds is the least squares of the relative misfit.
    """

    name: str
    shipped: float
    measured: float


class Sample(NamedTuple):
    """A method on one profile: its settings, the seconds for all loads, and contacts and errors at each load."""

    profile: Profile
    settings: Mapping[str, Any]
    first_contact: float
    seconds: float
    points: float
    loads: Array
    contacts: Array
    compliance_error: Array
    resistance_error: Array

    @property
    def waves(self) -> int:
        """Of the finest term, in one period."""
        return self.profile.waves_per_period[-1]


class Term(NamedTuple):
    """A constant, and what it stands before: in the largest error of a sample, or in its seconds.

    For an error, `of` gives the error over what the constant is multiplied by; for seconds, that factor itself.
    """

    name: str
    shipped: float
    of: Callable[[Sample], float]


class Fit(NamedTuple):
    """The constants of a method, and what they are measured on; seconds count from those of a start.

    settings : the values that a setting of the samples may have, empty for any; the others are at their defaults
    """

    method: str
    settings: Mapping[str, Sequence[Any]] = {}
    errors: tuple[Term, ...] = ()
    seconds: tuple[Term, ...] = ()
    start: float = 0.0


def constants(data: xr.Dataset) -> list[Constant]:
    """What a measured trade says of each constant, NaN where it says nothing.

    Parameters
    ----------
    data : Dataset
        As `weier.accuracy.tradeoff.measure` returns it.
    """
    found = []
    for fit in FITS:
        samples = [sample for sample in _samples(data, fit.method) if _is_used(fit, sample)]
        found += [Constant(term.name, term.shipped, _largest(term, samples)) for term in fit.errors]
        fitted = zip(fit.seconds, _least_squares(fit, samples), strict=True)
        found += [Constant(term.name, term.shipped, float(value)) for term, value in fitted]
    return found


def _is_used(fit: Fit, sample: Sample) -> bool:
    values = {name: [value] for name, value in defaults(find_method(fit.method)).items()} | dict(fit.settings)
    return all(sample.settings[name] in allowed for name, allowed in values.items() if allowed)


def _samples(data: xr.Dataset, method: str) -> Iterator[Sample]:
    errors = [by_load(data, quantity) for quantity in ("compliance", "resistance")]
    run = np.isfinite(data["seconds"].values) & (data["solution_method"].values == method)
    for case, variant in np.argwhere(run):
        one = data.isel(case=case, variant=variant)
        settings = all_settings(find_method(method), json.loads(one["settings"].item()))
        first_contact, seconds, points = (float(one[name]) for name in ("first_contact", "seconds", "points"))
        arrays = one["mean_pressure"].values, one["patch_count"].values, *(error[case, variant] for error in errors)
        yield Sample(curves.profile(one), settings, first_contact, seconds, points, *arrays)


def _largest(term: Term, samples: Sequence[Sample]) -> float:
    return float(max(0.0, *np.nan_to_num([term.of(sample) for sample in samples]))) if samples else np.nan


def _least_squares(fit: Fit, samples: Sequence[Sample]) -> Array:
    """The constants of seconds, none negative, that leave the least squares of the relative misfit."""
    if not (samples and fit.seconds):
        return np.full(len(fit.seconds), np.nan)
    seconds = np.array([sample.seconds - fit.start for sample in samples])
    factors = np.array([[term.of(sample) for term in fit.seconds] for sample in samples])
    return np.asarray(nnls(factors / seconds[:, None], np.ones(seconds.size))[0])


def _grid_compliance(sample: Sample) -> float:
    curved = bem.error_model.curvature(sample.profile) * (sample.waves / sample.points) ** 2
    return float(sample.compliance_error.max() / curved)


def _grid_nodes(sample: Sample) -> float:
    """Nodes times pairs of FFTs, with those of a start."""
    return float(sample.points * (bem.error_model.fft_pairs(sample.contacts).sum() + bem.error_model.START_PAIRS))


def _in_tolerances(error: Array, sample: Sample) -> float:
    """The largest error beyond rounding, over the tolerance."""
    return float((error.max() - error_model.RESISTANCE_ROUNDING) / sample.settings["residual_tolerance"])


def _estimate(sample: Sample) -> float:
    """Error of an estimate over the amplitude after the first term, where first contact alone does not explain it."""
    if sample.profile.m == 1:
        return 0.0
    light = sample.compliance_error / error_model.partial_share(
        sample.loads, error_model.CREST_LOAD, sample.profile.D
    )
    beyond = light[light > sample.first_contact]
    return float(beyond.max(initial=0.0)) / (sample.profile.total_amplitude - 1)


GRID, CONTACTS = bem.error_model, patches.error_model
FITS = (
    Fit(
        bem.METHOD.name,
        {"points": (), "edges": ("nodes",)},
        (Term("BEM_COMPLIANCE", GRID.COMPLIANCE, _grid_compliance),),
    ),
    Fit(
        bem.METHOD.name,
        {"points": ()},
        seconds=(
            Term("SECONDS_LOAD bem", GRID.SECONDS_LOAD, lambda sample: sample.loads.size),
            Term("SECONDS_NODE bem", GRID.SECONDS_NODE, _grid_nodes),
        ),
        start=GRID.SECONDS_START,
    ),
    Fit(
        patches.METHOD.name,
        {"residual_tolerance": CONTACTS.TOLERANCES},
        (
            Term("PATCHES_COMPLIANCE", CONTACTS.COMPLIANCE_FACTOR, lambda s: _in_tolerances(s.compliance_error, s)),
            Term("PATCHES_RESISTANCE", CONTACTS.RESISTANCE_FACTOR, lambda s: _in_tolerances(s.resistance_error, s)),
        ),
        (
            Term("SECONDS_LOAD patches", CONTACTS.SECONDS_LOAD, lambda s: s.loads.size),
            Term("SECONDS_WAVE", CONTACTS.SECONDS_WAVE, lambda s: s.waves * float(np.sum(np.sqrt(s.contacts)))),
            Term("SECONDS_CONTACT", CONTACTS.SECONDS_CONTACT, lambda s: float(np.sum(s.contacts))),
            Term("SECONDS_PAIR", CONTACTS.SECONDS_PAIR, lambda s: float(np.sum(s.contacts**2))),
        ),
        CONTACTS.SECONDS_START,
    ),
    Fit(layer.METHOD.name, errors=(Term("LAYER", layer.method.MAX_ERROR_SHARE, _estimate),)),
    Fit(demelio.METHOD.name, errors=(Term("DEMELIO", demelio.MAX_ERROR_SHARE, _estimate),)),
)
