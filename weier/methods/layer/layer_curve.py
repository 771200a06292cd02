"""Compliance and resistance curves of the non-linear layer model (4.3).

docs/layer.md: "Tables" for the range of the tables and heavier loads, "The whole series" for series that are treated
as infinite.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from weier.checks import checked_count, checked_number
from weier.kernels.arrays import Array
from weier.kernels.blas import one_thread
from weier.methods import westergaard
from weier.methods.curve import Curve
from weier.methods.errors import ConvergenceError
from weier.methods.layer.closure import log_compression
from weier.methods.layer.fixed_point import infinite_waves
from weier.methods.layer.scales import ComplianceTable, Model, finer_waves, model_of, scale_on
from weier.methods.layer.scaling_tables import BOTTOM_POSITIONS, MAX_POSITION, MIN_LOADS, log_load_at, table_position
from weier.surface.loads import checked_loads
from weier.surface.profile import Profile
from weier.surface.series import tail_amplitude

POINTS = 24  # error of the compliance 5e-6 of the total amplitude (notes of `curve`)
ACCURACY = 1e-5
MIN_POINTS, MAX_POINTS = 4, 500  # 40 loads on 384 points take 3 s, growing as the cube
MIN_ACCURACY, MAX_ACCURACY = 1e-9, 1e-2  # an accuracy of 1e-2 adds few rows to the initial ones
MAX_SCALES = 1000  # scales of a finite series that differs from the infinite one
TAIL_FRACTION = 0.1  # tail over accuracy up to which a series is treated as infinite
FLAT_MARGIN = 1.0  # ln xi from the lightest load at which a wave is practically flat to the end of a table


def curve(profile: Profile, mean_pressure: ArrayLike, points: int = POINTS, accuracy: float = ACCURACY) -> Curve:
    """Return compliance and resistance of the non-linear layer model (4.3).

    Parameters
    ----------
    profile : Profile
        A series of any number of terms, also inf; its phases do not matter.
    mean_pressure : array_like, shape (loads,)
        Increasing mean pressures, in p_0*.
    points : int
        Nodes on half a wave.
    accuracy : float
        Largest relative error of the compliance due to the tables of all scales, at any load. The error of the mesh
        is additional: see the notes.

    Returns
    -------
    Curve
        With the residual of the coarsest wave.

    Raises
    ------
    ValueError
        If a load or a setting lies outside its range.
    ConvergenceError
        If a wave does not converge, or a table misses the accuracy: errors add up over about 1/(1 - gamma^(D-2))
        scales at heavy loads, and over more at light ones. Or if a series of too many terms still differs from the
        infinite one.

    Notes
    -----
    The solution at a load does not depend on the other loads.

    The resistance is the exact derivative of the discrete compliance. With more `points` the error of the
    compliance falls as N^-2 or faster, the error of the resistance as N^-1 to N^-2.7 and at times unevenly: the
    pressure has kinks where the layer is flattened. With the defaults the compliance is within 5e-6 of the total
    amplitude and the resistance below p_0* within 1.5e-3 of itself, mostly 3e-6 and 6e-4 (135 series with D from 1.1
    to 1.9, gamma from 2 to 10, m up to 4); where the resistance vanishes, close to full contact, its relative error
    reaches a few per cent.

    """
    check(profile, points, accuracy)
    model = model_of(profile.D, float(profile.gamma), profile.m, int(points), float(accuracy))
    loads = checked_loads(mean_pressure)
    if loads[0] < MIN_LOADS[1]:
        raise ValueError(f"mean_pressure must be at least {MIN_LOADS[1]:g} p_0*, got {loads[0]:g}")
    if profile.m == 1:
        return Curve(westergaard.compliance(loads), westergaard.resistance(loads), residual=np.zeros(loads.size))
    # Tables for light loads begin lower; tables for heavy loads on a finite series extend to full contact.
    top = _top(model)
    parts = zip(
        np.split(loads, np.searchsorted(loads, [MIN_LOADS[0], math.exp(top)])),
        (BOTTOM_POSITIONS[1], BOTTOM_POSITIONS[0], BOTTOM_POSITIONS[0]),
        (table_position(top), table_position(top), MAX_POSITION),
        strict=True,
    )
    solved = [_solve(some, bottom, end, model) for some, bottom, end in parts if some.size]
    h, R, residual = (np.concatenate(columns) for columns in zip(*solved, strict=True))
    return Curve(h, R, residual=residual)


def check(profile: Profile, points: int = POINTS, accuracy: float = ACCURACY) -> None:
    """Refuse settings out of range, for any series."""
    checked_count("points", points, MIN_POINTS, MAX_POINTS)
    within = f"lie in [{MIN_ACCURACY:g}, {MAX_ACCURACY:g}]"
    checked_number("accuracy", accuracy, within, lambda value: MIN_ACCURACY <= value <= MAX_ACCURACY)


def tail_closure(log_load: Array, D: float, gamma: float) -> tuple[Array, Array]:
    """Return the closure of a layer for an infinite series: ln W and d ln W/d ln xi, from `MIN_LOADS[0]` on."""
    model = model_of(D, gamma, math.inf, POINTS, ACCURACY)
    waves = _finer_waves(BOTTOM_POSITIONS[0], MAX_POSITION, model)
    carried, height, scale = _flat_waves(log_load, waves, model)
    log_W, power = log_compression(waves.rows.closure, carried)
    W = height + scale * np.exp(log_W)
    return np.log(W), power * scale * np.exp(log_W) / W


def _flat_waves(log_load: Array, waves: ComplianceTable, model: Model) -> tuple[Array, Array, Array]:
    """Return ln xi on the waves that are not flat, with height and scale of h = height + scale * h(xi).

    The number of flattened waves of the infinite series is such that the load on the next one lies within the table.
    At the end of the table the pressure varies so little along a wave that w(p) is linear.
    """
    excess = log_load - log_load_at(waves.rows.position[-1])
    most = 0.0 if math.isfinite(waves.log_full) else math.inf
    number = np.clip(np.ceil(excess / model.log_pressure), 0.0, most)
    scale = np.exp(number * model.log_height)
    return log_load - number * model.log_pressure, (1 - scale) * waves.amplitude, scale


@one_thread
def _solve(loads: Array, bottom: float, top: float, model: Model) -> tuple[Array, Array, Array]:
    """Return h, R and the residual of the coarsest wave under these loads, on the layer of all finer ones."""
    waves = _finer_waves(bottom, top, model)
    carried, height, scale = _flat_waves(np.log(loads), waves, model)
    h, rate, residual = scale_on(waves, model).solve(carried)
    return height + scale * h, scale * rate / loads, scale * residual


@one_thread
def _finer_waves(bottom: float, top: float, model: Model) -> ComplianceTable:
    """Return the waves finer than the first, on tables that depend on no load."""
    D, gamma, m, _, accuracy, _ = model
    if _may_be_infinite(bottom, model):
        waves = infinite_waves(model, bottom, table_position(_top(model)))
        tail = 0.0 if math.isinf(m) else float(tail_amplitude(m, D, gamma))  # bounds the change of every compliance
        if tail <= TAIL_FRACTION * accuracy * math.exp(waves.rows.log_compliance[0]):
            return waves
    if m > MAX_SCALES + 1:
        raise ConvergenceError(
            f"a series of {m} terms still differs from the infinite one, and the layer model takes at most "
            f"{MAX_SCALES} scales one by one: choose a smaller m, or m = inf",
            float(tail_amplitude(m, D, gamma) / tail_amplitude(0, D, gamma)),
        )
    return finer_waves(model, bottom, top)


def _top(model: Model) -> float:
    """Return the ln xi at which tables end: above it the first wave is practically flat.

    No pressure in a wave exceeds 1 + xi, so that the table of its layer extends far enough.
    """
    step = model.log_pressure
    self_contained = -step - math.log(-math.expm1(-step))
    return max(self_contained, -0.5 * math.log(model.accuracy)) + FLAT_MARGIN


def _may_be_infinite(bottom: float, model: Model) -> bool:
    """Return whether the tail may be negligible: ln W approaches -2 sqrt((2 - D) ln gamma |ln xi|) at light loads."""
    lightest = 2 * math.sqrt(-model.log_height * -log_load_at(bottom))
    return model.m * -model.log_height >= lightest - math.log(TAIL_FRACTION * model.accuracy)
