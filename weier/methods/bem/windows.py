"""The nodes about a contact or a gap that its polynomials are fitted on, and the fits, which are the same for all."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.edges import Edges
from weier.methods.bem.polynomials import DEGREE, TERMS, derivative, fit_polynomials, next_terms, value

EDGE = 0.384947631413  # nodes from the last one in contact to the edge of a flat punch, in the mean of a step
MAX_BEYOND = 1.5  # nodes from the last one in contact to its edge: half a node in all that a grid can miss
MARGIN = 2  # nodes beyond a contact or a gap that its polynomial is fitted on, at each end; more if it has few itself
MAX_MARGIN = (TERMS + 1) // 2 + MARGIN
CREST_MARGIN = DEGREE // 2  # and beyond the highest node of a gap, or the node of least pressure in a contact
MAX_FITTED = 25  # nodes that a polynomial is fitted on: more add nothing
MIN_POLYNOMIAL = 3  # nodes of a window: a parabola


class Windows(NamedTuple):
    """Fits for windows of w = 0, 1, ... nodes, in s from -1 at the first to 1 at the last; those below 2 are empty.

    fitted : nodes that are fitted on, shape (windows,)
    degree : of the polynomial, shape (windows,)
    offset : of these nodes from the first of the window, shape (windows, MAX_FITTED)
    coefficient : of s^k for a value of 1 at one of these nodes, shape (windows, MAX_FITTED, TERMS)
    following : what the fit makes of the two Chebyshev polynomials after its degree, shape (windows, 2, TERMS)
    """

    fitted: Indices
    degree: Indices
    offset: Indices
    coefficient: Array
    following: Array


@kernel
def make_windows(most: int) -> Windows:
    """Fits for windows of up to so many nodes."""
    windows = Windows(
        np.zeros(most + 1, np.int64), np.zeros(most + 1, np.int64), np.zeros((most + 1, MAX_FITTED), np.int64),
        np.zeros((most + 1, MAX_FITTED, TERMS)), np.zeros((most + 1, 2, TERMS)),
    )  # fmt: skip
    for whole in range(2, most + 1):
        fitted = min(whole, MAX_FITTED)
        degree = min(DEGREE, fitted - 1)
        for i in range(fitted):
            windows.offset[whole, i] = (i * (whole - 1) + (fitted - 1) // 2) // (fitted - 1)
        s = windows.offset[whole, :fitted] / scale_of(whole) - 1
        windows.fitted[whole], windows.degree[whole] = fitted, degree
        windows.coefficient[whole, :fitted] = fit_polynomials(s, np.eye(fitted), degree)
        windows.following[whole] = fit_polynomials(s, next_terms(s, degree), degree)
    return windows


@kernel
def scale_of(whole: int) -> float:
    """The nodes in one s of a window of so many."""
    return (whole - 1) / 2


@kernel
def fit_window(windows: Windows, whole: int, values: Array) -> Array:
    """Least-squares polynomials, shape (k, TERMS), of values at the nodes of a window, shape (k, fitted)."""
    polynomials = np.zeros((values.shape[0], TERMS))
    coefficient = windows.coefficient[whole]
    for j in range(values.shape[0]):
        for i in range(values.shape[1]):
            for k in range(TERMS):
                polynomials[j, k] += coefficient[i, k] * values[j, i]
    return polynomials


@kernel
def margin_of(edge: Edges, run: int) -> int:
    """Nodes beyond both ends of a run that belong to no further one, at most as many as the polynomial needs."""
    before, nodes = edge[run + 1] - edge[run], edge[run + 2] - edge[run + 1]
    after = edge[run + 3] - edge[run + 2] if run + 3 < edge.size else edge[2] - edge[1]
    return min(max(MARGIN, (TERMS - nodes + 1) // 2), before, after)


@kernel
def average_under_triangle(polynomial: Array, scale: float) -> Array:
    """The moving average of a polynomial under a triangle of the nodes' spacing."""
    second = derivative(derivative(polynomial))
    fourth = derivative(derivative(second))
    return polynomial + second / (12 * scale**2) + fourth / (360 * scale**4)


@kernel
def added_by_triangles(polynomial: Array, nodes: int, scale: float) -> Array:
    """What that average adds at the nodes of a run, to second differences."""
    second = derivative(derivative(polynomial))
    values = np.empty(nodes)
    for i in range(nodes):
        values[i] = value(second, (i - (nodes - 1) / 2) / scale) / (12 * scale**2)
    return values


@kernel
def side_margin(node: int, contact: Flags) -> int:
    """Nodes to each side of this one that are in contact if it is, and not if it is not; at most CREST_MARGIN."""
    margin = 1
    while (
        margin < CREST_MARGIN
        and contact[node - margin - 1] == contact[node]
        and contact[(node + margin + 1) % contact.size] == contact[node]
    ):
        margin += 1
    return margin
