"""The error and the cost of resolved terms on a layer that are expected before they are run.

The formula is that of docs/hybrid.md, "The error, and where it stops", and of docs/planned.md, "Expected seconds".
What was measured is in docs/numerics.md, "The tail on the layer".
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.error_model import CREST_LOAD, partial_contact_factor
from weier.surface.profile import Profile

# Error of the compliance over the amplitude of the tail, at light loads and at heavy ones. At light loads it is that
# of first contact, which was lower by 1.18 at most than the layer has it, on 3000 series of random phases, 0 and pi.
LIGHT_ERROR, HEAVY_ERROR = 1.25, 0.16

SECONDS_START, SECONDS_LOAD = 0.15, 4e-3  # Seconds of a curve, and of each load.
SECONDS_NODE = 4e-5  # Seconds of each load and node.
START_LOADS = 3  # A start takes as long as so many loads.
BYTES_NODE = 900  # Bytes of the directions of GMRES, of each node.


def compliance_error(mean_pressure: Array, kept: Profile) -> Array:
    """Error of h of an infinite series with all but these terms on the layer, in g_0, without that of the mesh."""
    relative = np.maximum(LIGHT_ERROR * (CREST_LOAD / np.maximum(mean_pressure, CREST_LOAD)), HEAVY_ERROR)
    pressure = float(kept.gamma) ** ((kept.D - 1) * kept.terms)  # p_k*
    return np.asarray(relative * kept.tail_amplitude * partial_contact_factor(mean_pressure, pressure, kept.D))


def seconds(points: int) -> tuple[float, float]:
    """Expected seconds to start on so many nodes, and of each load."""
    load = SECONDS_LOAD + SECONDS_NODE * points
    return SECONDS_START + START_LOADS * load, load


def memory(points: int) -> float:
    """Expected bytes on so many nodes."""
    return float(BYTES_NODE * points)
