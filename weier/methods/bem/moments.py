"""What narrow contacts do to each other by the moments of their load that the grid has not (docs/subgrid.md).

Two points act on each other by K = -2 ln|2 sin(pi x/L)|. A pressure near x_j with the moments M_0 to M_3 about it
therefore displaces x_i by M_0 K - M_1 K' + M_2 K''/2 - M_3 K'''/6, where K is taken at x_i - x_j.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import kernel
from weier.methods.bem.grid_contacts import NARROW, WIDE, Contacts
from weier.methods.bem.narrow_contacts import force_per_half_width
from weier.methods.bem.polynomials import derivative, expansion, value

Slopes = tuple[float, float, float, float]  # K' to K'''', in a tuple, which takes no memory from the heap

HATS = 1 / 6  # second moment of the triangle of a nodal pressure, in squares of the nodes' spacing


class Effects(NamedTuple):
    """Effects of moments of force and share that the grid has not; arrays of shape (contacts,).

    lift, lift_rate : displacement of each contact by the first to third moments of others, and its rate
    tilt, bend : slope and curvature of the displacement under each contact, by changes of force too
    mixed, energy : energies of moments of force with those of share, and of share with share
    mixed_size, energy_size : of those but of first moments with each other, signs aside, and of changes of force and
        share with second moments; each pair counts for one of the two
    """

    lift: Array
    lift_rate: Array
    tilt: Array
    bend: Array
    mixed: float
    energy: float
    mixed_size: Array
    energy_size: Array


@kernel
def effects_of_moments(
    contacts: Contacts, first: int, touching: Flags, change: Array, faster: Array, period: float
) -> Effects:
    """Effects on the contacts from `first` on, after these changes of force and share."""
    n = touching.size
    force, share = _all_moments(contacts, first, touching, change, faster)
    lift, lift_rate, tilt, bend = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    mixed_size, energy_size = np.zeros(n), np.zeros(n)
    mixed = energy = 0.0
    own = _image_kernel(period)
    for i in range(n):
        lift[i] += _lift(force[i], own)
        lift_rate[i] += _lift(share[i], own)
        tilt[i] += _tilt(force[i], own)
        bend[i] += _bend(force[i], own)
        mixed += _energy(force[i], share[i], own)
        energy += _energy(share[i], share[i], own)
        for j in range(i):
            there = _kernel(contacts.position[first + i] - contacts.position[first + j], period)
            here = _opposite(there)
            lift[i] += _lift(force[j], there)
            lift[j] += _lift(force[i], here)
            lift_rate[i] += _lift(share[j], there)
            lift_rate[j] += _lift(share[i], here)
            tilt[i] += _tilt(force[j], there)
            tilt[j] += _tilt(force[i], here)
            bend[i] += _bend(force[j], there)
            bend[j] += _bend(force[i], here)
            mixed += _energy(force[i], share[j], there) + _energy(force[j], share[i], here)
            energy += 2 * _energy(share[i], share[j], there)
            mixed_size[i] += _size(force[i], share[j], there) + _size(force[j], share[i], here)
            energy_size[i] += 2 * _size(share[i], share[j], there)
    return Effects(lift, lift_rate, tilt, bend, mixed, energy, mixed_size, energy_size)


@kernel
def displacement_by_moments(contacts: Contacts, first: int, touching: Flags, change: Array, period: float) -> Array:
    """Displacement of each contact by the first to third moments of others, the `lift` of `Effects`."""
    n = touching.size
    lift = np.zeros(n)
    force, _ = _all_moments(contacts, first, touching, change, np.zeros(n))
    own = _image_kernel(period)
    for i in range(n):
        lift[i] += _lift(force[i], own)
        for j in range(i):
            there = _kernel(contacts.position[first + i] - contacts.position[first + j], period)
            lift[i] += _lift(force[j], there)
            lift[j] += _lift(force[i], _opposite(there))
    return lift


@kernel
def _kernel(apart: float, period: float) -> Slopes:
    """K', K'', K''', K'''' at a distance."""
    a = np.pi / period
    cotangent = 1 / np.tan(a * apart)
    bend = 1 + cotangent**2
    return (
        -2 * a * cotangent,
        2 * a**2 * bend,
        -4 * a**3 * bend * cotangent,
        4 * a**4 * bend * (2 * cotangent**2 + bend),
    )


@kernel
def _opposite(slopes: Slopes) -> Slopes:
    """The same at the opposite distance."""
    return -slopes[0], slopes[1], -slopes[2], slopes[3]


@kernel
def _image_kernel(period: float) -> Slopes:
    """The same at 0, of the images of a point in all other periods."""
    a = np.pi / period
    return 0.0, 2 * a**2 / 3, 0.0, 4 * a**4 / 15


@kernel
def _lift(moment: Array, slopes: Slopes) -> float:
    """Displacement by all moments but the force."""
    return slopes[1] / 2 * moment[2] - slopes[0] * moment[1] - slopes[2] / 6 * moment[3]


@kernel
def _tilt(moment: Array, slopes: Slopes) -> float:
    """Slope of the displacement by all moments."""
    even = slopes[1] * moment[1] + slopes[3] / 6 * moment[3]
    return slopes[0] * moment[0] + slopes[2] / 2 * moment[2] - even


@kernel
def _bend(moment: Array, slopes: Slopes) -> float:
    """Second derivative of the displacement by all moments but the third."""
    return slopes[1] * moment[0] - slopes[2] * moment[1] + slopes[3] / 2 * moment[2]


@kernel
def _energy(one: Array, other: Array, slopes: Slopes) -> float:
    """Energy of first to third moments at x_i with those at x_j, up to K''''."""
    odd = slopes[2] / 2 * (one[1] * other[2] - one[2] * other[1])
    last = one[2] * other[2] / 4 - (one[1] * other[3] + one[3] * other[1]) / 6
    return odd - slopes[1] * one[1] * other[1] + slopes[3] * last


@kernel
def _size(one: Array, other: Array, slopes: Slopes) -> float:
    """Size of that energy but for first moments, and of changes of force or share with second moments."""
    odd = abs(slopes[2] / 2) * (abs(one[1] * other[2]) + abs(one[2] * other[1]))
    even = abs(slopes[1] / 2) * (abs(one[0] * other[2]) + abs(one[2] * other[0]))
    return odd + even + abs(slopes[3] / 4 * one[2] * other[2])


@kernel
def _all_moments(
    contacts: Contacts, first: int, touching: Flags, change: Array, faster: Array
) -> tuple[Array, Array]:
    """Change of each force with its moments that the grid has not, and of each share; shape (contacts, 4)."""
    n = touching.size
    force, share = np.zeros((n, 4)), np.zeros((n, 4))
    for i in range(n):
        force[i, 0], share[i, 0] = change[i], faster[i]
        if touching[i] and contacts.kind[first + i] == NARROW:
            force[i, 1:], share[i, 1:] = _moments(contacts, first + i, change[i], faster[i])
    return force, share


@kernel
def _moments(contacts: Contacts, at: int, change: float, faster: float) -> tuple[Array, Array]:
    """First to third moments of force and share that the continuum has more than the grid, about `position`."""
    middle, reach = contacts.scale[at] * contacts.centre[at], contacts.scale[at] * contacts.half_width[at]
    height = expansion(contacts.height[at], contacts.centre[at], contacts.half_width[at])
    others = expansion(contacts.rate[at], contacts.centre[at], contacts.half_width[at])
    force = _about_middle(contacts.force[at] + change, height, middle, reach)
    share = _about_middle(contacts.share[at] + faster, -others, middle, reach)
    return force - contacts.grid_force_moments[at], share - contacts.grid_share_moments[at]


@kernel
def _about_middle(total: float, height: Array, middle: float, reach: float) -> Array:
    """Moments of a pressure that carries `total`, and presses flat what has these coefficients of T_k."""
    one, two = reach * height[1] / 4, reach**2 * (total / 2 + height[2] / 4)
    three = reach**3 * 3 * (height[1] + height[3]) / 16
    return np.array(
        [
            total * middle + one,
            total * middle**2 + 2 * middle * one + two,
            total * middle**3 + 3 * middle**2 * one + 3 * middle * two + three,
        ]
    )


@kernel
def grid_moments(x: float, spacing: float) -> Array:
    """First to third moments of a nodal pressure without its size, at x from where they are taken."""
    spread = HATS * spacing**2
    return np.array([x, x**2 + spread, x**3 + 3 * x * spread])


@kernel
def yielding(contacts: Contacts, at: int, effects: Effects, which: int, share: float, period: float) -> Array:
    """What tilt and curvature of the displacement by others add to the resistance of one contact, as three terms.

    A curvature u'' makes it narrower. A slope u' moves it by -u'/k, to where its own curvature k is
    another, and along the rates of others.
    """
    if contacts.kind[at] == WIDE or contacts.half_width[at] == 0:
        return np.zeros(3)
    scale, centre, half_width = contacts.scale[at], contacts.centre[at], contacts.half_width[at]
    second = derivative(derivative(contacts.height[at]))
    curvature, twist = -value(second, centre) / scale**2, value(derivative(second), centre) / scale**3
    stiffness = 2 * force_per_half_width(contacts.height[at], centre, half_width) / half_width / scale**2
    if not (stiffness > 0 and curvature > 0):
        return np.zeros(3)
    along = -effects.tilt[which] / curvature
    others = value(derivative(contacts.rate[at]), centre) / scale
    return (
        np.array(
            [
                share**2 * effects.bend[which] / stiffness,
                -(share**2) * twist * along / curvature,
                2 * share * others * along,
            ]
        )
        / period
    )
