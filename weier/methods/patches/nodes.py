"""How many nodes a segment takes: foreseen from the waves and the neighbours, then from the tail of a solution."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.methods.errors import ConvergenceError
from weier.methods.patches.fields import State
from weier.methods.patches.segments import make_segments, spaces
from weier.methods.patches.waves import Waves

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

FEWEST_NODES = 8
MOST_NODES = 1000
WAVE_SHARE = 0.8  # nodes = 8 + 0.8 k r + 9/ln(rho): what the tails of converged solutions asked for
SPACE_SHARE = 9.0
# Of a half-width: what a guess believes of a space; a solution asks for more nodes by its tails.
NEAREST, FARTHEST = 0.01, 1e6
TAIL = 0.1  # to aim at, over the tolerance
LEAST_TAIL, MOST_TAIL = 1e-16, 0.5  # rounding, and no decay to speak of: what lies beyond tells no rate
SLOWEST_DECAY = 1e-3  # of ln(tail) a node, so that the rate can be divided by
MOST_FEWER = 2  # nodes taken away at once, for a tail may be small by chance; added are no more than there are
ROUNDING, MOST_ROUNDING = 1e-14, 1e-3  # of a tail; a density falls with the width squared and rounding does not


def expected_nodes(placed: tuple[Indices, Array, Array, Array], waves: Waves) -> Indices:
    """Nodes for the waves within a segment and the nearness of its neighbours, by Bernstein's ellipse."""
    half_width = placed[-1]
    bare = make_segments(*placed, np.full(half_width.size, 2), waves.period)
    space = spaces(bare, waves.period)
    near = np.clip(np.minimum(space, np.roll(space, 1)) / half_width, NEAREST, FARTHEST)
    ln_rho = np.log1p(near + np.sqrt(near * (near + 2)))
    count = FEWEST_NODES + WAVE_SHARE * waves.frequency[-1] * half_width + SPACE_SHARE / ln_rho
    return np.minimum(np.ceil(count), MOST_NODES).astype(np.int64)


def adjusted_nodes(count: Indices, tail: Array, aim: float, where: Flags) -> Indices:
    """Nodes that bring the tail to `aim` if it goes on decaying as it did so far."""
    tail = np.clip(tail, LEAST_TAIL, MOST_TAIL)
    change = np.ceil(np.log(tail / aim) / np.maximum(-np.log(tail) / count, SLOWEST_DECAY))
    new = count + np.where(where, np.clip(change, -MOST_FEWER, count), 0)
    return np.clip(new, FEWEST_NODES, MOST_NODES).astype(np.int64)


def tails(state: State) -> Array:
    """Size of the last two Chebyshev coefficients over the largest, shape (segments,)."""
    first, size = state.segments.first, np.abs(state.coefficient)
    return np.maximum(size[first[1:] - 1], size[first[1:] - 2]) / np.maximum.reduceat(size, first[:-1])


def more_nodes(state: State, tolerance: float) -> Indices | None:
    """Nodes of each segment that let the coefficients decay to the tolerance; None if all have.

    Raises
    ------
    ConvergenceError
        If a segment has the most nodes already.
    """
    half_width, count, tail = state.segments.half_width, np.diff(state.segments.first), tails(state)
    rounding = np.minimum(ROUNDING * (half_width.max() / half_width) ** 2, MOST_ROUNDING)
    rough = tail > np.maximum(tolerance, rounding)
    if not np.any(rough):
        return None
    if np.any(count[rough] >= MOST_NODES):
        raise ConvergenceError(
            f"a space between two contacts or two gaps is too narrow for {MOST_NODES} nodes under the mean "
            f"pressure {state.load:.6g} p_0*",
            float(tail.max()),
        )
    return adjusted_nodes(count, tail, TAIL * tolerance, rough)
