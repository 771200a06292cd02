"""Starts with no neighbour: Hertz's contacts, or those that boundary elements see on a coarse grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.methods.bem import fft
from weier.methods.bem.grids import full_contact, nested_grids
from weier.methods.errors import ConvergenceError
from weier.methods.patches.guess import Guess, arrange
from weier.methods.patches.hertz import hertz
from weier.methods.patches.surface import Surface
from weier.methods.patches.waves import excess, from_summits
from weier.theory.profile import Profile

Array = NDArray[np.float64]

CELLS_PER_WAVE = 16
COARSE_TOLERANCE = 1e-3  # in g_0: contacts are only to be told apart
ROOM = 0.4  # for Hertz's half-width, of the way from crest to crest: touching at 0.5, they would have to merge
LEAST_PRESSURE = 1e-3  # of a contact's largest, at nodes where the grid has none


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


def coarse_start(profile: Profile, surface: Surface, load: float) -> Guess:
    """Contacts wherever boundary elements find pressure."""
    p = _coarse_pressure(profile, load)
    h, waves = profile.period / p.size, surface.heights
    contact = p > 0
    starts = np.flatnonzero(contact & ~np.roll(contact, 1))
    ends = np.flatnonzero(contact & ~np.roll(contact, -1))
    if starts.size == 0:
        raise ConvergenceError(f"boundary elements see no gap under the mean pressure {load:.6g} p_0*")
    ends = np.where(ends[0] < starts[0], np.append(ends[1:], ends[0] + p.size), ends)
    middle = np.asarray(0.5 * h * (starts + ends), float)
    new, _ = arrange(waves, *from_summits(waves, middle), np.asarray(0.5 * h * (ends - starts + 1), float))
    count, s = np.diff(new.first), new.node
    x = np.repeat(new.origin + new.centre, count) + np.repeat(new.half_width, count) * s
    value = np.interp(x, np.arange(p.size) * h, p, period=profile.period)  # at once: each call sorts the whole grid
    least = np.repeat(LEAST_PRESSURE * np.maximum.reduceat(value, new.first[:-1]), count)
    return Guess(False, new, np.maximum(value, least) / np.sqrt((1 - s) * (1 + s)), 0.0)


def _coarse_pressure(profile: Profile, load: float) -> Array:
    hierarchy = nested_grids(profile, CELLS_PER_WAVE * profile.wavenumber[-1], COARSE_TOLERANCE)
    state = fft.make_state(hierarchy.points[-1])
    fft.descend(load, hierarchy, full_contact(hierarchy, load), state)
    return state.pressure
