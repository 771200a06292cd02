"""Convergence of the estimate and the bounds of the infinite series with the number of resolved terms."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import click
import numpy as np

from weier.accuracy.measurement import measurement, number
from weier.accuracy.runner import Variant, run
from weier.data.markdown import table
from weier.kernels.arrays import Array
from weier.methods import bem
from weier.methods.errors import ConvergenceError, OutOfReachError
from weier.scene import load
from weier.surface.profile import Profile
from weier.theory.bounds import complete_bounds

SCENE = Path("config/accuracy/infinite.yaml")
MESH_FRACTION = 0.1  # ratio of mesh error to tail amplitude; the mesh widens the bounds by at most a tenth
MAX_TOLERANCE = 0.9  # g_0: limit on the tolerance of boundary elements; the tail is much higher for gamma near 1
HEADER = ("series", "resolved terms", "nodes", "half-width of the bounds", "error of the estimate")


class Resolved(NamedTuple):
    """The infinite series with some terms resolved by boundary elements, at all loads: bounds, and their middle."""

    terms: int
    nodes: float
    low: Array
    high: Array

    @property
    def estimate(self) -> Array:
        """The middle of the bounds."""
        return (self.low + self.high) / 2


def measure(profile: Profile, loads: Array, max_terms: int) -> list[Resolved]:
    """Return bounds on an infinite series with 1, 2, ... resolved terms, skipping numbers out of reach."""
    found = []
    for terms in range(1, max_terms + 1):
        kept = profile.truncated(terms)
        tolerance = min(MESH_FRACTION * kept.tail_amplitude, MAX_TOLERANCE)
        try:
            solved = run(Variant(bem.METHOD.name, {"tolerance": tolerance}), kept, loads)
        except (ConvergenceError, OutOfReachError) as error:
            print(f"{profile.describe()}, {terms} terms resolved: {error}", file=sys.stderr)
            continue
        bounds = complete_bounds(solved.values[0], kept.tail_amplitude, profile.total_amplitude, solved.stated[0])
        found.append(Resolved(terms, solved.others["points"], *bounds))
    return found


def rows(profile: Profile, resolved: Sequence[Resolved]) -> Iterator[list[str]]:
    """Yield the largest half-width of the bounds over the loads, and the distance from the last estimate."""
    seed, last = profile.labels["seed"], resolved[-1]
    name = profile.describe() + ("" if np.isnan(seed) else f", seed = {seed:.0f}")
    for one in resolved:
        width = (one.high - one.low).max() / 2
        error = np.nan if one is last else np.abs(one.estimate - last.estimate).max()
        yield [name, str(one.terms), f"{one.nodes:.0f}", number(width, ".1e"), number(error, ".1e")]


@measurement("The infinite series, by the terms that are resolved")
@click.option("--scene", type=click.Path(path_type=Path), default=SCENE, help="Its infinite series and loads.")
@click.option("--terms", default=8, help="The largest number of resolved terms.")
def main(scene: Path, terms: int) -> list[str]:
    """Measure infinite series against the number of resolved terms.

    Heights are in g_0, at the worst load. The bounds hold for any phases of the unresolved terms. The
    estimate is their middle, as in the method "auto"; its error is the distance from the estimate with most terms.
    Nodes are nodes of boundary elements.
    """
    loaded = load(scene)
    found = (rows(case.profile, measure(case.profile, loaded.loads, terms)) for case in loaded.distinct)
    return [table(HEADER, chain.from_iterable(found))]
