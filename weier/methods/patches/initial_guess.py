"""Where Newton's method starts on a set of segments, and how a density is carried to another set."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.chebyshev import nodes
from weier.methods.patches.defect_correction import own_density
from weier.methods.patches.fields import ContactState, density
from weier.methods.patches.products import residuals
from weier.methods.patches.segments import Segments, distances_to_next, estimate_node_count, make_segments
from weier.methods.patches.surface import CosineSeries, Surface, nearest_crests

MAX_NODE_RATIO = 0.7  # of the gaps over the contacts, at which the gaps are solved for
COARSE_TOLERANCE = 1e-3  # of the density on the few nodes that Newton's method solves for
OWN_ROUNDS = 2  # of finding each segment's density under the others


class InitialGuess(NamedTuple):
    """Segments, phi at their nodes and the approach, as in `ContactState`."""

    dual: bool
    segments: Segments
    phi: Array
    approach: float


class Intervals(NamedTuple):
    """Intervals by the index of a crest, centre from there and half-width, each of shape (intervals,)."""

    crest: Indices
    centre: Array
    half_width: Array


def sort_segments(
    series: CosineSeries,
    intervals: Intervals,
    tolerance: float = COARSE_TOLERANCE,
    node_count: Indices | None = None,
) -> tuple[Segments, Indices]:
    """Segments in order round the period, and the permutation that sorted them.

    They have so many nodes, or else as many as a density within the tolerance is expected to need.
    """
    crest, centre, half_width = intervals
    if not np.all(half_width > 0):
        raise ConvergenceError("a contact or a gap has lost its width")
    origin = series.crest_position[crest]
    origin = origin - series.period * np.floor((origin + centre) / series.period)
    order = np.argsort(origin + centre, kind="stable")
    layout = origin[order], centre[order], half_width[order]
    count = estimate_node_count(*layout, series, tolerance) if node_count is None else node_count[order]
    return make_segments(crest[order], *layout, count, series.period), order


def contacts_guess(
    surface: Surface, middle: Array, half_width: Array, force: Array, tolerance: float
) -> InitialGuess:
    """A guess on contacts, or on the gaps between them if these need clearly fewer nodes; the density is rough.

    middle, half_width : of the contacts, in lambda_0, shape (contacts,)
    force : that each carries, in p_0* lambda_0, shape (contacts,)
    """
    contacts, order = sort_segments(surface.heights, Intervals(*nearest_crests(surface.heights, middle), half_width))
    distance = distances_to_next(contacts, surface.heights.period)
    if np.all(distance > 0):
        end = contacts.origin + (contacts.centre + contacts.half_width)
        gaps = nearest_crests(surface.tensions, end + 0.5 * distance)
        segments, _ = sort_segments(surface.tensions, Intervals(*gaps, 0.5 * distance))
        needed = [
            estimate_node_count(each.origin, each.centre, each.half_width, series, tolerance).sum()
            for each, series in ((contacts, surface.heights), (segments, surface.tensions))
        ]
        if needed[1] < MAX_NODE_RATIO * needed[0]:
            return InitialGuess(True, segments, np.zeros(segments.node.size), 0.0)
    phi = 2 / np.pi * force[order] / contacts.half_width
    return InitialGuess(False, contacts, np.repeat(phi, np.diff(contacts.first_node)), 0.0)


def refine_density(surface: Surface, guess: InitialGuess, load: float) -> InitialGuess:
    """The guess with the density that each segment takes under those of the others."""
    series = surface.series(guess.dual)
    for _ in range(OWN_ROUNDS):
        row = residuals(guess.segments, guess.phi, guess.approach, series, load, guess.dual)
        guess = guess._replace(phi=guess.phi - own_density(row, guess.segments, series.period))
    return guess


def transfer_density(surface: Surface, state: ContactState, node_count: Indices | None = None) -> InitialGuess:
    """A guess on the segments of a state, with so many nodes each, or as few as a guess has."""
    series, old = surface.series(state.dual), state.segments
    intervals = Intervals(old.crest, old.centre, old.half_width)
    new, _ = sort_segments(series, intervals, COARSE_TOLERANCE, node_count)
    return InitialGuess(state.dual, new, sample_density(state, series, new), state.approach)


@kernel
def sample_density(state: ContactState, series: CosineSeries, new: Segments) -> Array:
    """phi at the nodes of other segments, from the density of a state."""
    phi = np.empty(new.node.size)
    for j in range(new.centre.size):
        for q in range(new.first_node[j], new.first_node[j + 1]):
            s = new.node[q]
            y = new.centre[j] + new.half_width[j] * s
            phi[q] = density(state, series.period, new.origin[j], y) / np.sqrt((1 - s) * (1 + s))
    return phi


def hertz_density(dual: bool, curvature: float, half_width: float, node_count: int) -> Array:
    """phi of a segment so small that its neighbours do not matter.

    That is Hertz's contact, where `curvature` is -z''; or the gap where the pressure of full contact is a parabola in
    tension, and `curvature` its second derivative (dual).
    """
    if dual:
        return -np.pi * curvature * half_width**2 * nodes(node_count)
    return np.full(node_count, curvature * half_width / (2 * np.pi))
