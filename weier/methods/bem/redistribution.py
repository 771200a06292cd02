"""Forces of contacts in the continuum, with those born between nodes: all bear on each other and on one plane."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Record, Records, record_type
from weier.kernels.jit import kernel
from weier.methods.bem.active_set import dot
from weier.methods.bem.contacts import CREST, NARROW, WIDE, displacement_by_edges, nearest_others
from weier.methods.bem.factors import ROUNDING
from weier.methods.bem.grid_solution import Continuum, GridSolution
from weier.methods.bem.interaction import HATS, MOMENTS, Interaction, displace, make_interaction, press
from weier.methods.bem.local_fit import expansion, slopes, value
from weier.methods.bem.narrow_contacts import contact_energies, move_edges, plane_height
from weier.methods.punches import Inverse, invert_punches, solve_forces
from weier.theory.halfplane import displacement_of_punch

MAX_STEPS = 40  # of Newton's; 4 to 6 are usual, 15 where a contact lets go
MAX_ROUNDS = 8  # of touching and letting go
MAX_GRADIENTS = 400  # steps of conjugate gradients: 5 in a step of Newton's, 12 for the shares
STEP_TOLERANCE = 1e-4  # square of the relative error at which they stop in a step of Newton's, which the next mends
SHARE_TOLERANCE = 1e-14  # and for the shares, which nothing mends
CLOSE = 1e-12  # of the load: the last step, and the force of a contact that lets go
MAX_RELEASED = 0.02  # of the shares, by contacts that let go: reciprocity with a grid that has them tells too little
MAX_LOSS = 0.9  # of its force that a contact may lose in one step
MIN_LEFT = 0.1  # of all shares, that others are taken to have where a crest touches

# A contact in the continuum, or a crest that may be one:
#
# touching : whether a contact of the grid still touches, or a crest does
# force, share : per period, and its rate per mean pressure
# centre, half_width : if it is a crest or has polynomials, in s
# moments : of the force that it has more, or elsewhere than on the grid, shape (MOMENTS,)
# tilt : slope of the displacement by these of all contacts
# second, rate_second : sizes of what second moments change of compliance and resistance
# penetration, closing : by how much one that is narrow, or a crest, stands above the plane that it does not touch, or
#     would without its force, in g_0, and the rate of that per mean pressure if it does not touch
CORRECTED = record_type(
    ("touching", np.bool_, ()),
    ("force share centre half_width tilt second rate_second penetration closing", np.float64, ()),
    ("moments", np.float64, (MOMENTS,)),
)
# What reciprocity makes of a contact, with the shares of the grid as weights:
#
# slope : its compliance in the continuum
# more : displacement that its share makes there more than on the grid, by itself and by `others`
# others : displacement by the rates of others that it has more, since it is elsewhere
# raised : displacement by these rates for more force, which does not change how the rates are spread
# closing : rate of the plane towards a crest that the grid has not in contact
WEIGHTS = record_type(("slope more others raised closing", np.float64, ()))


class Redistribution(NamedTuple):
    """What contacts carry in the continuum.

    found : whether forces were found that are positive, of contacts within their polynomials
    compliance, resistance : what all this adds
    contacts : in the continuum, in the order of those on the grid, shape (contacts,)
    displacement : of all nodes, shape (N,), by all this
    """

    found: bool
    compliance: float
    resistance: float
    contacts: Records
    displacement: Array


class State(NamedTuple):
    """Where the iteration stands, each of shape (contacts,).

    touching, centre, half_width : as in `CORRECTED`
    change : of the force, from that on the grid
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
def redistribute(contacts: Records, solution: GridSolution, continuum: Continuum) -> Redistribution:
    """Find the forces of contacts that are to stand on one plane, and what they change."""
    period, interaction = continuum.period, make_interaction(contacts["position"].copy(), continuum)
    n, centre, half_width = contacts.size, contacts["centre"].copy(), contacts["half_width"].copy()
    state = State(contacts["kind"] != CREST, np.zeros(n), centre, half_width, np.zeros(n), np.ones(n))
    total, by_edges = solution.pressure.mean() * period, _displacements_by_edges(contacts, period)
    for _ in range(MAX_ROUNDS):
        lift = displace(_moments(False, contacts, state), interaction)
        lift[:, 0] += by_edges
        found = _equalise_heights(contacts, solution.plane, total, period, lift, interaction, state)
        if not (found and _touch_and_let_go(contacts, total, period, lift, interaction, state)):
            break
    for i in range(n):
        if state.touching[i]:  # a wide contact has no law of its own that keeps its force positive
            found &= contacts[i].force + state.change[i] > 0
            reach = abs(state.centre[i]) + state.half_width[i]
            found &= contacts[i].kind == WIDE or reach <= contacts[i].limit
    return _correct_by_reciprocity(found, contacts, by_edges, solution, period, interaction, state)


@kernel
def _displacements_by_edges(contacts: Records, period: float) -> Array:
    """How far the lone edges of wide contacts displace crests, more than on the grid.

    What they do to contacts of the grid is in what they add to compliance and resistance.
    """
    displacement = np.zeros(contacts.size)
    for i in range(contacts.size):
        if contacts[i].kind == CREST:
            for j in nearest_others(i, contacts.size):
                if contacts[j].kind == WIDE:
                    displacement[i] += displacement_by_edges(contacts[j], contacts[i].position, period)[0]
    return displacement


@kernel
def _heights(contacts: Records, plane: float, period: float, state: State) -> bool:
    """Height of the plane for each force, and its fall with the force; False if not found.

    On a wide contact the height falls by nothing but what other forces and its own compliance say: `excess` leaves
    these out for all contacts of the grid.
    """
    for i in range(contacts.size):
        contact = contacts[i]
        if state.touching[i] and contact.kind == WIDE:
            state.excess[i] = plane - contact.edge_compliance * period / contact.share
            state.slope[i] = contact.self_compliance
        elif state.touching[i]:
            force = contact.force + state.change[i]
            height, compliance, centre, half_width = plane_height(
                contact.height, force, state.centre[i], state.half_width[i], contact.scale, period
            )
            if not height < np.inf:
                return False
            state.centre[i], state.half_width[i], state.slope[i] = centre, half_width, compliance
            state.excess[i] = height + contact.self_compliance * state.change[i]  # which is 0 of a crest
    return True


@kernel
def _equalise_heights(
    contacts: Records, plane: float, total: float, period: float, lift: Array, interaction: Interaction, state: State
) -> bool:
    """Newton's method for the change of each force that brings all touching contacts to one height.

    `lift` is their displacement by moments of all that the grid has not, with its images, in the first column; the
    forces are `total` in all.
    """
    if not _heights(contacts, plane, period, state):
        return False
    inverse = invert_punches(np.flatnonzero(state.touching), contacts["position"], state.slope, period)
    for _ in range(MAX_STEPS):
        right = _asked_heights(contacts, lift, interaction, state)
        rest = -state.change.sum()
        step, found = solve_bordered(state.slope, right, rest, STEP_TOLERANCE, interaction, inverse)
        largest, done, released = 0.0, True, False
        for i in range(contacts.size):
            if state.touching[i]:
                if contacts[i].kind != WIDE:
                    step[i] = max(step[i], -MAX_LOSS * (contacts[i].force + state.change[i]))
                state.change[i] += step[i]
                released |= _has_let_go(contacts[i], state.change[i], total)
                largest = max(largest, abs(step[i]))
                done &= (abs(step[i]) - CLOSE * total) * state.slope[i] <= ROUNDING * abs(state.excess[i])
        if not largest < np.inf:
            return False
        # A contact without force is let go before the others are solved for. A step that is all rounding ends the
        # search, though gradients need not converge in it.
        if done or released or not found:
            return done or released
        if not _heights(contacts, plane, period, state):
            return False
    return False


@kernel
def _asked_heights(contacts: Records, lift: Array, interaction: Interaction, state: State) -> Array:
    """Height of the plane that each contact asks for, by all that displaces it."""
    heights = press(state.change, interaction)
    for i in range(heights.size):
        own = contacts[i].self_compliance * state.change[i]
        heights[i] = state.excess[i] - own - heights[i] - lift[i, 0]
    return heights


@kernel
def solve_bordered(
    slope: Array, right: Array, total: float, tolerance: float, interaction: Interaction, inverse: Inverse
) -> tuple[Array, bool]:
    """Solve (slope + mutual) x + y = right with the sum of x given: x, and whether it went well.

    Only those change that the inverse is of. Conjugate gradients on changes that sum to 0, preconditioned by about
    the inverse, until the square of the error is so small a part of what it was. Where not one step of them can be
    taken, as where no inverse is known, x is infinite.
    """
    _, member, entry = inverse
    size = np.sum((entry * right[member]) ** 2)  # the energy of such heights, each by itself
    even, direction = solve_forces(inverse, np.ones(right.size)), np.zeros(right.size)  # what raises all alike
    x = total / even.sum() * even
    rest = right - slope * x - press(x, interaction)
    energy, first = np.inf, 0.0
    for step in range(MAX_GRADIENTS):
        rest -= dot(even, rest) / even.sum()
        downhill, last = solve_forces(inverse, rest), energy
        energy = dot(rest, downhill)
        first = energy if step == 0 else first
        if energy <= tolerance * first + ROUNDING**2 * size:
            return x, True
        direction = downhill + energy / last * direction
        product = slope * direction + press(direction, interaction)
        curvature = dot(product, direction)
        if not curvature > 0:
            return x if step > 0 else np.full(x.size, np.inf), False
        x += energy / curvature * direction
        rest -= energy / curvature * product
    return x, bool(energy <= (10 * ROUNDING) ** 2 * size)  # thousands of contacts add up their rounding


@kernel
def _has_let_go(contact: Record, change: float, total: float) -> bool:
    """Whether a contact with a polynomial carries nothing any more."""
    return contact.kind != WIDE and contact.force + change <= CLOSE * total


@kernel
def _touch_and_let_go(
    contacts: Records, total: float, period: float, lift: Array, interaction: Interaction, state: State
) -> bool:
    """Release contacts without force, and let crests touch that stand above the plane; whether anything changed."""
    asked, displacement = _asked_heights(contacts, lift, interaction, state), press(state.change, interaction)
    plane = weight = 0.0
    for i in range(contacts.size):
        if state.touching[i]:
            plane += contacts[i].share * asked[i]
            weight += contacts[i].share
    plane = plane / weight if weight > 0 else np.nan
    changed = False
    for i in range(contacts.size):
        contact = contacts[i]
        if state.touching[i] and _has_let_go(contact, state.change[i], total):
            state.touching[i], changed = False, True
            state.change[i] = -contact.force
        elif not state.touching[i] and contact.kind == CREST:
            top = state.centre[i] if state.half_width[i] == 0 else contact.centre
            above = value(contact.height, top) - displacement[i] - lift[i, 0] - plane
            bend = -slopes(contact.height, top)[1]
            if above > CLOSE * abs(plane) and bend > 0:
                state.touching[i] = changed = True
                half_width = np.sqrt(2 * above / bend)
                state.change[i] = above / (1 + displacement_of_punch(half_width * contact.scale, period))
                state.centre[i], state.half_width[i] = top, 2 * np.sqrt(state.change[i] / bend)
    return changed


@kernel
def _moments(of_rate: bool, contacts: Records, state: State) -> Array:
    """First to third moments of the pressure that the continuum has more than the grid, shape (contacts, MOMENTS).

    On each contact the pressure carries the force and displaces the surface by the polynomial but for a constant. Its
    rate carries the share, and takes off what the rates of others have bent.
    """
    moments = np.zeros((contacts.size, MOMENTS))
    for i in range(contacts.size):
        contact, centre, half_width = contacts[i], state.centre[i], state.half_width[i]
        if state.touching[i] and contact.kind == NARROW:
            if of_rate:
                total, on_grid = contact.share, contact.share_moments
                coefficient = -expansion(contact.rate, centre, half_width)
            else:
                total, on_grid = contact.force + state.change[i], contact.force_moments
                coefficient = expansion(contact.height, centre, half_width)
            middle, reach = contact.scale * (centre - contact.centre), contact.scale * half_width
            first = reach * coefficient[1] / 4  # about its own centre
            second = reach**2 * (total / 2 + coefficient[2] / 4)
            third = reach**3 * 3 / 16 * (coefficient[1] + coefficient[3])
            moments[i, 1] = total * middle + first - on_grid[0]
            moments[i, 2] = total * middle**2 + 2 * middle * first + second - on_grid[1]
            moments[i, 3] = total * middle**3 + 3 * middle * (middle * first + second) + third - on_grid[2]
    return moments


@kernel
def _correct_by_reciprocity(
    found: bool, contacts: Records, by_edges: Array, solution: GridSolution, period: float, interaction: Interaction,
    state: State,
) -> Redistribution:  # fmt: skip
    """Compliance and resistance by reciprocity with the grid, and what is to be told of each contact.

    The height of the plane is the mean of the heights that contacts ask for, weighted by their shares of the grid.
    Contacts displace each other reciprocally: in this mean, the displacements by all changes of force are the work of
    these changes on the displacement by the shares. As that is the same at all contacts and the changes sum to
    nothing, they drop out, and `excess` is what is left of a contact. Only where shares displace the surface
    otherwise in the continuum than on the grid, by `WEIGHTS` and moments, do changes of force do work.
    """
    plane, rate = solution.plane, solution.rate
    weights, compliance = _weigh(contacts, rate, period, state)
    of_force, of_share = _moments(False, contacts, state), _moments(True, contacts, state)
    by_shares = displace(of_share, interaction)
    share_change, released, solved = _changes_of_shares(contacts, weights, by_shares, period, state, interaction)
    for i in range(contacts.size):
        of_force[i, 0], of_share[i, 0] = state.change[i], share_change[i]
    moved_shares = displace(of_share, interaction)
    moved = displace(of_force, interaction)  # the last product: its displacement of all nodes is looked at later
    corrected, resistance = np.zeros(contacts.size, CORRECTED), 0.0
    for i in range(contacts.size):
        contact, each, weight, change = contacts[i], corrected[i], weights[i], state.change[i]
        each.touching, each.centre, each.half_width = state.touching[i], state.centre[i], state.half_width[i]
        each.force, each.share = contact.force + change, contact.share + share_change[i]
        each.tilt, tilted = moved[i, 1], by_shares[i, 0] - weight.closing
        each.moments[0] = change
        for k in range(1, MOMENTS):
            each.moments[k] = of_force[i, k]
            compliance += of_force[i, k] * by_shares[i, k] / period
            resistance += of_share[i, k] * by_shares[i, k] / period
        reach = max(each.half_width * contact.scale, interaction.spacing)
        least = HATS * np.sqrt(reach * interaction.spacing**3)
        force_spread, share_spread = _spread(of_force[i], each.force, least), _spread(of_share[i], each.share, least)
        images = 2 / 15 * (np.pi / period) ** 4
        by_share = abs(moved_shares[i, 2]) + images * share_spread
        each.second = (force_spread * by_share + share_spread * abs(moved[i, 2])) / period
        each.rate_second = 2 * share_spread * by_share / period
        if each.touching and contact.kind != WIDE:  # a contact that is tilted presses elsewhere, and tilts others
            tilts = (each.half_width * contact.scale) ** 2 * abs(moved_shares[i, 1]) / (4 * period)
            each.second += tilts * abs(each.tilt)
            each.rate_second += tilts * abs(moved_shares[i, 1])
            # What displaces it tilts and bends the surface: it moves along, to another rate of others, and widens.
            tilt, bend = each.tilt * contact.scale, moved[i, 2] * contact.scale**2
            along, wider = move_edges(contact.height, -tilt, -bend * each.half_width, each.centre, each.half_width)
            rate_slope = slopes(contact.rate, each.centre)[0] + moved_shares[i, 1] * contact.scale
            resistance += 2 * each.share * (rate_slope * along - each.share * wider / each.half_width) / period
        elif each.touching:  # its edges move on with the force, by a step at most
            yielded = min(max(contact.edge_yield * change, -contact.edge_drop), contact.edge_drop)
            resistance -= yielded
            each.rate_second += abs(yielded)
        if each.touching:
            higher = contact.share * (state.excess[i] - plane) - (weight.raised + tilted) * change
            stiffer = -weight.more * each.share - weight.others * contact.share - tilted * share_change[i]
        else:
            higher = contact.share * (moved[i, 0] + contact.self_compliance * change) - tilted * change
            stiffer = contact.share * (moved_shares[i, 0] + tilted - contact.self_compliance * contact.share)
        compliance -= higher / (period - released)
        resistance -= stiffer / (period - released)
    for i in range(contacts.size):
        contact, each = contacts[i], corrected[i]
        if contact.kind == WIDE:
            continue
        if each.touching:
            compliance_here = displacement_of_punch(each.half_width * contact.scale, period)
            each.penetration = each.force * compliance_here
            each.closing = contact.share * compliance_here
            if contact.kind == CREST:  # without which the others would have its share, and what they add to the rate
                each.closing = (weights[i].closing + resistance) / max(1 - each.share / period, MIN_LEFT)
        else:
            top = contact.centre if contact.kind == CREST else each.centre
            each.penetration = value(contact.height, top) - moved[i, 0] - by_edges[i] - (plane - compliance)
            each.closing = rate + resistance - value(contact.rate, top) - moved_shares[i, 0]
    found &= solved and released <= MAX_RELEASED * period
    return Redistribution(found, compliance, resistance, corrected, interaction.displacement)


@kernel
def _spread(moments: Array, total: float, least: float) -> float:
    """Size of second moments: of the one that was found, at least so much per force, and of the first one.

    The second moment happens to vanish at some loads, where the fourth, which is not corrected, does not. It usually
    is that of a node alone, or, for the root at the edges of a wide contact, that of half a node there.
    """
    return max(abs(moments[2]), least * abs(total)) + (moments[1] ** 2 / total if total > 0 else 0.0)


@kernel
def _weigh(contacts: Records, rate: float, period: float, state: State) -> tuple[Records, float]:
    """Weights of all that touch, and what their shapes change of the compliance."""
    weights, shape = np.zeros(contacts.size, WEIGHTS), 0.0
    for i in range(contacts.size):
        contact, weight, centre, half_width = contacts[i], weights[i], state.centre[i], state.half_width[i]
        if not state.touching[i]:
            continue
        if contact.kind == WIDE:
            own = contact.edge_resistance * period / contact.share**2
            weight.slope, weight.more = contact.self_compliance + own, own * contact.share
            continue
        others = expansion(contact.rate, centre, half_width)
        weight.slope = displacement_of_punch(half_width * contact.scale, period)
        if contact.kind == CREST:
            weight.closing = rate - others[0]
            continue
        height = expansion(contact.height, centre, half_width)
        mixed, cross = contact_energies(height, others, contact.force, contact.share)
        weight.slope += (others[0] - cross / contact.share) / contact.share
        weight.slope += contact.edge_resistance * period / contact.share**2
        weight.others = (cross - contact.grid_cross) / contact.share
        weight.raised = others[0] - contact.grid_cross / contact.share
        weight.more = (weight.slope - contact.self_compliance) * contact.share + weight.others
        shape += (mixed - contact.grid_mixed) / period + contact.edge_compliance
    return weights, shape


@kernel
def _changes_of_shares(
    contacts: Records, weights: Records, by_shares: Array, period: float, state: State, interaction: Interaction
) -> tuple[Array, float, bool]:
    """How much more of a load each carries, shares released, and whether these were found."""
    n = contacts.size
    slope, right, on_released = np.ones(n), np.zeros(n), np.zeros(n)
    for i in range(n):
        if state.touching[i]:
            slope[i] = weights[i].slope
            right[i] = weights[i].closing - weights[i].more - by_shares[i, 0]
        else:
            on_released[i] = contacts[i].share
    released = on_released.sum()
    if released > 0:  # what they carried on the grid is carried by the others
        right += press(on_released, interaction)
    inverse = invert_punches(np.flatnonzero(state.touching), contacts["position"], slope, period)
    share_change, found = solve_bordered(slope, right, released, SHARE_TOLERANCE, interaction, inverse)
    return share_change - on_released, released, found
