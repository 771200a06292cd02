"""Curves of the non-linear layer model (4.3): compliance and resistance over the loads."""

from __future__ import annotations

import math
from numbers import Real
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array, Indices
from weier.methods import westergaard
from weier.methods.layer.closure import compressions
from weier.methods.layer.model import MIN_TOLERANCE, Model
from weier.methods.layer.rows import BOTTOM_POSITIONS, MIN_LOADS, log_load_at
from weier.theory.series import checked_dimension, checked_terms

POINTS = 24
ACCURACY = 1e-5
TOLERANCE = 1e-10
MIN_POINTS, MAX_POINTS = 4, 500  # 40 loads on 384 take 3 s, and time grows as the cube
MIN_ACCURACY, MAX_ACCURACY = 1e-9, 1e-2  # at the upper one few rows are added to the lattice of a table


class Curve(NamedTuple):
    """Curves of the non-linear layer model; arrays have the shape of the loads.

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*
    residual : largest violation of a contact condition by the coarsest wave, on a freshly applied operator, in g_0
    work : Newton steps for the coarsest wave
    """

    compliance: Array
    resistance: Array
    residual: Array
    work: Indices


def curve(
    mean_pressure: ArrayLike,
    D: float,
    gamma: float,
    m: float,
    points: int = POINTS,
    accuracy: float = ACCURACY,
    tolerance: float = TOLERANCE,
) -> Curve:
    """Compliance and resistance of the non-linear layer model (4.3).

    Parameters
    ----------
    mean_pressure : array_like
        Mean pressures of any shape and order, at least 1e-305, in p_0*.
    D : float
        Fractal dimension, 1 < D < 2.
    gamma : float
        Ratio of successive wavelengths, > 1; any real number will do.
    m : int or inf
        Number of terms.
    points : int
        Nodes on half a wave, 4 to 500.
    accuracy : float
        Largest relative error of the compliance by the tables of all scales together, whatever loads are asked for;
        1e-9 to 0.01. The error of the mesh comes on top: see the notes.
    tolerance : float
        Largest residual of a wave, relative to the compression at the edge of its contact; 1e-13 to `accuracy`.

    Returns
    -------
    Curve
        Arrays of the shape of `mean_pressure`.

    Raises
    ------
    ValueError
        If a parameter lies outside its range.
    ConvergenceError
        If a wave misses the tolerance or a table the accuracy: errors add up over about 1/(1 - gamma^(D-2)) scales at
        heavy loads, and over more at light ones. Or if a series has more than 1000 terms and still differs from the
        infinite one.

    Notes
    -----
    The solution at a load does not depend on the other loads.

    The resistance is the exact derivative of the discrete compliance. With more `points` the error of the
    compliance falls as N^-2 or faster, that of the resistance as N^-1 to N^-2.7 and at times unevenly: the pressure
    has kinks where the layer is pressed flat. With the defaults the compliance is within 5e-6 of the total amplitude
    and the resistance below p_0* within 1.5e-3 of itself, mostly 3e-6 and 6e-4 (135 series with D from 1.1 to 1.9,
    gamma from 2 to 10, m up to 4); where the resistance vanishes, close to full contact, its relative error reaches
    a few per cent.

    """
    _check_series(D, gamma, m)
    _check_settings(points, accuracy, tolerance)
    given = _check_loads(mean_pressure)
    loads, position = np.unique(given, return_inverse=True)
    if m == 1:
        h, R = westergaard.compliance(loads), westergaard.resistance(loads)
        solution = Curve(h, R, np.zeros(loads.size), np.zeros(loads.size, np.int64))
    else:
        wave = Model(D, gamma, m, int(points), accuracy, tolerance).solve(loads)
        solution = Curve(wave.compliance, wave.rate / loads, wave.residual, wave.work)
    index = position.reshape(given.shape)
    return Curve(
        np.asarray(solution.compliance[index]),
        np.asarray(solution.resistance[index]),
        np.asarray(solution.residual[index]),
        np.asarray(solution.work[index]),
    )


def compliance(mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> Array:
    """Compliance of the non-linear layer model, in g_0, of the shape of the loads in p_0*: see `curve`."""
    return curve(mean_pressure, D, gamma, m).compliance


def resistance(mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> Array:
    """Resistance dh/dp of the non-linear layer model, in g_0/p_0*, of the shape of the loads in p_0*: see `curve`."""
    return curve(mean_pressure, D, gamma, m).resistance


def tail_table(D: float, gamma: float, heaviest: float, subdivision: int) -> tuple[Array, Array, Array]:
    """The compliance W of an infinite series over its load xi, as the closure of a layer that stands for its waves.

    Parameters
    ----------
    D, gamma : float
        Fractal dimension and ratio of wavelengths.
    heaviest : float
        Load that the table reaches, in p_0*.
    subdivision : int
        Points for each of its rows.

    Returns
    -------
    log_load, log_compliance, power : ndarray
        ln xi, increasing from below 1e-18; ln W; and d ln W/d ln xi.
    """
    model = Model(D, gamma, math.inf, POINTS, ACCURACY, TOLERANCE)
    tops = model.tops(math.log(heaviest))
    (waves,) = model.finer_waves(BOTTOM_POSITIONS[0], tops, np.array([len(tops) - 1]))
    rows = waves.rows.position
    number = np.arange(subdivision * (rows.size - 1) + 1) / subdivision
    log_load = log_load_at(np.interp(number, np.arange(rows.size), rows))
    return log_load, *compressions(waves.rows.closure, log_load)


def _check_loads(mean_pressure: ArrayLike) -> Array:
    loads = np.asarray(mean_pressure, float)
    wrong = ~((loads >= MIN_LOADS[1]) & np.isfinite(loads))
    if loads.size == 0 or np.any(wrong):
        first = loads[wrong].flat[0] if loads.size else "none"
        raise ValueError(f"mean_pressure must be finite and at least {MIN_LOADS[1]:g} p_0*, got {first}")
    return loads


def _check_series(D: float, gamma: float, m: float) -> None:
    checked_dimension(D)
    checked_terms(m)
    if not 1 < gamma < math.inf:
        raise ValueError(f"gamma must be finite and exceed 1, got {gamma}")


def _check_settings(points: int, accuracy: float, tolerance: float) -> None:
    if not (isinstance(points, Real) and MIN_POINTS <= points <= MAX_POINTS and points == points // 1):
        raise ValueError(f"points must be a whole number from {MIN_POINTS} to {MAX_POINTS}, got {points}")
    if not (isinstance(accuracy, Real) and MIN_ACCURACY <= accuracy <= MAX_ACCURACY):
        raise ValueError(f"accuracy must lie in [{MIN_ACCURACY:g}, {MAX_ACCURACY:g}], got {accuracy}")
    if not (isinstance(tolerance, Real) and MIN_TOLERANCE <= tolerance <= accuracy):
        raise ValueError(
            f"residual_tolerance must lie in [{MIN_TOLERANCE:g}, {accuracy:g}], at most the accuracy, got {tolerance}"
        )
