"""What each method costs and how far it is off, before it is run.

Laws fitted to the rule `tradeoff` (14 profiles; D from 1.1 to 1.75, gamma from 2 to 5, up to 32 waves of the finest
term in a period, 25 loads from 1e-3 to 10 p_0*), and checked on random profiles by `python -m benchmarks.planned`.
Heights in g_0, pressures in p_0*, seconds on one core of a 2.5 GHz server, bytes beyond those of the interpreter.
The error of a resistance is relative to the larger of itself and 1 g_0/p_0*.
"""

from __future__ import annotations

import math

import numpy as np

from weier.profile import Profile

# Times what the grid misses of each wave, sum g_n (waves_n/points)^2: measured between 1.3 and 3.9, of order 2.
BEM_COMPLIANCE = 4.5
# Measured at up to 12 for one wave and 6 for more. Order 1: edges of contact move by whole nodes.
BEM_RESISTANCE = 14.0
FEWEST_PER_WAVE = 12  # fewer were not measured
HALVED_TO = 8  # points a wave that the coarsest of the nested grids has at least

# Measured: 2e-3 of the tolerance and 0.6 of it.
PATCHES_COMPLIANCE = 0.01
PATCHES_RESISTANCE = 1.0
PATCHES_FLOOR = 1e-12  # rounding
PATCHES_TOLERANCES = (1e-6, 1e-8, 1e-10, 1e-12)

# Largest error of the compliance in the amplitude of the terms after the first. At light loads an estimate knows
# nothing of where the crests are: it tends to 0 where the profile tends to first contact; that part is added apart.
LAYER = 0.3
DEMELIO = 0.7

SECONDS_LOAD = {"westergaard": 1e-6, "demelio": 2e-5, "layer": 4e-4}
SECONDS_FEW_NODES, SECONDS_NODE = 2e-5, 1.5e-6  # of boundary elements, for each load
SECONDS_PATCH, SECONDS_CONTACT, CONTACT_POWER = 7e-4, 3e-4, 1.15  # each load; and for each of the finest waves
BYTES_NODE = 250  # of boundary elements: the grids, their eigenvalues and the arrays of the solver
NODES_CONTACT = 20  # of a contact, whose matrix is dense;
DENSE_COPIES = 4  # the matrix, its factors and what they are made from


def bem_compliance_error(profile: Profile, points: int) -> float:
    """Error of h by boundary elements on `points` nodes, in g_0: 4.5 sum g_n (waves_n/points)^2."""
    return BEM_COMPLIANCE * _unresolved(profile) * (profile.wavenumber[-1] / points) ** 2


def _unresolved(profile: Profile) -> float:
    """Sum g_n (waves_n/waves of the finest)^2, in g_0."""
    share = np.array([waves / profile.wavenumber[-1] for waves in profile.wavenumber])  # integers of any size
    return float(np.sum(profile.amplitude * share**2))


def bem_resistance_error(profile: Profile, points: int) -> float:
    """Error of the resistance by boundary elements on `points` nodes: 14 waves/points."""
    return BEM_RESISTANCE * profile.wavenumber[-1] / points


def bem_points(profile: Profile, error: float, quantity: str) -> int:
    """Fewest nodes in a period that keep within this error, and can be halved to nested grids."""
    if quantity == "compliance":
        needed = math.sqrt(BEM_COMPLIANCE * _unresolved(profile) / error)
    else:
        needed = BEM_RESISTANCE / error
    needed = max(needed, FEWEST_PER_WAVE)
    halvings = 2 ** int(math.log2(needed / HALVED_TO))
    return math.ceil(needed / halvings) * halvings * profile.wavenumber[-1]


def patches_error(tolerance: float, quantity: str) -> float:
    """Error by contact patches at this tolerance."""
    factor = PATCHES_COMPLIANCE if quantity == "compliance" else PATCHES_RESISTANCE
    return factor * tolerance + PATCHES_FLOOR


def estimate_error(method: str, first_contact: float, amplitude: float) -> float:
    """Error of h by an estimate, in g_0.

    Parameters
    ----------
    method : "layer" or "demelio"
    first_contact : float
        Compliance at first contact, in g_0, or a bound above it.
    amplitude : float
        Sum of the amplitudes after the first, in g_0.
    """
    return max(first_contact, (LAYER if method == "layer" else DEMELIO) * amplitude)


def bem_seconds(points: int, loads: int) -> float:
    """Seconds of boundary elements."""
    return (SECONDS_FEW_NODES + SECONDS_NODE * points) * loads


def patches_seconds(waves: int, loads: int) -> float:
    """Seconds of contact patches, at so many of the finest waves in a period."""
    return float((SECONDS_PATCH + SECONDS_CONTACT * waves**CONTACT_POWER) * loads)


def bem_bytes(points: int) -> float:
    """Memory of boundary elements."""
    return float(BYTES_NODE * points)


def patches_bytes(waves: int) -> float:
    """Memory of contact patches: a few dense matrices."""
    return float(DENSE_COPIES * 8 * (NODES_CONTACT * waves) ** 2)
