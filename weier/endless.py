"""The whole series, m = inf: its coarse terms resolved, all finer ones as the non-linear layer under each point.

The first k waves are solved by boundary elements on a layer that yields by w(p) = g_k W(p/p_k*), where W is the
layer model's law of the endless series (4.3), the fixed point of one level. At every node

    w(p) + A p = z - flat  where p > 0,    z - A p - flat < 0  where p = 0,

and one number s at a node says both: s = w(p) + c p in contact, the negative gap outside, so that w, p and their
slopes are continuous in s and Newton's method needs no set of active nodes. For k = 1 this is the layer model itself;
the more terms are resolved, the less is left to it. Beside it stand the bounds theorem's rigorous limits, which a
plain grid finds for more terms than the layer can be laid under.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are used: a tenth of a second each, that few jobs need
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from weier import bem, dataset, laws, layer
from weier.bem.curve import checked_points
from weier.bounds import complete_bounds
from weier.errors import ConvergenceError
from weier.halfplane import eigenvalues, influence_coefficients
from weier.loads import checked_loads
from weier.profile import Profile
from weier.terms import truncated

Array = NDArray[np.float64]

POINTS_PER_WAVE = 32  # of the finest resolved wave: within 9e-4 of its amplitude, as the layer rounds the edges
MOST_POINTS = 2**14  # more take minutes
NEWTON_STEPS = 60
STEP_ACCURACY, RATE_ACCURACY = 1e-6, 1e-9  # relative residuals of the linear equations of a step, of dh/dp
DIRECTIONS, RESTARTS = 80, 10  # of GMRES: some tens of directions reach these residuals
TOLERANCE = 1e-9  # of the residual, in g_0
BOUND_SHARE = 0.1  # of the tail's amplitude, that boundary elements may be off when they find the bounds
MOST_BOUND_POINTS = 2**20
ROWS = 400  # of the law's table
LIGHTEST, HEAVIEST = 1e-9, 1e3  # loads of the table, in p_k*: beyond, power laws
LOADS = 1e-6, 1e3  # p_0*: lighter ones drown in the tolerance, heavier ones leave the table


class Curve(NamedTuple):
    """The endless series over the loads, each of shape (loads,).

    compliance : best estimate of h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp of it, in g_0/p_0*
    compliance_lower, compliance_upper : bounds on h from the resolved terms alone (27), as much wider as
        boundary elements may be off
    residual : largest violation of the equations, in g_0
    """

    compliance: Array
    resistance: Array
    compliance_lower: Array
    compliance_upper: Array
    residual: Array


class TooManyPointsError(ValueError):
    """So many resolved terms take more points than there may be."""


class Law(NamedTuple):
    """The layer at a node of self-influence c: ln p over ln(w + c p), and c."""

    log_pressure: scipy.interpolate.PchipInterpolator
    stiffness: float


class Node(NamedTuple):
    """Pressure, compression or negative gap, and their slopes, at every s."""

    pressure: Array
    compression: Array
    pressure_slope: Array
    compression_slope: Array


def curve(profile: Profile, mean_pressure: ArrayLike, terms: int, points: int | None = None) -> Curve:
    """Best estimate of the endless series from its first terms, with bounds beside it.

    Parameters
    ----------
    profile : Profile
        With m = inf.
    mean_pressure : array_like, shape (loads,)
        Increasing, in p_0*.
    terms : int
        Waves to resolve, at least 1.
    points : int, optional
        Nodes in a period of the resolved waves; 32 for each of the finest unless told.

    Returns
    -------
    Curve
        Arrays over the loads.

    Raises
    ------
    ValueError
        If the series ends, or takes more than 2^14 points, or a load lies outside [1e-6, 1e3].
    ConvergenceError
        If Newton's method stops short of 1e-9 g_0.
    """
    loads = _checked_loads(mean_pressure)
    kept, points = _checked(profile, terms, points)
    law = _law(kept, float(influence_coefficients(points, kept.period)[0]))
    h, R, residual = _solve_loads(kept, loads, points, law)
    return Curve(h, R, *bounds(profile, loads, terms), residual)


def bounds(profile: Profile, mean_pressure: ArrayLike, terms: int) -> tuple[Array, Array]:
    """Bounds on the compliance of the endless series, from its first terms by boundary elements.

    Parameters
    ----------
    profile : Profile
        With m = inf.
    mean_pressure : array_like, shape (loads,)
        Increasing, in p_0*.
    terms : int
        Waves to resolve.

    Returns
    -------
    lower, upper : ndarray, shape (loads,)
        In g_0, from 0 to full contact, h = sum g_n.

    Raises
    ------
    ValueError
        If the series ends, or takes more than 2^20 points.
    ConvergenceError
        If boundary elements miss their tolerance.

    Notes
    -----
    They are [h_k, h_k + 2 G_k] with G_k the amplitude of the tail (27), as much wider as boundary elements may be
    off. The theorem is proved, and so is what a grid misses at first touch, z'' dx^2/8; that it is off by no more
    under load was measured (`python -m benchmarks.planned`).
    """
    _check_endless(profile)
    kept = truncated(profile, terms)
    tail = kept.tail_amplitude
    points, miss = laws.bem_points(kept, BOUND_SHARE * tail, "compliance"), BOUND_SHARE * tail
    if points > MOST_BOUND_POINTS:
        raise TooManyPointsError(
            f"terms must be fewer, got {terms}: {points} points are more than {MOST_BOUND_POINTS}"
        )
    h = bem.curve(kept, checked_loads(mean_pressure), points=points, tolerance=miss / 10, resistance=False).compliance
    off = laws.bem_compliance_error(kept, points) + laws.RESIDUAL * miss / 10
    return complete_bounds(h, tail, profile.total_amplitude, off)


def convergence(profiles: Sequence[Profile], mean_pressure: ArrayLike, most_terms: int) -> xr.Dataset:
    """The estimate and its bounds with 1, 2, ... resolved terms.

    Parameters
    ----------
    profiles : sequence of Profile
        With m = inf.
    mean_pressure : array_like, shape (loads,)
        Increasing, in p_0*.
    most_terms : int
        Waves to resolve in the last of them.

    Returns
    -------
    Dataset
        As that of a scene, with "1 resolved", "2 resolved" ... for methods. Where only the bounds are within reach
        there is no estimate, and where neither is, the status says so.

    Raises
    ------
    ValueError
        If a series ends, or a load lies outside [1e-6, 1e3].

    """
    loads = checked_loads(mean_pressure)
    names = [f"{count} resolved" for count in range(1, most_terms + 1)]
    data = dataset.blank(len(profiles), names, loads, most_terms)
    for case, profile in enumerate(profiles):
        values = {"D": profile.D, "gamma": float(profile.gamma), "m": profile.m, "tail_amplitude": 0.0}
        for name, value in {**values, "total_amplitude": profile.total_amplitude}.items():
            data[name].values[case] = value
        data["phase"].values[case] = truncated(profile, most_terms).phase
        for row in range(most_terms):
            _resolve_into(data, (case, row), profile, loads)
    return data


def _resolve_into(data: xr.Dataset, place: tuple[int, int], profile: Profile, loads: Array) -> None:
    """The estimate with its bounds, or the bounds alone where there are too many points for it."""
    terms = place[1] + 1
    points = POINTS_PER_WAVE * truncated(profile, terms).wavenumber[-1]
    try:
        if points <= MOST_POINTS:
            found = curve(profile, loads, terms)._asdict()
            data["points"].values[place] = points
        else:
            found = dict(zip(("compliance_lower", "compliance_upper"), bounds(profile, loads, terms), strict=True))
    except ConvergenceError as error:
        print(f"{profile.describe()}, {terms} resolved: {error}", file=sys.stderr)
        data["status"].values[place] = dataset.Status.not_converged
        return
    except TooManyPointsError:
        data["status"].values[place] = dataset.Status.not_applicable
        return
    for name, values in found.items():
        data[name].values[place] = values
    data["status"].values[place] = dataset.Status.solved


def _check_endless(profile: Profile) -> None:
    if math.isfinite(profile.m):
        raise ValueError(f"m must be inf, got {profile.m}: a finite series has no endless tail")


def _checked(profile: Profile, terms: int, points: int | None) -> tuple[Profile, int]:
    _check_endless(profile)
    kept = truncated(profile, terms)
    points = checked_points(kept, points or POINTS_PER_WAVE * kept.wavenumber[-1])
    if points > MOST_POINTS:
        raise ValueError(f"terms must be fewer, got {terms}, which take {points} points, more than {MOST_POINTS}")
    return kept, points


def _checked_loads(mean_pressure: ArrayLike) -> Array:
    loads = checked_loads(mean_pressure)
    outside = (loads < LOADS[0]) | (loads > LOADS[1])
    if outside.any():
        raise ValueError(
            f"mean_pressure must lie in [{LOADS[0]:g}, {LOADS[1]:g}] p_0* where terms are resolved on the layer, got "
            f"{loads[outside][0]:g}: take method layer"
        )
    return loads


def _law(kept: Profile, stiffness: float) -> Law:
    """The tail's layer, in the units of the first wave."""
    D, gamma, n = kept.D, float(kept.gamma), kept.terms
    xi = np.geomspace(LIGHTEST, HEAVIEST, ROWS)
    amplitude, pressure = gamma ** ((D - 2) * n), xi * gamma ** ((D - 1) * n)
    compression = amplitude * layer.compliance(xi, D, gamma, math.inf)
    log_pressure = scipy.interpolate.PchipInterpolator(np.log(compression + stiffness * pressure), np.log(pressure))
    return Law(log_pressure, stiffness)


def _state_of_nodes(s: Array, law: Law) -> Node:
    inside = s > 0
    log_s = np.log(np.where(inside, s, 1.0))
    near = np.clip(log_s, *law.log_pressure.x[[0, -1]])
    slope = law.log_pressure(near, 1)
    p = np.where(inside, np.exp(law.log_pressure(near) + slope * (log_s - near)), 0.0)
    p_slope = np.where(inside, slope * p / np.where(inside, s, 1.0), 0.0)
    return Node(p, s - law.stiffness * p, p_slope, 1 - law.stiffness * p_slope)


def _solve_loads(kept: Profile, loads: Array, points: int, law: Law) -> tuple[Array, Array, Array]:
    """Compliance, resistance and residual, from the heaviest load down, each started from the one before."""
    z, sinking = kept.sampled_height(points), eigenvalues(points, kept.period)
    h, R, miss = np.zeros((3, loads.size))
    state = _start(z, sinking, float(loads[-1]), law)
    for i in reversed(range(loads.size)):
        state, miss[i] = _newton(state, z, sinking, float(loads[i]), law)
        h[i] = kept.total_amplitude - state[-1]
        # By how much the flat sinks is the equations' answer to a unit of load.
        unit = np.append(np.zeros(points), 1.0)
        rate = _newton_step(_state_of_nodes(state[:-1], law), sinking, unit, RATE_ACCURACY)[-1]
        R[i] = max(-rate, 0.0)  # close to full contact the rate is below its own accuracy, of either sign
    return h, R, miss


def _start(z: Array, sinking: Array, load: float, law: Law) -> Array:
    """A state from full contact under this load: s at every node, then the flat."""
    spectrum = np.fft.rfft(z)
    spectrum[1:] /= sinking[1:]
    spectrum[0] = load * z.size
    p = np.fft.irfft(spectrum, z.size)
    return np.append(law.stiffness * p, 0.0)


def _newton(state: Array, z: Array, sinking: Array, load: float, law: Law) -> tuple[Array, float]:
    """Newton's method from this state: the solution, and its residual in g_0."""
    for _ in range(NEWTON_STEPS):
        node = _state_of_nodes(state[:-1], law)
        wrong = np.append(
            node.compression + _sunk(node.pressure, sinking) - z + state[-1], node.pressure.mean() - load
        )
        miss = float(np.max(np.abs(wrong)))
        if miss <= TOLERANCE:
            return state, miss
        state = state - _newton_step(node, sinking, wrong, STEP_ACCURACY)
    raise ConvergenceError(
        f"the resolved terms on the layer stopped at a residual of {miss:.1e} g_0 under the mean pressure {load:.6g} "
        f"p_0*, above {TOLERANCE:.0e}: resolve fewer terms",
        miss,
    )


def _sunk(pressure: Array, sinking: Array) -> Array:
    """A p by FFT."""
    return np.asarray(np.fft.irfft(np.fft.rfft(pressure) * sinking, pressure.size))


def _newton_step(node: Node, sinking: Array, right: Array, accuracy: float) -> Array:
    """The linear equations of a Newton step, by GMRES, preconditioned by those of a uniform layer.

    [diag(dw/ds) + A diag(dp/ds), 1; mean of dp/ds, 0] [ds; dflat] = right
    """
    n, yielding, bearing = right.size - 1, float(node.compression_slope.mean()), float(node.pressure_slope.mean())

    def equations(x: Array) -> Array:
        p = node.pressure_slope * x[:-1]
        return np.append(node.compression_slope * x[:-1] + _sunk(p, sinking) + x[-1], p.mean())

    def uniform(r: Array) -> Array:
        spectrum = np.fft.rfft(r[:-1])
        spectrum[1:] /= yielding + bearing * sinking[1:]
        flat = spectrum[0].real / n - yielding * r[-1] / bearing
        spectrum[0] = n * r[-1] / bearing
        return np.append(np.fft.irfft(spectrum, n), flat)

    size = (n + 1, n + 1)
    operator = scipy.sparse.linalg.LinearOperator
    found, _ = scipy.sparse.linalg.gmres(
        operator(size, equations), right, rtol=accuracy, atol=0.0, restart=DIRECTIONS, maxiter=RESTARTS,
        M=operator(size, uniform),
    )  # fmt: skip
    return np.asarray(found)
