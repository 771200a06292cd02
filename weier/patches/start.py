"""A start with no neighbour: contacts seen by boundary elements on a coarse grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.bem import fft
from weier.bem.grids import full_contact, nested_grids
from weier.errors import ConvergenceError
from weier.patches.guess import Guess, Surface, arrange
from weier.patches.waves import from_summits
from weier.profile import Profile

Array = NDArray[np.float64]

CELLS_PER_WAVE = 16
COARSE_TOLERANCE = 1e-3  # in g_0: contacts are only to be told apart
LEAST_PRESSURE = 1e-3  # of a contact's largest, at nodes where the grid has none


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
