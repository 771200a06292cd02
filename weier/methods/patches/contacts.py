"""Contacts as segments: punches with given edges, under the load that they share.

At the zeros of T_K, f_i = (pi/K) r psi_i. With A the sum over all nodes of -2 ln|2 sin(pi (x_i - x_j)/L)|,

    z - A f = d on all contacts,   sum f = p L,

with d the mean gap: docs/patches.md, "Given edges". A is positive definite on forces of sum 0, and `OFFSET` makes it
so on all.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.patches.rule import Kind, Rule, cosine_sums
from weier.methods.punches import OFFSET


@kernel
def contact_rule(first_node: Indices, r: Array, period: float) -> Rule:
    """Return the rule of contacts: theta_i = pi (i + 1/2)/K.

    The integral of T_k/sqrt(1-s^2) with ln|t-s| is -(pi/k) T_k, and -pi ln 2 for k = 0, so that a unit force at t_j
    makes -ln 2 - 2 sum T_k(t_i) T_k(t_j)/k. Less ln|t_i - t_j|, which the sum over all nodes has already, that is
    X(i - j) + X(i + j + 1) with X(q) = -ln 2 - C(q) - ln sin(pi q/(2K)), C(q) = sum_k cos(pi k q/K)/k, k < K.
    The forces (k/(2K)) T_k make the displacement T_k.
    """
    nodes, n = first_node[-1], r.size
    offset, left, at_node, inverse_left = np.empty(nodes), np.ones(nodes), np.empty(nodes), np.ones(nodes)
    own, own_scale, inverse, inverse_scale = np.empty(2 * nodes + n), np.ones(n), np.empty(2 * nodes + n), np.empty(n)
    wave, step, turn, degree_scale = (
        np.empty(4 * nodes),
        np.empty(nodes, np.int64),
        np.empty(n, np.int64),
        np.empty(nodes),
    )
    angles = np.empty(n, np.int64)
    for j in range(n):
        first, K = first_node[j], first_node[j + 1] - first_node[j]
        X, F, W = own[2 * first + j : 2 * first + j + 2 * K + 1], inverse[2 * first + j :], wave[4 * first :]
        if j > 0 and angles[j - 1] == K:
            X[:] = own[2 * first + j - 2 * K - 1 : 2 * first + j]
            for q in range(2 * K + 1):
                F[q] = inverse[2 * first + j - 2 * K - 1 + q]
            for q in range(4 * K):
                W[q] = wave[4 * first - 4 * K + q]
        else:
            cosine_sums(K, K - 1, -1, X)
            cosine_sums(K, K - 1, 1, F[: 2 * K + 1])
            for q in range(4 * K):
                W[q] = np.cos(np.pi / (2 * K) * q)
            X[0] *= -1
            for q in range(1, 2 * K):
                X[q] = -np.log(2 * np.sin(np.pi / (2 * K) * q)) - X[q]
        for i in range(K):
            step[first + i] = 2 * K - 2 * i - 1
            sine = np.sin(np.pi / (2 * K) * (2 * i + 1))
            offset[first + i] = r[j] * W[2 * K - 2 * i - 1]
            at_node[first + i] = np.log(2 * np.pi / period * r[j] * sine)
            degree_scale[first + i] = (1 if i == 0 else 2) / (np.pi * r[j])
        angles[j], turn[j], inverse_scale[j] = K, 4 * K, 0.5 / K**2
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
        1.0,
        1,
        -2.0,
        False,
    )


@kernel
def _close(force: Array, even: Array, load: float, period: float) -> tuple[Array, float]:
    """Return the forces that carry the load, displaced by the same height everywhere, and the plane."""
    shift, of_even, carrying = load * period, 0.0, np.empty(force.size)
    for i in range(force.size):
        shift, of_even = shift - force[i], of_even + even[i]
    shift /= of_even
    for i in range(force.size):
        carrying[i] = force[i] + shift * even[i]
    return carrying, OFFSET * load * period - shift


CONTACTS = Kind(
    dual=False,
    right_sign=1.0,
    k_0_of_curvature=-0.75,  # of a gap in a parabola of tension
    strength_factor=1.0,
    tangent_forcing=0.0,
    sign_of_plane=-1.0,
    rounding_power=2,
    close=_close,
    factor=lambda period: -2.0,
    forcing_of_maximum=lambda series, load: 0.0,
    height_of_residual=np.ones_like,
    finest_height=lambda series: abs(float(series.amplitude[-1])),
)
