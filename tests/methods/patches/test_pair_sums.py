"""Fast sums of the periodic logarithm, and of 1/sin^2, against the sums as they stand."""

import numpy as np
import pytest

from weier.methods.patches.pair_sums import (
    LEAF_POINTS,
    ORDER,
    POINT,
    _interpolate,
    make_pair_matrix,
    pair_sums,
    potential,
)


def clustered_points(count, period):
    """Clusters of all widths, some closer to each other than they are wide, and one across the end of the period."""
    rng = np.random.default_rng(count)
    clusters = -(-count // 12)
    centre = np.cumsum(rng.exponential(size=clusters) ** 2)
    width = 10.0 ** rng.uniform(-8, -3, clusters)
    x = centre[:, None] / centre[-1] + width[:, None] * np.sort(rng.uniform(-1, 1, (clusters, 12)), axis=1)
    x = np.sort(x.ravel())[:count]
    return period * (x - x[0]) / (x[-1] - x[0]) * 0.9999 + 0.7 * period


def kernel(x, sources, period, dual):
    chord = np.abs(2 * np.sin(np.pi / period * (x[:, None] - sources)))
    chord[chord == 0] = np.inf if dual else 1
    return 4 / chord**2 if dual else np.log(chord)


@pytest.mark.parametrize("count", [1, 2, LEAF_POINTS, LEAF_POINTS + 1, 300, 3001])
def test_sums_over_points(count, dual):
    x = clustered_points(count, 3.0) if count > 2 else np.arange(1.0, count + 1)
    f = np.random.default_rng(0).normal(size=count)
    fast = pair_sums(make_pair_matrix(np.zeros(count), x, 3.0, dual), f)
    matrix = kernel(x, x, 3.0, dual)
    error = np.abs(fast - matrix @ f)
    # Interpolation leaves less than 1e-12 of the largest far element, and 1e-13 of a logarithm, which is at most 20.
    assert np.all(error <= (1e-12 if dual else 1e-13) * (matrix if dual else np.full_like(matrix, 20)) @ np.abs(f))


def test_points_that_are_closer_than_their_positions_tell():
    origin, offset = np.array([1.0, 1.0, 2.0]), np.array([1e-18, 3e-18, 0.1])
    # 1 + 1e-18 is 1 as a float; the distance of points with the same origin is that of the offsets.
    matrix = make_pair_matrix(origin, offset, 3.0, True)
    assert pair_sums(matrix, np.array([0.0, 1.0, 0.0]))[0] == pytest.approx(
        (3 / np.pi / 2e-18) ** 2, rel=1e-12, abs=0
    )


@pytest.mark.parametrize(("count", "targets"), [(1, 5), (500, 1), (500, 65), (2000, 777)])
def test_potential_at_other_points(count, targets, dual):
    source = clustered_points(count, 1.0) if count > 1 else np.array([0.3])
    f = np.random.default_rng(1).random(count)
    x = np.sort(np.random.default_rng(2).uniform(source[0], source[0] + 1, targets))
    fast = potential(np.zeros(count), source, f, np.zeros(targets), x, 1.0, dual)
    matrix = kernel(x, source, 1.0, dual)
    error = np.abs(fast - matrix @ f)
    assert np.all(error <= (1e-11 if dual else 1e-13) * (matrix if dual else np.full_like(matrix, 20)) @ f)


def test_far_pairs_are_few():
    counts = []
    for count in (4000, 16000):
        matrix = make_pair_matrix(np.zeros(count), clustered_points(count, 1.0), 1.0, False)
        counts.append((matrix.far_block.size + matrix.near_block.size) / count)
    assert counts[1] < 1.2 * counts[0]  # numbers stored for each point do not grow
    assert counts[1] < 250


@pytest.mark.parametrize("t", [*POINT, -1.0, 1.0, 0.3, np.nextafter(POINT[3], 1)])
def test_interpolation_is_exact_for_polynomials_at_and_between_the_points(t):
    weight = np.empty(ORDER)
    _interpolate(t, weight)
    for degree in range(ORDER):
        assert weight @ np.cos(degree * np.arccos(POINT)) == pytest.approx(np.cos(degree * np.arccos(t)), abs=1e-13)
