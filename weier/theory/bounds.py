"""Barber's bounds on the effect of the terms left out of a series (Section 5.5).

docs/closed_forms.md, "Bounds on the terms left out", proves them; docs/bem.md, "Bounds", has their use by boundary
elements. Roughness within a band of half-height G moves the mean gap by at most G (27). The complete curve H is
concave and within G of the truncated one, h, so that for p' < p (and reversed, with -2 G, for p' > p)

    R(p) <= [H(p) - H(p')]/(p - p') <= [h(p) - h(p') + 2 G]/(p - p').

The first three functions take any consistent units.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.surface.profile import Profile
from weier.surface.waves import Waves


def complete_bounds(
    compliance: ArrayLike, amplitude: ArrayLike, full_contact: ArrayLike, error: ArrayLike = 0.0
) -> tuple[Array, Array]:
    """Return bounds h and h + 2 G on the compliance of the complete series, counted from its own sum g_n (27).

    h is the compliance of the truncated series in its own datum, known within `error`, and G the total amplitude of
    the terms left out. No compliance exceeds the sum of all g_n, `full_contact`. The arguments broadcast.
    """
    h, top = np.asarray(compliance, float), np.asarray(full_contact, float)
    return np.clip(h - error, 0, top), np.clip(h + 2 * np.asarray(amplitude, float) + error, 0, top)


def resistance_bounds(
    mean_pressure: ArrayLike,
    compliance: ArrayLike,
    amplitude: ArrayLike,
    first_contact: ArrayLike | None = None,
    error: ArrayLike = 0.0,
) -> tuple[Array, Array]:
    """Return bounds on dh/dp of the complete series: the shallowest and steepest line that its concave curve allows.

    The line through the complete curve at p stays above that curve, hence above the lower bound on it, and starts
    no higher than the upper bound: R <= [h(p) - h(p') + 2 G]/(p - p') for every p' < p, and
    R >= [h(p') - h(p) - 2 G]/(p' - p) for every p' > p.

    Loads p >= 0 of any order and the compliance h of the truncated series, with a bound on the `error` of each h,
    have the shape (..., loads). The total `amplitude` G of the terms left out and the compliance at `first_contact`,
    sum g_n - max z, which tightens the upper bound at light loads, have the shape (...). A large error at one load
    widens the bounds at that load alone.

    Returns
    -------
    lower, upper : ndarray, shape (..., loads)
        0 and inf where no load above or below gives a bound. NaN where an input is NaN; the bounds at the loads
        around it remain valid.

    Notes
    -----
    Each p' gives a valid bound, and so does the best of the tabulated p'. A finer table of loads gives tighter
    bounds. Nothing is assumed of the curve beyond the last load. Work and memory grow with loads^2.

    """
    p, h, off = np.broadcast_arrays(*(np.asarray(values, float) for values in (mean_pressure, compliance, error)))
    top, other_p, other_h = h + off + 2 * np.asarray(amplitude, float)[..., None], p, h - off
    if first_contact is not None:
        start = np.broadcast_to(np.asarray(first_contact, float)[..., None], (*h.shape[:-1], 1))
        other_p = np.concatenate([np.zeros_like(start), p], axis=-1)
        other_h = np.concatenate([start, other_h], axis=-1)
    lower, upper = slope_bounds(p, top, other_p[..., None, :], other_h[..., None, :])
    missing = np.isnan(top) | np.isnan(p)
    return np.where(missing, np.nan, lower), np.where(missing, np.nan, upper)


def slope_bounds(p: Array, upper: Array, other: Array, lower: Array) -> tuple[Array, Array]:
    """Return bounds on the slope at p of a concave curve below `upper` there, and above `lower` at `other` loads.

    They are the steepest line to heavier loads and the shallowest to lighter ones; 0 and inf where there is none.
    `other` and `lower` have the shape (..., others).
    """
    run, rise = p[..., None] - other, upper[..., None] - lower
    with np.errstate(over="ignore"):  # a slope beyond the largest float bounds nothing: inf
        to_heavier = np.divide(rise, run, out=np.zeros(rise.shape), where=run < 0)
        to_lighter = np.divide(rise, run, out=np.full(rise.shape, np.inf), where=run > 0)
    return np.fmax.reduce(to_heavier, axis=-1, initial=0.0), np.fmin.reduce(to_lighter, axis=-1, initial=np.inf)


def infinite_series_bounds(profile: Profile, loads: Array, compliance: Array, error: ArrayLike) -> dict[str, Array]:
    """Return bounds on both curves of the infinite series, by the names of their variables.

    They follow from the compliance of the terms of a profile, in g_0, and the bound on its error at each load, in
    g_0. Given that bound they are a theorem: docs/closed_forms.md, "Bounds on the terms left out".
    """
    total, tail = profile.total_amplitude, profile.tail_amplitude
    lower, upper = complete_bounds(compliance, tail, total + tail, error)
    flattest, steepest = resistance_bounds(loads, compliance, tail, first_contact(profile), error)
    return {
        "compliance_lower": lower,
        "compliance_upper": upper,
        "resistance_lower": flattest,
        "resistance_upper": steepest,
    }


def first_contact(profile: Waves) -> float:
    """Return compliance of a surface of finitely many waves at first contact, sum g_n - max z, in g_0."""
    return profile.total_amplitude - profile.crest[1]
