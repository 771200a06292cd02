"""Run a plan: each part by its method, with an error for every number."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier import bem, demelio, layer, patches, westergaard
from weier.plan import TOLERANCE, Part, left_out, plan, truncated
from weier.profile import Profile

Array = NDArray[np.float64]


class Curve(NamedTuple):
    """Planned curves over the loads, each of shape (loads,).

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*
    compliance_error, resistance_error : expected, of the quantity that was planned for; NaN for the other
    """

    compliance: Array
    resistance: Array
    compliance_error: Array
    resistance_error: Array


def curve(
    profile: Profile, mean_pressure: Array, tolerance: float = TOLERANCE, quantity: str = "compliance"
) -> Curve:
    """Plan and run: see `weier.plan`.

    Parameters
    ----------
    profile : Profile
        With any number of terms.
    mean_pressure : array, shape (loads,)
        Increasing, in p_0*.
    tolerance, quantity
        As in `weier.plan`.

    Returns
    -------
    Curve
        Arrays over the loads.

    Raises
    ------
    ValueError
        If the tolerance is out of reach.
    ConvergenceError
        If a solver misses its own tolerance.

    """
    runs = [_run(profile, part, quantity) for part in plan(profile, mean_pressure, tolerance, quantity).parts]
    return Curve(*(np.concatenate(columns) for columns in zip(*runs, strict=True)))


def _run(profile: Profile, part: Part, quantity: str) -> Curve:
    h, R = _solved(profile, part)
    error, unknown = np.full(h.size, part.error), np.full(h.size, np.nan)
    if quantity == "compliance":
        return Curve(h + left_out(profile, part.terms), R, error, unknown)
    return Curve(h + left_out(profile, part.terms), R, unknown, error * np.maximum(R, 1))


def _solved(profile: Profile, part: Part) -> tuple[Array, Array]:
    """Compliance of the terms that are modelled, in their own datum, and resistance."""
    loads, series = part.mean_pressure, (profile.D, float(profile.gamma), profile.m)
    if part.method == "full contact":
        return np.full(loads.size, profile.total_amplitude), np.zeros(loads.size)
    if part.method == "westergaard":
        return westergaard.compliance(loads), westergaard.resistance(loads)
    if part.method == "demelio":
        return demelio.compliance(loads, *series), demelio.resistance(loads, *series)
    if part.method == "layer":
        found = layer.curve(loads, *series)
        return found.compliance, found.resistance
    kept = truncated(profile, int(part.terms))
    if part.method == "bem":
        grid = bem.curve(kept, loads, **part.settings)
        return grid.compliance, grid.resistance
    exact = patches.curve(kept, loads, **part.settings)
    return exact.compliance, exact.resistance
