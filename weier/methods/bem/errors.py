"""How far off a corrected solution may be: estimates, told by what was corrected and by what stands near a birth.

Of a contact that has a polynomial the next two terms of it are known well, and with them what they change: that is
all, as long as nothing else is near. Whatever contacts and gaps do to each other, and edges that stand alone, is
measured in steps: one of an edge from a node to the next changes the compliance by D (a + b) and the resistance by
D (docs/subgrid.md). The factors stand in `factors`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import kernel
from weier.methods.bem.contacts import CREST, WIDE, GridContacts
from weier.methods.bem.edges import Edges
from weier.methods.bem.factors import (
    ALONE,
    BIRTH_SHARE,
    BIRTHS,
    CANCELLED,
    CURVATURE_ROUNDING,
    GAP,
    HEIGHT_SHARE,
    IMAGES,
    MAX_UNEVEN,
    MOMENT,
    MOMENTS,
    NEAR_GAP,
    PRESSED,
    RATE_ROUNDING,
    RECIPROCITY,
    REST,
    ROUNDING,
    UNEVEN,
)
from weier.methods.bem.grid_solution import Continuum, GridSolution
from weier.methods.bem.local_fit import shift, slopes, value
from weier.methods.bem.lone_edges import Steps
from weier.methods.bem.narrow_contacts import force_per_half_width, means, punch_compliance
from weier.methods.bem.narrow_gaps import Gaps
from weier.methods.bem.redistribution import Redistribution


class Errors(NamedTuple):
    """Errors of compliance, in g_0, and resistance, in g_0/p_0*; what they say of contacts.

    uncertain : whether a contact may be one too many or too few
    judged : False where a crest stands above the plane by more than its own error
    """

    compliance: float
    resistance: float
    uncertain: bool
    judged: bool


@kernel
def estimate_errors(
    solution: GridSolution, edge: Edges, steps: Steps, polynomial: Flags, gaps: Gaps, contacts: GridContacts,
    forces: Redistribution, continuum: Continuum,
) -> Errors:  # fmt: skip
    """How far off a corrected solution is expected to be."""
    used, angle, period = contacts.kind.size, continuum.angle, continuum.period
    load = float(np.mean(solution.pressure))
    error, rate_error = _errors_of_the_solver(solution, load), RATE_ROUNDING / angle**2 * solution.rate
    for at in range(used):
        if not forces.touching[at]:
            continue
        error += MOMENTS * forces.second[at]
        rate_error += MOMENTS * forces.rate_second[at]
        if contacts.kind[at] != WIDE:
            off, rate_off = _errors_of_the_polynomial(contacts, forces, at, abs(solution.plane), period)
            shifted = abs(forces.share_change[at] * forces.change[at]) / period
            error += REST * off + RECIPROCITY[0] * shifted
            rate_error += REST * rate_off + RECIPROCITY[1] * shifted / load
    off, rate_off = _errors_of_edges(solution, edge, steps, polynomial, angle, load)
    error, rate_error = error + off, rate_error + rate_off
    births = missed = 0.0
    uncertain, judged = False, True
    for at in range(used):
        if contacts.kind[at] != WIDE:
            rest = _size(contacts.height_rest[at], forces.centre[at])
            displaced = _displacement_by_moments(contacts, at, solution.contact.size, period)
            off = HEIGHT_SHARE * error + PRESSED * forces.pressed[at] + 2 * rest + displaced
            if forces.touching[at]:  # the more of the load it takes, the less another can take from it
                off *= max(1 - (contacts.share[at] + forces.share_change[at]) / period, 0.0)
            else:
                judged &= forces.penetration[at] <= off
            uncertain |= abs(forces.penetration[at]) <= off
            drop = _uncertain_birth(contacts, forces, at, off, period)
            births += BIRTHS * drop
            if contacts.kind[at] == CREST:
                births += BIRTH_SHARE * abs(forces.closing[at] * forces.share_change[at]) / period
            if forces.closing[at] > 0:  # the load between where it is born and where it seems to be, times the drop
                missed += drop * displaced / forces.closing[at]
    return Errors(gaps.error[0] + error + missed, gaps.error[1] + rate_error + births, uncertain, judged)


@kernel
def _errors_of_the_solver(solution: GridSolution, load: float) -> float:
    """What residuals leave of the compliance.

    The residual of the heights, and that of the rate times the load: the correction is the mean, weighted by the
    rate, of what the continuum changes, and moves no more than the load.
    """
    residual = flatness = 0.0
    for i in range(solution.contact.size):
        if solution.contact[i]:
            residual = max(residual, abs(solution.plane - solution.deformed[i]))
            flatness = max(flatness, abs(solution.rate - solution.displacement[i]))
        else:
            residual = max(residual, solution.deformed[i] - solution.plane)
    return residual + flatness * load + ROUNDING * abs(solution.plane)


@kernel
def _is_lone_with_polynomial(solution: GridSolution, edge: Edges, polynomial: Flags) -> bool:
    """Whether one contact has the whole load, whatever the rate, and has had it from first touch on."""
    if edge.size != 4:
        return False
    return bool(polynomial[0] if solution.contact[edge[1] % solution.pressure.size] else polynomial[1])


@kernel
def _errors_of_edges(
    solution: GridSolution, edge: Edges, steps: Steps, polynomial: Flags, angle: float, mean_pressure: float
) -> tuple[float, float]:
    """What steps that are misjudged change of compliance and resistance at most."""
    errors = np.zeros(2)
    if _is_lone_with_polynomial(solution, edge, polynomial):  # only its images bear on it
        nodes = min(edge[2] - edge[1], edge[3] - edge[2])
        change = (nodes / solution.pressure.size) ** 4 * steps.drop.sum()
        return IMAGES[0] * change * mean_pressure, IMAGES[1] * change
    for run in range(edge.size - 2):
        here, before = edge[run + 2] - edge[run + 1], edge[run + 1] - edge[run]
        narrower = min(here, before)
        near = (narrower / (here + before)) ** 2
        gap = run - 1 if solution.contact[edge[run + 1] % solution.pressure.size] else run
        contact = run - 1 if gap == run else run
        change = steps.drop[run] * min(steps.load[run], mean_pressure), steps.drop[run]  # no older than the load
        for quantity in range(2):
            if polynomial[gap]:
                errors[quantity] += (NEAR_GAP[quantity] * near + GAP[quantity] * angle**2) * change[quantity]
            elif not polynomial[contact]:
                uneven = min(UNEVEN * steps.longer[run] ** 2, MAX_UNEVEN)
                errors[quantity] += ALONE[quantity] * max(1 / narrower, uneven) * change[quantity]
    return errors[0], errors[1]


@kernel
def _size(polynomials: Array, s: float) -> float:
    """The sum of two terms at s, with a share of each in case that their signs are others."""
    return _of_two(value(polynomials[0], s), value(polynomials[1], s))


@kernel
def _of_two(one: float, other: float) -> float:
    """The size of such a sum."""
    return abs(one + other) + CANCELLED * (abs(one) + abs(other))


@kernel
def _errors_of_the_polynomial(
    contacts: GridContacts, forces: Redistribution, at: int, height: float, period: float
) -> tuple[float, float]:
    """What the next two terms of its polynomials change of compliance and resistance, and rounding of heights.

    A height delta z in contact raises the plane by its mean over the Chebyshev nodes; that mean changes with the half
    width a, and a with the force, which is -(a/2) times the mean of t z'. A slope moves the contact by slope/z'', to
    where its curvature is another.
    """
    force, share = contacts.force[at] + forces.change[at], contacts.share[at] + forces.share_change[at]
    centre, half_width = forces.centre[at], forces.half_width[at]
    odd, odd_change = _means_of_the_rest(contacts.height_rest[at, 0], centre, half_width)
    even, even_change = _means_of_the_rest(contacts.height_rest[at, 1], centre, half_width)
    odd_rate, _ = _means_of_the_rest(contacts.rate_rest[at, 0], centre, half_width)
    even_rate, _ = _means_of_the_rest(contacts.rate_rest[at, 1], centre, half_width)
    off = abs(share) * _of_two(odd, even) + abs(force) * _of_two(odd_rate, even_rate)
    rate_off = 2 * abs(share) * _of_two(odd_rate, even_rate)
    wider = force_per_half_width(contacts.height[at], centre, half_width)
    if wider > 0:
        rate_off += share**2 * _of_two(odd_change, even_change) / wider
    _, bend, twist = slopes(contacts.height[at], centre)
    if bend < 0:
        slope = abs(forces.tilt[at]) * contacts.scale[at]
        for j in range(2):
            slope += abs(slopes(contacts.height_rest[at, j], centre)[0])
        rate_off += share**2 * (abs(twist) * slope / bend**2 - CURVATURE_ROUNDING * height / bend)
    return off / period, rate_off / period


@kernel
def _means_of_the_rest(rest: Array, centre: float, half_width: float) -> tuple[float, float]:
    """Mean of a term over the Chebyshev nodes t of a contact, and that of t times its slope."""
    moved = rest.copy()
    shift(moved, centre)
    mean, _, _, slope_t, _ = means(moved, half_width)
    return mean, slope_t


@kernel
def _displacement_by_moments(contacts: GridContacts, at: int, points: int, period: float) -> float:
    """How far a crest may stand off by the second moments of the contacts on the grid: K''/2 of each of these."""
    off = 0.0
    for other in range(contacts.kind.size):
        if other != at and contacts.kind[other] != CREST:
            apart = np.sin(np.pi / period * (contacts.position[at] - contacts.position[other]))
            share = MOMENT[0] if contacts.kind[other] == WIDE else MOMENT[1]
            off += share * contacts.force[other] * (np.pi / points / apart) ** 2
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
