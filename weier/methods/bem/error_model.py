"""How far boundary elements are off, and what they cost, before they are run."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem.grids import MIN_POINTS_PER_CARRIED_WAVE
from weier.methods.error_model import RESIDUAL_FACTOR
from weier.theory.waves import Waves

Number = TypeVar("Number", float, Array)

# With edges on nodes: times sum g_n (waves_n/points)^2. A crest half a node off the grid is missed by z'' dx^2/8,
# where z'' is at most sum g_n k_n^2. That is the error at first touch; at no load was one larger.
COMPLIANCE = math.pi**2 / 2
# With edges between the nodes, of the errors that a solution states (docs/subgrid.md), at 90 % of the loads. Of the
# compliance, times the same sum over the points a wave and times the contacts of a wave; of the resistance, over the
# square of the points a wave, and what the contacts of a wave add, and over the points a wave by the square of the
# contacts of a wave, since these bear on each other in pairs. The errors themselves are far smaller. A solution that
# states more than this, as next to births, is not taken if it is too much.
STATED_COMPLIANCE = 1.8
STATED_RESISTANCE, RESISTANCE_CROWDING, RESISTANCE_PAIRS = 0.03, 1.05, 0.012
LONE_SHARE = 3e-3  # of these where there is one contact, which has no neighbours that bear on it

MIN_MEASURED_POINTS = 12  # for each of the finest waves, with edges on nodes: coarser grids were not measured
MAX_POINTS_PER_WAVE = 1e15  # more than any computer holds, and still an integer
MAX_POINTS = 2**21  # a load then takes a second
# Of the grids that plans choose from, with edges between the nodes: contact patches are cheaper than finer ones.
PLANNED_POINTS_PER_WAVE = (16, 24, 32, 48, 64, 96, 128)
PLANNED_RESIDUAL = 1e-10  # g_0, at which boundary elements of a plan stop

SECONDS_START, SECONDS_LOAD = 5e-4, 8e-5
SECONDS_NODE = 1.3e-8  # of each load and node, for a pair of FFTs, of which there are more for more contacts
PAIRS, MORE_PAIRS = 14, 0.2  # for each square root of contacts, and for each contact, to equalise their forces
START_PAIRS = 15  # as many take as long as a start
BYTES_NODE = 180  # the grids, their eigenvalues and the solver's arrays


def compliance_error(profile: Waves, points: int) -> float:
    """Error of h on `points` nodes, in g_0, with edges of contact on nodes: COMPLIANCE sum g_n (waves_n/points)^2."""
    return COMPLIANCE * _nodal_curvature(profile, points)


def solution_error(profile: Waves, points: int, residual: Number) -> Number:
    """Error of h of a solution with these residuals, in g_0, of their shape: that of the grid, and what they add."""
    return compliance_error(profile, points) + RESIDUAL_FACTOR * residual


def fewest_points(profile: Waves, error: float) -> int:
    """Fewest nodes in a period that keep within this `compliance_error`, and can be halved to nested grids."""
    needed = math.sqrt(COMPLIANCE * curvature(profile) / error)
    needed = min(max(needed, MIN_MEASURED_POINTS), MAX_POINTS_PER_WAVE)
    halvings = 2 ** int(math.log2(needed / MIN_POINTS_PER_CARRIED_WAVE))
    return math.ceil(needed / halvings) * halvings * profile.waves_per_period[-1]


def stated_error(profile: Waves, points: int, quantity: str, contacts: Array) -> Array:
    """Error that a solution with edges between the nodes states at most loads with so many contacts, of their shape.

    It is in g_0 of a compliance, in the larger of itself and 1 of a resistance.
    """
    per_wave = points / profile.waves_per_period[-1]
    crowding, lone = contacts / profile.waves_per_period[-1], np.where(contacts < 1.5, LONE_SHARE, 1.0)
    if quantity == "compliance":
        share = STATED_COMPLIANCE * crowding / per_wave
        return np.asarray(lone * share * _nodal_curvature(profile, points) + PLANNED_RESIDUAL)
    share = (STATED_RESISTANCE + RESISTANCE_CROWDING * crowding) / per_wave + RESISTANCE_PAIRS * crowding**2
    return np.asarray(lone * share / per_wave)


def curvature(profile: Waves) -> float:
    """Sum g_n (waves_n/waves of the finest)^2, in g_0: the largest curvature, in that of the finest wave."""
    share = np.array(
        [waves / profile.waves_per_period[-1] for waves in profile.waves_per_period]
    )  # integers of any size
    return float(np.sum(profile.amplitude * share**2))


def _nodal_curvature(profile: Waves, points: int) -> float:
    """Sum g_n (waves_n/points)^2, in g_0: the largest curvature, in that of a wave as long as the nodes' spacing."""
    return curvature(profile) * (profile.waves_per_period[-1] / points) ** 2


def seconds(points: float, contacts: Array) -> tuple[float, Array]:
    """Seconds to start on so many nodes, and for each load with so many contacts."""
    pair = SECONDS_NODE * points
    return SECONDS_START + START_PAIRS * pair, SECONDS_LOAD + pair * fft_pairs(contacts)


def fft_pairs(contacts: Array) -> Array:
    """Pairs of FFTs that a load takes for both numbers."""
    return np.asarray(PAIRS * np.sqrt(contacts) + MORE_PAIRS * contacts)


def memory(points: int) -> float:
    """Bytes of the solver on so many nodes."""
    return float(BYTES_NODE * points)
