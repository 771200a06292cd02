"""The density of a segment so small that it does not see its neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.methods.patches.chebyshev import nodes

Array = NDArray[np.float64]


def hertz(dual: bool, curvature: float, half_width: float, count: int) -> Array:
    """phi of a lone small segment: Hertz's contact, or (dual) the gap under a parabola of pressure."""
    if dual:
        return -np.pi * curvature * half_width**2 * nodes(count)
    return np.full(count, curvature * half_width / (2 * np.pi))
