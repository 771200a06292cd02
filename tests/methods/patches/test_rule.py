"""Self-influences of segments and expansions against the closed forms of Chebyshev polynomials."""

import numpy as np
from numpy.polynomial.chebyshev import chebval

from tests.methods.patches.westergaard_states import KINDS
from weier.methods.patches.rule import (
    add_self_influence,
    add_self_influence_blocks,
    expand_forces,
    forces_from_expansion,
    place_nodes,
    self_influence_tables,
)

COUNTS = np.array([1, 2, 5, 12])
FIRST = np.append(0, np.cumsum(COUNTS))
RADII = np.array([0.3, 0.01, 0.1, 0.2])  # of L


def placed(first, r, period, dual):
    """The nodes of segments that are 0.01 L apart: offsets, factors and diagonal."""
    middle = np.cumsum(2 * r + 0.01 * period) - r
    shift = KINDS[dual].shift
    gap, (offset, left, diagonal, _), is_apart = place_nodes(first, np.zeros(r.size), middle, r, period, shift, dual)
    np.testing.assert_allclose(gap[:-1], 0.01 * period)
    np.testing.assert_allclose(2 * r.sum() + gap.sum(), period)
    assert is_apart == (gap[-1] > 0)
    return offset, left, diagonal


def angles(nodes, dual):
    return np.pi * (np.arange(nodes) + (1.0 if dual else 0.5)) / (nodes + dual)


def waves(nodes, dual):
    """T_k or U_k, k = 0 ... K - 1, at the nodes -cos(theta), shape (degrees, nodes)."""
    k, angle = np.arange(nodes)[:, None], np.pi - angles(nodes, dual)
    return np.sin((k + 1) * angle) / np.sin(angle) if dual else np.cos(k * angle)


def test_own_influences_replace_the_kernel_by_its_closed_form(period, dual):
    """-ln 2 - 2 sum T_k T_k/k for ln|t_i - t_j|, and -2 sum (k+1) U_k U_k for 1/(t_i - t_j)^2, on each segment."""
    kind = KINDS[dual]
    r, dense = RADII * period, np.zeros((FIRST[-1], FIRST[-1]))
    offset, left, diagonal = placed(FIRST, r, period, dual)
    table = self_influence_tables(FIRST, kind, False)
    add_self_influence_blocks(FIRST, left, diagonal, table, kind.shift, kind.hankel_sign, dense)
    for j, K in enumerate(COUNTS):
        here, wave = slice(FIRST[j], FIRST[j + 1]), waves(K, dual)
        t, k = -np.cos(angles(K, dual)), np.arange(K)
        np.testing.assert_allclose(offset[here], r[j] * t, atol=1e-15 * period)
        apart = np.abs(t[:, None] - t) + np.eye(K)
        if dual:
            expected = -2 * np.einsum("k,ki,kj", k + 1, wave, wave) - (1 - np.eye(K)) / apart**2
            # 1/sin^2(pi x/L) is 1/(pi x/L)^2 + 1/3 at its pole.
            expected = (period / (np.pi * r[j])) ** 2 * expected + np.eye(K) / 3
        else:
            expected = -np.log(2) - 2 * np.einsum("k,ki,kj", 1 / np.maximum(k, 1), wave, wave) + 2 * wave[0]
            expected += np.eye(K) * np.log(2 * np.pi * r[j] / period) - np.log(apart)
        upper = np.triu_indices(K)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(dense[here, here][upper], expected[upper], atol=2e-13 * scale)
    assert not np.any(np.tril(dense, -1))
    force = np.random.default_rng(0).normal(size=FIRST[-1])
    total = diagonal * force
    add_self_influence(FIRST, table, kind.shift, kind.hankel_sign, left, force, total)
    both = dense + dense.T - np.diag(np.diag(dense))
    np.testing.assert_allclose(total, both @ force, atol=1e-12 * np.abs(both @ force).max())


def test_the_own_influence_is_inverted_degree_by_degree(dual, period):
    """The displacement T_k needs the forces k/(2K) T_k, and the pressure U_k in a gap 2 pi r^2 w_i U_k/(k+1).

    The kernels of both have the factors -2 and -1/(2 L^2).
    """
    nodes, r = 9, np.array([0.13]) * period
    first, wave = np.array([0, nodes]), waves(nodes, dual)
    kind = KINDS[dual]
    inverse = self_influence_tables(first, kind, True)
    _, left, _ = placed(first, r, period, dual)
    weight = np.pi / (nodes + 1) * np.sin(angles(nodes, dual)) ** 2 * 2 * np.pi * r**2
    for k in range(nodes):
        force = np.zeros(nodes)
        add_self_influence(first, inverse, kind.shift, kind.hankel_sign, 1 / left, wave[k], force)
        force *= 2 * period**2 if dual else 0.5
        expected = weight * wave[k] / (k + 1) if dual else k / (2 * nodes) * wave[k]
        np.testing.assert_allclose(force, expected, atol=1e-12 * period**2)


def test_expansions_are_those_of_the_density(period, dual):
    """f = (pi/K) r psi at the zeros of T_K; for gaps f = r w omega, and psi is the slope of sqrt(1-t^2) omega."""
    kind = KINDS[dual]
    r, random = RADII * period, np.random.default_rng(1)
    b = random.normal(size=FIRST[-1])
    if dual:
        b[FIRST[:-1]] = 0.0  # a slope with a mean would not close the gap
    _, left, _ = placed(FIRST, r, period, dual)
    force = forces_from_expansion(FIRST, r, left, b, FIRST, np.arange(4), period, kind.shift, kind.derivative)
    for j, K in enumerate(COUNTS):
        here, angle = slice(FIRST[j], FIRST[j + 1]), angles(K, dual)
        t = -np.cos(angle)
        if dual:  # int T_n/sqrt(1-t^2) dt = -sin(n theta)/n with t = cos(theta)
            n = np.arange(1, K)[:, None]
            gap = -r[j] * (b[here][1:, None] / n * np.sin(n * (np.pi - angle))).sum(axis=0)
            expected = np.pi / (K + 1) * np.sin(angle) * r[j] * gap
        else:
            expected = np.pi / K * r[j] * chebval(t, b[here])
        np.testing.assert_allclose(force[here], expected, atol=1e-12 * period**2)
    np.testing.assert_allclose(
        expand_forces(FIRST, r, left, force, period, kind.shift, kind.derivative), b, atol=1e-12
    )
