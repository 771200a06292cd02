"""Bounds on the stiffness of the self-similar punch of Borodich and Galanov, Appendix B.

The punch lies between two paraboloids, (1 -/+ epsilon) r^2/(2 R) (B.1), so that its force lies between two
Hertzian curves and its convex force curve has a slope between two tangents to the upper one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from weier.checks import checked_numbers
from weier.kernels.arrays import Array


def tangent_roots(epsilon: ArrayLike) -> tuple[Array, Array]:
    """Return positive roots x_1 <= x_2 of 2 lambda x^3 - 3 x^2 + 1 = 0, lambda = C_2/C_1 (B.8), (B.9).

    With x = 1/(2 sin t), (B.8) is sin 3 t = lambda. The arc tangent keeps all digits of 3 t where the roots merge,
    epsilon = 0, and where x_2 grows without bound, epsilon = 1.
    """
    epsilon = _checked(epsilon)
    angle = np.arctan2(np.sqrt(1 - epsilon), np.sqrt(2 * epsilon))
    return 0.5 / np.sin((np.pi - angle) / 3), 0.5 / np.sin(angle / 3)


def stiffness_bounds(epsilon: ArrayLike) -> tuple[Array, Array]:
    """Return lower and upper bound on k/k_H, with k_H the stiffness of the smooth punch at the same force (B.16).

    They bound the contact conductance alike, by (2). `epsilon` lies in [0, 1).
    """
    epsilon = _checked(epsilon)
    first, second = tangent_roots(epsilon)
    common = (1 + epsilon) ** (1 / 6) / (1 - epsilon) ** (1 / 2)
    return common / second, common / first


def _checked(epsilon: ArrayLike) -> Array:
    return checked_numbers("epsilon", epsilon, "lie in [0, 1)", lambda epsilon: (epsilon >= 0) & (epsilon < 1))
