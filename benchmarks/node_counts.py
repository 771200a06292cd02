"""Chebyshev coefficients that segments need, by their size and neighbours."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import click
import numpy as np
import scipy.optimize
import scipy.sparse

from weier import Profile
from weier.accuracy.measurement import measurement
from weier.data import markdown
from weier.kernels.arrays import Array
from weier.methods.patches.segments import NODE_FACTORS, ContactState, count_nodes, node_factors
from weier.methods.patches.solver import solve_state
from weier.methods.patches.stages import TARGET
from weier.methods.patches.start import Starts
from weier.methods.patches.surface import distances_between

TOLERANCE = 1e-12  # tolerance of the solutions: coefficients decay by twelve digits
DIGITS = (4, 6, 8, 10)
FRACTIONS = np.geomspace(0.003, 0.95, 8)  # load over full-contact load
QUANTILE = 0.9  # quantile of the fit; rounding up gives enough nodes to further segments
HEADER = ("digits", "enough by `NODE_FACTORS`", "nodes over needed", "enough by the fit", "nodes over needed")


def states(count: int) -> Iterator[tuple[Starts, ContactState]]:
    """Return the states of random series under light to heavy loads."""
    random = np.random.default_rng(count)
    for _ in range(count):
        m = int(random.integers(2, 5))
        profile = Profile(random.uniform(1.05, 1.7), int(random.integers(2, 6)), m, random.uniform(0, 2 * np.pi, m))
        starts = Starts(profile, TOLERANCE)
        for load in FRACTIONS * profile.full_contact_load:
            state, _ = solve_state(starts, float(load))
            if state is not None:
                yield starts, state


def needed(state: ContactState, digits: int) -> Array:
    """Return the number of coefficients of each segment that the target needs."""
    first = state.segments.first_node
    sizes = [np.abs(state.coefficient[a:b]) for a, b in pairwise(first)]
    return np.array([1 + np.flatnonzero(size > TARGET * 10.0**-digits * size.max())[-1] for size in sizes], float)


def terms(starts: Starts, state: ContactState) -> Array:
    """Return 1, k_f r and 1/ln(rho) of each segment, shape (segments, 3)."""
    series, r = state.kind.series(starts.surface), state.segments.half_width
    distance = distances_between(*state.segments.extent, series.period)
    mu = np.minimum(distance, np.roll(distance, 1)) / r
    return np.stack([np.ones(r.size), series.wavenumber[-1] * r, 1 / np.arccosh(1 + mu)], axis=1)


def fitted(matrix: Array, count: Array) -> Array:
    """Fit the factors K_i, linear in the digits, by quantile regression, shape (3, 2).

    `matrix` holds the terms, shape (segments, 3), and `count` the nodes needed, shape (digits, segments). Positive
    and negative deviations from a quantile q weigh q and 1 - q. The formula adds 2 nodes.
    """
    rows = np.concatenate([np.concatenate([matrix, digits * matrix], axis=1) for digits in DIGITS])
    cost = np.concatenate([np.zeros(6), np.repeat([QUANTILE, 1 - QUANTILE], len(rows))])
    one = scipy.sparse.eye_array(len(rows))
    equations = scipy.sparse.hstack([scipy.sparse.csr_array(rows), one, -one])
    bounds = [(None, None)] * 6 + [(0, None)] * (2 * len(rows))
    found = scipy.optimize.linprog(cost, A_eq=equations, b_eq=count.ravel() - 2, bounds=bounds)
    return np.asarray(found.x[:6].reshape(2, 3).T)


def given(starts: Starts, state: ContactState, factors: tuple[float, ...]) -> Array:
    """Return the number of nodes of each segment by the formula with these factors."""
    series = state.kind.series(starts.surface)
    nodes = count_nodes(*state.segments.extent, series.period, float(series.wavenumber[-1]), factors)
    return np.asarray(nodes, np.float64)


@measurement("Nodes of segments")
@click.option("--series", default=30, help="Number of random series.")
def main(series: int) -> list[str]:
    """Count the Chebyshev coefficients that contacts and gaps of random series need, and fit `NODE_FACTORS` to them.

    At a tolerance of 10^-digits, a coefficient is needed if |a_k|/max|a_k| exceeds the target of contact patches. The
    first guess of the nodes is K_0 + K_1 k_f r + K_2/ln(rho) + 2, rounded up, with K_i linear in the digits
    (docs/patches.md, "Chebyshev polynomials"), fitted to a quantile of 0.9. The numbers in use are larger than the
    fit: segments with too few nodes get more, at the cost of a step, and at ten digits fewer segments have too few.
    """
    found = list(states(series))
    matrix = np.concatenate([terms(*each) for each in found])
    count = np.array([np.concatenate([needed(state, digits) for _, state in found]) for digits in DIGITS])
    fit, rows = fitted(matrix, count), []
    for digits, needs in zip(DIGITS, count, strict=True):
        cells = [str(digits)]
        for factors in (node_factors(10.0**-digits), node_factors(10.0**-digits, tuple(map(tuple, fit)))):
            nodes = np.concatenate([given(*each, factors) for each in found])
            cells += [f"{np.mean(nodes >= needs):.1%}", f"{nodes.sum() / needs.sum():.2f}"]
        rows.append(cells)
    pairs = ", ".join(f"({constant:.2f}, {slope:.3f})" for constant, slope in fit)
    text = f"{len(matrix)} segments; fitted: `NODE_FACTORS = {pairs}`, used: `{NODE_FACTORS}`."
    return [markdown.table(HEADER, rows), text]
