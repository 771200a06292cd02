"""The inverse of the influence of punches on each other."""

import numpy as np
import pytest

from weier.methods.punches import MAX_COARSEST, OFFSET, invert_punches, solve_forces


@pytest.mark.parametrize(
    ("count", "ratio"), [(3, 1 + 1e-9), (MAX_COARSEST, 1 + 1e-9), (MAX_COARSEST + 1, 4), (400, 4)]
)
def test_the_inverse_of_few_punches_is_exact_and_that_of_many_is_near(count, ratio):
    """The inverse is that of a few punches, and so near to that of many that conjugate gradients are soon there."""
    rng = np.random.default_rng(count)
    centre = (np.arange(count) + 0.5 * rng.random(count)) / count
    compliance = -2 * np.log(np.pi / count * rng.uniform(0.02, 0.24, count))
    chord = np.abs(2 * np.sin(np.pi * (centre[:, None] - centre)))
    np.fill_diagonal(chord, np.exp(-0.5 * compliance))
    inverse = invert_punches(centre, compliance, 1.0)
    product = np.array([solve_forces(inverse, row) for row in OFFSET - 2 * np.log(chord)])
    eigenvalues = np.sort(np.linalg.eigvals(product).real)
    assert 0 < eigenvalues[-1] < ratio * eigenvalues[0]
