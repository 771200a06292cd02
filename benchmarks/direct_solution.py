"""Processor time of direct solutions over conjugate gradients."""

from __future__ import annotations

from time import process_time

import click
import numpy as np

from weier.accuracy.measurement import measurement
from weier.data import markdown
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.given_edges import Forces, make_punches, solve_forces_on_contacts, solve_tangent
from weier.methods.patches.kind import Kind
from weier.methods.patches.segments import Segments, make_segments

NODES, RESIDUAL, REDUCTION = 8, 1e-12, 1e-8  # nodes of a segment, and accuracies of a load at the default tolerance
SEGMENTS = (20, 30, 40, 50, 60, 80, 120)
HEADER = ("unknowns", "contacts", "gaps")


def random_segments(count: int) -> Segments:
    """Return segments of random widths and distances in a period of 1."""
    random, none = np.random.default_rng(count), np.zeros(count)
    centre = (np.arange(count) + 0.5 * random.random(count)) / count
    half_width = random.uniform(0.02, 0.24, count) / count
    return make_segments(none.astype(np.int64), none, centre, half_width, np.full(count, NODES))


def solve(segments: Segments, kind: Kind, directly: bool) -> tuple[Forces, Forces]:
    """Return the solution under a uniform forcing and its increment, directly or by conjugate gradients."""
    unknowns = segments.first_node[-1]
    punches, none = make_punches(segments, 1.0, kind, unknowns if directly else 0), np.zeros(unknowns)
    forces = solve_forces_on_contacts(punches, none + kind.increment, 1.0, RESIDUAL)
    return forces, solve_tangent(punches, forces, REDUCTION)


def ratio(count: int, kind: Kind, rounds: int) -> float:
    """Return the ratio of the least processor times, direct solutions over conjugate gradients."""
    segments, seconds = random_segments(count), {True: np.inf, False: np.inf}
    for _ in range(rounds + 1):  # The first round compiles.
        for directly in seconds:
            start = process_time()
            solve(segments, kind, directly)
            seconds[directly] = min(seconds[directly], process_time() - start)
    return seconds[True] / seconds[False]


@measurement("Direct solution or conjugate gradients")
@click.option("--rounds", default=10, help="Solutions of each kind, of which the fastest counts.")
def main(rounds: int) -> list[str]:
    """Compare the processor time of direct solutions with that of conjugate gradients.

    The table has the ratio of the two by the number of unknowns, for contacts and for gaps of random widths with 8
    nodes each. `MAX_DIRECT` of contact patches is the number at which the ratio reaches 1.
    """
    rows = ([str(NODES * n), *(f"{ratio(n, kind, rounds):.2f}" for kind in (CONTACTS, GAPS))] for n in SEGMENTS)
    return [markdown.table(HEADER, rows)]
