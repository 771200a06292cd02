"""Where contacts are, to start from: the waves of the series are added one by one.

The contacts of the first k waves are known well enough after a few steps on their edges. The next wave, which is much
shorter, sees their pressure as a mean pressure that varies slowly, and under this each of its crests or troughs is
Westergaard's: in contact on arcsin(sqrt(xi))/pi of a wavelength on either side of a crest, with xi the mean pressure
over the wave's pressure of full contact (10). No grid is solved on, and the time is that of a single step for the
whole series.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.edge_iteration import Stage, Step, make_guess, next_guess, take_step
from weier.theory.profile import Profile

STEPS_PER_WAVE = 5  # at most; 2 or 3 are usual
MIN_XI, MAX_XI = 1e-4, 0.98  # that an edge is placed by: a contact on a crest is not empty, a gap in a trough is open
MIN_PRESSURE = 1e-12  # mean pressure of a crest in contact, over the wave's pressure of full contact


def wave_by_wave(profile: Profile, load: float, stage: Stage) -> tuple[Array, Array]:
    """Left and right edges of the contacts to start from, each of shape (contacts,), in lambda_0."""
    state: Step | None = None
    edges = None
    for terms in range(1, profile.terms + 1):
        part = profile.truncated(terms)
        edges = _add_wave(part, _force_left_of(part, load, state))
        if edges is None and state is not None:
            raise ConvergenceError(f"no gap is left between the contacts of {terms} waves under {load:.6g} p_0*")
        if edges is not None and terms < profile.terms:
            state = _few_steps(part, load, edges, stage)
    if edges is None:
        raise ConvergenceError(f"contact is full under the mean pressure {load:.6g} p_0*, or nearly so")
    return edges


def _few_steps(profile: Profile, load: float, edges: tuple[Array, Array], stage: Stage) -> Step:
    guess = make_guess(profile, *edges, stage)
    for _ in range(STEPS_PER_WAVE):
        step = take_step(profile, load, guess, stage)
        if step.settled:
            break
        guess = next_guess(profile, step, stage)
    return step


def _force_left_of(profile: Profile, load: float, state: Step | None) -> Callable[[Array], Array]:
    """The integral of the pressure of all waves but the last, in p_0* lambda_0; without a state, of full contact."""
    if state is not None:
        old, b = state.punches, state.b
        return lambda x: force_left_of(old.centre, old.half_width, old.first_node, b, x, old.period)
    wavenumber = 2 * np.pi * np.array(profile.waves_per_period[:-1], float) / float(profile.period)
    amplitude, phase = profile.full_contact_pressure[:-1] / wavenumber, profile.phase[:-1]
    return lambda x: load * x + np.sin(x[:, None] * wavenumber + phase) @ amplitude


def _add_wave(profile: Profile, force_left_of: Callable[[Array], Array]) -> tuple[Array, Array] | None:
    """The edges of contact with the last wave; None if contact is full."""
    waves, period = profile.waves_per_period[-1], float(profile.period)
    length = period / waves
    crest = (np.arange(waves) - profile.phase[-1] / (2 * np.pi)) * length

    def xi(x: Array) -> Array:
        force = force_left_of(x + 0.5 * length) - force_left_of(x - 0.5 * length)
        return np.asarray(force / (length * profile.full_contact_pressure[-1]))

    touching, open_right = xi(crest) > MIN_PRESSURE, xi(crest + 0.5 * length) < 1
    left = crest - _westergaard(xi(crest - 0.25 * length), length)
    right = crest + _westergaard(xi(crest + 0.25 * length), length)
    return _join(touching, open_right, left, right, period)


def _westergaard(xi: Array, length: float) -> Array:
    """Half-width of contact on a crest (10)."""
    return np.asarray(length / np.pi * np.arcsin(np.sqrt(np.clip(xi, MIN_XI, MAX_XI))))


def _join(touching: Flags, open_right: Flags, left: Array, right: Array, period: float) -> tuple[Array, Array] | None:
    """Contacts from the crests that touch, as one where no gap is open between two of them."""
    ends = np.flatnonzero(touching & (open_right | ~np.roll(touching, -1)))
    starts: Indices = np.flatnonzero(touching & (np.roll(open_right, 1) | ~np.roll(touching, 1)))
    if ends.size == 0:
        return None
    start, end = left[starts], right[ends]
    if ends[0] < starts[0]:
        end = np.append(end[1:], end[0] + period)
    return start, end


@kernel
def force_left_of(centre: Array, half_width: Array, first_node: Indices, b: Array, x: Array, period: float) -> Array:
    """The force between the first left edge and x, for coefficients b of psi in T_k; any x, periodically continued.

    With t = -cos(angle), int_-1^t T_k(s)/sqrt(1-s^2) ds is the angle for k = 0, and else (-1)^k sin(k angle)/k.
    """
    n, force = centre.size, np.empty(x.size)
    left, before = centre - half_width, np.zeros(centre.size + 1)
    for j in range(n):
        before[j + 1] = before[j] + np.pi * half_width[j] * b[first_node[j]]
    for i in range(x.size):
        turns = np.floor((x[i] - left[0]) / period)
        y = x[i] - turns * period
        j = min(max(np.searchsorted(left, y, side="right") - 1, 0), n - 1)
        t = (y - centre[j]) / half_width[j]
        angle = np.arccos(-min(max(t, -1.0), 1.0))
        part, sign = b[first_node[j]] * angle, -1.0
        for k in range(1, first_node[j + 1] - first_node[j]):
            part += sign * b[first_node[j] + k] * np.sin(k * angle) / k
            sign = -sign
        force[i] = before[j] + half_width[j] * part + turns * before[n]
    return force
