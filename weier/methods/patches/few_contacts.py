"""One load on a few contacts or gaps, whose set is right: Newton's method with a dense matrix of all of them.

The solution is refined until its density is resolved, and checked: no segment is missing, none is cut by tension or
overlap, and nothing remains of the equations. A guess with a wrong set of segments is refused, since `many_contacts`
corrects it.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.collocation import NewtonResult, newton_iteration
from weier.methods.patches.defect_correction import refine
from weier.methods.patches.fields import ContactState, complementary_residual
from weier.methods.patches.inequalities import (
    SAMPLED_FACTOR,
    Violations,
    certify,
    error_bound,
    find_negative_intervals,
    lowest_inside,
    lowest_outside,
    sample_count,
)
from weier.methods.patches.initial_guess import COARSE_TOLERANCE, InitialGuess, refine_density
from weier.methods.patches.segments import coefficient_tails, estimate_node_count, increase_node_count
from weier.methods.patches.surface import CosineSeries, Surface

MAX_UNKNOWNS = 8000  # on few nodes, a dense matrix of 0.5 GB, and 15 s for each step
MAX_NODE_ROUNDS = 6  # of adding nodes
# Tension, over the pressure, that may remain where two contacts have nearly merged: it changes dh/dp by less than
# itself, and h by its square.
MAX_TENSION = 1e-9
# An overlap beyond this, over the approach, and so many times the residual shows that a contact is missing: tighter
# than the tolerance, since next to its birth a contact changes dh/dp far more than h.
MIN_OVERLAP, OVERLAP_FACTOR = 1e-12, 10.0


def solve_few_contacts(
    surface: Surface, guess: InitialGuess, load: float, tolerance: float
) -> tuple[ContactState, int]:
    """The state under one load, from a guess on few nodes, and the Newton steps and corrections that it took.

    ConvergenceError is raised if Newton's method fails, or if the state does not meet the contact conditions.
    """
    state, steps = solve_on_segments(surface, refine_density(surface, guess, load), load, tolerance)
    series = surface.series(state.dual)
    worst, height, closure = contact_residual(state, series)
    holds, outside, inside = check_inequalities(state, series, worst, tolerance)
    if not holds:
        raise ConvergenceError(f"another set of contacts is in contact under the mean pressure {state.load:.6g} p_0*")
    state = certify(state, max(height, closure), series.period, tolerance)
    worst *= SAMPLED_FACTOR
    unmet = Violations(max(closure, -inside), max(worst, -outside))
    if not state.dual:
        unmet = Violations(max(worst, -outside), -inside)
    return state._replace(error=error_bound(state, unmet, series.period)), steps


def solve_on_segments(
    surface: Surface, guess: InitialGuess, load: float, tolerance: float
) -> tuple[ContactState, int]:
    """The state that solves the equations on the segments of a guess, whether the inequalities hold or not."""
    coarse = solve_on_few_nodes(surface, guess, load)
    state, steps = solve_on_many_nodes(surface, coarse, guess.dual, load, tolerance)
    return state, coarse.steps + steps


def solve_on_few_nodes(surface: Surface, guess: InitialGuess, load: float) -> NewtonResult:
    """Newton's method on the segments of a guess and so few nodes that its matrix is cheap."""
    unknowns, series = guess.phi.size + 2 * guess.segments.centre.size + 1, surface.series(guess.dual)
    if unknowns > MAX_UNKNOWNS:
        raise ConvergenceError(f"{unknowns} unknowns are more than a dense matrix holds, {MAX_UNKNOWNS}")
    return newton_iteration(guess.segments, guess.phi, guess.approach, series, load, guess.dual, COARSE_TOLERANCE)


def solve_on_many_nodes(
    surface: Surface, coarse: NewtonResult, dual: bool, load: float, tolerance: float
) -> tuple[ContactState, int]:
    """The state with its density resolved to the tolerance, and the corrections that it took."""
    few, series = coarse.segments, surface.series(dual)
    expected = estimate_node_count(few.origin, few.centre, few.half_width, series, tolerance)
    count, steps = np.maximum(expected, np.diff(few.first_node)), 0
    for _ in range(MAX_NODE_ROUNDS):
        r = refine(coarse, count, series, load, dual, tolerance)
        steps += r.steps
        if r.resolved:
            unknowns = r.approach, r.segments, r.phi, r.coefficient, r.sensitivity
            return ContactState(dual, load, *unknowns, np.nan, np.nan), steps
        count = increase_node_count(r.segments, r.coefficient, load, tolerance)
    raise ConvergenceError(f"the density does not converge under the mean pressure {load:.6g} p_0*")


@kernel
def check_inequalities(
    state: ContactState, series: CosineSeries, residual: float, tolerance: float
) -> tuple[bool, float, float]:
    """Whether there is no overlap or tension but by rounding, and the lowest value off the segments and on them.

    Both are 0 if they are nowhere negative. While the nodes of a segment do not resolve its density, the inequalities
    are not known any better; and an overlap is known as well as the gap on the contacts vanishes, which is the
    residual.
    """
    unresolved = coefficient_tails(state.segments, state.coefficient)
    outside, inside = (MAX_TENSION, tolerance) if state.dual else (tolerance, MAX_TENSION)
    scale = state.load if state.dual else abs(state.approach)
    limit = max(tolerance, outside, unresolved.max()) * scale
    if not state.dual:
        limit = min(limit, max(MIN_OVERLAP * scale, OVERLAP_FACTOR * residual))
    lowest = lowest_outside(state, series, 0.0), lowest_inside(state)
    if lowest[0] < -limit:
        return False, lowest[0], lowest[1]
    allowed = np.maximum(unresolved, max(tolerance, inside))
    holds = lowest[1] == 0 or find_negative_intervals(state, allowed).segment.size == 0
    return holds, lowest[0], lowest[1]


@kernel
def contact_residual(state: ContactState, series: CosineSeries) -> tuple[float, float, float]:
    """What is left of the equations: the largest residual on a segment, its height, and the gaps that do not close.

    That is the gap on a contact, in g_0. In a gap (dual), it is the pressure, in p_0*, whose height is a displacement
    over the width; and each gap at its far end, of which all are added up. The potentials come from closed forms at
    other points than the nodes, so that neither the matrix nor the collocation points are used again.
    """
    segments, worst, height, open_gaps = state.segments, 0.0, 0.0, 0.0
    for j in range(segments.centre.size):
        r, first = segments.half_width[j], segments.first_node[j]
        count = sample_count(segments.first_node[j + 1] - first)
        for q in range(count):
            y = segments.centre[j] + r * np.cos((q + 0.5) * (np.pi / count))
            off = abs(complementary_residual(state, series, segments.crest[j], y))
            worst, height = max(worst, off), max(height, off * (2 * r if state.dual else 1.0))
        if state.dual:
            open_gaps += abs(0.5 * np.pi * r * state.coefficient[first])
    return worst, height, open_gaps
