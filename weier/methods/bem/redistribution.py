"""Forces of contacts in the continuum, with those born between nodes: all bear on each other and on one plane."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import kernel
from weier.methods.bem.contacts import CREST, NARROW, WIDE, GridContacts
from weier.methods.bem.factors import ROUNDING
from weier.methods.bem.grid_solution import Continuum
from weier.methods.bem.interaction import MOMENTS, Interaction, displace, make_interaction, press
from weier.methods.bem.local_fit import expansion, slopes, value
from weier.methods.bem.narrow_contacts import contact_energies, plane_height, punch_compliance

MAX_STEPS = 40  # of Newton's; 4 to 6 are usual, 15 where a contact lets go
MAX_ROUNDS = 8  # of touching and letting go
MAX_GRADIENTS = 400  # steps of conjugate gradients: some 250 of them are needed by 8 000 contacts
GRADIENT_TOLERANCE = 1e-14  # square of the relative error at which they stop
CLOSE = 1e-12  # of the load: the last step, and the force of a contact that lets go
MAX_RELEASED = 0.02  # of the shares, by contacts that let go: reciprocity with a grid that has them tells too little
MAX_LOSS = 0.9  # of its force that a contact may lose in one step


class Redistribution(NamedTuple):
    """What contacts carry in the continuum, each array of shape (contacts,).

    found : whether forces were found that are positive, of contacts within their polynomials
    compliance, resistance : what all this adds
    touching : whether a contact of the grid still touches, or a crest does
    change, share_change : how much more force each has, and of how much more share
    centre, half_width : of contacts with polynomials and of crests, in s
    moments : of the force that each has more, or elsewhere than on the grid, shape (contacts, MOMENTS)
    tilt : slope of the displacement by these
    second, rate_second : sizes of what second moments change of compliance and resistance
    penetration, closing : by how much each that is narrow, or a crest, stands above the plane that it does not touch,
        or would without its force, in g_0, and the rate of that per mean pressure
    displacement : of all nodes, shape (N,), by all this
    """

    found: bool
    compliance: float
    resistance: float
    touching: Flags
    change: Array
    share_change: Array
    centre: Array
    half_width: Array
    moments: Array
    tilt: Array
    second: Array
    rate_second: Array
    penetration: Array
    closing: Array
    displacement: Array


class State(NamedTuple):
    """Where the iteration stands, each of shape (contacts,).

    touching, change, centre, half_width : as in `Redistribution`
    excess : height of the plane that each contact asks for, besides what its own and other changes of force do
    slope : fall of it with its force
    """

    touching: Flags
    change: Array
    centre: Array
    half_width: Array
    excess: Array
    slope: Array


@kernel
def find_forces(contacts: GridContacts, plane: float, continuum: Continuum) -> tuple[bool, State, Interaction]:
    """Find the forces of contacts that are to stand on one plane: whether they were found, and what they displace."""
    period, interaction = continuum.period, make_interaction(contacts.position, continuum)
    n = contacts.kind.size
    state = State(
        contacts.kind != CREST, np.zeros(n), contacts.centre.copy(), contacts.half_width.copy(), np.zeros(n),
        np.ones(n),
    )  # fmt: skip
    for _ in range(MAX_ROUNDS):
        lift = displace(_moments_of_force(contacts, state), interaction)
        found = _equalise_heights(contacts, plane, period, lift, interaction, state)
        if not (found and _touch_and_let_go(contacts, period, lift, interaction, state)):
            break
    for i in range(n):
        if state.touching[i]:  # a wide contact has no law of its own that keeps its force positive
            found &= contacts.force[i] + state.change[i] > 0
            reach = abs(state.centre[i]) + state.half_width[i]
            found &= contacts.kind[i] == WIDE or reach <= contacts.limit[i]
    return found, state, interaction


@kernel
def _heights(contacts: GridContacts, plane: float, period: float, state: State) -> bool:
    """Height of the plane for each force, and its fall with the force; False if not found.

    On a wide contact the height falls by nothing but what other forces and its own compliance say: `excess` leaves
    these out for all contacts of the grid.
    """
    for i in range(state.change.size):
        if state.touching[i] and contacts.kind[i] == WIDE:
            state.excess[i] = plane - contacts.edge_compliance[i] * period / contacts.share[i]
            state.slope[i] = contacts.self_compliance[i]
        elif state.touching[i]:
            height, compliance, centre, half_width = plane_height(
                contacts.height[i], contacts.force[i] + state.change[i], state.centre[i], state.half_width[i],
                contacts.scale[i], period,
            )  # fmt: skip
            if not height < np.inf:
                return False
            state.centre[i], state.half_width[i], state.slope[i] = centre, half_width, compliance
            state.excess[i] = height + contacts.self_compliance[i] * state.change[i]  # which is 0 of a crest
    return True


@kernel
def _equalise_heights(
    contacts: GridContacts, plane: float, period: float, lift: Array, interaction: Interaction, state: State
) -> bool:
    """Newton's method for the change of each force that brings all touching contacts to one height.

    `lift` is their displacement by moments of all that the grid has not, with its images, in the first column.
    """
    n, total = state.change.size, contacts.force.sum()
    for _ in range(MAX_STEPS):
        if not _heights(contacts, plane, period, state):
            return False
        right = _asked_heights(contacts, lift, interaction, state)
        step, _, found = solve_bordered(state.slope, right, state.touching, -state.change.sum(), interaction)
        largest, done, released = 0.0, True, False
        for i in range(n):
            if state.touching[i]:
                if contacts.kind[i] != WIDE:
                    step[i] = max(step[i], -MAX_LOSS * (contacts.force[i] + state.change[i]))
                state.change[i] += step[i]
                released |= _has_let_go(contacts, i, state.change[i], total)
                largest = max(largest, abs(step[i]))
                done &= (abs(step[i]) - CLOSE * total) * state.slope[i] <= ROUNDING * abs(state.excess[i])
        if not largest < np.inf:
            return False
        # A contact without force is let go before the others are solved for. A step that is all rounding ends the
        # search, though gradients need not converge in it.
        if done or released:
            return True
        if not found:
            return False
    return False


@kernel
def _asked_heights(contacts: GridContacts, lift: Array, interaction: Interaction, state: State) -> Array:
    """Height of the plane that each contact asks for, by all that displaces it."""
    heights = press(state.change, interaction)
    for i in range(heights.size):
        own = contacts.self_compliance[i] * state.change[i]
        heights[i] = state.excess[i] - own - heights[i] - lift[i, 0]
    return heights


@kernel
def solve_bordered(
    slope: Array, right: Array, touching: Flags, total: float, interaction: Interaction
) -> tuple[Array, float, bool]:
    """Solve (slope + mutual) x + y = right for those touching, with the sum of x given: x, y, whether it went well.

    Conjugate gradients on changes that sum to 0, preconditioned by the slopes. Where not one step of them can be
    taken, x is infinite.
    """
    n = right.size
    x, direction, stiffness = np.zeros(n), np.zeros(n), np.zeros(n)  # 1/slope of those that touch
    size = 0.0
    for i in range(n):
        if touching[i]:
            if not slope[i] > 0:
                x[:] = np.inf
                return x, 0.0, False
            stiffness[i] = 1 / slope[i]
            size += right[i] ** 2 * stiffness[i]
    weight = stiffness.sum()
    for i in range(n):
        x[i] = total * stiffness[i] / weight
    rest = press(x, interaction)
    for i in range(n):
        rest[i] = right[i] - slope[i] * x[i] - rest[i]
    common = energy = first = 0.0
    for step in range(MAX_GRADIENTS):
        last, common, energy = energy, 0.0, 0.0
        for i in range(n):
            common += rest[i] * stiffness[i] / weight
        for i in range(n):
            energy += (rest[i] - common) ** 2 * stiffness[i]
        first = energy if step == 0 else first
        if energy <= GRADIENT_TOLERANCE * first + ROUNDING**2 * size:
            return x, common, True
        for i in range(n):
            direction[i] = (rest[i] - common) * stiffness[i] + (energy / last * direction[i] if step > 0 else 0.0)
        product = press(direction, interaction)
        curvature = 0.0
        for i in range(n):
            product[i] += slope[i] * direction[i]
            curvature += product[i] * direction[i]
        if not curvature > 0:
            if step == 0:
                x[:] = np.inf
            return x, common, False
        for i in range(n):
            x[i] += energy / curvature * direction[i]
            rest[i] -= energy / curvature * product[i]
    return x, common, energy <= (10 * ROUNDING) ** 2 * size  # thousands of contacts add up their rounding


@kernel
def _has_let_go(contacts: GridContacts, at: int, change: float, total: float) -> bool:
    """Whether a contact with a polynomial carries nothing any more."""
    return contacts.kind[at] != WIDE and contacts.force[at] + change <= CLOSE * total


@kernel
def _touch_and_let_go(
    contacts: GridContacts, period: float, lift: Array, interaction: Interaction, state: State
) -> bool:
    """Release contacts without force, and let crests touch that stand above the plane; whether anything changed."""
    asked, total = _asked_heights(contacts, lift, interaction, state), contacts.force.sum()
    plane = weight = 0.0
    for i in range(state.change.size):
        if state.touching[i]:
            plane += contacts.share[i] * asked[i]
            weight += contacts.share[i]
    plane = plane / weight if weight > 0 else np.nan
    changed = False
    displacement = press(state.change, interaction)
    for i in range(state.change.size):
        if state.touching[i] and _has_let_go(contacts, i, state.change[i], total):
            state.touching[i], changed = False, True
            state.change[i] = -contacts.force[i]
        elif not state.touching[i] and contacts.kind[i] == CREST:
            top = state.centre[i] if state.half_width[i] == 0 else contacts.centre[i]
            above = value(contacts.height[i], top) - displacement[i] - lift[i, 0] - plane
            bend = -slopes(contacts.height[i], top)[1]
            if above > CLOSE * abs(plane) and bend > 0:
                state.touching[i] = changed = True
                half_width = np.sqrt(2 * above / bend)
                state.change[i] = above / (1 + punch_compliance(half_width * contacts.scale[i], period))
                state.centre[i], state.half_width[i] = top, 2 * np.sqrt(state.change[i] / bend)
    return changed


@kernel
def _moments(
    polynomial: Array, total: Array, sign: float, on_grid: Array, contacts: GridContacts, state: State
) -> Array:
    """First to third moments of the pressure that the continuum has more than the grid, shape (contacts, MOMENTS).

    On each contact the pressure carries `total` and, with a sign of 1, displaces the surface by the polynomial but
    for a constant; with one of -1 it takes it off: of shares, that of what the rates of others have bent.
    """
    moments = np.zeros((total.size, MOMENTS))
    for i in range(total.size):
        if state.touching[i] and contacts.kind[i] == NARROW:
            coefficient = expansion(polynomial[i], state.centre[i], state.half_width[i])
            middle = contacts.scale[i] * (state.centre[i] - contacts.centre[i])
            reach = contacts.scale[i] * state.half_width[i]
            first = reach * sign * coefficient[1] / 4  # about its own centre
            second = reach**2 * (total[i] / 2 + sign * coefficient[2] / 4)
            third = reach**3 * sign * 3 / 16 * (coefficient[1] + coefficient[3])
            moments[i, 1] = total[i] * middle + first - on_grid[i, 0]
            moments[i, 2] = total[i] * middle**2 + 2 * middle * first + second - on_grid[i, 1]
            moments[i, 3] = total[i] * middle**3 + 3 * middle * (middle * first + second) + third - on_grid[i, 2]
    return moments


@kernel
def _moments_of_force(contacts: GridContacts, state: State) -> Array:
    """First to third moments of all that the pressure of the continuum has more than that of the grid."""
    return _moments(contacts.height, contacts.force + state.change, 1.0, contacts.force_moments, contacts, state)


class _Weights(NamedTuple):
    """What reciprocity makes of each contact, with the shares of the grid as weights; each of shape (contacts,).

    own : compliance that each has more than on the grid
    others : displacement by the rates of others that each has more, since it is elsewhere
    raised : displacement by these rates for more force, which does not change how the rates are spread
    closing : rate of the plane towards a crest that the grid has not in contact
    """

    own: Array
    others: Array
    raised: Array
    closing: Array


@kernel
def sum_up(
    found: bool, contacts: GridContacts, plane: float, rate: float, period: float, interaction: Interaction,
    state: State,
) -> Redistribution:  # fmt: skip
    """Compliance and resistance by reciprocity with the grid, and what is to be told of each contact."""
    n = state.change.size
    touching, change = state.touching, state.change
    weights, shape = _weigh(contacts, rate, period, state)
    of_share = _moments(contacts.rate, contacts.share, -1.0, contacts.share_moments, contacts, state)
    by_shares = displace(of_share, interaction)
    share_change, released, solved = _changes_of_shares(contacts, period, state, weights, by_shares, interaction)
    of_force = _moments_of_force(contacts, state)
    for i in range(n):
        of_force[i, 0], of_share[i, 0] = change[i], share_change[i]
    moved_shares = displace(of_share, interaction)
    moved = displace(of_force, interaction)  # the last product: its displacement of all nodes is looked at later
    compliance, resistance = shape / period, 0.0
    second, rate_second, closing = np.zeros(n), np.zeros(n), np.zeros(n)
    penetration, tilt = np.zeros(n), np.zeros(n)
    for i in range(n):
        share, own, tilted = contacts.share[i], contacts.self_compliance[i], by_shares[i, 0]
        for k in range(1, MOMENTS):
            compliance += of_force[i, k] * by_shares[i, k] / period
            resistance += of_share[i, k] * by_shares[i, k] / period
        tilt[i] = moved[i, 1]
        force_spread = _spread(of_force[i], contacts.force[i] + change[i])
        share_spread = _spread(of_share[i], share + share_change[i])
        images = 2 / 15 * (np.pi / period) ** 4
        by_share = abs(moved_shares[i, 2]) + images * share_spread
        second[i] = (force_spread * by_share + share_spread * abs(moved[i, 2])) / period
        rate_second[i] = 2 * share_spread * by_share / period
        if touching[i] and contacts.kind[i] != WIDE:  # a contact that is tilted presses elsewhere, and tilts others
            tilts = (state.half_width[i] * contacts.scale[i]) ** 2 * abs(moved_shares[i, 1]) / (4 * period)
            second[i] += tilts * abs(tilt[i])
            rate_second[i] += tilts * abs(moved_shares[i, 1])
            rate_slope = slopes(contacts.rate[i], state.centre[i])[0] / contacts.scale[i] + moved_shares[i, 1]
            bend = slopes(contacts.height[i], state.centre[i])[1] / contacts.scale[i] ** 2
            if bend < 0:  # it moves by slope over curvature, to where the rate of others is another
                resistance += 2 * (share + share_change[i]) * rate_slope * tilt[i] / bend / period
        elif touching[i]:  # its edges move on with the force, by a step at most
            yielded = contacts.edge_yield[i] * change[i]
            yielded = min(max(yielded, -contacts.edge_drop[i]), contacts.edge_drop[i])
            resistance -= yielded
            rate_second[i] += abs(yielded)
        if touching[i]:
            tilted -= weights.closing[i]
            higher = share * (state.excess[i] - plane) - (weights.raised[i] + tilted) * change[i]
            more = weights.own[i] * share + weights.others[i]
            stiffer = -more * (share + share_change[i]) - weights.others[i] * share - tilted * share_change[i]
        else:
            higher = share * (moved[i, 0] + own * change[i]) - tilted * change[i]
            stiffer = share * (moved_shares[i, 0] + tilted - own * share)
        compliance -= higher / (period - released)
        resistance -= stiffer / (period - released)
    for i in range(n):
        if contacts.kind[i] == WIDE:
            continue
        top = contacts.centre[i] if contacts.kind[i] == CREST else state.centre[i]
        if touching[i]:
            compliance_here = punch_compliance(state.half_width[i] * contacts.scale[i], period)
            penetration[i] = (contacts.force[i] + change[i]) * compliance_here
            closing[i] = weights.closing[i] if contacts.kind[i] == CREST else contacts.share[i] * compliance_here
        else:
            penetration[i] = value(contacts.height[i], top) - moved[i, 0] - (plane - compliance)
            closing[i] = rate + resistance - value(contacts.rate[i], top) - moved_shares[i, 0]
    found &= solved and released <= MAX_RELEASED * period
    return Redistribution(
        found, compliance, resistance, touching, change, share_change, state.centre, state.half_width, of_force,
        tilt, second, rate_second, penetration, closing, interaction.displacement,
    )  # fmt: skip


@kernel
def _spread(moments: Array, total: float) -> float:
    """Size of second moments: of the one that was found, and of the first one."""
    return abs(moments[2]) + (moments[1] ** 2 / total if total > 0 else 0.0)


@kernel
def _weigh(contacts: GridContacts, rate: float, period: float, state: State) -> tuple[_Weights, float]:
    """Weights of all that touch, and what their shapes change of the compliance, times the period."""
    n = state.change.size
    weights = _Weights(np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n))
    shape = 0.0
    for i in range(n):
        share = contacts.share[i]
        if state.touching[i] and contacts.kind[i] == WIDE:
            weights.own[i] = contacts.edge_resistance[i] * period / share**2
        elif state.touching[i]:
            compliance = punch_compliance(state.half_width[i] * contacts.scale[i], period)
            others = expansion(contacts.rate[i], state.centre[i], state.half_width[i])
            if contacts.kind[i] == NARROW:
                height = expansion(contacts.height[i], state.centre[i], state.half_width[i])
                mixed, cross = contact_energies(height, others, contacts.force[i], share)
                weights.others[i] = (cross - contacts.grid_cross[i]) / share
                weights.raised[i] = others[0] - contacts.grid_cross[i] / share
                weights.own[i] = compliance - contacts.self_compliance[i] + (others[0] - cross / share) / share
                weights.own[i] += contacts.edge_resistance[i] * period / share**2
                shape += mixed - contacts.grid_mixed[i] + contacts.edge_compliance[i] * period
            else:
                weights.closing[i] = rate - others[0]
    return weights, shape


@kernel
def _changes_of_shares(
    contacts: GridContacts,
    period: float,
    state: State,
    weights: _Weights,
    by_shares: Array,
    interaction: Interaction,
) -> tuple[Array, float, bool]:
    """How much more of a load each carries, shares released, and whether these were found."""
    n = state.change.size
    slope, right, on_released = np.ones(n), np.zeros(n), np.zeros(n)
    released = 0.0
    for i in range(n):
        share = contacts.share[i]
        if not state.touching[i]:
            released += share
            on_released[i] = share
            continue
        slope[i] = contacts.self_compliance[i] + weights.own[i]
        if contacts.kind[i] == CREST:
            slope[i] = punch_compliance(state.half_width[i] * contacts.scale[i], period)
        right[i] = weights.closing[i] - weights.own[i] * share - weights.others[i] - by_shares[i, 0]
    if released > 0:  # what they carried on the grid is carried by the others
        right += press(on_released, interaction)
    share_change, _, found = solve_bordered(slope, right, state.touching, released, interaction)
    for i in range(n):
        share_change[i] -= on_released[i]
    return share_change, released, found
