"""The half-plane: eigenvalues against their aliases, and against a dense matrix."""

import numpy as np
import pytest

from weier.theory.halfplane import eigenvalues, influence_coefficients


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
