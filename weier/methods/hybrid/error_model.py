"""How far resolved terms on a layer are off, and what they cost, before they are run."""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.error_model import CREST_LOAD, partial_share
from weier.theory.profile import Profile

# In the amplitude of the tail: at light loads, where 3000 series of random phases and those of 0 and pi had first
# contact lower by 1.18 at most than the layer has it, and at heavy ones.
LIGHT_SHARE, HEAVY_SHARE = 1.25, 0.16

SECONDS_START, SECONDS_LOAD = 0.15, 4e-3
SECONDS_NODE = 4e-5  # of each load and node
START_LOADS = 3  # a start takes as long as so many loads
BYTES_NODE = 900


def compliance_error(mean_pressure: Array, kept: Profile) -> Array:
    """Error of h of an infinite series with all but these terms on the layer, in g_0, but that of the mesh."""
    share = np.maximum(LIGHT_SHARE * (CREST_LOAD / np.maximum(mean_pressure, CREST_LOAD)), HEAVY_SHARE)
    pressure = float(kept.gamma) ** ((kept.D - 1) * kept.terms)  # p_k*
    return np.asarray(share * kept.tail_amplitude * partial_share(mean_pressure, pressure, kept.D))


def seconds(points: int) -> tuple[float, float]:
    """Seconds to start on so many nodes, and for each load."""
    load = SECONDS_LOAD + SECONDS_NODE * points
    return SECONDS_START + START_LOADS * load, load


def memory(points: int) -> float:
    """Bytes of the directions of GMRES, each a number at every node."""
    return float(BYTES_NODE * points)
