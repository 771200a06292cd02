"""The non-linear layer model against Westergaard, finer tables and its own limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from weier import Profile
from weier.methods import archard, layer, westergaard
from weier.methods.layer.nonlinear_layer import ACCURACY
from weier.surface.series import leading_amplitude

CASES = [(1.1, 10, 3), (1.25, 5, 2), (1.5, 2, 3), (1.9, 2, 4)]


def full_contact(D, gamma, m):
    xi = 1.0
    for _ in range(m - 1):
        xi = 1 + gamma ** (D - 1) * xi
    return xi


def test_one_wave_is_westergaard():
    xi = np.geomspace(1e-30, 1e3, 67)
    answer = layer.curve(Profile(1.3, 4, 1), xi)
    np.testing.assert_array_equal(answer.compliance, westergaard.compliance(xi))
    np.testing.assert_array_equal(answer.resistance, westergaard.resistance(xi))


# The worst of 135 series; in the last two a table met the midpoints beside a kink by chance, 30 times as far off.
WORST = [(1.1, 2, 2), (1.3, 2, 4), (1.3, 3, 4)]


@pytest.mark.parametrize(("D", "gamma", "m"), CASES)
def test_resistance_is_the_slope_of_the_compliance(D, gamma, m):
    # Differences cost step^2 and 1e-10/step.
    xi, step = np.array([1e-20, 1e-6, 1e-2, 0.3, 2.0]), 1e-4
    loads = np.stack([xi * (1 - step), xi, xi * (1 + step)], axis=1)
    answer = layer.curve(Profile(D, gamma, m), loads.ravel())
    below, _, above = answer.compliance.reshape(-1, 3).T
    np.testing.assert_allclose(answer.resistance[1::3], (above - below) / (2 * step * xi), rtol=1e-4)


@pytest.mark.parametrize("load", [1e-5, 0.3, 30.0])
@pytest.mark.parametrize("m", [3, math.inf])
def test_a_load_far_above_those_of_the_finer_waves_is_solved_alone_as_among_others(load, m):
    # gamma = 1e6: all that the finer waves carry lies far below the load.
    alone = layer.curve(Profile(1.5, 1e6, m), [load]).compliance
    assert alone == pytest.approx(layer.curve(Profile(1.5, 1e6, m), [1e-9, load]).compliance[1:], rel=ACCURACY)
    assert alone <= archard.compliance(load, 1.5, 1e6, m) * (1 + 1e-5)


@pytest.mark.parametrize(("D", "gamma", "m"), CASES)
def test_full_contact_is_exact(D, gamma, m):
    full = full_contact(D, gamma, m)
    answer = layer.curve(Profile(D, gamma, m), full * np.array([0.8, 1 - 1e-9, 1 + 1e-9, 1e6]))
    total = leading_amplitude(m, D, gamma)
    assert answer.compliance[0] < total
    assert answer.resistance[0] > 0
    np.testing.assert_allclose(answer.compliance[1:], total, rtol=1e-14)
    np.testing.assert_array_equal(answer.resistance[2:], 0)
    assert answer.resistance[1] < 1e-9


SERIES = [(1.02, 2, 12), (1.5, 2, 2), (1.5, 10, math.inf), (1.98, 2, math.inf)]


@pytest.mark.parametrize(("D", "gamma", "m"), SERIES + WORST)
def test_each_load_is_as_accurate_as_asked_for(D, gamma, m):
    heaviest = min(1e3, 0.99 * full_contact(D, gamma, m)) if math.isfinite(m) else 1e3
    loads = np.geomspace(1e-12, heaviest, 25)
    best = layer.curve(Profile(D, gamma, m), loads, accuracy=ACCURACY / 100, points=40).compliance
    for accuracy in (1e-3, ACCURACY):
        found = layer.curve(Profile(D, gamma, m), loads, accuracy=accuracy).compliance
        error = np.abs(found / best - 1).max()
        print(f"D = {D}, gamma = {gamma}, m = {m}: accuracy {accuracy:.0e}, error {error:.1e}")
        assert error <= accuracy  # and that of the mesh, 5e-6 at most


# Cubics through the waves of the first overshoot where a contact becomes full; the second needs shorter Newton steps.
HARD = [(1 + 1e-6, 428, 12), (1.999, 16, math.inf), (1.999, 9564, math.inf)]


@pytest.mark.parametrize(("D", "gamma", "m"), HARD)
def test_series_close_to_the_ends_of_D_are_solved(D, gamma, m):
    """Two meshes agree, and neither is above Archard's estimate."""
    loads = np.geomspace(1e-6, 30, 5)
    h = layer.curve(Profile(D, gamma, m), loads).compliance
    finer = layer.curve(Profile(D, gamma, m), loads, points=32).compliance
    np.testing.assert_allclose(h, finer, atol=5e-6 * leading_amplitude(m, D, gamma), rtol=ACCURACY)
    assert np.all(h <= archard.compliance(loads, D, gamma, m) * (1 + ACCURACY))


def test_loads_below_those_of_floats_are_refused():
    with pytest.raises(ValueError, match="mean_pressure must be at least 1e-305 p_0"):
        layer.curve(Profile(1.5, 5, 3), [1e-306])
