"""How the estimate and the bounds close in on the endless series with the number of resolved terms."""

from __future__ import annotations

import sys
from collections.abc import Sequence

import xarray as xr
from numpy.typing import ArrayLike

from weier.data import dataset
from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.hybrid.solver import MAX_POINTS, POINTS_PER_WAVE, curve
from weier.methods.hybrid.truncation_bounds import TooManyPointsError, bounds
from weier.theory.loads import checked_loads
from weier.theory.profile import Profile


def convergence(profiles: Sequence[Profile], mean_pressure: ArrayLike, most_terms: int) -> xr.Dataset:
    """The estimate and its bounds with 1, 2, ... resolved terms.

    Parameters
    ----------
    profiles : sequence of Profile
        With m = inf.
    mean_pressure : array_like, shape (loads,)
        Increasing, in p_0*.
    most_terms : int
        Waves to resolve in the last of them.

    Returns
    -------
    Dataset
        As that of a scene, with "1 resolved", "2 resolved" ... for methods. Where only the bounds are within reach
        there is no estimate, and where neither is, the status says so.

    Raises
    ------
    ValueError
        If a series ends, or a load lies outside [1e-6, 1e3].

    """
    loads = checked_loads(mean_pressure)
    names = [f"{count} resolved" for count in range(1, most_terms + 1)]
    data = dataset.blank(len(profiles), names, loads, most_terms)
    for case, profile in enumerate(profiles):
        values = {"D": profile.D, "gamma": float(profile.gamma), "m": profile.m, "tail_amplitude": 0.0}
        for name, value in {**values, "total_amplitude": profile.total_amplitude}.items():
            data[name].values[case] = value
        data["phase"].values[case] = profile.truncated(most_terms).phase
        for row in range(most_terms):
            _resolve_into(data, (case, row), profile, loads)
    return data


def _resolve_into(data: xr.Dataset, place: tuple[int, int], profile: Profile, loads: Array) -> None:
    """The estimate with its bounds, or the bounds alone where there are too many points for it."""
    terms = place[1] + 1
    points = POINTS_PER_WAVE * profile.truncated(terms).wavenumber[-1]
    try:
        if points <= MAX_POINTS:
            found = curve(profile, loads, terms)._asdict()
            data["points"].values[place] = points
        else:
            found = dict(zip(("compliance_lower", "compliance_upper"), bounds(profile, loads, terms), strict=True))
    except ConvergenceError as error:
        print(f"{profile.describe()}, {terms} resolved: {error}", file=sys.stderr)
        data["status"].values[place] = dataset.Status.not_converged
        return
    except TooManyPointsError:
        data["status"].values[place] = dataset.Status.not_applicable
        return
    for name, values in found.items():
        data[name].values[place] = values
    data["status"].values[place] = dataset.Status.solved
