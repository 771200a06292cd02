"""From compliance to resistance between two bodies, Eqs (2), (3) and (7).

docs/closed_forms.md, "From compliance to resistance", derives the formulas.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from weier import units
from weier.checks import Condition, checked_numbers
from weier.kernels.arrays import Array

beyond_floats = np.errstate(over="ignore")  # Values larger than the largest float become inf.
# condition on each quantity, as words after "must" and as a function, and its unit
RANGES: dict[str, tuple[str, Condition, str]] = {
    **dict.fromkeys(
        ("mu_1", "mu_2", "E_1", "E_2", "modulus"),
        ("be positive (inf for a rigid body)", lambda mu: mu > 0, units.PASCAL),
    ),
    **dict.fromkeys(("nu_1", "nu_2"), ("lie in (-1, 0.5]", lambda nu: (nu > -1) & (nu <= 0.5), units.NONE)),
    **dict.fromkeys(
        ("rho_1", "rho_2"),
        ("be finite and not negative", lambda rho: (rho >= 0) & (rho < math.inf), units.OHM_METRE),
    ),
    **dict.fromkeys(
        ("hardness_1", "hardness_2"), ("be positive and finite", lambda x: (x > 0) & (x < math.inf), units.PASCAL)
    ),
    **dict.fromkeys(
        ("k_1", "k_2"), ("be positive and finite", lambda k: (k > 0) & (k < math.inf), units.CONDUCTIVITY)
    ),
    **dict.fromkeys(("lambda_0", "g_0"), ("be positive and finite", lambda x: (x > 0) & (x < math.inf), units.METRE)),
}


def _checked(name: str, values: ArrayLike) -> Array:
    return checked_numbers(name, values, *RANGES[name])


@beyond_floats
def composite_modulus(
    *,
    nu_1: ArrayLike,
    nu_2: ArrayLike,
    mu_1: ArrayLike | None = None,
    mu_2: ArrayLike | None = None,
    E_1: ArrayLike | None = None,
    E_2: ArrayLike | None = None,
) -> Array:
    """Return composite modulus M of two bodies, 1/M = (1 - nu_1)/mu_1 + (1 - nu_2)/mu_2 (3).

    Each body has Poisson's ratio in (-1, 0.5] and one of mu, the shear modulus, and E = 2 mu (1 + nu), Young's
    modulus, in the unit of M. One modulus may be inf: a rigid body. ValueError is raised for other values.
    """
    moduli = shear_modulus(1, mu_1, E_1, nu_1), shear_modulus(2, mu_2, E_2, nu_2)
    softness = (1 - _checked("nu_1", nu_1)) / moduli[0] + (1 - _checked("nu_2", nu_2)) / moduli[1]
    if np.any(softness == 0):
        raise ValueError("mu_1 and mu_2 are both inf: two rigid bodies have no elastic contact, give one a modulus")
    return np.asarray(1 / softness)


def full_contact_pressure(modulus: float, lambda_0: ArrayLike, g_0: ArrayLike) -> Array:
    """Return mean pressure p_0* = 2 pi M g_0/lambda_0 that flattens one wave (7), in the unit of the modulus."""
    return np.asarray(2 * math.pi * modulus * np.asarray(g_0) / np.asarray(lambda_0))


def shear_modulus(body: int, mu: ArrayLike | None, E: ArrayLike | None, nu: ArrayLike) -> Array:
    """Return the shear modulus of body 1 or 2, from its own value or Young's modulus."""
    if mu is not None and E is None:
        return _checked(f"mu_{body}", mu)
    if E is not None and mu is None:
        return np.asarray(_checked(f"E_{body}", E) / (2 * (1 + _checked(f"nu_{body}", nu))))
    given = "neither" if mu is None else "both"
    raise ValueError(f"give one of mu_{body}, the shear modulus, and E_{body}, Young's modulus, got {given}")


@beyond_floats
def specific_resistance(compliance_slope: ArrayLike, modulus: ArrayLike, rho_1: ArrayLike, rho_2: ArrayLike) -> Array:
    """Return resistance times nominal area, M (rho_1 + rho_2) dh/dp, in ohm m^2 (2).

    dh/dp is in m/Pa, M in Pa, the resistivities are in ohm m; 1/k of thermal conductivities k give K m^2/W.
    Broadcasts.
    """
    slope = checked_numbers("compliance_slope", compliance_slope, unit="m/Pa")
    return np.asarray(_checked("modulus", modulus) * (_checked("rho_1", rho_1) + _checked("rho_2", rho_2)) * slope)
