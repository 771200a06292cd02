"""A start with no neighbour: contacts seen by boundary elements on a coarse grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.bem import fft
from weier.bem.grids import full_contact, nested_grids
from weier.errors import ConvergenceError
from weier.patches.guess import Guess, Surface, arrange
from weier.patches.waves import nearest_summits
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
    new, _ = arrange(waves, *nearest_summits(waves, middle), np.asarray(0.5 * h * (ends - starts + 1), float))
    phi = np.empty(new.node.size)
    for j in range(new.centre.size):
        here = slice(new.first[j], new.first[j + 1])
        s = new.node[here]
        x = new.origin[j] + new.centre[j] + new.half_width[j] * s
        value = np.interp(x, np.arange(p.size) * h, p, period=profile.period)
        phi[here] = np.maximum(value, LEAST_PRESSURE * value.max()) / np.sqrt((1 - s) * (1 + s))
    return Guess(False, new, phi, 0.0)


def _coarse_pressure(profile: Profile, load: float) -> Array:
    hierarchy = nested_grids(profile, CELLS_PER_WAVE * profile.wavenumber[-1], COARSE_TOLERANCE)
    state = fft.make_state(hierarchy.points[-1])
    fft.descend(load, hierarchy, full_contact(hierarchy, load), state)
    return state.pressure
