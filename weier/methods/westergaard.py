"""One wave against a plane: Westergaard's closed form, Eqs (6)-(14) and Appendix A.

docs/closed_forms.md, "One wave", derives the formulas. Heights are in the amplitude g, pressures in p* (7): xi is the
mean pressure (9). The functions broadcast.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.errors import NotApplicableError
from weier.methods.method import Method, Style
from weier.surface.profile import Profile


def compliance(xi: ArrayLike) -> Array:
    """Return compliance h = xi (1 - ln xi), in g; h = g beyond full contact, xi >= 1 (12)."""
    xi = np.minimum(xi, 1.0)
    return np.asarray(xi * (1 - np.log(xi)))


def resistance(xi: ArrayLike) -> Array:
    """Return specific contact resistance dh/dxi = -ln xi, in g/p*; 0 beyond full contact (13), (14).

    Notes
    -----
    (13) prints 1/R; this is R, which joins (14) at xi = 1.
    """
    return np.asarray(-np.log(np.minimum(xi, 1.0)) + 0.0)


def contact_half_width(xi: ArrayLike) -> Array:
    """Return the contact half-width a = arcsin(sqrt(xi))/pi, in lambda; 1/2 in full contact (8)."""
    return np.asarray(np.arcsin(np.sqrt(np.minimum(xi, 1.0))) / np.pi)


def elastic_energy(xi: ArrayLike) -> Array:
    """Return the elastic energy per area, the integral of xi over h: xi^2 (1 - 2 ln xi)/4, in g p*."""
    xi = np.minimum(xi, 1.0)
    return np.asarray(xi**2 * (1 - 2 * np.log(xi)) / 4)


def curve(profile: Profile, xi: ArrayLike) -> Curve:
    """Return both curves and the contact fraction of the only wave of a series, over loads in p*."""
    fraction, energy = 2 * contact_half_width(xi), elastic_energy(xi)
    return Curve(compliance(xi), resistance(xi), contact_fraction=fraction, elastic_energy=energy)


def _applies(profile: Profile) -> None:
    if profile.m != 1:
        raise NotApplicableError(f'method "westergaard" is for one wave, m = 1, got m = {profile.m}')


METHOD = Method(
    name="westergaard",
    label="Westergaard",
    summary="the closed form for one wave (6)-(14); m = 1",
    solve=curve,
    returns=("contact_fraction", "elastic_energy"),
    applies=_applies,
    uses_phases=False,
    in_paper=True,
    style=Style("#CC79A7", (6, 1.5, 1, 1.5, 1, 1.5), "*"),
)
