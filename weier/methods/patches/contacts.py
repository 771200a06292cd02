"""Contacts as segments: punches with given edges and a common load (docs/patches.md, "Given edges").

At the zeros of T_K, f_i = (pi/K) r psi_i. With A the sum over all nodes of -2 ln|2 sin(pi (x_i - x_j)/L)|,

    z - A f = d on all contacts,   sum f = p L,

with the mean gap d. A is positive definite on forces of sum 0; `OFFSET` makes it so on all forces.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Records
from weier.kernels.jit import kernel
from weier.methods.patches.kind import FIELD_ROUNDING, NEW_CONTACT_WIDTH, Kind
from weier.methods.patches.surface import Extent
from weier.methods.punches import OFFSET, Inverse, invert_punches
from weier.theory.halfplane import displacement_of_punch

# of the self-influence: shift of theta_i = pi (i + 1/2)/K, sign of X(i + j + shift), and power of k in the sum
RULE = 1, 1.0, -1


def own_kernel(sine: Array) -> Array:
    """Return the kernel that a sum over all nodes contains, ln(2 sin theta)."""
    return np.asarray(np.log(2 * sine))


@kernel
def contact_node(r: float, sine: float, period: float) -> tuple[float, float]:
    """Return the factor of a node in the self-influence, and its diagonal."""
    return 1.0, np.log(2 * np.pi / period * r * sine)


@kernel
def contact_wave(angle: float) -> float:
    """Return the value of T_k at a node, from k times its angle."""
    return np.cos(angle)


@kernel
def contact_degree(n: int, r: float) -> float:
    """Return b_n over the sum of T_n f."""
    return (1 if n == 0 else 2) / (np.pi * r)


@kernel
def _close(force: Array, even: Array, load: float, period: float) -> tuple[Array, float]:
    """Return the forces that carry the load with a uniform displacement, and the plane."""
    total, of_even, closed = 0.0, 0.0, np.empty(force.size)
    for i in range(force.size):
        total, of_even = total + force[i], of_even + even[i]
    shift = (load * period - total) / of_even
    for i in range(force.size):
        closed[i] = force[i] + shift * even[i]
    return closed, OFFSET * load * period - shift


def _invert_punches(half_width: Array, middle: Array, period: float) -> Inverse:
    """Return the inverse of the influence of contacts as flat punches."""
    return invert_punches(middle, displacement_of_punch(half_width, period), period)


def _imbalance(integral: Array, load: float, period: float) -> tuple[float, float]:
    """Return the difference of the mean pressure and the load; there are no gaps to close."""
    return abs(float(integral.sum()) / period - load), 0.0


def _tensions(contacts: Extent, negative: Records, period: float) -> NDArray[np.float64]:
    """Return intervals of tension on contacts: index, middle and half-width in the coordinate t."""
    middle, reach = 0.5 * (negative["start"] + negative["end"]), 0.5 * (negative["end"] - negative["start"])
    return np.stack([negative["segment"], middle, reach], axis=1)


def _are_certain(tensions: Records, tail: Array, residual: float, load: float) -> Flags:
    """Return which tensions, over the largest pressure of their contact, are larger than its last coefficients."""
    return np.asarray(tensions["relative"] < -np.maximum(tail, FIELD_ROUNDING)[tensions["segment"]])


CONTACTS = Kind(
    dual=False,
    right_sign=1.0,
    k_0_of_curvature=-0.75,  # of a gap in a parabola of tension
    strength_factor=1.0,
    residual_power=1.5,
    residual_strength=4 * np.pi / 3,
    rounding_grows=True,
    close=_close,
    factor=lambda period: -2.0,
    invert_punches=_invert_punches,
    plane_of=lambda total, multiplier, period: multiplier,
    height_of_residual=np.ones_like,
    rounded_width=lambda period, half_width: period,
    share=lambda count: 1.0,
    new_outside=NEW_CONTACT_WIDTH,
    new_within=np.sqrt(2.0),
    integral_factor=lambda period: -2.0,
    constant=lambda load, approach, maximum: -approach,
    contacts_of=lambda extent, period: extent,
    at_contacts=lambda values: values,
    limit_outside=lambda load, height, tension: height,
    height_of_negative=lambda width: np.pi * width,  # a crack of half-width b under the tension p opens by 2 pi b p
    overlaps_and_tensions=lambda minima, negative: (minima, negative),
    tensions=_tensions,
    are_certain=_are_certain,
    scale_of_residual=lambda load, approach, period: approach,
    imbalance=_imbalance,
    largest_indentation=lambda approach, series: approach,
)
