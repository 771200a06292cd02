"""The infinite series: a fixed point, against another solver of one wave and iterations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.fft import dct, idct
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from weier import ConvergenceError, Profile
from weier.methods import demelio, layer, westergaard
from weier.methods.layer import fixed_point
from weier.methods.layer.nonlinear_layer import ACCURACY
from weier.surface.series import tail_amplitude

# Close to D = 2 errors add up over hundreds of scales; for gamma close to 1 the spline bends where the wave is flat.
SERIES = [(1.25, 5), (1.75, 2), (1.999, 5.38), (1.25, 1.01)]


@pytest.mark.parametrize(("D", "gamma"), [(1.5, 2), (1.25, 5), (1 + 1e-9, 5)])
def test_heavy_loads_press_the_infinite_series_flat_and_leave_light_ones_as_they_are(D, gamma):
    loads = np.array([1e-3, 1.0, 1e3, 1e300])
    together = layer.curve(Profile(D, gamma, math.inf), loads)
    assert together.compliance[-1] == pytest.approx(tail_amplitude(0, D, gamma), rel=1e-14)
    # Finite series of nearly that amplitude, and the infinite one without the heavy loads.
    np.testing.assert_allclose(
        together.compliance, layer.curve(Profile(D, gamma, 200), loads).compliance, rtol=ACCURACY
    )
    np.testing.assert_allclose(
        together.compliance[:2], layer.curve(Profile(D, gamma, math.inf), loads[:2]).compliance, rtol=ACCURACY
    )


def mean_pressure_at(h, log_pressure, n=400):
    """Mean pressure of one wave on a layer at the compliance h, from n equal steps of half a wave.

    With s = w + p in contact and s = h - 2 sin^2(pi x) - u outside, s - p(s) + A p(s) = h - 2 sin^2(pi x): Newton's
    method on dense matrices. p vanishes with many derivatives at the edges, so that equal steps are accurate.
    """
    k = np.arange(n)
    softness = np.where(k > 0, 1 / np.maximum(k, 1), 0.0)
    operator = idct(softness[:, None] * dct(np.eye(n), axis=0, norm="ortho"), axis=0, norm="ortho") - np.eye(n)
    indentation = h - 1 + np.cos(np.pi * (k + 0.5) / n)
    s = indentation.copy()
    for _ in range(50):
        log_s = np.log(np.maximum(s, 1e-30))
        known = np.clip(log_s, *log_pressure.x[[0, -1]])
        power = log_pressure(known, 1)
        p = np.where(s > 0, np.exp(log_pressure(known) + power * (log_s - known)), 0)
        slope = np.where(s > 0, p * power / np.maximum(s, 1e-30), 0)
        step = np.linalg.solve(operator * slope + np.eye(n), indentation - s - operator @ p)
        s = s + step
        if np.abs(step).max() < 1e-12:
            return p.mean()
    raise AssertionError("Newton's method did not converge")


def closure(curve, D, gamma):
    """The logarithm of the pressure over that of w + p, of a layer of finer waves with this curve."""
    xi = np.concatenate([np.geomspace(1e-18, 1e-4, 500)[:-1], np.geomspace(1e-4, 30, 500)])
    pressure = gamma ** (D - 1) * xi
    return CubicSpline(np.log(gamma ** (D - 2) * curve(xi) + pressure), np.log(pressure))


@pytest.mark.parametrize(("D", "gamma"), [(1.25, 5), (1.5, 2)])
@pytest.mark.parametrize("h", [0.05, 1.1])
def test_two_waves_are_one_on_a_layer_of_westergaards(D, gamma, h):
    # With 400 steps the load at h = 0.05, D = 1.25 is off by 1.0e-5 of itself, with 800 by 2e-6.
    load = mean_pressure_at(h, closure(westergaard.compliance, D, gamma), n=800)
    assert layer.curve(Profile(D, gamma, 2), load).compliance == pytest.approx(h, rel=ACCURACY)


@pytest.mark.parametrize(("D", "gamma"), SERIES)
def test_the_infinite_series_is_a_fixed_point(D, gamma):
    """Its curve is the closure of a layer, on which another solver finds a wave with that same curve.

    A deviation of one scale adds up to 1/(1 - gamma^(D-2)) times as much over all of them.
    """
    log_pressure = closure(lambda xi: layer.curve(Profile(D, gamma, math.inf), xi).compliance, D, gamma)
    loads = np.geomspace(1e-5, 3, 4)
    h = layer.curve(Profile(D, gamma, math.inf), loads).compliance
    found = np.array([mean_pressure_at(one, log_pressure) for one in h])
    slope = layer.curve(Profile(D, gamma, math.inf), loads).resistance * loads / h
    error = np.abs(np.log(found / loads)) * slope / (1 - gamma ** (D - 2))
    print(f"D = {D}, gamma = {gamma}: off by {error.max():.1e} of itself at most")
    assert error.max() < ACCURACY


@pytest.mark.parametrize(("D", "gamma"), [(1.25, 5), (1.75, 2)])
def test_light_loads_of_the_infinite_series_satisfy_an_integral_equation(D, gamma):
    """Where the half-plane yields nothing, P(h) = gamma^(D-1) int P(gamma^(2-D) (h - 2 pi^2 x^2)) dx."""
    xi = np.geomspace(1e-200, 1e-9, 2000)
    log_h = np.log(layer.curve(Profile(D, gamma, math.inf), xi).compliance)
    log_load = CubicSpline(log_h, np.log(xi))
    h = np.exp(log_h[700])
    assert h < 1e-3 or D > 1.5

    def pressure(x):
        w = gamma ** (2 - D) * (h - 2 * np.pi**2 * x**2)
        return np.exp(log_load(np.log(w))) / xi[700] if np.log(w) > log_h[0] else 0.0

    edge = math.sqrt(h / 2) / math.pi
    total = 2 * gamma ** (D - 1) * quad(pressure, 0, edge, epsabs=1e-12, epsrel=1e-10, limit=200)[0]
    error = abs(math.log(total)) / log_load(log_h[700], 1)
    print(f"D = {D}, gamma = {gamma}: h = {h:.1e} at xi = {xi[700]:.0e}, off by {error:.1e} of itself")
    assert error < ACCURACY


def test_thousands_of_scales_add_up():
    """4800 of them. Tables of another accuracy agree, and the curve lies between Demelio's and the total height."""
    D, gamma, loads = 1.9985, 1.15, [1e-3, 1.0, 1e3, 1e300]
    h = layer.curve(Profile(D, gamma, math.inf), loads).compliance
    coarse = layer.curve(Profile(D, gamma, math.inf), loads, accuracy=1e-3).compliance
    np.testing.assert_allclose(coarse, h, rtol=1e-3)
    assert np.all(h > demelio.compliance(loads, D, gamma, math.inf))
    assert h[-1] < tail_amplitude(0, D, gamma)


# 30 for more; the second one was refined without end
UNRESOLVED = [(1.99, 10, 1e-3), (1.9988088973674574, 44.10092323135747, 1e-5)]


@pytest.mark.parametrize(("D", "gamma", "accuracy"), UNRESOLVED)
def test_waves_that_the_mesh_does_not_resolve_are_refused(D, gamma, accuracy):
    """Their pressures drop by decades between two nodes, and the errors add up over hundreds of scales."""
    with pytest.raises(ConvergenceError, match="mesh"):
        layer.curve(Profile(D, gamma, math.inf), [1e-16], points=6, accuracy=accuracy)


@pytest.mark.parametrize(("D", "gamma", "points"), [(1.999, 100, 24), (1.9, 5, 6), (1.25, 5, 4)])
def test_accepted_meshes_are_within_a_hundredth_of_twice_the_points(D, gamma, points):
    loads = np.geomspace(1e-17, 10, 4)
    finer = layer.curve(Profile(D, gamma, math.inf), loads, points=2 * points, accuracy=1e-3).compliance
    found = layer.curve(Profile(D, gamma, math.inf), loads, points=points, accuracy=1e-3).compliance
    np.testing.assert_allclose(found, finer, rtol=fixed_point.MAX_MESH_ERROR)
