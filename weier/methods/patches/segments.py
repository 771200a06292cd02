"""Segments with their Chebyshev nodes, round the period."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.methods.patches.chebyshev import central_logarithm, nodes, weights

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

LN_FAR = 18.5  # Gauss's error is rho^(-2 (K+1)), rho that of Bernstein's ellipse: 1e-16 from ln(rho) = 18.5/(K+1) on


class Segments(NamedTuple):
    """Segments [c-r, c+r], each counted from a summit, with the nodes of all of them in a row.

    summit : index of that summit, shape (segments,)
    origin : its place, or that of the image next to the segment, in lambda_0, shape (segments,)
    centre, half_width : c from the origin, and r, in lambda_0, shape (segments,)
    first : each segment's first node and, last, the count of all nodes, shape (segments + 1,)
    node : Gauss nodes t in (-1, 1), descending within a segment, shape (nodes,)
    weight : of int sqrt(1-t^2) phi dt over a segment, shape (nodes,)
    central : of int sqrt(1-t^2) phi ln|t| dt, shape (nodes,)
    reach : distance from c beyond which the quadrature is exact, in half-widths, shape (segments,)
    sine, cosine : of pi r t/L at the nodes, shape (nodes,): with them sin(pi (x-s)/L) needs no call, and loses no
        digit either, for the two angles that it combines are counted from the segment's own centre
    """

    summit: Indices
    origin: Array
    centre: Array
    half_width: Array
    first: Indices
    node: Array
    weight: Array
    central: Array
    reach: Array
    sine: Array
    cosine: Array


def make_segments(
    summit: Indices, origin: Array, centre: Array, half_width: Array, count: Indices, period: float
) -> Segments:
    """Segments with `count` nodes each."""
    first = np.concatenate([[0], np.cumsum(count)])
    node, weight, central = np.concatenate([_rule(int(k)) for k in count], axis=1)
    sine, cosine = _turns(half_width, count, node, period)
    reach = np.cosh(LN_FAR / (count + 1))
    return Segments(summit, origin, centre, half_width, first, node, weight, central, reach, sine, cosine)


@cache
def _rule(count: int) -> Array:
    return np.stack([nodes(count), weights(count), central_logarithm(count)])


def _turns(half_width: Array, count: Indices, node: Array, period: float) -> tuple[Array, Array]:
    angle = np.pi / period * np.repeat(half_width, count) * node
    return np.sin(angle), np.cos(angle)


def moved(segments: Segments, centre: Array, half_width: Array, period: float) -> Segments:
    """The same segments elsewhere."""
    sine, cosine = _turns(half_width, np.diff(segments.first), segments.node, period)
    return segments._replace(centre=centre, half_width=half_width, sine=sine, cosine=cosine)


def spaces(segments: Segments, period: float) -> Array:
    """Distance from each segment's right end to the next one's left end, round the period."""
    left = segments.centre - segments.half_width
    right = segments.centre + segments.half_width
    apart = from_right(segments.origin) - segments.origin
    apart[-1] += period
    return apart + (from_right(left) - right)


def from_right(value: Array) -> Array:
    """The values of each segment's neighbour on the right: np.roll(value, -1), many times faster."""
    return np.concatenate([value[1:], value[:1]])
