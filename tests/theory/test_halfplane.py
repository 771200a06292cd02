"""The half-plane: eigenvalues against their aliases, a dense matrix, and functions of distances against mpmath."""

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad

from weier.theory.halfplane import (
    displacement_at_distance,
    eigenvalues,
    influence_coefficients,
    punch_displacement,
    replace_by_influence,
    take_logarithms,
)


@pytest.mark.parametrize("points", [3, 8, 12, 101])
def test_eigenvalues_sum_all_aliases(points):
    """The triangle's spectrum, sinc^2/|k|, summed over its aliases; the tail beyond J is below 1/(J^2)."""
    k = np.arange(1, points // 2 + 1)
    j = np.arange(-20000, 20001)[:, None]
    waves = np.abs(k + j * points)
    direct = (np.sinc(waves / points) ** 2 / waves).sum(0)
    assert eigenvalues(points)[1:] == pytest.approx(direct, rel=1e-8)
    assert eigenvalues(points)[0] == 0


def test_a_longer_period_scales_the_displacement():
    assert eigenvalues(16, period=4.0) == pytest.approx(4 * eigenvalues(16), rel=1e-14)


@pytest.mark.parametrize("points", [7, 12])
def test_influence_is_the_circulant_of_its_eigenvalues(points):
    column = influence_coefficients(points)
    matrix = np.array([np.roll(column, j) for j in range(points)])
    waves = eigenvalues(points)
    both = np.concatenate([waves, waves[1 : (points + 1) // 2]])
    assert np.linalg.eigvalsh(matrix) == pytest.approx(np.sort(both), abs=1e-14)


@pytest.mark.parametrize("period", [1.0, 3.0])
def test_a_line_force_displaces_by_its_fourier_series(period):
    """sum of 2 cos(2 pi k x/L)/k, which is -2 ln 2, -ln 2, -ln 3 and 0 at a half, fourth, third and sixth of L."""
    x = period / np.array([2.0, 4.0, 3.0, 6.0])
    expected = -np.log([4.0, 2.0, 3.0, 1.0])
    assert [displacement_at_distance(at, period) for at in -x] == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("period", [1.0, 3.0])
def test_a_narrow_flat_punch_sinks_in_as_its_pressure_says(period):
    """With the pressure 1/(pi (r^2-s^2)^(1/2)), s = r sin(theta), at 0.3 r."""
    r, place = 1e-4 * period, np.arcsin(0.3)
    ends = (-np.pi / 2, place), (place, np.pi / 2)
    u = sum(quad(lambda t: displacement_at_distance(r * (np.sin(t) - 0.3), period), *end)[0] for end in ends)
    assert u / np.pi == pytest.approx(punch_displacement(r, period), rel=1e-7)


@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("period", [1.0, 9.0])
def test_influence_of_distances_holds_all_digits(period, dual):
    rng = np.random.default_rng(1)
    x = np.concatenate([rng.uniform(-3, 3, 300), 10.0 ** rng.uniform(-150, 0, 100), [0.5, 0.25, 1 / 3, 1.5]]) * period
    found = np.append(x, [0.0])
    replace_by_influence(found, period, dual)
    with mp.workdps(40):
        cycles = [mp.mpf(float(d)) / mp.mpf(period) for d in x]
        sines = [2 * abs(mp.sinpi(u - mp.nint(u))) for u in cycles]
        exact = np.array([float(4 / s**2 if dual else mp.log(s)) for s in sines])
    turns = np.abs(np.array([float(u) for u in cycles])) > 0.5  # distances of several periods lose digits of sines
    assert found[-1] == 0
    np.testing.assert_allclose(found[:-1][~turns], exact[~turns], rtol=9e-16, atol=0 if dual else 3e-16)
    np.testing.assert_allclose(found[:-1][turns], exact[turns], rtol=1e-11, atol=1e-11)


def test_logarithms_hold_all_digits():
    rng = np.random.default_rng(1)
    x = np.concatenate([rng.uniform(0.5, 2, 2000), 2.0 ** rng.uniform(-1000, 1000, 500), 1 + 0.1 ** np.arange(1, 16)])
    with mp.workdps(30):
        exact = np.array([float(mp.log(float(value))) for value in x])
    found = np.append(x, 0.0)
    take_logarithms(found)
    assert found[-1] == 0
    np.testing.assert_allclose(found[:-1], exact, rtol=5e-16, atol=0)
