"""Gaps as segments: cracks with given edges, in the tension of full contact.

At the zeros of U_K, f_i = r w_i omega_i with the gap w = sqrt(1-t^2) omega and the weights w_i of Gauss's quadrature.
With C the sum over all nodes of -1/(2 L^2 sin^2(pi (x_i - x_j)/L)),

    C f = the tension of full contact in all gaps,   d = sum f/L:

docs/patches.md, "Given edges". C is positive definite.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.patches.rule import Kind, Rule, cosine_sums
from weier.methods.patches.surface import CosineSeries


@kernel
def gap_rule(first_node: Indices, r: Array, period: float) -> Rule:
    """Return the rule of gaps: theta_i = pi (i + 1)/(K + 1).

    The finite part of the integral of sqrt(1-s^2) U_k/(t-s)^2 is -pi (k+1) U_k, so that a unit force at t_j makes
    -2 sum (k+1) U_k(t_i) U_k(t_j). Less 1/(t_i - t_j)^2, which the sum over all nodes has already, that is
    [X(i - j) - X(i + j + 2)]/(sin theta_i sin theta_j) with X(q) = -D(q) - 1/[4 sin^2(pi q/(2N))], N = K + 1,
    D(q) = sum_n n cos(pi n q/N), n <= K. The forces 2 pi r^2 w_i U_k/(k+1) make the pressure U_k. The gap is
    sum c_k sin((k+1) theta), whose slope has the coefficients b_n = -(n/r) c_(n-1).
    """
    nodes, n = first_node[-1], r.size
    offset, left, at_node, inverse_left = np.empty(nodes), np.empty(nodes), np.empty(nodes), np.empty(nodes)
    own, own_scale, inverse, inverse_scale = (
        np.empty(2 * nodes + n),
        np.empty(n),
        np.empty(2 * nodes + n),
        np.empty(n),
    )
    wave, step, turn, degree_scale = (
        np.empty(4 * nodes),
        np.empty(nodes, np.int64),
        np.empty(n, np.int64),
        np.empty(nodes),
    )
    angles = np.empty(n, np.int64)
    for j in range(n):
        first, K = first_node[j], first_node[j + 1] - first_node[j]
        N = K + 1
        X, G, W = own[2 * first + j : 2 * first + j + 2 * K + 1], inverse[2 * first + j :], wave[4 * first :]
        scale = (period / (np.pi * r[j])) ** 2
        if j > 0 and angles[j - 1] == N:
            X[:] = own[2 * first + j - 2 * K - 1 : 2 * first + j]
            for q in range(2 * K + 1):
                G[q] = inverse[2 * first + j - 2 * K - 1 + q]
            for q in range(4 * K):
                W[q] = wave[4 * first - 4 * K + q]
        else:
            cosine_sums(N, K, 1, X)
            cosine_sums(N, K, -1, G[: 2 * K + 1])
            for q in range(2 * N):
                W[q] = np.sin(np.pi / N * q)
            X[0] *= -1
            for q in range(1, 2 * K + 1):
                X[q] = -X[q] - 0.25 / np.sin(np.pi / (2 * N) * q) ** 2
        for i in range(K):
            step[first + i] = K - i
            sine = W[i + 1]
            offset[first + i] = -r[j] * np.cos(np.pi / N * (i + 1))
            left[first + i], inverse_left[first + i] = 1 / sine, np.pi / N * sine
            at_node[first + i] = 1 / 3 - 0.25 * scale / sine**4
            degree_scale[first + i] = -2 * i / (np.pi * r[j] ** 2)
        angles[j], turn[j], own_scale[j], inverse_scale[j] = N, 2 * N, scale, 2 * r[j] ** 2
    return Rule(
        offset,
        left,
        own,
        own_scale,
        at_node,
        inverse,
        inverse_left,
        inverse_scale,
        wave,
        step,
        turn,
        degree_scale,
        angles,
        -1.0,
        2,
        -0.5 / period**2,
        True,
    )


@kernel
def _close(force: Array, even: Array, load: float, period: float) -> tuple[Array, float]:
    """Return the forces as they are, since gaps close by themselves, and the mean gap."""
    return force, force.sum() / period


def _height_of_residual(half_width: Array) -> Array:
    """Return the displacement that a pressure makes over the width of its gap."""
    return 2 * half_width


def _finest_height(series: CosineSeries) -> float:
    """Return the amplitude of the finest wave of pressure over its number of waves in lambda_0."""
    return abs(float(series.amplitude[-1])) * 2 * np.pi / float(series.wavenumber[-1])


GAPS = Kind(
    dual=True,
    right_sign=-1.0,  # the slope is negative where a gap closes
    k_0_of_curvature=0.25,  # of a contact between gaps
    strength_factor=0.5 / np.pi,  # the slope of a gap is 2 pi times as strong as the pressure beyond its edge
    tangent_forcing=1.0,
    sign_of_plane=1.0,
    rounding_power=0,
    close=_close,
    factor=lambda period: -0.5 / period**2,
    forcing_of_maximum=lambda series, load: series.maximum - load,
    height_of_residual=_height_of_residual,
    finest_height=_finest_height,
)
