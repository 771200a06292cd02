"""How far off a corrected solution may be: estimates, told by what was corrected and by what stands near a birth.

Of a contact that has a polynomial the next two terms of it are known well, and with them what they change: that is
all, as long as nothing else is near. Whatever contacts and gaps do to each other, and edges that stand alone, is
measured in steps: one of an edge from a node to the next changes the compliance by D (a + b) and the resistance by
D (docs/subgrid.md). The factors stand in `factors`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Record, Records
from weier.kernels.jit import kernel
from weier.methods.bem import factors
from weier.methods.bem.contacts import CREST, WIDE, displacement_by_edges, nearest_others
from weier.methods.bem.grid_solution import Continuum, GridSolution
from weier.methods.bem.local_fit import DEGREE, derivative, shift, size, slopes, value
from weier.methods.bem.narrow_contacts import means, move_edges
from weier.methods.bem.narrow_gaps import Gaps
from weier.methods.bem.redistribution import Redistribution
from weier.theory.halfplane import displacement_at_distance, displacement_of_punch

MAX_BEYOND = 2.5  # nodes from a crest to another one that is not seen as one of its own
SAMPLES = 10  # to each side, to look for it
MAX_BEND = DEGREE**2 * (DEGREE**2 - 1) / 3  # second derivative of T_8 at most: of heights, what rounding adds to it


class Errors(NamedTuple):
    """Errors of compliance, in g_0, and resistance, in g_0/p_0*; what they say of contacts.

    judged : False where a crest stands above the plane by more than its own error
    """

    compliance: float
    resistance: float
    judged: bool


@kernel
def estimate_errors(
    solution: GridSolution, steps: Records, polynomial: Flags, gaps: Gaps, contacts: Records,
    forces: Redistribution, continuum: Continuum,
) -> Errors:  # fmt: skip
    """How far off a corrected solution is expected to be."""
    angle, period, load = continuum.angle, continuum.period, float(np.mean(solution.pressure))
    compliance, resistance = _errors_of_edges(solution, steps, polynomial, angle, load)
    compliance += _error_of_the_solver(solution, load)
    resistance += factors.RATE_ROUNDING / angle**2 * solution.rate
    for at in range(contacts.size):
        contact, each = contacts[at], forces.contacts[at]
        if each.touching:
            compliance += factors.MOMENTS_LEFT * each.second
            resistance += factors.MOMENTS_LEFT * each.rate_second
            if contact.kind != WIDE:
                of_rest = _errors_of_the_polynomial(contact, each, abs(solution.plane), period)
                compliance += factors.REST * of_rest[0]
                resistance += factors.REST * of_rest[1]
    birth_compliance = birth_resistance = 0.0
    judged = True
    for at in range(contacts.size):
        contact, each = contacts[at], forces.contacts[at]
        if contact.kind == WIDE:
            continue
        rest = factors.REST * size(contact.height_rest, each.centre)
        displaced, relief = _effects_of_others(contacts, forces.contacts, at, period)
        height = factors.HEIGHT_SHARE * compliance + rest + displaced
        judged &= each.penetration + _other_crest(contact, each, period / solution.contact.size) < -height
        if each.touching:  # the more of the load it takes, the less another can take from it
            height *= max(1 - each.share / period, 0.0)
        else:
            judged &= each.penetration <= height
        drop = _drop(contact, each, factors.HIGHER * height, relief, period)
        drop -= _drop(contact, each, -factors.LOWER * height, relief, period)
        birth_resistance += drop
        if each.closing > 0:  # the load between where it is born and where it seems to be, times the drop
            birth_compliance += drop * height / each.closing
    for gap in gaps.runs:
        birth_compliance += gap.compliance_error
        birth_resistance += gap.resistance_error
    return Errors(compliance + birth_compliance, resistance + birth_resistance, judged)


@kernel
def _error_of_the_solver(solution: GridSolution, load: float) -> float:
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
    return residual + flatness * load + factors.ROUNDING * abs(solution.plane)


@kernel
def _errors_of_edges(
    solution: GridSolution, steps: Records, polynomial: Flags, angle: float, mean_pressure: float
) -> tuple[float, float]:
    """What steps that are misjudged change of compliance and resistance at most."""
    errors, edge, points = np.zeros(2), solution.edge, solution.pressure.size
    half_wave = np.pi / angle  # in nodes: the surface below a wider run bends as much
    for run in range(edge.size - 2):
        here, before = edge[run + 2] - edge[run + 1], edge[run + 1] - edge[run]
        narrower = min(here, before)
        near = (narrower / (here + before)) ** 2
        gap = run - 1 if solution.contact[edge[run + 1] % points] else run
        contact = run - 1 if gap == run else run
        change = steps[run].drop * min(steps[run].load, mean_pressure), steps[run].drop  # no older than the load
        for quantity in range(2):
            if polynomial[gap]:
                share = factors.GAP[quantity] * angle**2 + factors.NEAR_GAP[quantity] * near
                errors[quantity] += share * change[quantity]
            elif not polynomial[contact]:
                share = 1.0 if steps[run].uneven else factors.ALONE[quantity] / min(narrower, half_wave)
                errors[quantity] += share * change[quantity]
    return errors[0], errors[1]


@kernel
def _errors_of_the_polynomial(contact: Record, each: Record, height: float, period: float) -> tuple[float, float]:
    """What the next two terms of its polynomials change of compliance and resistance, and rounding of heights.

    A height delta z in contact raises the plane by its mean over the Chebyshev nodes. Its slope moves both edges, and
    so does that of the displacement by others; the resistance falls by 2 share^2/a with the half width a.
    """
    half_width, share = each.half_width, each.share
    rounding = factors.ROUNDING * MAX_BEND * height * half_width / 2
    mean = mean_rate = 0.0
    wider = _widening(contact, each, each.tilt * contact.scale, 0.0) + _widening(contact, each, 0.0, rounding)
    for k in range(contact.height_rest.shape[0]):
        mean += abs(_means_about(contact.height_rest[k], each)[0])
        mean_rate += abs(_means_about(contact.rate_rest[k], each)[0])
        wider += _widening(contact, each, *_means_about(derivative(contact.height_rest[k]), each))
    compliance = abs(share) * mean + abs(each.force) * mean_rate
    return compliance / period, 2 * (abs(share) * mean_rate + share**2 * wider / half_width) / period


@kernel
def _means_about(polynomial: Array, each: Record) -> tuple[float, float]:
    """Means over the Chebyshev nodes t of a contact, of a polynomial and of t times it."""
    moved = polynomial.copy()
    shift(moved, each.centre)
    mean, mean_t, _, _, _ = means(moved, each.half_width)
    return mean, mean_t


@kernel
def _widening(contact: Record, each: Record, mean: float, mean_t: float) -> float:
    """By how much a slope with these means over its Chebyshev nodes t, and of t times it, widens a contact."""
    return abs(move_edges(contact.height, mean, mean_t, each.centre, each.half_width)[1])


@kernel
def _effects_of_others(contacts: Records, corrected: Records, at: int, period: float) -> tuple[float, float]:
    """How far others may displace a crest by what is not corrected, and how much they relieve its force.

    Of what lone edges of wide contacts displace at most, a third was left in experiments. Of contacts with
    polynomials it is the moments after the third, which displace no more, it is taken, than third and fourth moments
    of dipoles at the edges with the corrected m_1 and m_2 would: 3 a^2 m_1 and 2 a^2 m_2. A change of force acts in
    the middles, and not on all of either contact, which leaves K''/4 (a_i^2 + a_j^2). A force f that another contact
    loses displaces both by f (C_i + C_j - 2 K_ij); the relief is what that leaves out of C_i at most.
    """
    displacement, relief = 0.0, 0.0
    for i in nearest_others(at, contacts.size):
        contact, other = contacts[i], corrected[i]
        away, yielding = contacts[at].position - contact.position, contact.self_compliance
        near = np.pi / period / abs(np.sin(np.pi / period * away))
        if contact.kind == WIDE:
            displacement += displacement_by_edges(contact, contacts[at].position, period)[1]
        elif other.touching:
            change, first, second = abs(other.moments[0]), abs(other.moments[1]), abs(other.moments[2])
            half_width = other.half_width * contact.scale
            displacement += near * (near * half_width) ** 2 * (2 * first + near * second)
            widths = half_width**2 + (corrected[at].half_width * contacts[at].scale) ** 2
            displacement += near**2 / 2 * widths * change
            yielding = displacement_of_punch(half_width, period)
        if other.touching:
            relief = min(relief, yielding - 2 * displacement_at_distance(away, period))
    return displacement, relief


@kernel
def _other_crest(contact: Record, each: Record, spacing: float) -> float:
    """How far another crest stands above this one that is no farther than the nodes beside; -inf without one.

    Between so few nodes it is not seen as one of its own. Within a contact on nodes, gaps are looked for.
    """
    reach, own, near = contact.limit, each.centre, each.half_width
    if contact.kind == CREST:
        reach, own, near = min(MAX_BEYOND * spacing / contact.scale, 1.0), contact.centre, 0.0
    step, top, highest = reach / SAMPLES, value(contact.height, own), -np.inf
    before = slopes(contact.height, -reach)[0]
    for i in range(1 - SAMPLES, SAMPLES + 1):
        s, after = i * step, slopes(contact.height, i * step)[0]
        if before > 0 >= after and abs(s - step / 2 - own) > near + step:
            highest = max(highest, value(contact.height, s) - after * step)
        before = after
    return highest - top


@kernel
def _drop(contact: Record, each: Record, higher: float, relief: float, period: float) -> float:
    """What a contact takes off the resistance that a crest makes by penetrating so much farther.

    One that is hollow in its middle is taken for the parabola that would be as wide. Where the plane cuts a parabola
    at the half width b, dH/dF is C(a) = C(b) + ln((1 + C(a))/2), which 1 + C(b) stands for (docs/subgrid.md).
    """
    penetration, bend = each.penetration + higher, -slopes(contact.height, each.centre)[1]
    if bend <= 0 and each.touching:
        bend = 2 * each.penetration / each.half_width**2
    if penetration <= 0 or bend <= 0:
        return 0.0
    half_width = min(np.sqrt(2 * penetration / bend) * contact.scale, period / 4)
    return each.closing**2 / max(1 + displacement_of_punch(half_width, period) + relief, 1.0) / period
