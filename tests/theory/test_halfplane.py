"""The half-plane: eigenvalues against the image sum, against u = p/|k|, and against a dense matrix."""

import numpy as np
import pytest
from scipy.special import zeta

from weier.theory.halfplane import eigenvalues, hurwitz_zeta_3, influence_coefficients


def test_zeta_is_that_of_scipy():
    """To the rounding of some twenty sums, from the first wave of 10^7 nodes to the shortest."""
    q = np.concatenate([np.geomspace(1e-7, 1.0, 2001), np.linspace(0.4, 1.0, 2001)])
    np.testing.assert_allclose(hurwitz_zeta_3(q), zeta(3, q), rtol=4e-15)


@pytest.mark.parametrize("points", [3, 8, 12, 101])
def test_eigenvalues_sum_all_aliases(points):
    """The triangle's spectrum, sinc^2/|k|, summed over its aliases; the tail beyond J is below 1/(J^2)."""
    k = np.arange(1, points // 2 + 1)
    j = np.arange(-20000, 20001)[:, None]
    waves = np.abs(k + j * points)
    direct = (np.sinc(waves / points) ** 2 / waves).sum(0)
    assert eigenvalues(points)[1:] == pytest.approx(direct, rel=1e-8)
    assert eigenvalues(points)[0] == 0


def test_long_waves_sink_by_pressure_over_wavenumber():
    """The error of linear elements is of second order in the number of nodes a wave: sinc^2 = 1 - (pi k/N)^2/3."""
    points = 4096
    k = np.arange(1, 9)
    assert eigenvalues(points)[1:9] * k == pytest.approx(np.ones(8), abs=2 * (np.pi * 8 / points) ** 2 / 3)


def test_a_longer_period_scales_the_displacement():
    assert eigenvalues(16, period=4.0) == pytest.approx(4 * eigenvalues(16), rel=1e-14)


@pytest.mark.parametrize("points", [7, 12])
def test_influence_is_the_circulant_of_its_eigenvalues(points):
    column = influence_coefficients(points)
    matrix = np.array([np.roll(column, j) for j in range(points)])
    waves = eigenvalues(points)
    both = np.concatenate([waves, waves[1 : (points + 1) // 2]])
    assert np.linalg.eigvalsh(matrix) == pytest.approx(np.sort(both), abs=1e-14)


def test_influence_of_one_element_matches_the_integral_over_its_images():
    """u = -2 int p ln|2 sin pi(x - s)| ds less its mean, for a triangle over two elements, by quadrature."""
    points, fine = 16, 2_000_000
    s = (np.arange(fine) + 0.5) / fine - 0.5
    triangle = np.maximum(1 - np.abs(s) * points, 0)
    at = np.arange(1, points) / points  # away from the node itself, where the kernel is singular
    u = [-2 * np.mean(triangle * np.log(np.abs(2 * np.sin(np.pi * (x - s))))) for x in at]
    # midpoint rule: the singular points cost about h ln h each
    assert influence_coefficients(points)[1:] == pytest.approx(np.array(u), abs=1e-6)
