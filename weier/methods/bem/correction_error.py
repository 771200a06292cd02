"""How far off a corrected solution may be, told by what was corrected and by what stands near a birth.

Of a contact that has a polynomial the next two terms of it are known well, and with them what they change: that is
all, as long as nothing else is near. Whatever contacts and gaps do to each other, and edges that stand alone, is
measured in steps: one of an edge from a node to the next changes the compliance by D (a + b) and the resistance by
D (docs/subgrid.md).
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import kernel
from weier.methods.bem.contacts import CREST, NARROW, WIDE, GridContacts
from weier.methods.bem.edge_error import Steps, errors_of_edges, is_lone_with_polynomial
from weier.methods.bem.edges import Edges
from weier.methods.bem.grid_solution import GridSolution
from weier.methods.bem.narrow_contacts import force_per_half_width, means, punch_compliance
from weier.methods.bem.polynomials import REST, shift, slopes, value
from weier.methods.bem.redistribution import Redistribution

PLACE = 1.4  # times what the known shift of a contact changes
CANCELLED = 0.25  # of terms of opposite signs
ROUNDING = 1e-13  # of the heights
RATE_ROUNDING = 5e-13  # of the resistance, over (2 pi/points a wave)^2: what rounding of heights does to curvatures
CURVATURE_ROUNDING = 1e-11  # of the heights, over the curvature of a contact's polynomial: half is as measured
# What is left on any grid: times the square of how far A q is from flat, of the resistance, since a share shifts from
# contact to contact, or from the middle of one to its edges, with little resistance.
SHIFTED = 60.0
UNFLAT = 7e-3  # times how far A q is from flat and the change that the rate makes of the load, of the compliance
BIRTH_SHARE = 0.1  # of what a new contact takes off the compliance: how others give way to it is known roughly
BIRTH_RATE = 0.02  # and off the resistance
MOMENTS, RATE_MOMENTS = 1.5, 2.0  # times what second moments of contacts change
# Times change of force and change of share, since reciprocity is linear: of h, and over the load of R.
RECIPROCITY, RATE_RECIPROCITY = 0.1, 1.0
LET_GO = 1.2  # of the force, in g_0 per lambda_0 p_0*, of a contact of the grid that the continuum has not
PRESSED = 0.05  # of what others press a contact down by more than on the grid
# Of the nodes' spacing squared times the force of a contact: how far the second moment of its pressure on the grid
# may be off. 1/4 is half a node at each edge; the most that was measured is 1/3. A contact with a polynomial has its
# first three moments taken off, and this is left.
MOMENT, MOMENT_LEFT = 0.4, 0.05
HEIGHT_SHARE = 4.0  # errors of the compliance by which a crest may stand higher or lower


@kernel
def expected_errors(
    solution: GridSolution, edge: Edges, steps: Steps, polynomial: Flags, contacts: GridContacts, used: int,
    forces: Redistribution, angle: float, period: float,
) -> tuple[float, float, bool, bool]:  # fmt: skip
    """Errors of compliance, in g_0, and resistance, in g_0/p_0*; whether a contact may be one too many or too few.

    The last is False where a crest stands above the plane by more than its own error; `angle` is 2 pi/(points a
    wave).
    """
    load = float(np.mean(solution.pressure))
    error, rate_error, flatness = _errors_of_the_solver(solution)
    if not is_lone_with_polynomial(solution, edge, polynomial):
        error += UNFLAT * flatness * solution.rate * load
    rate_error += RATE_ROUNDING / angle**2 * solution.rate
    let_go = False
    moments = rate_moments = 0.0
    for at in range(used):
        if contacts.kind[at] == NARROW and not forces.touching[at]:
            let_go = True
            error += LET_GO * contacts.force[at] * contacts.share[at] / period
        if forces.touching[at]:
            moments += forces.second[at]
            rate_moments += forces.rate_second[at]
        if forces.touching[at] and contacts.kind[at] != WIDE:
            off, rate_off = _errors_of_the_polynomial(contacts, forces, at, period)
            error += REST * off
            rate_error += REST * rate_off + PLACE * _errors_of_the_place(contacts, forces, at, period)
            rate_error += CURVATURE_ROUNDING * _rounding_of_the_curvature(
                contacts, forces, at, abs(solution.plane), period
            )
            shifted = abs(forces.share_change[at] * forces.change[at]) / period
            error += RECIPROCITY * shifted
            rate_error += RATE_RECIPROCITY * shifted / load
            if contacts.kind[at] == CREST:
                off, rate_off = _errors_of_a_birth(contacts, forces, at, period)
                error += off
                rate_error += rate_off
    off, rate_off = errors_of_edges(solution, edge, steps, polynomial, angle, flatness, let_go, load)
    error += MOMENTS * moments + off
    rate_error += RATE_MOMENTS * rate_moments + rate_off
    sine, cosine = (np.sin(np.pi / period * contacts.position), np.cos(np.pi / period * contacts.position))
    births = missed = 0.0
    uncertain, judged = False, True
    for at in range(used):
        if contacts.kind[at] != WIDE:
            off = (
                HEIGHT_SHARE * error
                + PRESSED * forces.pressed[at]
                + 2 * _rest(contacts.height_rest[at], forces.centre[at])
            )
            displaced = _displacement_by_moments(contacts, used, at, sine, cosine, np.pi / solution.contact.size)
            off += displaced
            if forces.touching[at]:  # the more of the load it takes, the less another can take from it
                off *= max(1 - (contacts.share[at] + forces.share_change[at]) / period, 0.0)
            else:
                judged &= forces.penetration[at] <= off
            uncertain |= abs(forces.penetration[at]) <= off
            drop = _uncertain_birth(contacts, forces, at, off, period)
            births += drop
            if forces.closing[at] > 0:  # the load between where it is born and where it seems to be, times the drop
                missed += drop * displaced / forces.closing[at]
    return error + missed, rate_error + births, uncertain, judged


@kernel
def _errors_of_the_solver(solution: GridSolution) -> tuple[float, float, float]:
    """What residuals leave, all of that of the heights and the square of that of the rate; the latter as a share."""
    residual = flatness = 0.0
    for i in range(solution.contact.size):
        if solution.contact[i]:
            residual = max(residual, abs(solution.plane - solution.deformed[i]))
            flatness = max(flatness, abs(solution.rate - solution.displacement[i]))
        else:
            residual = max(residual, solution.deformed[i] - solution.plane)
    share = min(flatness / solution.rate, 1.0) if solution.rate > 0 else 0.0  # in full contact both are rounding
    return residual + ROUNDING * abs(solution.plane), SHIFTED * share * flatness, share


@kernel
def _size(one: float, other: float) -> float:
    """Of a sum of two terms, with a share of each in case that their signs are others."""
    return abs(one + other) + CANCELLED * (abs(one) + abs(other))


@kernel
def _rest(polynomials: Array, s: float) -> float:
    """What the next two terms are there."""
    return _size(value(polynomials[0], s), value(polynomials[1], s))


@kernel
def _errors_of_the_polynomial(
    contacts: GridContacts, forces: Redistribution, at: int, period: float
) -> tuple[float, float]:
    """What the next two terms of its polynomials change of compliance and resistance.

    A height delta z in contact raises the plane by its mean over the Chebyshev nodes; that mean changes with the half
    width a, and a with the force, which is -(a/2) times the mean of t z'.
    """
    force, share = (contacts.force[at] + forces.change[at], contacts.share[at] + forces.share_change[at])
    centre, half_width = forces.centre[at], forces.half_width[at]
    odd, odd_change = _means_of_the_rest(contacts.height_rest[at, 0], centre, half_width)
    even, even_change = _means_of_the_rest(contacts.height_rest[at, 1], centre, half_width)
    odd_rate, _ = _means_of_the_rest(contacts.rate_rest[at, 0], centre, half_width)
    even_rate, _ = _means_of_the_rest(contacts.rate_rest[at, 1], centre, half_width)
    wider = force_per_half_width(contacts.height[at], centre, half_width)
    off = abs(share) * _size(odd, even) + abs(force) * _size(odd_rate, even_rate)
    rate_off = 2 * abs(share) * _size(odd_rate, even_rate)
    if wider > 0:
        rate_off += share**2 * _size(odd_change, even_change) / wider
    return off / period, rate_off / period


@kernel
def _means_of_the_rest(rest: Array, centre: float, half_width: float) -> tuple[float, float]:
    """Mean of a term over the Chebyshev nodes t of a contact, and that of t times its slope."""
    moved = rest.copy()
    shift(moved, centre)
    mean, _, _, slope_t, _ = means(moved, half_width)
    return mean, slope_t


@kernel
def _errors_of_the_place(contacts: GridContacts, forces: Redistribution, at: int, period: float) -> float:
    """What it changes of the resistance that a contact stands elsewhere, where its curvature is another.

    It moves by slope/z'' if the moments of others, its images or the next two terms tilt the surface.
    """
    _, bend, twist = slopes(contacts.height[at], forces.centre[at])
    slope = abs(forces.tilt[at]) * contacts.scale[at]
    for j in range(2):
        slope += abs(slopes(contacts.height_rest[at, j], forces.centre[at])[0])
    share = contacts.share[at] + forces.share_change[at]
    return float(share**2 / period * abs(twist) * slope / bend**2)


@kernel
def _rounding_of_the_curvature(
    contacts: GridContacts, forces: Redistribution, at: int, height: float, period: float
) -> float:
    """What rounding of heights changes of the resistance, much where waves are low: share^2/L over the curvature."""
    bend = abs(slopes(contacts.height[at], forces.centre[at])[1])
    share = contacts.share[at] + forces.share_change[at]
    return float(share**2 / period * height / bend) if bend > 0 else 0.0


@kernel
def _errors_of_a_birth(contacts: GridContacts, forces: Redistribution, at: int, period: float) -> tuple[float, float]:
    """What a contact between two nodes changes may be misjudged by."""
    bend = -slopes(contacts.height[at], forces.centre[at])[1]
    height = BIRTH_SHARE * forces.penetration[at] * forces.closing[at] / period
    return height, BIRTH_RATE * _drop(contacts, forces, at, forces.penetration[at], bend, period)


@kernel
def _displacement_by_moments(
    contacts: GridContacts, used: int, at: int, sine: Array, cosine: Array, angle: float
) -> float:
    """How far a crest may stand off by the second moments of the contacts on the grid: K''/2 of each of these.

    Sine and cosine are of pi x/L at all contacts, `angle` is that of one step of the grid.
    """
    off = 0.0
    for other in range(used):
        if other != at and contacts.kind[other] != CREST:
            apart = sine[at] * cosine[other] - cosine[at] * sine[other]
            share = MOMENT if contacts.kind[other] == WIDE else MOMENT_LEFT
            off += share * contacts.force[other] * (angle / apart) ** 2
    return off


@kernel
def _uncertain_birth(contacts: GridContacts, forces: Redistribution, at: int, off: float, period: float) -> float:
    """By how much the resistance would differ if a crest stood so much higher or lower."""
    bend = -slopes(contacts.height[at], forces.centre[at])[1]
    higher = _drop(contacts, forces, at, forces.penetration[at] + off, bend, period)
    return higher - _drop(contacts, forces, at, forces.penetration[at] - off, bend, period)


@kernel
def _drop(
    contacts: GridContacts, forces: Redistribution, at: int, penetration: float, bend: float, period: float
) -> float:
    """What a contact takes off the resistance that a crest makes by penetrating so far."""
    if penetration <= 0 or bend <= 0:
        return 0.0
    half_width = min(np.sqrt(2 * penetration / bend) * contacts.scale[at], period / 4)
    return forces.closing[at] ** 2 / (1 + punch_compliance(half_width, period)) / period
