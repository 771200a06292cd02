"""Convergence of the estimate and the bounds of the infinite series with the number of resolved terms."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
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
    """The infinite series with some terms resolved by boundary elements: bounds, shape (2, loads)."""

    terms: int
    nodes: float
    bounds: Array


def measure(profile: Profile, loads: Array, max_terms: int) -> Iterator[Resolved]:
    """Yield bounds on an infinite series with 1, 2, ... resolved terms, as far as they are within reach."""
    for terms in range(1, max_terms + 1):
        kept = profile.truncated(terms)
        tolerance = min(MESH_FRACTION * kept.tail_amplitude, MAX_TOLERANCE)
        with suppress(ConvergenceError, OutOfReachError):
            solved = run(Variant(bem.METHOD.name, {"tolerance": tolerance}), kept, loads)
            bounds = complete_bounds(solved.values[0], kept.tail_amplitude, profile.total_amplitude, solved.stated[0])
            yield Resolved(terms, solved.others["points"], np.stack(bounds))


def rows(profile: Profile, resolved: Sequence[Resolved]) -> Iterator[list[str]]:
    """Yield the largest half-width of the bounds over the loads, and the distance of their middle from the last."""
    seed, middles = profile.labels["seed"], [one.bounds.mean(axis=0) for one in resolved]
    name = profile.describe() + ("" if np.isnan(seed) else f", seed = {seed:.0f}")
    for one, middle in zip(resolved, middles, strict=True):
        error = np.nan if middle is middles[-1] else np.abs(middle - middles[-1]).max()
        width = np.ptp(one.bounds, axis=0).max() / 2
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
    found = (rows(case.profile, [*measure(case.profile, loaded.loads, terms)]) for case in loaded.distinct)
    return [table(HEADER, chain.from_iterable(found))]
