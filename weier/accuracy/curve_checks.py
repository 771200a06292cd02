"""Checks that every curve of compliance must pass.

A curve rises and is concave, its resistance falls and lies between the chords on both sides, and both lie within the
bounds that the closed form of the first wave gives for all longer series (Section 5.5). The errors stated by a method
hold.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.methods import westergaard
from weier.surface.profile import Profile
from weier.theory.bounds import resistance_bounds


class Noise(NamedTuple):
    """Unstated errors: of heights relative to the total amplitude, and relative errors of slopes."""

    height: float = 1e-12
    slope: float = 1e-11


ROUNDING = Noise()
# Errors of methods that interpolate tables of accuracy 1e-5 and state no error.
TABLE_NOISE = {"layer": Noise(1e-6, 1e-5)}


def check(method: str, profile: Profile, p: Array, curve: Array, stated: Array) -> dict[str, bool]:
    """Return the checks of compliance and resistance, with stated errors or 0, each of shape (2, loads), by name.

    Checks of the shape of a curve need at least two loads.
    """
    found, noise, total = dict[str, bool](), TABLE_NOISE.get(method, ROUNDING), profile.total_amplitude
    # Without a first contact, Persson's compliance falls without bound as ln p (docs/persson.md).
    if p.size > 0 and method != "persson":
        found["within_band"] = within_band(profile, p, curve, noise, stated)
    if p.size > 1:
        found["monotone"] = bool(np.all(np.diff(curve[0]) >= -noise.height * total - _both_ends(stated[0])))
        found["concave"] = concave(p, curve, noise, total, stated)
    return found


def _both_ends(error: Array) -> Array:
    """Return the sum of the errors at both ends of each interval of loads."""
    return np.asarray(error[:-1] + error[1:])


def concave(p: Array, curve: Array, noise: Noise, amplitude: float, stated: Array) -> bool:
    """Return whether the slope falls and every chord lies between the slopes at its ends, within the noise."""
    (h, R), R_error = curve, stated[1]
    with np.errstate(over="ignore", invalid="ignore"):
        slack = (noise.height * amplitude + _both_ends(stated[0])) / np.diff(p)
        chord = np.diff(h) / np.diff(p)
        steepest = R[:-1] * (1 + noise.slope) + R_error[:-1] + slack
        flattest = R[1:] * (1 - noise.slope) - R_error[1:] - slack
        falls = np.diff(R) <= noise.slope * R[:-1] + _both_ends(R_error) + slack
    return bool(np.all(falls & (chord <= steepest) & (chord >= flattest)))


def within_band(profile: Profile, p: Array, curve: Array, noise: Noise, stated: Array) -> bool:
    """Return whether compliance and resistance lie within the bounds of the first wave alone.

    The largest stated error of the compliance and the noise are added to the amplitude of the waves left out.
    """
    (h, R), total = curve, profile.total_amplitude
    band = total - 1 + stated[0].max() + noise.height * total
    one = westergaard.compliance(p)
    within = np.abs(h - total + 1 - one) <= band
    low, high = resistance_bounds(p, one, band, first_contact=0.0)
    R_error = noise.slope * R + stated[1]
    return bool(np.all(within & (low - R_error <= R) & (R - R_error <= high)))


def within_stated_error(deviation: Array, stated: Array, uncertainty: Array) -> bool | None:
    """Return whether no deviation exceeds the stated error plus the uncertainty of the reference.

    None where there is no number with both a reference and a stated error.
    """
    known = np.isfinite(deviation + uncertainty) & ~np.isnan(stated)
    return bool(np.all((deviation <= stated + uncertainty)[known])) if known.any() else None
