"""One load: Newton on the segments at hand, corrected until every contact condition holds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.fields import State, clearance, expand
from weier.methods.patches.guess import Guess, cheaper, refined
from weier.methods.patches.newton import Iterate, Status, newton
from weier.methods.patches.surface import Surface
from weier.methods.patches.topology import corrected, without_cramped
from weier.methods.patches.waves import Waves

Array = NDArray[np.float64]

MOST_ROUNDS = 16
MOST_CRAMPED_ROUNDS = 6  # of these, in a row, that only join and remove segments: the start was no good
MOST_UNKNOWNS = 8000  # a dense matrix of 0.5 GB, 15 s a step
MANY_UNKNOWNS = 400  # from here on a Newton step costs more than a look at all signs
LOOSE = 1e-3  # last Newton step before that look
CERTIFIED = 100  # residual that is accepted, in units of the tolerance


class TooLargeError(ConvergenceError):
    """More unknowns than a dense matrix should hold."""


def settle(surface: Surface, guess: Guess, load: float, tolerance: float) -> tuple[State, int]:
    """Solve, check, correct, until nothing is left to correct. Returns the solution and the Newton steps.

    Raises
    ------
    ConvergenceError
        If Newton stalls, the corrections do not come to rest, or the solution fails its certificate.
    """
    steps, cramped, size, checked = 0, 0, float("nan"), False
    for _ in range(MOST_ROUNDS):
        guess = cheaper(surface, guess, load)
        loose = _unknowns(guess, load) > MANY_UNKNOWNS and not checked
        state, found = newton_from(surface, guess, load, LOOSE if loose else tolerance)
        steps, size = steps + found.steps, found.size
        cramped = cramped + 1 if found.status == Status.topology else 0
        if found.status == Status.stalled or cramped > MOST_CRAMPED_ROUNDS:
            break
        better, checked = _improved(surface, state, found, tolerance, loose)
        if better is None:
            return _certified(surface, state, tolerance), steps
        guess = better
    raise ConvergenceError(f"the contacts under the mean pressure {load:.6g} p_0* did not settle", size)


def _unknowns(guess: Guess, load: float) -> int:
    """How many unknowns a guess has.

    Raises
    ------
    TooLargeError
        If they are too many for a dense matrix.
    """
    unknowns = guess.phi.size + 2 * guess.segments.centre.size + 1
    if unknowns > MOST_UNKNOWNS:
        raise TooLargeError(
            f"the contacts under the mean pressure {load:.6g} p_0* need {unknowns} unknowns, more than "
            f"{MOST_UNKNOWNS}; take boundary elements"
        )
    return unknowns


def _improved(
    surface: Surface, state: State, found: Iterate, tolerance: float, loose: bool
) -> tuple[Guess | None, bool]:
    """What to solve next, None if nothing is left to improve, and whether all signs of the state are right."""
    if found.status == Status.topology:
        return without_cramped(surface, state, found.closing, found.vanishing), False
    correction = corrected(surface, state, LOOSE if loose else tolerance)
    if correction is not None:
        return correction, False
    if loose:
        return Guess(state.dual, state.segments, state.phi, state.approach), True
    return refined(surface, state, tolerance), True


def newton_from(surface: Surface, guess: Guess, load: float, tolerance: float) -> tuple[State, Iterate]:
    """Where Newton's method leads, with no check: the state, and how it went.

    Raises
    ------
    ConvergenceError
        If the equations are singular.
    """
    waves = surface.of(guess.dual)
    try:
        found = newton(guess.segments, guess.phi, guess.approach, waves, load, guess.dual, tolerance)
    except np.linalg.LinAlgError:
        raise ConvergenceError(f"singular equations under the mean pressure {load:.6g} p_0*") from None
    solution = found.approach, found.segments, found.phi, expand(found.segments, found.phi), found.sensitivity
    return State(guess.dual, load, *solution, np.nan), found


def residual(surface: Surface, state: State) -> float:
    """Largest violation of a contact condition on the segments, as a length in g_0.

    Notes
    -----
    Potentials in closed form, at the nodes: neither the matrix nor the points of the collocation. The gap of a
    contact counts as it is; the pressure in a gap counts by what it would displace over the gap's width.
    """
    return float(np.max(_violation(state, surface.of(state.dual))))


@kernel
def _violation(state: State, waves: Waves) -> Array:
    """Of each segment, in g_0: the gap on a contact; 2 r times the pressure in a gap, and the gap at its far end.

    Every second node will do, for a polynomial of their number.
    """
    segments = state.segments
    worst = np.zeros(segments.centre.size)
    for j in range(worst.size):
        r = segments.half_width[j]
        for q in range(segments.first[j], segments.first[j + 1], 2):
            y = segments.centre[j] + r * segments.node[q]
            worst[j] = max(worst[j], abs(clearance(state, waves, segments.summit[j], y)))
        worst[j] *= 2 * r if state.dual else 1.0
        if state.dual:
            a = state.coefficient[segments.first[j]]
            worst[j] = max(worst[j], abs(0.5 * np.pi * r * a))  # the gap closes at its far end
    return worst


def _certified(surface: Surface, state: State, tolerance: float) -> State:
    """The state with its residual, if that and the load p L = (pi/2) sum r a_0 are met.

    Signs were checked by `corrected`; what remains are the equations themselves and the load.

    Raises
    ------
    ConvergenceError
        If they are not.
    """
    period, miss = surface.heights.period, residual(surface, state)
    size = state.load * period if state.dual else state.approach
    reached = miss / size if size > 0 else np.inf  # 0: Newton lost all digits, far from its load
    if not state.dual:
        carried = 0.5 * np.pi * (state.segments.half_width @ state.coefficient[state.segments.first[:-1]])
        reached = max(reached, abs(float(carried) / (state.load * period) - 1))
    if not reached <= CERTIFIED * tolerance:
        raise ConvergenceError(
            f"the contacts under the mean pressure {state.load:.6g} p_0* miss their conditions by {reached:.1e}",
            reached,
        )
    return state._replace(residual=miss)
