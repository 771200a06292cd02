"""Contacts that bear on each other: their forces and rates in the continuum, and contacts born between nodes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import kernel
from weier.methods.bem.grid_contacts import BIRTH, NARROW, WIDE, Contacts
from weier.methods.bem.moments import Effects, cotangents, displacement_by_moments, effects_of_moments, yielding
from weier.methods.bem.narrow_contacts import contact_energy, cross_energy, plane_height, punch_compliance
from weier.methods.bem.polynomials import expansion, slopes, value

MAX_TOGETHER = 40  # contacts whose forces are found together: farther ones hardly feel a shift of force
MAX_STEPS = 40  # of Newton's; 4 to 6 are usual, 15 where a contact lets go
MAX_ROUNDS = 8  # of touching and letting go
CLOSE = 1e-12  # of the load: the last step, and the force of a contact that lets go
ROUNDING = 1e-14  # of the heights, below which no step says anything
MAX_LOST = 0.99  # of the shares: reciprocity with the grid tells nothing when all its contacts let go
MAX_LOSS = 0.9  # of its force that a contact may lose in one step


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
    flat punches as its diagonal the matrix is one of energies, and positive. For a punch wider than half the period
    this rule is too coarse: what it does to others is taken from its own solution.
    """
    n = last - first
    matrix, sine, cosine = np.zeros((n, n)), np.empty((n, 2)), np.empty((n, 2))
    for i in range(n):
        for side in range(2):
            x = contacts.position[first + i] + np.sqrt(0.5) * (2 * side - 1) * contacts.reach[first + i]
            sine[i, side], cosine[i, side] = np.sin(np.pi * x / period), np.cos(np.pi * x / period)
    for i in range(n):
        for j in range(i):
            if max(contacts.reach[first + i], contacts.reach[first + j]) > period / 4:
                matrix[i, j] = matrix[j, i] = _beside_a_wide_punch(contacts, first + i, first + j, period)
                continue
            product = 1.0  # of 2 sin(pi x/L) at all four distances: a logarithm takes as long as ten of these
            for side in range(2):
                for other in range(2):
                    apart = sine[i, side] * cosine[j, other] - cosine[i, side] * sine[j, other]
                    product *= 2 * apart
            matrix[i, j] = matrix[j, i] = -np.log(abs(product)) / 2
    return matrix


@kernel
def _beside_a_wide_punch(contacts: Contacts, one: int, other: int, period: float) -> float:
    """Displacement of the narrower contact per force on the wider, a flat punch of half-width a.

    It is -2 ln sin(pi a/L) - 2 arcosh[sin(pi x/L)/sin(pi a/L)] at the distance x from its middle.
    """
    wide, narrow = (one, other) if contacts.reach[one] > contacts.reach[other] else (other, one)
    edge = np.sin(np.pi * contacts.reach[wide] / period)
    displacement = -2 * np.log(edge)
    for side in (-1, 1):
        x = contacts.position[narrow] + side * np.sqrt(0.5) * contacts.reach[narrow] - contacts.position[wide]
        displacement -= np.arccosh(max(abs(np.sin(np.pi * x / period)) / edge, 1.0))
    return displacement


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
    mutual, cotangent = _mutual(contacts, first, last, period), cotangents(contacts, first, last, period)
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
            contacts, first, plane, lifted, period, mutual, cotangent, touching, change, excess, slope, total
        )
        if not going:
            break
        common = weight = 0.0
        pressed = mutual @ change + displacement_by_moments(contacts, first, touching, change, cotangent, period)
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
    return _sums(contacts, first, plane, rate, lifted, period, mutual, cotangent, touching, change, excess)


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
            beyond = abs(contacts.centre[at]) + contacts.half_width[at] > contacts.limit[at]
            contacts.lost[at] = touching[i] and beyond and contacts.kind[at] == NARROW


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
            contacts.lost[at] = contacts.kind[at] == NARROW
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
    cotangent: Array, touching: Flags, change: Array, excess: Array, slope: Array, total: float,
) -> bool:  # fmt: skip
    """Newton's method for the change of each force that brings all touching contacts to one height."""
    n = change.size
    right = np.zeros(n)
    lift = displacement_by_moments(contacts, first, touching, change, cotangent, period)
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
            bend = -slopes(contacts.height[at], top)[1]
            if above > CLOSE * abs(plane) and bend > 0:
                touching[i] = changed = True
                half_width = np.sqrt(2 * above / bend)
                change[i] = above / (1 + punch_compliance(half_width * contacts.scale[at], period))
                contacts.half_width[at] = 2 * np.sqrt(change[i] / bend)
    return changed


class Weights(NamedTuple):
    """What reciprocity makes of each contact, with the shares of the grid as weights; each of shape (contacts,).

    softer : compliance that each has more than on the grid
    nearer : displacement by the rates of others that each has more, since it is elsewhere
    raised : the same for more force, which does not change how the rates are spread
    closing : rate of the plane towards a crest that the grid has not in contact
    """

    softer: Array
    nearer: Array
    raised: Array
    closing: Array


@kernel
def _sums(
    contacts: Contacts, first: int, plane: float, rate: float, lifted: float, period: float, mutual: Array,
    cotangent: Array, touching: Flags, change: Array, excess: Array,
) -> tuple[float, float]:  # fmt: skip
    """Compliance and resistance of these contacts by reciprocity."""
    n = change.size
    effects = effects_of_moments(contacts, first, touching, change, np.zeros(n), cotangent, period)
    for i in range(n):  # as if others displaced it by so much: the shares are those of an unfinished solution
        effects.lift_rate[i] += contacts.uneven[first + i]
    weights, shape = _weights(contacts, first, rate, period, touching, change)
    faster, slower, lost = _changes_of_shares(contacts, first, period, mutual, touching, weights, effects)
    if np.isnan(lost):  # to be refused
        return np.nan, np.nan
    moved = effects_of_moments(contacts, first, touching, change, faster, cotangent, period)
    pressed, pressed_rate = mutual @ change + effects.lift, mutual @ faster + moved.lift_rate
    yielded = _note(contacts, first, period, touching, faster, pressed, moved)
    if lost > MAX_LOST * period:
        common = np.sum(change[touching] * (excess[touching] - pressed[touching])) / change[touching].sum()
        _note_crests(contacts, first, touching, pressed, pressed_rate, common, -slower)
        return plane - common, -slower
    compliance = (shape + moved.mixed) / period
    resistance = effects.energy / period + yielded
    for i in range(n):
        share, own = contacts.share[first + i], contacts.self_compliance[first + i]
        if touching[i]:
            tilted = effects.lift_rate[i] - weights.closing[i]
            compliance -= (share * (excess[i] - plane) - (weights.raised[i] + tilted) * change[i]) / (period - lost)
            softer, nearer = weights.softer[i] * share + weights.nearer[i], weights.nearer[i]
            resistance += (softer * (share + faster[i]) + nearer * share + tilted * faster[i]) / (period - lost)
        else:
            tilted = effects.lift_rate[i]
            compliance -= (share * (pressed[i] + own * change[i]) - tilted * change[i]) / (period - lost)
            resistance -= share * (pressed_rate[i] + tilted - own * share) / (period - lost)
    _note_crests(contacts, first, touching, pressed, pressed_rate, plane - compliance - lifted, rate + resistance)
    return compliance, resistance


@kernel
def _weights(
    contacts: Contacts, first: int, rate: float, period: float, touching: Flags, change: Array
) -> tuple[Weights, float]:
    """Weights of all that touch, and what their shapes change of the compliance, times the period."""
    n = change.size
    weights = Weights(np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n))
    shape = 0.0
    for i in range(n):
        at = first + i
        share = contacts.share[at]
        if touching[i] and contacts.kind[at] == WIDE:
            weights.softer[i] = contacts.edge_resistance[at] * period / share**2
        elif touching[i]:
            compliance = punch_compliance(contacts.half_width[at] * contacts.scale[at], period)
            others = expansion(contacts.rate[at], contacts.centre[at], contacts.half_width[at])
            contacts.penetration[at] = (contacts.force[at] + change[i]) * compliance
            contacts.closing[at] = share * compliance
            if contacts.kind[at] == NARROW:
                height = expansion(contacts.height[at], contacts.centre[at], contacts.half_width[at])
                mixed, energy = contact_energy(height, others, contacts.force[at], share, compliance)
                weights.nearer[i] = (cross_energy(others, share) - contacts.grid_cross[at]) / share
                weights.raised[i] = others[0] - contacts.grid_cross[at] / share
                more = energy - contacts.grid_energy[at] + contacts.edge_resistance[at] * period
                weights.softer[i] = more / share**2 - 2 * weights.nearer[i] / share
                shape += mixed - contacts.grid_mixed[at] + contacts.edge_compliance[at] * period
            else:
                weights.closing[i] = contacts.closing[at] = rate - others[0]
    return weights, shape


@kernel
def _changes_of_shares(
    contacts: Contacts, first: int, period: float, mutual: Array, touching: Flags, weights: Weights, effects: Effects
) -> tuple[Array, float, float]:
    """How much more of a load each carries, by how much less the plane sinks, and shares lost; NaN if not found."""
    n = touching.size
    matrix = mutual.copy()
    right = np.zeros(n)
    lost = 0.0
    for i in range(n):
        at = first + i
        share = contacts.share[at]
        matrix[i, i] = contacts.self_compliance[at] + weights.softer[i]
        if touching[i]:
            if contacts.kind[at] == BIRTH:
                matrix[i, i] = punch_compliance(contacts.half_width[at] * contacts.scale[at], period)
            right[i] = weights.closing[i] - weights.softer[i] * share - weights.nearer[i] - effects.lift_rate[i]
        else:
            lost += share
    for j in range(n):
        if not touching[j]:  # what it carried on the grid is carried by the others
            right += mutual[:, j] * contacts.share[first + j]
    faster, slower, found = _with_sum(matrix, right, touching, lost)
    for i in range(n):
        if not touching[i]:
            faster[i] = -contacts.share[first + i]
    return faster, slower, lost if found else np.nan


@kernel
def _note(
    contacts: Contacts, first: int, period: float, touching: Flags, faster: Array, pressed: Array, moved: Effects
) -> float:
    """Note what bears on each contact, and return what it adds to the resistance as they yield to it."""
    yielded = 0.0
    for i in range(faster.size):
        at = first + i
        contacts.share_change[at], contacts.tilt[at], contacts.pressed[at] = faster[i], moved.tilt[i], abs(pressed[i])
        contacts.off[at], contacts.rate_off[at] = moved.mixed_size[i] / period, moved.energy_size[i] / period
        if touching[i]:
            terms = yielding(contacts, at, moved, i, contacts.share[at] + faster[i], period)
            yielded += terms.sum()
            contacts.rate_off[at] += np.abs(terms).sum()
    return yielded


@kernel
def _note_crests(
    contacts: Contacts, first: int, touching: Flags, pressed: Array, pressed_rate: Array, plane: float, rate: float
) -> None:
    """Note how far the crests that do not touch stand below the plane."""
    for i in range(touching.size):
        at = first + i
        if contacts.kind[at] != WIDE and not touching[i]:
            top = contacts.centre[at]
            contacts.penetration[at] = value(contacts.height[at], top) - pressed[i] - plane
            contacts.closing[at] = rate - value(contacts.rate[at], top) - pressed_rate[i]
