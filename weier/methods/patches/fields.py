"""A solution and its values anywhere: pressure, gap and displacement from the densities, exact up to the edges."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.jit import kernel
from weier.methods.patches.chebyshev import coefficients, integrals, partial_integral, series
from weier.methods.patches.segments import Segments
from weier.methods.patches.waves import Waves, excess, from_summit

Array = NDArray[np.float64]

SMALL_ANGLE = 1e-3


class State(NamedTuple):
    """A solution under one mean pressure: contacts with their pressure, or (dual) gaps with their slope.

    dual : whether the segments are the gaps
    load : mean pressure, in p_0*
    approach : indentation from first contact or, dual, the mean gap with its sign turned, in g_0
    segments : the contacts or, dual, the gaps
    phi : at the nodes, shape (nodes,); sqrt(1-t^2) phi is the pressure, in p_0*, or the slope of the gap, in
        g_0/lambda_0
    coefficient : of phi in U_k, segment by segment, shape (nodes,)
    sensitivity : derivatives of all unknowns in the mean pressure, in the order and the units of the collocation
        equations, shape (nodes + 2 segments + 1,); the last is the resistance, in g_0/p_0*
    residual : largest violation of a contact condition, in g_0; NaN until it has been looked at
    """

    dual: bool
    load: float
    approach: float
    segments: Segments
    phi: Array
    coefficient: Array
    sensitivity: Array
    residual: float


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
def cauchy(state: State, period: float, origin: float, y: float) -> tuple[float, float]:
    """int rho cot(pi (x-s)/L) ds at x = origin + y, any x, and its derivative in x."""
    segments, factor = state.segments, np.pi / period
    value, slope = 0.0, 0.0
    for j in range(segments.centre.size):
        r, t = segments.half_width[j], local(segments, j, period, origin, y)
        if abs(t) > segments.reach[j]:
            s, c = np.sin(factor * r * t), np.cos(factor * r * t)
            for q in range(segments.first[j], segments.first[j + 1]):
                sine, cosine = segments.sine[q], segments.cosine[q]
                cot = (c * cosine + s * sine) / (s * cosine - c * sine)
                share = r * segments.weight[q] * state.phi[q]
                value += share * cot
                slope -= share * factor * (1 + cot * cot)
        else:
            near = _near(state, j, t, period)
            value += near[0]
            slope += near[1]
    return value, slope


@kernel
def potential(state: State, period: float, origin: float, y: float) -> float:
    """int rho ln|2 sin(pi (x-s)/L)| ds at x = origin + y, any x."""
    segments, total = state.segments, 0.0
    for j in range(segments.centre.size):
        r, t = segments.half_width[j], local(segments, j, period, origin, y)
        if abs(t) > segments.reach[j]:
            s, c = np.sin(np.pi / period * r * t), np.cos(np.pi / period * r * t)
            for q in range(segments.first[j], segments.first[j + 1]):
                sine = s * segments.cosine[q] - c * segments.sine[q]
                total += r * segments.weight[q] * state.phi[q] * np.log(abs(2 * sine))
        else:
            total += _near(state, j, t, period)[2]
    return total


@kernel
def _near(state: State, j: int, t: float, period: float) -> tuple[float, float, float]:
    """Cauchy integral, its derivative and the potential of segment j at its own coordinate t.

    The poles of the segment, and of its images on both sides if they are near too, in closed form: with the
    derivative in x = r t, (L/pi) int rho/(x-s) ds and int rho ln|x-s| ds; what `_remainders` leaves by quadrature.
    """
    segments = state.segments
    r = segments.half_width[j]
    here = slice(segments.first[j], segments.first[j + 1])
    a = state.coefficient[here]
    value, slope, logarithm = 0.0, 0.0, 0.0
    images = 0 if period / r - abs(t) > segments.reach[j] else 1
    for image in range(-images, images + 1):
        c, d, v = integrals(a, t - image * period / r)
        value += c * period / np.pi
        slope += d * period / (np.pi * r)
        logarithm += r * (v + np.log(r) * 0.5 * np.pi * a[0])
    for q in range(segments.first[j], segments.first[j + 1]):
        share = r * segments.weight[q] * state.phi[q]
        c, d, v = _remainders(r * (t - segments.node[q]), period, images)
        value += share * c
        slope += share * d
        logarithm += share * v
    return value, slope, logarithm


@kernel
def _remainders(d: float, period: float, images: int) -> tuple[float, float, float]:
    """cot(pi d/L), its derivative and ln|2 sin(pi d/L)|, less the poles at d = 0 and, if asked for, -L and L.

    With a = pi d/L, near a pole cot(a) - 1/a = -a/3 and ln|2 sin(a)| - ln|d| = ln(2 pi/L) - a^2/6.
    """
    factor = np.pi / period
    turn = min(max(np.rint(d / period), -images), images)
    angle = factor * (d - turn * period)
    if abs(angle) < SMALL_ANGLE:
        value, slope, logarithm = -angle / 3, -factor / 3, np.log(2 * factor) - angle * angle / 6
    else:
        sine = np.sin(angle)
        value, slope = np.cos(angle) / sine - 1 / angle, factor * (1 / (angle * angle) - 1 / (sine * sine))
        logarithm = np.log(2 * factor * abs(sine / angle))
    for image in range(-images, images + 1):
        if image != turn:
            apart = d - image * period
            value -= 1 / (factor * apart)
            slope += 1 / (factor * apart * apart)
            logarithm -= np.log(abs(apart))
    return value, slope, logarithm


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
    value, place = excess(waves, summit, y)[0], waves.place[summit]
    if state.dual:
        push = cauchy(state, waves.period, place, y)[0] / (2 * np.pi * waves.period)
        return state.load - waves.top - value + push
    return -2 * potential(state, waves.period, place, y) - state.approach - value


@kernel
def clearance_slope(state: State, waves: Waves, summit: int, y: float) -> float:
    """Its derivative."""
    value, slope = cauchy(state, waves.period, waves.place[summit], y)
    change = slope / (2 * np.pi * waves.period) if state.dual else -2 * np.pi / waves.period * value
    return change - excess(waves, summit, y)[1]


@kernel
def other_density(state: State, waves: Waves, summit: int, y: float) -> float:
    """The density of the other problem: slope of the gap (primal), pressure (dual)."""
    return clearance(state, waves, summit, y) if state.dual else clearance_slope(state, waves, summit, y)


@kernel
def clearances(state: State, waves: Waves, x: Array) -> Array:
    """`clearance` at places x."""
    value = np.empty(x.size)
    for i in range(x.size):
        summit, y = from_summit(waves, x[i])
        value[i] = clearance(state, waves, summit, y)
    return value


@kernel
def clearance_slopes(state: State, waves: Waves, x: Array) -> Array:
    """`clearance_slope` at places x."""
    value = np.empty(x.size)
    for i in range(x.size):
        summit, y = from_summit(waves, x[i])
        value[i] = clearance_slope(state, waves, summit, y)
    return value
