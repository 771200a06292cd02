"""Chebyshev coefficients that segments need, by their size and neighbours: `python -m weier.accuracy.node_counts`.

For a tolerance of 10^-digits the coefficients above `TARGET` times it, relative to the largest, are counted on
contacts and gaps of random series, and K_0 + K_1 k_f r + K_2/ln(rho) is fitted to these counts. `node_factors` of
contact patches lies above the fit, since a segment with too few nodes costs a step.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import click
import numpy as np

from weier import Profile
from weier.data import markdown
from weier.kernels.arrays import Array
from weier.kernels.blas import one_thread
from weier.methods.patches.segments import ContactState, estimate_node_count, node_factors
from weier.methods.patches.solver import solve_state
from weier.methods.patches.stages import TARGET
from weier.methods.patches.start import Starts
from weier.methods.patches.surface import distances_between

TOLERANCE = 1e-12  # of the solutions, so that their coefficients decay by twelve digits
DIGITS = (4, 6, 8, 10)
FRACTIONS = np.geomspace(0.003, 0.95, 8)  # loads over that of full contact
HEADER = (
    "digits",
    "fitted K_0, K_1, K_2",
    "those of `node_factors`",
    "segments with enough nodes",
    "nodes over needed",
)


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
    series, r = starts.surface.series(state.dual), state.segments.half_width
    distance = distances_between(*state.segments.extent, series.period)
    mu = np.minimum(distance, np.roll(distance, 1)) / r
    return np.stack([np.ones(r.size), series.wavenumber[-1] * r, 1 / np.arccosh(1 + mu)], axis=1)


@click.command(context_settings={"show_default": True})
@click.option("--series", default=30, help="Number of random series.")
@one_thread
def main(series: int) -> None:
    """Print the factors fitted by least squares, those of the program, and how many segments have enough nodes."""
    found = list(states(series))
    matrix, rows = np.concatenate([terms(*each) for each in found]), []
    for digits in DIGITS:
        count = np.concatenate([needed(state, digits) for _, state in found])
        given = np.concatenate(
            [
                estimate_node_count(state.segments.extent, starts.surface.series(state.dual), 10.0**-digits)
                for starts, state in found
            ]
        )
        fitted, own = np.linalg.lstsq(matrix, count)[0], node_factors(10.0**-digits)
        factors = (", ".join(f"{value:.2f}" for value in each) for each in (fitted, own))
        rows.append([str(digits), *factors, f"{np.mean(given >= count):.0%}", f"{np.mean(given / count):.2f}"])
    click.echo(f"{len(matrix)} segments\n\n{markdown.table(HEADER, rows)}")


if __name__ == "__main__":
    main()
