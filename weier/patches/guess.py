"""Where Newton starts: segments laid out round the period, and their densities from an earlier solution."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.errors import ConvergenceError
from weier.jit import kernel
from weier.limits import check_resolvable
from weier.patches.chebyshev import nodes
from weier.patches.fields import State, density, expand, other_density
from weier.patches.segments import Segments, make_segments, spaces
from weier.patches.waves import Waves, excess, from_summit, from_summits, make_waves
from weier.profile import Profile

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

FEWEST_NODES = 8
MOST_NODES = 1000
WAVE_SHARE = 0.8  # nodes = 8 + 0.8 k r + 9/ln(rho): what the tails of converged solutions asked for
SPACE_SHARE = 9.0
# Of a half-width: what a guess believes of a space; a solution asks for more nodes by its tails.
NEAREST, FARTHEST = 0.01, 1e6
TAIL = 0.1  # to aim at, over the tolerance
LEAST_TAIL, MOST_TAIL = 1e-16, 0.5  # rounding, and no decay to speak of: what lies beyond tells no rate
SLOWEST_DECAY = 1e-3  # of ln(tail) a node, so that the rate can be divided by
MOST_FEWER = 2  # nodes taken away at once, for a tail may be small by chance; added are no more than there are
ROUNDING, MOST_ROUNDING = 1e-14, 1e-3  # of a tail; a density falls with the width squared and rounding does not
ROOM = 0.4  # for Hertz's half-width, of the way from crest to crest: touching at 0.5, they would have to merge
SWITCH = 0.7  # change to the other problem when it needs fewer nodes than this share


class Surface(NamedTuple):
    """The heights, and the full-contact pressures with their sign turned.

    heights : z, in g_0: on its highest summit is the first contact
    pressures : -p_full, in p_0*: on its highest summit is the last gap
    total_amplitude : sum g_n, in g_0
    """

    heights: Waves
    pressures: Waves
    total_amplitude: float

    @property
    def full_load(self) -> float:
        """Mean pressure from which on contact is full, in p_0*."""
        return self.pressures.top

    def of(self, dual: bool) -> Waves:
        """The series that the problem for contacts, or for gaps (dual), looks at."""
        return self.pressures if dual else self.heights


class Guess(NamedTuple):
    """Segments, phi at their nodes and the approach, as in `State`."""

    dual: bool
    segments: Segments
    phi: Array
    approach: float


def surface_of(profile: Profile) -> Surface:
    """What the solver needs to know of a profile.

    Raises
    ------
    ValueError
        If its waves are too many for a computer.
    """
    check_resolvable(profile)
    series = profile.wavenumber, profile.phase, profile.period
    return Surface(
        make_waves(profile.amplitude, *series),
        make_waves(-profile.full_contact_pressure, *series),
        profile.total_amplitude,
    )


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
    count = _expected_nodes(placed, waves) if count is None else count[order]
    return make_segments(*placed, count, waves.period), order


def _expected_nodes(placed: tuple[Indices, Array, Array, Array], waves: Waves) -> Indices:
    """Nodes for the waves within a segment and the nearness of its neighbours, by Bernstein's ellipse."""
    half_width = placed[-1]
    bare = make_segments(*placed, np.full(half_width.size, 2), waves.period)
    space = spaces(bare, waves.period)
    near = np.clip(np.minimum(space, np.roll(space, 1)) / half_width, NEAREST, FARTHEST)
    ln_rho = np.log1p(near + np.sqrt(near * (near + 2)))
    count = FEWEST_NODES + WAVE_SHARE * waves.frequency[-1] * half_width + SPACE_SHARE / ln_rho
    return np.minimum(np.ceil(count), MOST_NODES).astype(np.int64)


def adjusted_nodes(count: Indices, tail: Array, aim: float, where: Flags) -> Indices:
    """Nodes that bring the tail to `aim` if it goes on decaying as it did so far."""
    tail = np.clip(tail, LEAST_TAIL, MOST_TAIL)
    change = np.ceil(np.log(tail / aim) / np.maximum(-np.log(tail) / count, SLOWEST_DECAY))
    new = count + np.where(where, np.clip(change, -MOST_FEWER, count), 0)
    return np.clip(new, FEWEST_NODES, MOST_NODES).astype(np.int64)


def tails(state: State) -> Array:
    """Size of the last two Chebyshev coefficients over the largest, shape (segments,)."""
    first, size = state.segments.first, np.abs(state.coefficient)
    return np.maximum(size[first[1:] - 1], size[first[1:] - 2]) / np.maximum.reduceat(size, first[:-1])


def refined(surface: Surface, state: State, tolerance: float) -> Guess | None:
    """A guess with more nodes where the coefficients have not decayed; None if all have.

    Raises
    ------
    ConvergenceError
        If a segment has the most nodes already.
    """
    old, count, tail = state.segments, np.diff(state.segments.first), tails(state)
    rounding = np.minimum(ROUNDING * (old.half_width.max() / old.half_width) ** 2, MOST_ROUNDING)
    rough = tail > np.maximum(tolerance, rounding)
    if not np.any(rough):
        return None
    if np.any(count[rough] >= MOST_NODES):
        raise ConvergenceError(
            f"a space between two contacts or two gaps is too narrow for {MOST_NODES} nodes under the mean "
            f"pressure {state.load:.6g} p_0*",
            float(tail.max()),
        )
    count = adjusted_nodes(count, tail, TAIL * tolerance, rough)
    return carried_over(surface, state, old.summit, old.centre, old.half_width, count)[0]


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


def hertz(dual: bool, curvature: float, half_width: float, count: int) -> Array:
    """phi of a lone small segment: Hertz's contact, or (dual) the gap under a parabola of pressure."""
    if dual:
        return -np.pi * curvature * half_width**2 * nodes(count)
    return np.full(count, curvature * half_width / (2 * np.pi))


def hertz_start(surface: Surface, load: float, dual: bool) -> Guess:
    """Contacts at the highest crests, a = 2 sqrt(p L/|z''|), or gaps where the full-contact pressure is least."""
    waves = surface.of(dual)
    tops = np.flatnonzero(waves.rise == 0)
    curvature = np.array([-excess(waves, int(j), 0.0)[2] for j in tops])
    force = waves.top - load if dual else load * waves.period / tops.size
    half_width = np.minimum(2 * np.sqrt(force / curvature), ROOM * waves.period / tops.size)
    new, order = arrange(waves, tops, np.zeros(tops.size), half_width)
    count = np.diff(new.first)
    phi = [hertz(dual, curvature[order[j]], new.half_width[j], count[j]) for j in range(tops.size)]
    return Guess(dual, new, np.concatenate(phi), 0.0)


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
