"""Contacts that bear on each other: their forces and rates in the continuum, and contacts born between nodes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.narrow_contacts import contact_energy, cross_energy, plane_height, punch_compliance
from weier.methods.bem.polynomials import derivative, expansion, value

WIDE, NARROW, BIRTH = 0, 1, 2
MAX_TOGETHER = 40  # contacts whose forces are found together: farther ones hardly feel a shift of force
MAX_STEPS = 40  # of Newton's; 4 to 6 are usual, 15 where a contact lets go
MAX_ROUNDS = 8  # of touching and letting go
CLOSE = 1e-12  # of the load: the last step, and the force of a contact that lets go
ROUNDING = 1e-14  # of the heights, below which no step says anything
MAX_LOST = 0.99  # of the shares: reciprocity with the grid tells nothing when all its contacts let go
MAX_LOSS = 0.9  # of its force that a contact may lose in one step


class Contacts(NamedTuple):
    """Contacts on the grid, and crests that may touch between nodes, by position; each of shape (contacts,).

    kind : WIDE, NARROW or BIRTH
    position, reach : of the centre, and half width, in lambda_0
    force, share : on the grid, per period, and of it per mean pressure
    self_compliance : displacement per force of its own on the grid, in g_0/p_0* per lambda_0
    edge_compliance, edge_resistance : what its edges add, if they stand alone
    joined : whether the gap after it is closed in the continuum
    left, right : edges, in lambda_0; found by `redistribute` for those with a polynomial
    touching, change : whether it touches in the continuum, and with how much more force; found by `redistribute`
    origin : of the polynomials, in lambda_0
    scale : length of one s of the polynomials, in lambda_0
    centre, half_width : in s; where the search for the edges begins
    height, rate : polynomials of the surface as this contact sees it and of A q of the others, (contacts, TERMS)
    grid_mixed, grid_energy : energies of `contact_energy` on the grid
    grid_cross : of the rates of others alone, with this contact's share
    grid_force_moment, grid_share_moment : of force and share on the grid, about `position`, in lambda_0
    height_rest, rate_rest : what the polynomials leave of two terms beyond them, shape (contacts, 2, terms + 2)
    pressed : displacement of it by what others carry more than on the grid, or elsewhere; found by `redistribute`
    share_change, tilt : of each share, and of the surface by `Dipoles`; found by `redistribute`
    penetration, closing : of each crest that is narrow or new, by how much it stands above the plane that it does not
        touch, in g_0, and the rate of that per mean pressure; found by `redistribute`
    """

    kind: Indices
    position: Array
    reach: Array
    force: Array
    share: Array
    self_compliance: Array
    edge_compliance: Array
    edge_resistance: Array
    joined: Flags
    left: Array
    right: Array
    touching: Flags
    change: Array
    origin: Array
    scale: Array
    centre: Array
    half_width: Array
    height: Array
    rate: Array
    grid_mixed: Array
    grid_energy: Array
    grid_cross: Array
    grid_force_moment: Array
    grid_share_moment: Array
    height_rest: Array
    rate_rest: Array
    share_change: Array
    tilt: Array
    pressed: Array
    penetration: Array
    closing: Array


class Dipoles(NamedTuple):
    """Effects of first moments of force and share that the grid has not.

    lift, lift_rate : displacement of each contact by the moments of others, and its rate, shape (contacts,)
    tilt : of the surface under each contact, by them and by its own images, shape (contacts,)
    mixed, energy : energies of moments of force with those of share, and of share with share
    """

    lift: Array
    lift_rate: Array
    tilt: Array
    mixed: float
    energy: float


@kernel
def make_contacts(contacts: int, terms: int) -> Contacts:
    """Room for so many."""
    return Contacts(
        np.zeros(contacts, np.int64), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts),
        np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts),
        np.zeros(contacts, np.bool_), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts, np.bool_),
        np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts),
        np.zeros((contacts, terms)), np.zeros((contacts, terms)), np.zeros(contacts), np.zeros(contacts),
        np.zeros(contacts), np.zeros(contacts), np.zeros(contacts), np.zeros((contacts, 2, terms + 2)),
        np.zeros((contacts, 2, terms + 2)), np.zeros(contacts), np.zeros(contacts), np.zeros(contacts),
        np.zeros(contacts), np.zeros(contacts),
    )  # fmt: skip


@kernel
def redistribute(
    contacts: Contacts, used: int, plane: float, rate: float, lifted: float, period: float
) -> tuple[float, float]:
    """What contacts add to compliance and resistance, or NaN; `lifted` is what gaps add to the compliance."""
    compliance = resistance = 0.0
    first = 0
    while first < used:
        last = min(first + MAX_TOGETHER, used)
        if used - last < MAX_TOGETHER // 2:
            last = used
        higher, faster = _together(contacts, first, last, plane, rate, lifted, period)
        compliance += higher
        resistance += faster
        first = last
    return compliance, resistance


@kernel
def _mutual(contacts: Contacts, first: int, last: int, period: float) -> Array:
    """Displacement of one contact per force on another; their own is left 0.

    Each force stands half on either node of the two-point rule of Gauss and Chebyshev, so that with the compliance of
    flat punches as its diagonal the matrix is one of energies, and positive.
    """
    matrix = np.zeros((last - first, last - first))
    for i in range(last - first):
        for j in range(i):
            for side in (-1, 1):
                for other in (-1, 1):
                    apart = contacts.position[first + i] - contacts.position[first + j]
                    apart += np.sqrt(0.5) * (side * contacts.reach[first + i] - other * contacts.reach[first + j])
                    matrix[i, j] -= np.log(2 * abs(np.sin(np.pi * apart / period))) / 2
            matrix[j, i] = matrix[i, j]
    return matrix


@kernel
def solve_positive(matrix: Array, right: Array) -> bool:
    """Solve with a symmetric positive matrix, overwritten, `right`, shape (n, k), in place; False if it is not."""
    n = right.shape[0]
    for i in range(n):
        for j in range(i + 1):
            rest = matrix[i, j]
            for k in range(j):
                rest -= matrix[i, k] * matrix[j, k]
            if i > j:
                matrix[i, j] = rest / matrix[j, j]
            elif rest > 0:
                matrix[i, i] = np.sqrt(rest)
            else:
                return False
    for column in range(right.shape[1]):
        for i in range(n):
            for k in range(i):
                right[i, column] -= matrix[i, k] * right[k, column]
            right[i, column] /= matrix[i, i]
        for i in range(n - 1, -1, -1):
            for k in range(i + 1, n):
                right[i, column] -= matrix[k, i] * right[k, column]
            right[i, column] /= matrix[i, i]
    return True


@kernel
def _with_sum(matrix: Array, right: Array, touching: Flags, total: float) -> tuple[Array, float, bool]:
    """Solve matrix x + y = right on those touching, with the sum of x given: x, y, and whether it went well."""
    which = np.flatnonzero(touching)
    n = which.size
    part = np.empty((n, n))
    columns = np.ones((n, 2))
    for i in range(n):
        columns[i, 0] = right[which[i]]
        for j in range(n):
            part[i, j] = matrix[which[i], which[j]]
    found = solve_positive(part, columns)
    common = (columns[:, 0].sum() - total) / columns[:, 1].sum()
    x = np.zeros(right.size)
    for i in range(n):
        x[which[i]] = columns[i, 0] - common * columns[i, 1]
    return x, common, found


@kernel
def _together(
    contacts: Contacts, first: int, last: int, plane: float, rate: float, lifted: float, period: float
) -> tuple[float, float]:
    """`redistribute` for the contacts from `first` to before `last`."""
    n = last - first
    mutual = _mutual(contacts, first, last, period)
    change = np.zeros(n)  # of each force
    excess = np.zeros(n)  # height of the plane that each asks for, besides what forces elsewhere do
    slope = np.zeros(n)  # of it with the force
    touching = np.empty(n, np.bool_)
    total = 0.0
    for i in range(n):
        touching[i] = contacts.kind[first + i] != BIRTH
        total += contacts.force[first + i]
    common = plane
    going = True
    for _ in range(MAX_ROUNDS):
        going = _equalise_heights(
            contacts, first, plane, lifted, period, mutual, touching, change, excess, slope, total
        )
        if not going:
            break
        common = weight = 0.0
        pressed = mutual @ change + _dipoles(contacts, first, touching, change, np.zeros(n), period).lift
        for i in range(n):
            if touching[i]:
                own = contacts.self_compliance[first + i] * change[i]
                common += contacts.share[first + i] * (excess[i] - own - pressed[i])
                weight += contacts.share[first + i]
        if weight == 0:  # all contacts of the grid have let go: crests between its nodes carry the load
            for i in range(n):
                if touching[i]:
                    common += change[i] * (excess[i] - pressed[i])
                    weight += change[i]
        common /= weight
        if not _touch_and_let_go(contacts, first, period, common - lifted, pressed, touching, change, total):
            break
    if not going:  # to be refused
        return np.nan, np.nan
    _keep(contacts, first, touching, change)
    return _sums(contacts, first, plane, rate, lifted, period, mutual, touching, change, excess)


@kernel
def _keep(contacts: Contacts, first: int, touching: Flags, change: Array) -> None:
    """Note which contacts touch, with which force, and where those with polynomials end."""
    for i in range(change.size):
        at = first + i
        contacts.touching[at], contacts.change[at] = touching[i], change[i]
        if contacts.kind[at] != WIDE:
            middle = contacts.origin[at] + contacts.centre[at] * contacts.scale[at]
            reach = contacts.half_width[at] * contacts.scale[at]
            contacts.left[at], contacts.right[at] = middle - reach, middle + reach


@kernel
def _heights(
    contacts: Contacts, first: int, plane: float, lifted: float, period: float, touching: Flags,
    change: Array, excess: Array, slope: Array,
) -> bool:  # fmt: skip
    """Height of the plane for each force, `excess`, and its fall with the force, `slope`; False if not found.

    On a wide contact the height falls by nothing but what `mutual` and its own compliance say: `excess` leaves these
    out for all contacts of the grid.
    """
    for i in range(change.size):
        at = first + i
        if not touching[i]:
            continue
        if contacts.kind[at] == WIDE:
            excess[i] = plane - contacts.edge_compliance[at] * period / contacts.share[at]
            slope[i] = contacts.self_compliance[at]
            continue
        height, compliance, centre, half_width = plane_height(
            contacts.height[at], contacts.force[at] + change[i], contacts.centre[at], contacts.half_width[at],
            contacts.scale[at], period,
        )  # fmt: skip
        if not height < np.inf:
            return False
        contacts.centre[at], contacts.half_width[at] = centre, half_width
        slope[i] = compliance
        excess[i] = height
        if contacts.kind[at] == NARROW:
            excess[i] += contacts.self_compliance[at] * change[i]
        else:
            excess[i] += lifted
    return True


@kernel
def _equalise_heights(
    contacts: Contacts, first: int, plane: float, lifted: float, period: float, mutual: Array,
    touching: Flags, change: Array, excess: Array, slope: Array, total: float,
) -> bool:  # fmt: skip
    """Newton's method for the change of each force that brings all touching contacts to one height."""
    n = change.size
    right = np.zeros(n)
    lift = _dipoles(contacts, first, touching, change, np.zeros(n), period).lift
    for _ in range(MAX_STEPS):
        if not _heights(contacts, first, plane, lifted, period, touching, change, excess, slope):
            return False
        matrix = mutual.copy()
        pressed = mutual @ change + lift
        for i in range(n):
            own = contacts.self_compliance[first + i] * change[i]
            right[i] = excess[i] - own - pressed[i]
            matrix[i, i] = slope[i]
        step, _, found = _with_sum(matrix, right, touching, -change.sum())
        if not found:
            return False
        largest, done, gone = 0.0, True, False
        for i in range(n):
            if touching[i]:
                if contacts.kind[first + i] != WIDE:
                    step[i] = max(step[i], -MAX_LOSS * (contacts.force[first + i] + change[i]))
                change[i] += step[i]
                gone |= _has_let_go(contacts, first + i, change[i], total)
                largest = max(largest, abs(step[i]))
                done &= (abs(step[i]) - CLOSE * total) * slope[i] <= ROUNDING * abs(excess[i])
        if done or gone:  # a contact without force is let go before the others are solved for
            return True
        if not largest < np.inf:
            return False
    return False


@kernel
def _has_let_go(contacts: Contacts, at: int, change: float, total: float) -> bool:
    """Whether a contact with a polynomial carries nothing any more."""
    return contacts.kind[at] != WIDE and contacts.force[at] + change <= CLOSE * total


@kernel
def _touch_and_let_go(
    contacts: Contacts, first: int, period: float, plane: float, pressed: Array, touching: Flags,
    change: Array, total: float,
) -> bool:  # fmt: skip
    """Release contacts without force, and let crests touch that stand above the plane; whether anything changed."""
    changed = False
    for i in range(change.size):
        at = first + i
        if contacts.kind[at] == WIDE:
            continue
        if touching[i]:
            if _has_let_go(contacts, at, change[i], total):
                touching[i] = False
                change[i] = -contacts.force[at]
                changed = True
        elif contacts.kind[at] == BIRTH:
            top = contacts.centre[at] if contacts.half_width[at] == 0 else 0.0
            above = value(contacts.height[at], top) - pressed[i] - plane
            bend = -value(derivative(derivative(contacts.height[at])), top)
            if above > CLOSE * abs(plane) and bend > 0:
                touching[i] = changed = True
                half_width = np.sqrt(2 * above / bend)
                change[i] = above / (1 + punch_compliance(half_width * contacts.scale[at], period))
                contacts.half_width[at] = 2 * np.sqrt(change[i] / bend)
    return changed


@kernel
def _sums(
    contacts: Contacts, first: int, plane: float, rate: float, lifted: float, period: float, mutual: Array,
    touching: Flags, change: Array, excess: Array,
) -> tuple[float, float]:  # fmt: skip
    """Compliance and resistance of these contacts by reciprocity, with the shares of the grid as weights."""
    n = change.size
    dipoles = _dipoles(contacts, first, touching, change, np.zeros(n), period)
    softer = np.zeros(n)  # compliance that each has more than on the grid
    nearer = np.zeros(n)  # displacement by the rates of others that each has more, since it is elsewhere
    raised = np.zeros(n)  # the same for more force, which does not change how the rates are spread
    right = np.zeros(n)
    matrix = mutual.copy()
    closing = np.zeros(n)  # rate of the plane towards a crest that the grid has not in contact
    shape = lost = 0.0
    for i in range(n):
        at = first + i
        matrix[i, i] = contacts.self_compliance[at]
        share = contacts.share[at]
        if not touching[i]:
            lost += share
            continue
        if contacts.kind[at] == WIDE:
            softer[i] = contacts.edge_resistance[at] * period / share**2
        else:
            scale, centre, half_width = contacts.scale[at], contacts.centre[at], contacts.half_width[at]
            compliance = punch_compliance(half_width * scale, period)
            contacts.penetration[at] = (contacts.force[at] + change[i]) * compliance
            contacts.closing[at] = share * compliance
            others = expansion(contacts.rate[at], centre, half_width)
            if contacts.kind[at] == NARROW:
                height = expansion(contacts.height[at], centre, half_width)
                mixed, energy = contact_energy(height, others, contacts.force[at], share, compliance)
                nearer[i] = (cross_energy(others, share) - contacts.grid_cross[at]) / share
                raised[i] = others[0] - contacts.grid_cross[at] / share
                softer[i] = (energy - contacts.grid_energy[at] + contacts.edge_resistance[at] * period) / share**2
                softer[i] -= 2 * nearer[i] / share
                shape += mixed - contacts.grid_mixed[at] + contacts.edge_compliance[at] * period
            else:
                matrix[i, i] = compliance
                closing[i] = contacts.closing[at] = rate - others[0]
        matrix[i, i] += softer[i]
        right[i] = closing[i] - softer[i] * share - nearer[i] - dipoles.lift_rate[i]
    for j in range(n):
        if not touching[j]:  # what it carried on the grid is carried by the others
            right += mutual[:, j] * contacts.share[first + j]
    faster, slower, found = _with_sum(matrix, right, touching, lost)
    if not found:  # to be refused
        return np.nan, np.nan
    for i in range(n):
        if not touching[i]:
            faster[i] = -contacts.share[first + i]
    moved = _dipoles(contacts, first, touching, change, faster, period)
    pressed, pressed_rate = mutual @ change + dipoles.lift, mutual @ faster + moved.lift_rate
    for i in range(n):
        contacts.share_change[first + i], contacts.tilt[first + i] = faster[i], dipoles.tilt[i]
        contacts.pressed[first + i] = abs(pressed[i])
    compliance, resistance = (shape + dipoles.mixed) / period, dipoles.energy / period
    if lost > MAX_LOST * period:
        carried = change[touching].sum()
        common = np.sum(change[touching] * (excess[touching] - pressed[touching])) / carried
        for i in range(n):
            at = first + i
            if contacts.kind[at] != WIDE and not touching[i]:
                top = value(contacts.height[at], contacts.centre[at])
                contacts.penetration[at] = top - pressed[i] - common
                contacts.closing[at] = -slower - value(contacts.rate[at], contacts.centre[at]) - pressed_rate[i]
        return plane - common, -slower
    for i in range(n):
        at = first + i
        share = contacts.share[at]
        if touching[i]:
            tilted = dipoles.lift_rate[i] - closing[i]
            compliance -= (share * (excess[i] - plane) - (raised[i] + tilted) * change[i]) / (period - lost)
            own = softer[i] * share + nearer[i]
            resistance += (own * (share + faster[i]) + nearer[i] * share + tilted * faster[i]) / (period - lost)
        else:
            own = contacts.self_compliance[at]
            tilted = dipoles.lift_rate[i]
            compliance -= (share * (pressed[i] + own * change[i]) - tilted * change[i]) / (period - lost)
            resistance -= share * (pressed_rate[i] + tilted - own * share) / (period - lost)
    for i in range(n):
        at = first + i
        if contacts.kind[at] != WIDE and not touching[i]:
            top = value(contacts.height[at], contacts.centre[at])
            contacts.penetration[at] = top - pressed[i] - (plane - compliance - lifted)
            contacts.closing[at] = rate + resistance - value(contacts.rate[at], contacts.centre[at]) - pressed_rate[i]
    return compliance, resistance


@kernel
def _moments(contacts: Contacts, at: int, change: float, faster: float) -> tuple[float, float]:
    """First moments of force and share that the continuum has more than the grid, about the middle of the nodes."""
    share, force = contacts.share[at] + faster, contacts.force[at] + change
    if contacts.kind[at] != NARROW:
        return 0.0, 0.0
    scale, centre, half_width = contacts.scale[at], contacts.centre[at], contacts.half_width[at]
    height = expansion(contacts.height[at], centre, half_width)
    others = expansion(contacts.rate[at], centre, half_width)
    return (
        scale * (force * centre + half_width * height[1] / 4) - contacts.grid_force_moment[at],
        scale * (share * centre - half_width * others[1] / 4) - contacts.grid_share_moment[at],
    )


@kernel
def _dipoles(contacts: Contacts, first: int, touching: Flags, change: Array, faster: Array, period: float) -> Dipoles:
    """What it changes that nodes carry the load of narrow contacts off its place, after changes of force and share.

    Two points act on each other by K = -2 ln|2 sin(pi x/L)|, so that a first moment M displaces another contact by
    -M K', and acts on its first moment by -M M' K''; on that of its own images K'' is 2 (pi/L)^2/3.
    """
    n = touching.size
    force, share = np.zeros(n), np.zeros(n)
    lift, lift_rate, tilt = np.zeros(n), np.zeros(n), np.zeros(n)
    mixed = energy = 0.0
    for i in range(n):
        if touching[i]:
            force[i], share[i] = _moments(contacts, first + i, change[i], faster[i])
        tilt[i] -= force[i] * 2 * (np.pi / period) ** 2 / 3
        mixed -= force[i] * share[i] * 2 * (np.pi / period) ** 2 / 3
        energy -= share[i] ** 2 * 2 * (np.pi / period) ** 2 / 3
        for j in range(i):
            apart = np.pi * (contacts.position[first + i] - contacts.position[first + j]) / period
            slope, bend = -2 * np.pi / period / np.tan(apart), 2 * (np.pi / (period * np.sin(apart))) ** 2
            mixed -= (force[i] * share[j] + share[i] * force[j]) * bend
            energy -= 2 * share[i] * share[j] * bend
            tilt[i] -= force[j] * bend
            tilt[j] -= force[i] * bend
            lift[i] -= force[j] * slope
            lift[j] += force[i] * slope
            lift_rate[i] -= share[j] * slope
            lift_rate[j] += share[i] * slope
    return Dipoles(lift, lift_rate, tilt, mixed, energy)
