"""A start with no neighbour: contacts seen by boundary elements on a coarse grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.bem import fft
from weier.bem.curve import nested_grids
from weier.errors import ConvergenceError
from weier.patches.guess import Guess, Surface, arrange
from weier.patches.waves import nearest_summit, offset
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
    middle = 0.5 * (starts + ends) * h
    summit = np.array([nearest_summit(waves, x) for x in middle])
    centre = np.array([offset(waves, j, x) for j, x in zip(summit, middle, strict=True)])
    new, _ = arrange(waves, summit, centre, 0.5 * (ends - starts + 1) * h)
    phi = np.empty(new.node.size)
    for j in range(new.centre.size):
        here = slice(new.first[j], new.first[j + 1])
        s = new.node[here]
        x = new.origin[j] + new.centre[j] + new.half_width[j] * s
        value = np.interp(x, np.arange(p.size) * h, p, period=profile.period)
        phi[here] = np.maximum(value, LEAST_PRESSURE * value.max()) / np.sqrt((1 - s) * (1 + s))
    return Guess(False, new, phi, 0.0)


def _coarse_pressure(profile: Profile, load: float) -> Array:
    points = CELLS_PER_WAVE * profile.wavenumber[-1]
    hierarchy = nested_grids(profile, points, COARSE_TOLERANCE)
    state = fft.make_state(points)
    for level in range(hierarchy.points.size):
        grid = fft.part_of_hierarchy(hierarchy, level)
        part = fft.part_of_state(state, grid.height.size)
        if level == 0:
            part.pressure[:] = load + np.fft.irfft(grid.inverse * np.fft.rfft(grid.height), grid.height.size)
            part.contact[:] = part.pressure > 0
        else:
            fft.refine(grid.height.size // 2, part)
        fft.solve_load(load, grid, part)
    return part.pressure
