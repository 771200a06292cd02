"""What each method costs and how far it is off, before it is run.

The constants stand above what the rule `tradeoff` measures (`weier.accuracy.tradeoff.fit` fits them again, side by
side in results/tradeoff/tradeoff.md). `python -m benchmarks.planned` checks them on random profiles, and those of
memory come from `python -m benchmarks.memory`. Heights in g_0, pressures in p_0*, seconds on one core of a 2.5 GHz
server, bytes beyond those of the interpreter. The error of a resistance is relative to the larger of itself and
1 g_0/p_0*.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from weier.theory.profile import Profile

Array = NDArray[np.float64]

# Times sum g_n (waves_n/points)^2: a crest half a node off the grid is missed by z'' dx^2/8, where z'' is at most
# sum g_n k_n^2. That is the error at first touch; at no load was one larger.
BEM_COMPLIANCE = math.pi**2 / 2
# Times waves/points. Order 1: edges of contact move by whole nodes. It is not for the very load of a birth, where a
# grid has a contact of a node too many or too few.
BEM_RESISTANCE = 18.0
# At lighter loads contacts have a few nodes, half a contact sqrt(p/missed)/pi of them at one crest, where missed is
# sum g_n (waves_n/points)^2; and a crest that the grid takes for lower than it is touches too late.
LIGHT = 3000.0  # times missed: contacts of 35 nodes
NARROW = 0.002  # times sum g_n (waves_n/waves of the finest)^2, on any grid: contacts of a 35th of the finest wave
FEWEST_PER_WAVE = 12  # fewer were not measured
MOST_PER_WAVE = 1e15  # more than any computer holds, and still an integer
HALVED_TO = 8  # points a wave that the coarsest of the nested grids has at least

PATCHES_COMPLIANCE = 0.01  # times the tolerance
PATCHES_RESISTANCE = 1.0
# At a looser tolerance symmetric contacts take hundreds of times as long, and no others less.
PATCHES_TOLERANCES = (1e-8, 1e-10, 1e-12)
# What misses the contact conditions by a length is exact for a surface as far from the given one, and the bounds
# theorem holds the compliance to that length: measured 1.25 of it, since it is looked for at every second node.
RESIDUAL = 2.0
BEM_RESIDUAL = 1e-10  # g_0, at which boundary elements stop
FLOOR = 1e-14  # of the total amplitude: rounding of the compliance
ROUNDING = 1e-12  # of the resistance; also of the compliance while planning

# Largest error of the compliance in the amplitude of the terms after the first. At light loads an estimate knows
# nothing of where the crests are: it tends to 0 where the profile tends to first contact; that part is added apart.
LAYER = 0.5
DEMELIO = 0.7
CROWDED = 0.3  # p_0*: from here on crests of the coarsest wave matter no more, and the errors fall with the load
# Of the endless series with its coarse terms resolved, in the amplitude of its tail: at light loads, at heavy ones.
TAIL = 0.8
TAIL_CROWDED = 0.16

SECONDS_START = {"westergaard": 1e-6, "demelio": 5e-5, "layer": 0.06, "bem": 3e-4, "patches": 5e-4, "endless": 0.15}
SECONDS_LOAD = {"westergaard": 1e-6, "demelio": 2e-6, "layer": 3e-4, "bem": 2e-5, "patches": 3e-4, "endless": 4e-3}
# Of each load and node: by boundary elements for a pair of FFTs, of which there are more for more contacts.
SECONDS_NODE = {"bem": 8e-9, "endless": 1.2e-5}
PAIRS, PAIRS_CONTACT = 20, 15  # and this times the square root of their number
START_LOADS = 3  # as long as so many of the heaviest loads
SECONDS_WAVE, SECONDS_CONTACT, CONTACT_POWER = 1.5e-5, 8e-5, 2.0  # of patches, each load

# The grids, their eigenvalues and the solver's arrays; the directions of GMRES.
BYTES_NODE = {"bem": 180, "endless": 900}
BYTES_WAVE = 1e5  # of patches: every crest, and the coarse grid to start from
NODES_CONTACT = 20  # of a contact, whose matrix is dense
DENSE_COPIES = 7  # of that matrix: itself, its factors and what they are made from


def bem_compliance_error(profile: Profile, points: int) -> float:
    """Error of h by boundary elements on `points` nodes, in g_0: BEM_COMPLIANCE sum g_n (waves_n/points)^2."""
    return BEM_COMPLIANCE * unresolved(profile) * (profile.wavenumber[-1] / points) ** 2


def unresolved(profile: Profile) -> float:
    """Sum g_n (waves_n/waves of the finest)^2, in g_0."""
    share = np.array([waves / profile.wavenumber[-1] for waves in profile.wavenumber])  # integers of any size
    return float(np.sum(profile.amplitude * share**2))


def bem_light_load(profile: Profile, points: int) -> float:
    """Mean pressure below which `points` nodes do not tell the resistance, in p_0*."""
    return unresolved(profile) * max(LIGHT * (profile.wavenumber[-1] / points) ** 2, NARROW)


def bem_resistance_error(profile: Profile, points: int, mean_pressure: Array) -> Array:
    """Error of the resistance by boundary elements, shape (loads,): BEM_RESISTANCE waves/points, inf where light."""
    seen = mean_pressure >= bem_light_load(profile, points)
    return np.where(seen, BEM_RESISTANCE * profile.wavenumber[-1] / points, np.inf)


def light_resistance_error(profile: Profile, points: int, mean_pressure: Array, resistance: Array) -> Array:
    """Error of the resistance by boundary elements at light loads, in g_0/p_0*, shape (loads,).

    All of it, since the true one is no less than 0; and L ln(light load/p) more, L the period: so grows that of one
    contact, -2 L ln a, whose half-width a is as sqrt(p), where that of a single node stands still.
    """
    lighter = np.log(bem_light_load(profile, points)) - np.log(mean_pressure)
    return np.asarray(resistance + profile.period * np.maximum(lighter, 0))


def bem_points(profile: Profile, error: float, quantity: str) -> int:
    """Fewest nodes in a period that keep within this error, and can be halved to nested grids."""
    if quantity == "compliance":
        needed = math.sqrt(BEM_COMPLIANCE * unresolved(profile) / error)
    else:
        needed = BEM_RESISTANCE / error
    needed = min(max(needed, FEWEST_PER_WAVE), MOST_PER_WAVE)
    halvings = 2 ** int(math.log2(needed / HALVED_TO))
    return math.ceil(needed / halvings) * halvings * profile.wavenumber[-1]


def patches_error(tolerance: float, quantity: str) -> float:
    """Error by contact patches at this tolerance."""
    factor = PATCHES_COMPLIANCE if quantity == "compliance" else PATCHES_RESISTANCE
    return factor * tolerance + ROUNDING


def estimate_error(method: str, mean_pressure: Array, D: float, first_contact: float, amplitude: float) -> Array:
    """Error of h by an estimate, in g_0, shape (loads,).

    Parameters
    ----------
    method : "layer" or "demelio"
    mean_pressure : array, shape (loads,)
        In p_0*.
    D : float
        Fractal dimension.
    first_contact : float
        Compliance at first contact, in g_0, or a bound above it.
    amplitude : float
        Sum of the amplitudes after the first, in g_0.
    """
    light = max(first_contact, {"layer": LAYER, "demelio": DEMELIO}[method] * amplitude)
    return light * unflattened(mean_pressure, CROWDED, D)


def endless_error(mean_pressure: Array, kept: Profile) -> Array:
    """Error of h of an endless series with all but these terms on the layer, in g_0, but that of the mesh."""
    share = np.maximum(TAIL * (CROWDED / np.maximum(mean_pressure, CROWDED)), TAIL_CROWDED)
    pressure = float(kept.gamma) ** ((kept.D - 1) * kept.terms)  # p_k*
    return np.asarray(share * kept.tail_amplitude * unflattened(mean_pressure, pressure, kept.D))


def unflattened(mean_pressure: Array, first: float, D: float) -> Array:
    """Share of the amplitudes that a load leaves, with p* of the first: g_n where p_n* = p (20), at least p*/p."""
    return np.asarray((first / np.maximum(mean_pressure, first)) ** min((2 - D) / (D - 1), 1.0))


def bem_seconds(points: float, contacts: Array) -> tuple[float, Array]:
    """Seconds of boundary elements to start on so many nodes, and for each load with so many contacts."""
    load = SECONDS_LOAD["bem"] + SECONDS_NODE["bem"] * points * fft_pairs(contacts)
    return SECONDS_START["bem"] + START_LOADS * float(load[-1]), load


def fft_pairs(contacts: Array) -> Array:
    """Pairs of FFTs that boundary elements take for a load and its resistance."""
    return np.asarray(PAIRS + PAIRS_CONTACT * np.sqrt(contacts))


def endless_seconds(points: int) -> tuple[float, float]:
    """Seconds of the endless series to start on so many nodes, and for each load."""
    load = SECONDS_LOAD["endless"] + SECONDS_NODE["endless"] * points
    return SECONDS_START["endless"] + START_LOADS * load, load


def patches_seconds(waves: int, contacts: Array) -> Array:
    """Seconds of contact patches for each load, at so many of the finest waves in a period and contacts."""
    return np.asarray(SECONDS_LOAD["patches"] + SECONDS_WAVE * waves + SECONDS_CONTACT * contacts**CONTACT_POWER)


def grid_bytes(method: str, points: int) -> float:
    """Memory of a solver on so many nodes."""
    return float(BYTES_NODE[method] * points)


def patches_bytes(waves: int, contacts: float) -> float:
    """Memory of contact patches: a few dense matrices, and what there is for each of the finest waves."""
    return float(DENSE_COPIES * 8 * (NODES_CONTACT * contacts) ** 2 + BYTES_WAVE * waves)
