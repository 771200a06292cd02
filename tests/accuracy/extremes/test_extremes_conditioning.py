"""Condition numbers are those of the matrices."""

import numpy as np
import pytest
from scipy.linalg import circulant

from weier.accuracy.extremes.conditioning import operator, system
from weier.theory.halfplane import influence_coefficients


def test_condition_number_of_the_operator_is_that_of_its_matrix():
    values = np.abs(np.linalg.eigvalsh(circulant(influence_coefficients(16))))
    values = np.sort(values)[1:]  # that of the mean is 0
    assert operator(16) == pytest.approx(values[-1] / values[0], rel=1e-10)
    assert operator(2**20) == pytest.approx(2**20 * operator(2**10) / 2**10, rel=1e-3)
    assert system(64, 64) > system(16, 16) > 1
