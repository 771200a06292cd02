"""A solution and its values anywhere: pressure, gap and displacement from the densities, exact up to the edges."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.jit import kernel
from weier.patches.chebyshev import coefficients, integrals, partial_integral, series
from weier.patches.collocation import Segments
from weier.patches.waves import Waves, excess

Array = NDArray[np.float64]

FAR = 6.0  # half-widths from the centre, beyond which the quadrature is exact: rho^(-2K) < 1e-16 for K >= 8
SMALL_ANGLE = 1e-3


class State(NamedTuple):
    """A solution under one mean pressure: contacts with their pressure, or (dual) gaps with their slope.

    `coefficient` holds those of phi in U_k, segment by segment; `sensitivity` the derivatives of all
    unknowns in the mean pressure, in the order of the collocation equations.
    """

    dual: bool
    load: float
    approach: float
    segments: Segments
    phi: Array
    coefficient: Array
    sensitivity: Array


@kernel
def expand(segments: Segments, phi: Array) -> Array:
    """Coefficients of phi in U_k, segment by segment."""
    a = np.empty(phi.size)
    for j in range(segments.centre.size):
        part = coefficients(phi[segments.first[j] : segments.first[j + 1]])
        for k in range(part.size):
            a[segments.first[j] + k] = part[k]
    return a


@kernel
def local(segments: Segments, j: int, period: float, origin: float, y: float) -> float:
    """The point origin + y in the coordinate of segment j, -1..1 on it, nearest image."""
    d = origin - segments.origin[j] + (y - segments.centre[j])
    return (d - period * np.rint(d / period)) / segments.half_width[j]


@kernel
def transforms(state: State, period: float, origin: float, y: float) -> tuple[float, float]:
    """int rho cot(pi (x-s)/L) ds and int rho ln|2 sin(pi (x-s)/L)| ds at x = origin + y, any x."""
    cauchy, potential = 0.0, 0.0
    segments = state.segments
    factor = np.pi / period
    for j in range(segments.centre.size):
        t = local(segments, j, period, origin, y)
        if abs(t) > FAR:
            r = segments.half_width[j]
            c, s = np.cos(factor * r * t), np.sin(factor * r * t)
            for q in range(segments.first[j], segments.first[j + 1]):
                sine = s * segments.cosine[q] - c * segments.sine[q]
                share = r * segments.weight[q] * state.phi[q]
                cauchy += share * (c * segments.cosine[q] + s * segments.sine[q]) / sine
                potential += share * np.log(abs(2 * sine))
        else:
            near = _near(state, j, t, period)
            cauchy += near[0]
            potential += near[1]
    return cauchy, potential


@kernel
def _near(state: State, j: int, t: float, period: float) -> tuple[float, float]:
    # The segment and its two neighbouring images in closed form, what is left of the kernels by quadrature.
    segments = state.segments
    r = segments.half_width[j]
    here = slice(segments.first[j], segments.first[j + 1])
    a = state.coefficient[here]
    cauchy, potential = 0.0, 0.0
    for image in range(-1, 2):
        c, v = integrals(a, t - image * period / r)
        cauchy += c * period / np.pi
        potential += r * (v + np.log(r) * 0.5 * np.pi * a[0])
    for q in range(segments.first[j], segments.first[j + 1]):
        share = r * segments.weight[q] * state.phi[q]
        c, v = _remainders(r * (t - segments.node[q]), period)
        cauchy += share * c
        potential += share * v
    return cauchy, potential


@kernel
def _remainders(d: float, period: float) -> tuple[float, float]:
    # cot(pi d/L) and ln|2 sin(pi d/L)| less the three poles at d = -L, 0, L; |d| < 1.5 L.
    factor = np.pi / period
    turn = np.rint(d / period)
    angle = factor * (d - turn * period)
    if abs(angle) < SMALL_ANGLE:
        cauchy, potential = -angle / 3, np.log(2 * factor) - angle * angle / 6
    else:
        cauchy, potential = 1 / np.tan(angle) - 1 / angle, np.log(2 * factor * abs(np.sin(angle) / angle))
    for image in range(-1, 2):
        if image != turn:
            cauchy -= 1 / (factor * (d - image * period))
            potential -= np.log(abs(d - image * period))
    return cauchy, potential


@kernel
def density(state: State, period: float, origin: float, y: float) -> float:
    """rho at origin + y: pressure of a contact, slope of a gap (dual); 0 elsewhere."""
    for j in range(state.segments.centre.size):
        t = local(state.segments, j, period, origin, y)
        if abs(t) < 1:
            here = slice(state.segments.first[j], state.segments.first[j + 1])
            return np.sqrt((1 - t) * (1 + t)) * series(state.coefficient[here], t)
    return 0.0


@kernel
def opening(state: State, period: float, origin: float, y: float) -> float:
    """Gap at origin + y of a dual solution."""
    for j in range(state.segments.centre.size):
        t = local(state.segments, j, period, origin, y)
        if abs(t) < 1:
            here = slice(state.segments.first[j], state.segments.first[j + 1])
            return state.segments.half_width[j] * partial_integral(state.coefficient[here], t)
    return 0.0


@kernel
def clearance(state: State, waves: Waves, summit: int, y: float) -> float:
    """Outside the segments: the gap (primal), the pressure (dual). On them it is what must vanish."""
    cauchy, potential = transforms(state, waves.period, waves.place[summit], y)
    value = excess(waves, summit, y)[0]
    if state.dual:
        return state.load - waves.top - value + cauchy / (2 * np.pi * waves.period)
    return -2 * potential - state.approach - value


@kernel
def other_density(state: State, waves: Waves, summit: int, y: float) -> float:
    """The density of the other problem: slope of the gap (primal), pressure (dual)."""
    if state.dual:
        return clearance(state, waves, summit, y)
    cauchy, _ = transforms(state, waves.period, waves.place[summit], y)
    return -2 * np.pi / waves.period * cauchy - excess(waves, summit, y)[1]
