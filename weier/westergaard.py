"""One wave against a plane: Westergaard's closed form, Eqs (6)-(14) and Appendix A.

Lengths along x are in the wavelength lambda, heights in the amplitude g, pressures in p* (7): xi is the mean
pressure (9). The functions broadcast.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def compliance(xi: ArrayLike) -> Array:
    """Compliance h = xi (1 - ln xi), in g; h = g beyond full contact, xi >= 1 (12)."""
    xi = np.minimum(xi, 1.0)
    return np.asarray(xi * (1 - np.log(xi)))


def resistance(xi: ArrayLike) -> Array:
    """Specific contact resistance dh/dxi = -ln xi, in g/p*; 0 beyond full contact (13), (14).

    Notes
    -----
    (13) prints 1/R; this is R, which joins (14) at xi = 1.
    """
    return np.asarray(-np.log(np.minimum(xi, 1.0)) + 0.0)
