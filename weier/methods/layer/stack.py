"""The stack of levels: each wave bears through a layer that stands for all finer waves (4.3).

W(xi) is the compliance of a wave together with all finer ones, in that wave's units. To the next coarser wave it is
the law of a layer, w(p) = gamma^(D-2) W(gamma^(1-D) p) in the coarser units. One level is the same map T, from W to
the next coarser W, at every scale: m waves have W = T^(m-1) W_1, from Westergaard's W_1 (12), and the endless series
has the fixed point of T. Between levels ln W is tabulated over ln xi, with its slope.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from weier.methods import westergaard
from weier.methods.errors import ConvergenceError
from weier.methods.layer.certificate import violations
from weier.methods.layer.law import Layer, compressions
from weier.methods.layer.wave import Mesh, depths, midpoints, trace
from weier.theory.series import checked_dimension, checked_terms

Array = NDArray[np.float64]
Law = Callable[[Array], tuple[Array, Array]]  # W and dW/dxi at increasing ln xi

POINTS = 24
ACCURACY = 1e-5
TOLERANCE = 1e-10
MOST_LEVELS = 1000  # a series that has not converged by then is refused
LIGHTEST = 1e-305  # load that leaves doubles to such a table
MARGIN = 5.0  # tables begin at e^-5 of the lightest load: what presses less moves h by less than 1e-6
MOST_POINTS = 500  # 40 loads on 384 take 3 s, and time grows as the cube
ACCURACIES = 1e-9, 1e-2  # at the upper one few rows are added to those e-folds apart
FINEST_TOLERANCE = 1e-13  # rounding allows no smaller one at the lightest loads
SLOPE_SHARE = 0.25  # of a slope over half the distance between rows; a cubic is astray by 4/27 of it
MOST_HALVINGS = 30  # of the distance between rows, and most rows of a table: the finest accuracy took 17
MOST_ROWS = 100_000  # and 4000 over all loads
LOG_UNSEEN = math.log(1e-25)  # of h, relative to itself: far below the rounding of doubles
ROUNDING = 1e-13  # of the freshly applied operator


class Curve(NamedTuple):
    """Curves of the non-linear layer model; arrays have the shape of the loads.

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*
    residual : largest violation of a contact condition by the coarsest wave, on a freshly applied operator, in g_0
    work : Newton steps for the coarsest wave
    levels : waves in the stack, a scalar; for m = inf as many as it took
    """

    compliance: Array
    resistance: Array
    residual: Array
    work: NDArray[np.int64]
    levels: int


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
        Relative error of W at which a row is added to a table, and at which the fixed point of m = inf is reached;
        1e-9 to 0.01.
    tolerance : float
        Largest residual of a wave, relative to the compression at the edge of its contact; 1e-13 to `accuracy`,
        since a table cannot be more accurate than its rows.

    Returns
    -------
    Curve
        Arrays of the shape of `mean_pressure`.

    Raises
    ------
    ValueError
        If a parameter lies outside its range.
    ConvergenceError
        If a wave misses the tolerance or a table the accuracy, or a long series still changes after 1000 levels: each
        new one changes the compliance gamma^(D-2) times as much as the one before, and loads gamma^(D-1) times as
        heavy need one more.

    Notes
    -----
    The resistance is the exact derivative of the discrete compliance. With more `points` the error of the
    compliance falls as N^-2 or faster, that of the resistance as N^-1 to N^-2.7 and at times unevenly: the pressure
    has kinks where the layer is pressed flat. With the defaults the compliance is within 5e-6 of the total amplitude
    and the resistance below p_0* within 1.5e-3 of itself, mostly 2e-6 and 6e-4 (135 series with D from 1.1 to 1.9,
    gamma from 2 to 10, m up to 4); where the resistance vanishes, close to full contact, its relative error reaches
    a few per cent. The fixed point of m = inf is approached until all levels that are missing change the compliance
    by less than `accuracy`, relative to itself.

    """
    _check_series(D, gamma, m)
    _check_settings(points, accuracy, tolerance)
    given = _checked_loads(mean_pressure)
    loads, place = np.unique(given, return_inverse=True)
    if m == 1:
        h, slope = westergaard.compliance(loads), westergaard.resistance(loads)
        answer = Curve(h, slope, np.zeros(loads.size), np.zeros(loads.size, np.int64), 1)
    else:
        log_load = np.log(loads)
        tables = _tables(log_load, D, gamma, accuracy)
        recursion = Recursion(_scaling(D, gamma), tables, midpoints(int(points)), tolerance)
        finer, levels = recursion.finer_waves(m)
        answer = recursion.solve(finer, log_load, certified=True)._replace(levels=levels + 1)
    place = place.reshape(given.shape)
    return Curve(
        np.asarray(answer.compliance[place]),
        np.asarray(answer.resistance[place]),
        np.asarray(answer.residual[place]),
        np.asarray(answer.work[place]),
        answer.levels,
    )


def compliance(mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> Array:
    """Compliance of the non-linear layer model, in g_0, of the shape of the loads in p_0*: see `curve`."""
    return curve(mean_pressure, D, gamma, m).compliance


def resistance(mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> Array:
    """Resistance dh/dp of the non-linear layer model, in g_0/p_0*, of the shape of the loads in p_0*: see `curve`."""
    return curve(mean_pressure, D, gamma, m).resistance


class Stack(NamedTuple):
    """A wave with all finer ones: W(xi), its limit, and ln xi where it gets there."""

    law: Layer
    amplitude: float
    log_full: float


class Scaling(NamedTuple):
    """Of the next finer wave: ln gamma^(D-1), its p*, and ln gamma^(D-2), its g, in units of this one."""

    log_pressure: float
    log_height: float


class Tables(NamedTuple):
    """Tables cover bottom <= ln xi <= top, of which loads from lightest on count, to a relative accuracy."""

    lightest: float
    bottom: float
    top: float
    accuracy: float


@dataclass(frozen=True)
class Recursion:
    """The map T (`coarser`), from the tables of one level to those of the next."""

    scaling: Scaling
    tables: Tables
    mesh: Mesh
    tolerance: float

    def finer_waves(self, m: float) -> tuple[Stack, int]:
        """The waves finer than the first of m, and their number.

        If m is inf the finest carries the amplitude of the endless tail, so that the limit of W is right from the
        start. A finite stack too ends where more levels change nothing.
        """
        endless = 1 / -math.expm1(self.scaling.log_height)
        finer, levels, change = self.finest(endless if math.isinf(m) else 1.0), 1, math.inf
        while levels < min(m - 1, MOST_LEVELS):
            coarser = self.coarser(finer)
            change, covered = self.remainder(coarser, finer), self.covered(coarser, finer, levels)
            finer, levels = coarser, levels + 1
            if change <= self.tables.accuracy and covered:
                return finer, levels
        if levels < m - 1:
            cause = (
                f"the layer model still changes by {change:.1e} of itself after {levels} levels, above the accuracy "
                f"{self.tables.accuracy:.1e}: choose a larger gamma, a smaller m or a larger accuracy"
                if change > self.tables.accuracy
                else f"the heaviest load presses more than {levels} waves flat: choose lighter loads or a smaller m"
            )
            raise ConvergenceError(cause, change)
        return finer, levels

    def finest(self, amplitude: float) -> Stack:
        """Westergaard's wave, of this amplitude (12)."""

        def law(log_load: Array) -> tuple[Array, Array]:
            xi = np.exp(log_load)
            return amplitude * westergaard.compliance(xi), amplitude * westergaard.resistance(xi)

        return Stack(self._table(law, 0.0), amplitude, 0.0)

    def coarser(self, finer: Stack) -> Stack:
        """T: the next coarser wave on the stack of finer ones."""
        amplitude, log_full = self._full_contact(finer)

        def law(log_load: Array) -> tuple[Array, Array]:
            answer = self.solve(finer, log_load, certified=False)
            return answer.compliance, answer.resistance

        return Stack(self._table(law, log_full), amplitude, log_full)

    def solve(self, finer: Stack, log_load: Array, certified: bool) -> Curve:
        """The next coarser wave on the stack of finer ones, at increasing loads, `levels` left at 0."""
        amplitude, log_full = self._full_contact(finer)
        n = log_load.size
        answer = Curve(np.full(n, amplitude), np.zeros(n), np.zeros(n), np.zeros(n, np.int64), 0)
        partial = int(np.searchsorted(log_load, log_full))  # beyond: full contact, exactly
        if partial:
            layer, loads = self._layer(finer.law), log_load[:partial]
            traced = trace(loads, layer, self.mesh, self.tolerance)
            self._check_residual(loads, traced.residual, self.tolerance)
            answer.compliance[:partial] = np.minimum(traced.compliance, amplitude)
            answer.resistance[:partial] = traced.resistance
            answer.work[:partial] = traced.work
            if certified:
                violation = violations(traced, loads, layer)
                self._check_residual(loads, violation, 10 * self.tolerance + ROUNDING * (1 + np.exp(loads)))
                answer.residual[:partial] = violation * depths(traced)
        return answer

    def covered(self, coarser: Stack, finer: Stack, levels: int) -> bool:
        """Whether tables end at the same load, or waves beyond these levels yield too little to be seen."""
        same = coarser.law.log_pressure[-1] == finer.law.log_pressure[-1]
        return bool(same or levels * self.scaling.log_height < LOG_UNSEEN)

    def remainder(self, coarser: Stack, finer: Stack) -> float:
        """What all further levels may still change W by, relative to itself."""
        log_load = coarser.law.log_pressure
        change = np.abs(coarser.law.log_compression - compressions(finer.law, log_load)[0])
        return float(np.max(change[log_load >= self.tables.lightest])) / math.expm1(-self.scaling.log_height)

    def _layer(self, law: Layer) -> Layer:
        """W of the finer stack as the law of the coarser wave's layer, in the coarser units."""
        log_pressure = law.log_pressure + self.scaling.log_pressure
        return Layer(log_pressure, law.log_compression + self.scaling.log_height, law.slope)

    def _full_contact(self, finer: Stack) -> tuple[float, float]:
        """Amplitude of the next coarser stack, and ln xi where the pressure in its troughs, xi - 1, is enough."""
        amplitude = 1 + math.exp(self.scaling.log_height) * finer.amplitude
        return amplitude, float(np.logaddexp(0, self.scaling.log_pressure + finer.log_full))

    def _table(self, law: Law, log_full: float) -> Layer:
        """Rows e-folds apart, and between them as many as the cubics need to meet the next midpoints.

        They must have the slope too: beside a kink a cubic may meet the value by chance.
        """
        top = min(self.tables.top, log_full)
        y = np.linspace(self.tables.bottom, top, math.ceil(top - self.tables.bottom) + 1)
        rows = np.array([y, *law(y)])
        middle, half = (y[1:] + y[:-1]) / 2, (y[1] - y[0]) / 2
        for _ in range(MOST_HALVINGS):
            table, between = _monotone(*rows), np.array([middle, *law(middle)])
            log_W, slope = compressions(table, middle)
            astray = np.abs(between[2] * np.exp(middle) / between[1] - slope)
            errors = np.maximum(np.abs(np.log(between[1]) - log_W), SLOPE_SHARE * half * astray)
            wrong = ~(errors <= self.tables.accuracy)
            rows = np.concatenate([rows, between], axis=1)
            rows = np.take(rows, np.argsort(rows[0]), axis=1)
            if not np.any(wrong):
                return _monotone(*rows)
            if rows.shape[1] > MOST_ROWS:
                break
            half /= 2
            middle = (middle[wrong, None] + np.array([-half, half])).ravel()
        worst = float(np.max(errors))
        raise ConvergenceError(
            f"a table of the layer model is still off by {worst:.1e} of itself after {rows.shape[1]} rows, above the "
            f"accuracy {self.tables.accuracy:.1e}: choose a larger accuracy or a smaller tolerance",
            worst,
        )

    def _check_residual(self, log_load: Array, residual: Array, limit: Array | float) -> None:
        missed = np.flatnonzero(~(residual <= limit))
        if missed.size:
            worst = float(residual[missed[0]])
            raise ConvergenceError(
                f"a wave of the layer model stopped at a relative residual of {worst:.1e} under the mean pressure "
                f"{math.exp(log_load[missed[0]]):.6g} in its own p*, above the tolerance {self.tolerance:.1e}; try "
                "other points or a larger tolerance",
                worst,
            )


def _scaling(D: float, gamma: float) -> Scaling:
    log_ratio = math.log(gamma)
    return Scaling((D - 1) * log_ratio, (D - 2) * log_ratio)


def _tables(log_load: Array, D: float, gamma: float, accuracy: float) -> Tables:
    """Tables for these loads: finer waves carry no more than Archard's peak pressures (17), (18)."""
    ratio = gamma ** (D - 1)
    load = math.exp(log_load[-1])
    second = (2 * math.sqrt(load) if load < 1 else 1 + load) / ratio  # zeta_0 (17), (18)
    last = 1 / math.expm1((D - 1) * math.log(gamma)) if ratio < 2 else 4 / ratio**2  # where zeta_n tends (18)
    top = math.log(max(second, last))
    lightest = min(float(log_load[0]), 0.0, top)  # the troughs carry light loads in any case
    return Tables(lightest, lightest - MARGIN, top, accuracy)


def _monotone(log_load: Array, W: Array, slope: Array) -> Layer:
    """A table whose cubics are monotone: no slope above three times that of a neighbouring chord."""
    log_W = np.log(W)
    chord = np.diff(log_W) / np.diff(log_load)
    beside = np.concatenate([chord[:1], chord, chord[-1:]])
    steepest = 3 * np.minimum(beside[1:], beside[:-1])
    return Layer(log_load, log_W, np.clip(slope * np.exp(log_load) / W, 0, np.maximum(steepest, 0)))


def _checked_loads(mean_pressure: ArrayLike) -> Array:
    loads = np.asarray(mean_pressure, float)
    wrong = ~((loads >= LIGHTEST) & np.isfinite(loads))
    if loads.size == 0 or np.any(wrong):
        found = loads[wrong].flat[0] if loads.size else "none"
        raise ValueError(f"mean_pressure must be finite and at least {LIGHTEST:g} p_0*, got {found}")
    return loads


def _check_series(D: float, gamma: float, m: float) -> None:
    checked_dimension(D)
    checked_terms(m)
    if not 1 < gamma < math.inf:
        raise ValueError(f"gamma must be finite and exceed 1, got {gamma}")


def _check_settings(points: int, accuracy: float, tolerance: float) -> None:
    if not (isinstance(points, Real) and 4 <= points <= MOST_POINTS and points == points // 1):
        raise ValueError(f"points must be a whole number from 4 to {MOST_POINTS}, got {points}")
    least, most = ACCURACIES
    if not (isinstance(accuracy, Real) and least <= accuracy <= most):
        raise ValueError(f"accuracy must lie in [{least:g}, {most:g}], got {accuracy}")
    if not (isinstance(tolerance, Real) and FINEST_TOLERANCE <= tolerance <= accuracy):
        raise ValueError(
            f"tolerance must lie in [{FINEST_TOLERANCE:g}, {accuracy:g}], at most the accuracy, got {tolerance}"
        )
