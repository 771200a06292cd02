"""Gaps as segments: cracks with given edges in the tension of full contact (docs/patches.md, "Given edges").

At the zeros of U_K, f_i = r w_i omega_i with the gap sqrt(1-t^2) omega and the weights w_i of Gauss quadrature. With
C the sum over all nodes of -1/(2 L^2 sin^2(pi (x_i - x_j)/L)), positive definite,

    C f = the tension of full contact in all gaps,   d = sum f/L.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Records
from weier.kernels.jit import kernel
from weier.methods.patches.kind import FIELD_ROUNDING, NEW_CONTACT_WIDTH, Kind
from weier.methods.patches.surface import CosineSeries, Extent, Sides, intervals_between, total_height

# of the self-influence: shift of theta_i = pi (i + 1)/(K + 1), sign of X(i + j + shift), and power of n in the sum
RULE = 2, -1.0, 1


def own_kernel(sine: Array) -> Array:
    """Return the kernel that a sum over all nodes contains, 1/(4 sin^2 theta)."""
    return 0.25 / sine**2


@kernel
def gap_node(r: float, sine: float, period: float) -> tuple[float, float]:
    """Return the factor of a node in the self-influence, and its diagonal."""
    left = period / (np.pi * r * sine)
    return left, 1 / 3 - (0.5 * left / sine) ** 2


@kernel
def gap_wave(angle: float) -> float:
    """Return sin(k theta) at a node, from k times its angle."""
    return np.sin(angle)


@kernel
def gap_degree(n: int, r: float, period: float) -> float:
    """Return b_n over the sum of sin(n theta) f L/(pi r sin(theta))."""
    return -2 * n / (r * period)


def _close(force: Array, even: Array, load: float, period: float) -> tuple[Array, float]:
    """Return the forces unchanged, since gaps carry no load constraint, and the mean gap."""
    return force, float(force.sum()) / period


def _largest_indentation(approach: float, series: CosineSeries) -> float:
    """Return the compliance sum g_n - d, which is larger than the indentation."""
    return total_height(series, True) + approach


def _at_contacts(values: Sides) -> Sides:
    """Return values at the edges of contacts; contact j follows gap j."""
    return np.stack([values[:, 1], np.roll(values[:, 0], -1)], axis=1)


def _tensions(contacts: Extent, minima: Records, period: float) -> NDArray[np.float64]:
    """Return intervals of tension between gaps, each approximated by a parabola."""
    origin, centre, r = (values[minima["interval"]] for values in contacts)
    middle = (minima["position"] - (origin + centre)) / r
    # Between adjacent crests the curvature by differences may vanish: the floor keeps the width finite.
    reach = np.sqrt(-2 * minima["value"] / np.maximum(minima["curvature"], -minima["value"] / period**2)) / r
    return np.stack([minima["interval"], middle, reach], axis=1)


def _are_certain(tensions: Records, tail: Array, residual: float, load: float) -> Flags:
    """Return which minima of the pressure are below minus the residual, a pressure as well."""
    return np.asarray((tensions["value"] < -max(residual, FIELD_ROUNDING * load)) & (tensions["curvature"] > 0))


GAPS = Kind(
    dual=True,
    right_sign=-1.0,  # the slope is negative where a gap closes
    k_0_of_curvature=0.25,  # of a contact between gaps
    strength_factor=0.5 / np.pi,  # strength of the pressure beyond an edge over that of the slope of the gap
    residual_power=0.5,
    residual_strength=0.5 / np.pi,
    rounding_grows=False,
    close=_close,
    factor=lambda period: -0.5 / period**2,
    invert_punches=lambda half_width, middle, period: None,
    plane_of=lambda total, multiplier, period: total / period,
    height_of_residual=lambda half_width: 2 * half_width,  # a pressure displaces by its product with the width
    rounded_width=lambda period, half_width: 2 * float(half_width.max()),
    share=lambda count: min(1.0, 5 / count),  # The bound is a sum over all gaps.
    new_outside=np.sqrt(2.0),
    new_within=NEW_CONTACT_WIDTH,
    integral_factor=lambda period: 0.5 / (np.pi * period),
    constant=lambda load, approach, maximum: load - maximum,
    contacts_of=intervals_between,
    at_contacts=_at_contacts,
    limit_outside=lambda load, height, tension: tension * load,
    height_of_negative=np.ones_like,
    overlaps_and_tensions=lambda minima, negative: (negative, minima),
    tensions=_tensions,
    are_certain=_are_certain,
    scale_of_residual=lambda load, approach, period: load * period,
    imbalance=lambda integral, load, period: (0.0, float(np.abs(integral).sum())),
    largest_indentation=_largest_indentation,
)
