"""Newton's initial guesses: from another state, from Hertz's theory, or from boundary elements on a coarse grid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem import fft
from weier.methods.bem.grids import full_contact, nested_grids
from weier.methods.errors import ConvergenceError
from weier.methods.patches.chebyshev import nodes
from weier.methods.patches.fields import ContactState, complementary_density, density, expand
from weier.methods.patches.segments import (
    Segments,
    distances_to_next,
    estimate_node_count,
    increase_node_count,
    make_segments,
)
from weier.methods.patches.surface import CosineSeries, Surface, evaluate_series, nearest_crest, nearest_crests
from weier.theory.profile import Profile

MAX_NODE_RATIO = 0.7  # of the other problem, contacts or gaps, over this one, at which one changes to the other
CELLS_PER_WAVE = 16  # of the finest wave, on the coarse grid
COARSE_TOLERANCE = 1e-3  # in g_0: the grid only has to tell the contacts apart
# Hertz's half-width over the distance between crests: contacts as wide as 0.5 would touch and have to be merged.
MAX_HERTZ_WIDTH = 0.4
MIN_PRESSURE = 1e-3  # over a contact's largest, at nodes where the grid has none


class InitialGuess(NamedTuple):
    """Segments, phi at their nodes and the approach, as in `ContactState`."""

    dual: bool
    segments: Segments
    phi: Array
    approach: float


def sort_segments(
    series: CosineSeries, crest: Indices, centre: Array, half_width: Array, node_count: Indices | None = None
) -> tuple[Segments, Indices]:
    """Segments in order round the period, and the permutation that sorted them; node counts are estimated if None."""
    if not np.all(half_width > 0):
        raise ConvergenceError("a contact or a gap has lost its width")
    origin = series.crest_position[crest]
    origin = origin - series.period * np.floor((origin + centre) / series.period)
    order = np.argsort(origin + centre, kind="stable")
    layout = origin[order], centre[order], half_width[order]
    count = estimate_node_count(*layout, series) if node_count is None else node_count[order]
    return make_segments(crest[order], *layout, count, series.period), order


def transfer_density(
    surface: Surface,
    state: ContactState,
    crest: Indices,
    centre: Array,
    half_width: Array,
    node_count: Indices | None = None,
) -> tuple[InitialGuess, Indices]:
    """A guess on other segments from the density of a state, and the permutation that sorted the segments."""
    series = surface.series(state.dual)
    if crest.size == 0:
        raise ConvergenceError(f"no contact is left under the mean pressure {state.load:.6g} p_0*")
    new, order = sort_segments(series, crest, centre, half_width, node_count)
    phi = sample_density(state, series, new, False)
    for j in range(new.centre.size):  # the Jacobian of a segment without any density would be singular
        here = slice(new.first_node[j], new.first_node[j + 1])
        if not np.any(phi[here]):
            phi[here] = hertz_density(state.dual, 1.0, new.half_width[j], here.stop - here.start)
    return InitialGuess(state.dual, new, phi, state.approach), order


def keep_segments(surface: Surface, state: ContactState, keep: Flags) -> InitialGuess:
    """A guess on some of the segments of a state."""
    old = state.segments
    return transfer_density(surface, state, old.crest[keep], old.centre[keep], old.half_width[keep])[0]


def add_nodes(surface: Surface, state: ContactState, tolerance: float) -> InitialGuess | None:
    """A guess with more nodes where the coefficients have not decayed to the tolerance; None if all have."""
    old = state.segments
    node_count = increase_node_count(old, state.coefficient, state.load, tolerance)
    if node_count is None:
        return None
    return transfer_density(surface, state, old.crest, old.centre, old.half_width, node_count)[0]


@kernel
def sample_density(state: ContactState, series: CosineSeries, new: Segments, complementary: bool) -> Array:
    """phi at the nodes of other segments, from the density of a state or from that of the other problem."""
    phi = np.empty(new.node.size)
    for j in range(new.centre.size):
        for q in range(new.first_node[j], new.first_node[j + 1]):
            s = new.node[q]
            y = new.centre[j] + new.half_width[j] * s
            if complementary:
                value = complementary_density(state, series, *nearest_crest(series, new.origin[j] + y))
            else:
                value = density(state, series.period, new.origin[j], y)
            phi[q] = value / np.sqrt((1 - s) * (1 + s))
    return phi


def choose_problem(surface: Surface, guess: InitialGuess, load: float) -> InitialGuess:
    """The same guess for contacts or for gaps, whichever is expected to need clearly fewer nodes.

    Two expectations are compared. The nodes that were found to be needed are more, and a comparison with them would
    lead from each problem to the other and back again.
    """
    this = guess.segments
    if np.any(distances_to_next(this, surface.heights.period) <= 0):
        return guess
    other = _segments_between(surface, this, not guess.dual)
    expected = estimate_node_count(this.origin, this.centre, this.half_width, surface.series(guess.dual))
    if other.node.size > MAX_NODE_RATIO * expected.sum():
        return guess
    phi = sample_density(state_of_guess(guess, load), surface.series(guess.dual), other, True)
    maximum = surface.heights.maximum
    return InitialGuess(not guess.dual, other, phi, guess.approach + (maximum if guess.dual else -maximum))


def state_of_guess(guess: InitialGuess, load: float) -> ContactState:
    """A guess as a state, to evaluate its density; it has no sensitivity."""
    coefficient = expand(guess.segments, guess.phi)
    return ContactState(guess.dual, load, guess.approach, guess.segments, guess.phi, coefficient, np.zeros(0), np.nan)


def _segments_between(surface: Surface, old: Segments, dual: bool) -> Segments:
    """The intervals between segments as segments of the other problem."""
    series = surface.series(dual)
    distance = distances_to_next(old, series.period)
    middle = old.origin + (old.centre + old.half_width) + 0.5 * distance
    return sort_segments(series, *nearest_crests(series, middle), 0.5 * distance)[0]


def hertz_density(dual: bool, curvature: float, half_width: float, node_count: int) -> Array:
    """phi of a segment so small that its neighbours do not matter.

    That is Hertz's contact, where `curvature` is -z''; or the gap where the pressure of full contact is a parabola in
    tension, and `curvature` its second derivative (dual).
    """
    if dual:
        return -np.pi * curvature * half_width**2 * nodes(node_count)
    return np.full(node_count, curvature * half_width / (2 * np.pi))


def hertz_guess(surface: Surface, load: float, dual: bool) -> InitialGuess:
    """Contacts of half-width 2 sqrt(p L/|z''|) on the highest crests, or gaps where tension is largest (dual)."""
    series = surface.series(dual)
    highest = np.flatnonzero(series.crest_offset == 0)
    curvature = np.array([-evaluate_series(series, int(j), 0.0)[2] for j in highest])
    force = series.maximum - load if dual else load * series.period / highest.size
    half_width = np.minimum(2 * np.sqrt(force / curvature), MAX_HERTZ_WIDTH * series.period / highest.size)
    new, order = sort_segments(series, highest, np.zeros(highest.size), half_width)
    count = np.diff(new.first_node)
    phi = [hertz_density(dual, curvature[order[j]], new.half_width[j], count[j]) for j in range(highest.size)]
    return InitialGuess(dual, new, np.concatenate(phi), 0.0)


def coarse_grid_guess(profile: Profile, surface: Surface, load: float) -> InitialGuess:
    """Contacts wherever boundary elements on a coarse grid find pressure."""
    p = _coarse_grid_pressure(profile, load)
    h, series = profile.period / p.size, surface.heights
    starts, ends = _runs(p > 0)
    if starts.size == 0:
        raise ConvergenceError(f"a coarse grid shows no gap under the mean pressure {load:.6g} p_0*")
    middle = np.asarray(0.5 * h * (starts + ends), float)
    half_width = np.asarray(0.5 * h * (ends - starts + 1), float)
    new, _ = sort_segments(series, *nearest_crests(series, middle), half_width)
    count, s = np.diff(new.first_node), new.node
    x = np.repeat(new.origin + new.centre, count) + np.repeat(new.half_width, count) * s
    value = np.interp(x, np.arange(p.size) * h, p, period=profile.period)  # one call, for each sorts the whole grid
    least = np.repeat(MIN_PRESSURE * np.maximum.reduceat(value, new.first_node[:-1]), count)
    return InitialGuess(False, new, np.maximum(value, least) / np.sqrt((1 - s) * (1 + s)), 0.0)


def _runs(contact: Flags) -> tuple[Indices, Indices]:
    """First and last grid point of each run in contact, round the period: a last one may lie beyond its end."""
    starts = np.flatnonzero(contact & ~np.roll(contact, 1))
    ends = np.flatnonzero(contact & ~np.roll(contact, -1))
    if starts.size > 0 and ends[0] < starts[0]:
        ends = np.append(ends[1:], ends[0] + contact.size)
    return starts, ends


def _coarse_grid_pressure(profile: Profile, load: float) -> Array:
    hierarchy = nested_grids(profile, CELLS_PER_WAVE * profile.waves_per_period[-1], COARSE_TOLERANCE)
    state = fft.make_grid_state(hierarchy.points[-1])
    fft.cascade(load, hierarchy, full_contact(hierarchy, load), state)
    return state.pressure
