"""Barber's bounds on the effect of the terms left out of a series (Section 5.5).

docs/closed_forms.md, "Bounds on the terms left out", proves them; docs/bem.md, "Bounds", has their use by boundary
elements. Roughness within a band of half-height G moves the mean gap by at most G (27). The complete curve H is
concave and within G of the truncated one, h, so that for p' < p (and reversed, with -2 G, for p' > p)

    R(p) <= [H(p) - H(p')]/(p - p') <= [h(p) - h(p') + 2 G]/(p - p').

All but the last two functions take any consistent units.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.surface.profile import Profile
from weier.surface.waves import Waves


def compliance_bounds(compliance: ArrayLike, amplitude: ArrayLike) -> tuple[Array, Array]:
    """Return bounds h - G and h + G on the compliance of the complete series (27).

    Parameters
    ----------
    compliance : array_like, shape (..., loads)
        Compliance h of the truncated series.
    amplitude : array_like, shape (...)
        Total amplitude G of the terms left out.

    Returns
    -------
    lower, upper : ndarray, shape (..., loads)

    Notes
    -----
    The bounds hold in the datum of the truncated series: h = sum of the g_n retained - mean gap. In its own
    datum, with all g_n in that sum, the complete series lies G higher, within [h, h + 2 G].
    """
    h, G = np.asarray(compliance, float), np.asarray(amplitude, float)[..., None]
    return h - G, h + G


def complete_bounds(
    compliance: ArrayLike, amplitude: ArrayLike, full_contact: ArrayLike, error: ArrayLike = 0.0
) -> tuple[Array, Array]:
    """Return bounds h and h + 2 G on the compliance of the complete series, counted from its own sum g_n (27).

    Parameters
    ----------
    compliance : array_like
        Compliance h of the truncated series, in its own datum.
    amplitude : array_like
        Total amplitude G of the terms left out.
    full_contact : array_like
        Compliance of the complete series at full contact, the sum of all g_n, which it never exceeds.
    error : array_like
        Bound on the error of h.

    Returns
    -------
    lower, upper : ndarray
        Of the shape to which the arguments broadcast, within [0, full contact].
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

    Parameters
    ----------
    mean_pressure : array_like, shape (..., loads)
        Mean pressures p >= 0, in any order. Broadcasts against `compliance`.
    compliance : array_like, shape (..., loads)
        Compliance h of the truncated series.
    amplitude : array_like, shape (...)
        Total amplitude G of the terms left out.
    first_contact : array_like, shape (...), optional
        Compliance of the truncated series at p = 0, sum g_n - max z: it tightens the upper bound at light loads.
    error : array_like, shape (..., loads)
        Bound on the error of each h. A large error at one load widens the bounds at that load alone.

    Returns
    -------
    lower, upper : ndarray, shape (..., loads)
        0 and inf where no load above or below gives a bound. NaN where an input is NaN; the bounds at the loads
        around it remain valid.

    Notes
    -----
    Each p' gives a valid bound, and so does the best of the tabulated p'. A finer table of loads gives tighter
    bounds. Nothing is assumed of the curve beyond the last load. Work and memory grow with loads^2.

    Examples
    --------
    One wave (12), where the waves left out have 5 % of its amplitude:

    >>> import numpy as np
    >>> from weier.methods import westergaard
    >>> from weier.theory import bounds
    >>> p = np.linspace(0.01, 1, 100)
    >>> lower, upper = bounds.resistance_bounds(p, westergaard.compliance(p), 0.05, first_contact=0.0)
    >>> print(f"{lower[49]:.2f} < {westergaard.resistance(0.5):.2f} < {upper[49]:.2f}")
    0.12 < 0.69 < 1.40

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
