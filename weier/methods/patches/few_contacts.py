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
from weier.methods.patches.inequalities import certify, find_negative_intervals, lowest_outside
from weier.methods.patches.initial_guess import COARSE_TOLERANCE, InitialGuess, refine_density
from weier.methods.patches.segments import coefficient_tails, estimate_node_count, increase_node_count
from weier.methods.patches.surface import CosineSeries, Surface

MAX_UNKNOWNS = 8000  # on few nodes, a dense matrix of 0.5 GB, and 15 s for each step
MAX_NODE_ROUNDS = 6  # of adding nodes
# Tension, over the pressure, that may remain where two contacts have nearly merged: it changes dh/dp by less than
# itself, and h by its square.
MAX_TENSION = 1e-9


def solve_few_contacts(
    surface: Surface, guess: InitialGuess, load: float, tolerance: float
) -> tuple[ContactState, int]:
    """The state under one load, from a guess on few nodes, and the Newton steps and corrections that it took.

    ConvergenceError is raised if Newton's method fails, or if the state does not meet the contact conditions.
    """
    state, steps = solve_on_segments(surface, refine_density(surface, guess, load), load, tolerance)
    _check_inequalities(surface, state, tolerance)
    residual = contact_residual(state, surface.series(state.dual))
    return certify(state, residual, surface.heights.period, tolerance), steps


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
            return ContactState(dual, load, *unknowns, np.nan), steps
        count = increase_node_count(r.segments, r.coefficient, load, tolerance)
    raise ConvergenceError(f"the density does not converge under the mean pressure {load:.6g} p_0*")


def _check_inequalities(surface: Surface, state: ContactState, tolerance: float) -> None:
    """ConvergenceError if there is overlap or tension: off the segments, or on them."""
    if violates_inequalities(state, surface.series(state.dual), tolerance):
        raise ConvergenceError(f"another set of contacts is in contact under the mean pressure {state.load:.6g} p_0*")


@kernel
def violates_inequalities(state: ContactState, series: CosineSeries, tolerance: float) -> bool:
    """Whether there is overlap or tension.

    While the nodes of a segment do not resolve its density, the inequalities are not known any better.
    """
    unresolved = coefficient_tails(state.segments, state.coefficient)
    outside, inside = (MAX_TENSION, tolerance) if state.dual else (tolerance, MAX_TENSION)
    scale = state.load if state.dual else abs(state.approach)
    limit = max(tolerance, outside, unresolved.max()) * scale
    if lowest_outside(state, series, limit) < -limit:
        return True
    return find_negative_intervals(state, np.maximum(unresolved, max(tolerance, inside))).segment.size > 0


@kernel
def contact_residual(state: ContactState, series: CosineSeries) -> float:
    """Largest violation of a contact condition on the segments, as a length in g_0.

    The gap on a contact counts as it is; in a gap, 2 r times the pressure, its displacement over the gap's width, and
    the gap at the far end. The potentials come from closed forms at the nodes, so that neither the matrix nor the
    collocation points are used again. Every second node is enough, since the residual varies like a polynomial with a
    degree of the number of nodes.
    """
    segments, worst = state.segments, 0.0
    for j in range(segments.centre.size):
        r = segments.half_width[j]
        for q in range(segments.first_node[j], segments.first_node[j + 1], 2):
            y = segments.centre[j] + r * segments.node[q]
            off = abs(complementary_residual(state, series, segments.crest[j], y)) * (2 * r if state.dual else 1.0)
            worst = max(worst, off)
        if state.dual:
            worst = max(worst, abs(0.5 * np.pi * r * state.coefficient[segments.first_node[j]]))
    return worst
