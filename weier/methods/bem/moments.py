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
from weier.methods.bem.polynomials import expansion, slopes

Slopes = tuple[float, float, float, float]  # K' to K'''', in a tuple, which takes no memory from the heap
Moments = tuple[float, float, float, float]  # zeroth to third, the same

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
    contacts: Contacts, first: int, touching: Flags, change: Array, faster: Array, cotangent: Array, period: float
) -> Effects:
    """Effects on the contacts from `first` on, after these changes of force and share; `cotangents` between them."""
    n = touching.size
    force, share = _all_moments(contacts, first, touching, change, faster)
    lift, lift_rate, tilt, bend = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    mixed_size, energy_size = np.zeros(n), np.zeros(n)
    mixed = energy = 0.0
    own = _image_kernel(period)
    for i in range(n):
        f, g = _row(force, i), _row(share, i)
        lift[i] += _lift(f, own)
        lift_rate[i] += _lift(g, own)
        tilt[i] += _tilt(f, own)
        bend[i] += _bend(f, own)
        mixed += _energy(f, g, own)
        energy += _energy(g, g, own)
        for j in range(i):
            other_f, other_g = _row(force, j), _row(share, j)
            there = _kernel(cotangent[i, j], period)
            here = _opposite(there)
            lift[i] += _lift(other_f, there)
            lift[j] += _lift(f, here)
            lift_rate[i] += _lift(other_g, there)
            lift_rate[j] += _lift(g, here)
            tilt[i] += _tilt(other_f, there)
            tilt[j] += _tilt(f, here)
            bend[i] += _bend(other_f, there)
            bend[j] += _bend(f, here)
            mixed += _energy(f, other_g, there) + _energy(other_f, g, here)
            energy += 2 * _energy(g, other_g, there)
            mixed_size[i] += _size(f, other_g, there) + _size(other_f, g, here)
            energy_size[i] += 2 * _size(g, other_g, there)
    return Effects(lift, lift_rate, tilt, bend, mixed, energy, mixed_size, energy_size)


@kernel
def displacement_by_moments(
    contacts: Contacts, first: int, touching: Flags, change: Array, cotangent: Array, period: float
) -> Array:
    """Displacement of each contact by the first to third moments of others, the `lift` of `Effects`."""
    n = touching.size
    lift = np.zeros(n)
    force, _ = _all_moments(contacts, first, touching, change, np.zeros(n))
    own = _image_kernel(period)
    for i in range(n):
        f = _row(force, i)
        lift[i] += _lift(f, own)
        for j in range(i):
            there = _kernel(cotangent[i, j], period)
            lift[i] += _lift(_row(force, j), there)
            lift[j] += _lift(f, _opposite(there))
    return lift


@kernel
def cotangents(contacts: Contacts, first: int, last: int, period: float) -> Array:
    """cot(pi x/L) at the distances x of contacts from those before them, shape (contacts, contacts)."""
    angle = np.pi / period * contacts.position[first:last]
    sine, cosine = np.sin(angle), np.cos(angle)
    cotangent = np.zeros((last - first, last - first))
    for i in range(last - first):
        for j in range(i):
            apart = sine[i] * cosine[j] - cosine[i] * sine[j]
            cotangent[i, j] = (cosine[i] * cosine[j] + sine[i] * sine[j]) / apart
    return cotangent


@kernel
def _row(moments: Array, i: int) -> Moments:
    return moments[i, 0], moments[i, 1], moments[i, 2], moments[i, 3]


@kernel
def _kernel(cotangent: float, period: float) -> Slopes:
    """K', K'', K''', K'''' at a distance."""
    a = np.pi / period
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
def _lift(moment: Moments, slopes: Slopes) -> float:
    """Displacement by all moments but the force."""
    return slopes[1] / 2 * moment[2] - slopes[0] * moment[1] - slopes[2] / 6 * moment[3]


@kernel
def _tilt(moment: Moments, slopes: Slopes) -> float:
    """Slope of the displacement by all moments."""
    even = slopes[1] * moment[1] + slopes[3] / 6 * moment[3]
    return slopes[0] * moment[0] + slopes[2] / 2 * moment[2] - even


@kernel
def _bend(moment: Moments, slopes: Slopes) -> float:
    """Second derivative of the displacement by all moments but the third."""
    return slopes[1] * moment[0] - slopes[2] * moment[1] + slopes[3] / 2 * moment[2]


@kernel
def _energy(one: Moments, other: Moments, slopes: Slopes) -> float:
    """Energy of first to third moments at x_i with those at x_j, up to K''''."""
    odd = slopes[2] / 2 * (one[1] * other[2] - one[2] * other[1])
    last = one[2] * other[2] / 4 - (one[1] * other[3] + one[3] * other[1]) / 6
    return odd - slopes[1] * one[1] * other[1] + slopes[3] * last


@kernel
def _size(one: Moments, other: Moments, slopes: Slopes) -> float:
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
            _enter_moments(contacts, first + i, change[i], faster[i], force[i], share[i])
    return force, share


@kernel
def _enter_moments(
    contacts: Contacts, at: int, change: float, faster: float, force_moments: Array, share_moments: Array
) -> None:
    """Enter first to third moments of force and share that the continuum has more than the grid, about `position`."""
    middle, reach = contacts.scale[at] * contacts.centre[at], contacts.scale[at] * contacts.half_width[at]
    height = expansion(contacts.height[at], contacts.centre[at], contacts.half_width[at])
    others = expansion(contacts.rate[at], contacts.centre[at], contacts.half_width[at])
    force = _about_middle(contacts.force[at] + change, 1.0, height, middle, reach)
    share = _about_middle(contacts.share[at] + faster, -1.0, others, middle, reach)
    for k in range(3):
        force_moments[k + 1] = force[k] - contacts.grid_force_moments[at, k]
        share_moments[k + 1] = share[k] - contacts.grid_share_moments[at, k]


@kernel
def _about_middle(
    total: float, sign: float, coefficient: Array, middle: float, reach: float
) -> tuple[float, float, float]:
    """Moments of a pressure that carries `total` and presses flat `sign` times what has these coefficients of T_k."""
    height = (0.0, sign * coefficient[1], sign * coefficient[2], sign * coefficient[3])
    one, two = reach * height[1] / 4, reach**2 * (total / 2 + height[2] / 4)
    three = reach**3 * 3 * (height[1] + height[3]) / 16
    return (
        total * middle + one,
        total * middle**2 + 2 * middle * one + two,
        total * middle**3 + 3 * middle**2 * one + 3 * middle * two + three,
    )


@kernel
def add_grid_moments(force: float, x: float, spacing: float, moments: Array) -> None:
    """Add the first to third moments of a nodal force, at x from where they are taken."""
    spread = HATS * spacing**2
    moments[0] += force * x
    moments[1] += force * (x**2 + spread)
    moments[2] += force * (x**3 + 3 * x * spread)


@kernel
def yielding(contacts: Contacts, at: int, effects: Effects, which: int, share: float, period: float) -> Array:
    """What tilt and curvature of the displacement by others add to the resistance of one contact, as three terms.

    A curvature u'' makes it narrower. A slope u' moves it by -u'/k, to where its own curvature k is
    another, and along the rates of others. Edges that stand alone go on with the change of force, by a step at most.
    """
    if contacts.kind[at] == WIDE:
        gone = contacts.edge_yield[at] * contacts.change[at]
        return np.array([-min(max(gone, -contacts.edge_drop[at]), contacts.edge_drop[at]), 0.0, 0.0])
    if contacts.half_width[at] == 0:
        return np.zeros(3)
    scale, centre, half_width = contacts.scale[at], contacts.centre[at], contacts.half_width[at]
    _, second, third = slopes(contacts.height[at], centre)
    curvature, twist = -second / scale**2, third / scale**3
    stiffness = 2 * force_per_half_width(contacts.height[at], centre, half_width) / half_width / scale**2
    if not (stiffness > 0 and curvature > 0):
        return np.zeros(3)
    along = -effects.tilt[which] / curvature
    others = slopes(contacts.rate[at], centre)[0] / scale
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
