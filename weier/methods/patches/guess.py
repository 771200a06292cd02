"""Where Newton starts: segments laid out round the period, and their densities from an earlier solution."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.fields import State, density, expand, other_density
from weier.methods.patches.hertz import hertz
from weier.methods.patches.nodes import expected_nodes, more_nodes
from weier.methods.patches.segments import Segments, make_segments, spaces
from weier.methods.patches.surface import Surface
from weier.methods.patches.waves import Waves, from_summit, from_summits

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

SWITCH = 0.7  # change to the other problem when it needs fewer nodes than this share


class Guess(NamedTuple):
    """Segments, phi at their nodes and the approach, as in `State`."""

    dual: bool
    segments: Segments
    phi: Array
    approach: float


def arrange(
    waves: Waves, summit: Indices, centre: Array, half_width: Array, count: Indices | None = None
) -> tuple[Segments, Indices]:
    """Segments in order round the period, and the permutation that put them so."""
    if not np.all(half_width > 0):
        raise ConvergenceError("a segment would have no width")
    origin = waves.place[summit]
    origin = origin - waves.period * np.floor((origin + centre) / waves.period)
    order = np.argsort(origin + centre, kind="stable")
    placed = summit[order], origin[order], centre[order], half_width[order]
    count = expected_nodes(placed, waves) if count is None else count[order]
    return make_segments(*placed, count, waves.period), order


def carried_over(
    surface: Surface,
    state: State,
    summit: Indices,
    centre: Array,
    half_width: Array,
    count: Indices | None = None,
) -> tuple[Guess, Indices]:
    """A guess on other segments with the density of a solution, and the permutation of the segments."""
    waves = surface.of(state.dual)
    if summit.size == 0:
        raise ConvergenceError(f"no contact is left under the mean pressure {state.load:.6g} p_0*")
    new, order = arrange(waves, summit, centre, half_width, count)
    phi = resampled(state, waves, new, False)
    for j in range(new.centre.size):  # a segment with no density at all would have no Jacobian
        here = slice(new.first[j], new.first[j + 1])
        if not np.any(phi[here]):
            phi[here] = hertz(state.dual, 1.0, new.half_width[j], here.stop - here.start)
    return Guess(state.dual, new, phi, state.approach), order


def refined(surface: Surface, state: State, tolerance: float) -> Guess | None:
    """A guess with more nodes where the coefficients have not decayed; None if all have."""
    old, count = state.segments, more_nodes(state, tolerance)
    if count is None:
        return None
    return carried_over(surface, state, old.summit, old.centre, old.half_width, count)[0]


@kernel
def resampled(state: State, waves: Waves, new: Segments, other: bool) -> Array:
    """phi at the nodes of other segments, from the density (or that of the other problem) of a solution."""
    phi = np.empty(new.node.size)
    for j in range(new.centre.size):
        for q in range(new.first[j], new.first[j + 1]):
            s = new.node[q]
            y = new.centre[j] + new.half_width[j] * s
            if other:
                value = other_density(state, waves, *from_summit(waves, new.origin[j] + y))
            else:
                value = density(state, waves.period, new.origin[j], y)
            phi[q] = value / np.sqrt((1 - s) * (1 + s))
    return phi


def cheaper(surface: Surface, guess: Guess, load: float) -> Guess:
    """The same guess for contacts or for gaps, whichever needs clearly fewer nodes."""
    if np.any(spaces(guess.segments, surface.heights.period) <= 0):
        return guess
    other = _complement(surface, guess.segments, not guess.dual)
    if other.node.size > SWITCH * guess.phi.size:
        return guess
    state = as_state(guess, load)
    phi = resampled(state, surface.of(guess.dual), other, True)
    top = surface.heights.top
    return Guess(not guess.dual, other, phi, guess.approach + (top if guess.dual else -top))


def as_state(guess: Guess, load: float) -> State:
    """A guess in the shape of a solution, with no sensitivity, to take values from."""
    coefficient = expand(guess.segments, guess.phi)
    return State(guess.dual, load, guess.approach, guess.segments, guess.phi, coefficient, np.zeros(0), np.nan)


def _complement(surface: Surface, old: Segments, dual: bool) -> Segments:
    """The spaces between segments as segments of the other problem."""
    to = surface.of(dual)
    space = spaces(old, to.period)
    middle = old.origin + (old.centre + old.half_width) + 0.5 * space
    return arrange(to, *from_summits(to, middle), 0.5 * space)[0]
