"""How far boundary elements are off, and what they cost, before they are run."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.error_model import RESIDUAL_FACTOR
from weier.theory.profile import Profile

Number = TypeVar("Number", float, Array)

# Times sum g_n (waves_n/points)^2: a crest half a node off the grid is missed by z'' dx^2/8, where z'' is at most
# sum g_n k_n^2. That is the error at first touch; at no load was one larger.
COMPLIANCE = math.pi**2 / 2
# Times waves/points. Order 1: edges of contact move by whole nodes. It is not for the very load of a birth, where a
# grid has a contact of a node too many or too few.
RESISTANCE = 18.0
# At lighter loads contacts have a few nodes, half a contact sqrt(p/missed)/pi of them at one crest, where missed is
# sum g_n (waves_n/points)^2; and a crest that the grid takes for lower than it is touches too late.
LIGHT_LOAD = 3000.0  # times missed: contacts of 35 nodes
NARROW_CONTACT = 0.002  # times sum g_n (waves_n/waves of the finest)^2, on any grid: a 35th of the finest wave
NEW_CONTACT = 5.0  # g_0/p_0*: -2 ln(pi a), the resistance of a contact of half-width a = 0.03, wide for a new one
EVENT_SHARE = 0.25  # of the error of a resistance, left to births and mergers that a grid sees at other loads
# Of an error, for a grid by itself. Near births and mergers a resistance needs more room, or else a finer grid.
GRID_SHARES = {"compliance": (1.0,), "resistance": (1 - EVENT_SHARE, EVENT_SHARE)}

MIN_POINTS_PER_WAVE = 12  # fewer were not measured
MAX_POINTS_PER_WAVE = 1e15  # more than any computer holds, and still an integer
COARSEST_POINTS_PER_WAVE = 8  # of the coarsest of the nested grids, at least
MAX_POINTS = 2**21  # a load then takes a second
PLANNED_RESIDUAL = 1e-10  # g_0, at which boundary elements of a plan stop

SECONDS_START, SECONDS_LOAD = 3e-4, 2e-5
SECONDS_NODE = 8e-9  # of each load and node, for a pair of FFTs, of which there are more for more contacts
PAIRS, PAIRS_CONTACT = 20, 15  # and this times the square root of their number
START_LOADS = 3  # a start takes as long as so many of the heaviest loads
BYTES_NODE = 180  # the grids, their eigenvalues and the solver's arrays


def compliance_error(profile: Profile, points: int) -> float:
    """Error of h on `points` nodes, in g_0: COMPLIANCE sum g_n (waves_n/points)^2."""
    return COMPLIANCE * curvature(profile) * (profile.waves_per_period[-1] / points) ** 2


def solution_error(profile: Profile, points: int, residual: Number) -> Number:
    """Error of h on `points` nodes by a solution with these residuals, in g_0, of the shape of `residual`."""
    return compliance_error(profile, points) + RESIDUAL_FACTOR * residual


def curvature(profile: Profile) -> float:
    """Sum g_n (waves_n/waves of the finest)^2, in g_0: the largest curvature, in that of the finest wave."""
    share = np.array(
        [waves / profile.waves_per_period[-1] for waves in profile.waves_per_period]
    )  # integers of any size
    return float(np.sum(profile.amplitude * share**2))


def light_load(profile: Profile, points: int) -> float:
    """Mean pressure below which `points` nodes do not tell the resistance, in p_0*."""
    return curvature(profile) * max(LIGHT_LOAD * (profile.waves_per_period[-1] / points) ** 2, NARROW_CONTACT)


def resistance_error(profile: Profile, points: int, mean_pressure: Array) -> Array:
    """Error of the resistance, shape (loads,): RESISTANCE waves/points; inf at light loads."""
    resolved = mean_pressure >= light_load(profile, points)
    return np.where(resolved, RESISTANCE * profile.waves_per_period[-1] / points, np.inf)


def neighbouring_loads(profile: Profile, points: int, mean_pressure: Array) -> Array:
    """A lighter and a heavier load beside each, shape (loads, 2): between them a grid sees what happens at the load.

    The heights of a crest and of the plane are off by the error of the compliance each, and under more load a crest
    nears the plane at a rate t. Its contact then lowers the resistance by t^2 over NEW_CONTACT or more: by less than
    the grid is off anyway, if t is smaller than sqrt(NEW_CONTACT error).
    """
    slowest = math.sqrt(NEW_CONTACT * RESISTANCE * profile.waves_per_period[-1] / points)
    shift = np.minimum(2 * compliance_error(profile, points) / slowest, mean_pressure / 2)
    return np.column_stack([mean_pressure - shift, mean_pressure + shift])


def light_resistance_error(profile: Profile, points: int, mean_pressure: Array, resistance: Array) -> Array:
    """Error of the resistance at light loads, in g_0/p_0*, shape (loads,).

    All of it, since the true one is no less than 0; and L ln(light load/p) more, L the period: so grows that of one
    contact, -2 L ln a, whose half-width a is as sqrt(p), where that of a single node stands still.
    """
    lighter = np.log(light_load(profile, points)) - np.log(mean_pressure)
    return np.asarray(resistance + profile.period * np.maximum(lighter, 0))


def fewest_points(profile: Profile, error: float, quantity: str) -> int:
    """Fewest nodes in a period that keep within this error, and can be halved to nested grids."""
    by_compliance = quantity == "compliance"
    needed = math.sqrt(COMPLIANCE * curvature(profile) / error) if by_compliance else RESISTANCE / error
    needed = min(max(needed, MIN_POINTS_PER_WAVE), MAX_POINTS_PER_WAVE)
    halvings = 2 ** int(math.log2(needed / COARSEST_POINTS_PER_WAVE))
    return math.ceil(needed / halvings) * halvings * profile.waves_per_period[-1]


def seconds(points: float, contacts: Array) -> tuple[float, Array]:
    """Seconds to start on so many nodes, and for each load with so many contacts."""
    load = SECONDS_LOAD + SECONDS_NODE * points * fft_pairs(contacts)
    return SECONDS_START + START_LOADS * float(load[-1]), load


def fft_pairs(contacts: Array) -> Array:
    """Pairs of FFTs that a load and its resistance take."""
    return np.asarray(PAIRS + PAIRS_CONTACT * np.sqrt(contacts))


def memory(points: int) -> float:
    """Bytes of the solver on so many nodes."""
    return float(BYTES_NODE * points)
