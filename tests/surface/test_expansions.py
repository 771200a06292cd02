"""A series by Taylor's polynomials about equally spaced nodes, against the sums that define it."""

import numpy as np
import pytest

from weier.surface.expansions import ORDER, count_nodes, derivatives, expand, move

ROUNDING = 8 * np.finfo(float).eps  # of a transform, and of a polynomial

FINEST = (np.ones(1), [256], np.full(1, 0.7))  # as few nodes a wave as there may be: the largest remainder
ROUGH = (np.arange(1, 301) ** -1.3, list(range(1, 301)), np.random.default_rng(1).uniform(0, 2 * np.pi, 300))
SERIES = (5.0 ** (-0.75 * np.arange(5)), [1, 5, 25, 125, 625], np.arange(5.0))


def values(expansion, t):
    """The polynomial of each row."""
    return np.sum(expansion * t[:, None] ** np.arange(ORDER + 1), axis=1)


def sums(amplitude, waves, phase, node, t, nodes):
    """The series and two derivatives by t, in steps from nodes."""
    kappa = 2 * np.pi * np.array(waves) / nodes
    angle = 2 * np.pi / nodes * (np.array(waves) * node[:, None] % nodes) + kappa * t[:, None] + phase
    return np.cos(angle) @ amplitude, -np.sin(angle) @ (kappa * amplitude), -np.cos(angle) @ (kappa**2 * amplitude)


@pytest.mark.parametrize("series", [FINEST, ROUGH, SERIES])
def test_values_and_derivatives_as_far_as_one_step(series):
    amplitude, waves, _ = series
    table = expand(*series)
    nodes = len(table)
    assert nodes == count_nodes(waves[-1])
    assert 4 * waves[-1] <= nodes < 8 * waves[-1]
    random = np.random.default_rng(2)
    node, t = random.integers(0, nodes, 500), random.uniform(-1, 1, 500)
    exact = sums(*series, node, t, nodes)
    found = values(table[node], t), *derivatives(table[node], t)
    kappa = 2 * np.pi * np.array(waves) / nodes
    for order in range(3):
        np.testing.assert_allclose(found[order], exact[order], atol=ROUNDING * amplitude @ kappa**order, rtol=0)


def test_a_moved_polynomial_is_the_same():
    rows, t = np.random.default_rng(3).normal(size=(4, ORDER + 1)), np.array([-0.5, 0.0, 0.2, 0.5])
    s = np.array([0.3, -0.2, 0.5, -0.5])
    scale = ROUNDING * np.abs(rows).sum(axis=1)
    assert np.all(np.abs(values(move(rows, t), s) - values(rows, t + s)) < scale)
