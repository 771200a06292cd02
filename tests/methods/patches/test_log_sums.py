"""Fast sums of the periodic logarithm against the sums as they stand."""

import numpy as np
import pytest

from weier.methods.patches.log_sums import LEAF_POINTS, log_potential, log_sums, make_log_matrix, make_tree


def clustered_points(count, period):
    """Clusters of all widths, some closer to each other than they are wide, and one across the end of the period."""
    rng = np.random.default_rng(count)
    clusters = -(-count // 12)
    centre = np.cumsum(rng.exponential(size=clusters) ** 2)
    width = 10.0 ** rng.uniform(-8, -3, clusters)
    x = centre[:, None] / centre[-1] + width[:, None] * np.sort(rng.uniform(-1, 1, (clusters, 12)), axis=1)
    x = np.sort(x.ravel())[:count]
    return period * (x - x[0]) / (x[-1] - x[0]) * 0.9999 + 0.7 * period


def direct_sums(x, sources, f, period):
    chord = np.abs(2 * np.sin(np.pi / period * (x[:, None] - sources)))
    chord[chord == 0] = 1
    return np.log(chord) @ f


@pytest.mark.parametrize("count", [1, 2, LEAF_POINTS, LEAF_POINTS + 1, 300, 3001])
def test_sums_over_points(count):
    x = clustered_points(count, 3.0) if count > 2 else np.arange(1.0, count + 1)
    f = np.random.default_rng(0).normal(size=count)
    fast = log_sums(make_log_matrix(x, 3.0), f)
    # 1e-13 of the largest sum without signs; logarithms are at most about 20.
    np.testing.assert_allclose(fast, direct_sums(x, x, f, 3.0), rtol=0, atol=1e-13 * 20 * np.abs(f).sum())


@pytest.mark.parametrize(("count", "targets"), [(1, 5), (500, 1), (2000, 777)])
def test_potential_at_other_points(count, targets):
    source = clustered_points(count, 1.0) if count > 1 else np.array([0.3])
    f = np.random.default_rng(1).random(count)
    x = np.sort(np.random.default_rng(2).uniform(source[0], source[0] + 1, targets))
    fast = log_potential(make_tree(source), f, x, 1.0)
    np.testing.assert_allclose(fast, direct_sums(x, source, f, 1.0), rtol=0, atol=1e-13 * 20 * f.sum())


def test_far_pairs_are_few():
    counts = []
    for count in (4000, 16000):
        matrix = make_log_matrix(clustered_points(count, 1.0), 1.0)
        counts.append((matrix.far_block.size + matrix.near_block.size) / count)
    assert counts[1] < 1.2 * counts[0]  # numbers stored for each point do not grow
    assert counts[1] < 250
