"""Bounds on the infinite series, from the curve of its first terms: what a batch adds to a numerical solution."""

from __future__ import annotations

from weier.kernels.arrays import Array
from weier.theory.bounds import complete_bounds, resistance_bounds
from weier.theory.profile import Profile


def infinite_series_bounds(profile: Profile, loads: Array, compliance: Array, error: float) -> dict[str, Array]:
    """Bounds on compliance and resistance of the infinite series that begins with the terms of a profile.

    Parameters
    ----------
    profile : Profile
        The terms that are solved.
    loads : ndarray, shape (loads,)
        Mean pressures, in p_0*.
    compliance : ndarray, shape (loads,)
        Their compliance, in g_0.
    error : float
        What the compliance may be off, in g_0. It widens the band of the terms that are left out.

    Returns
    -------
    dict
        By the names of their variables, each of shape (loads,).

    Notes
    -----
    `weier.methods.hybrid.truncation_bounds.bounds` says which part of them is proved and which is measured.
    """
    total, tail = profile.total_amplitude, profile.tail_amplitude
    sides = {
        "compliance": complete_bounds(compliance, tail, total + tail, error),
        "resistance": resistance_bounds(loads, compliance, tail + error, first_contact(profile)),
    }
    return {
        f"{quantity}_{side}": values
        for quantity, both in sides.items()
        for side, values in zip(("lower", "upper"), both, strict=True)
    }


def first_contact(profile: Profile) -> float:
    """Compliance of a finite series at first contact, sum g_n - max z, in g_0."""
    return profile.total_amplitude - profile.crest[1]
