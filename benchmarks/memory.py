"""Peak memory of boundary elements by their nodes, and of contact patches by their contacts.

`python -m benchmarks.memory` runs each in a process of its own, and prints what stands in the error models of the
methods.
"""

from __future__ import annotations

import multiprocessing
import resource
import sys
from collections.abc import Callable

import numpy as np

from weier import Profile, random_phases
from weier.methods import bem, hybrid, patches
from weier.methods.hybrid.solver import POINTS_PER_WAVE

UNIT = 1 if sys.platform == "darwin" else 1024  # The unit of ru_maxrss, in bytes.
# The sizes at which memory is measured, and the loads.
NODES = (2**14, 2**17, 2**20)
RESOLVED = (8, 9, 10)
TERMS = (6, 7, 8)
LOADS = np.array([0.03, 0.3, 1.0])


def main() -> None:
    """Print bytes a node, and dense matrices in copies."""
    for points in NODES:
        used, _ = _measured(_grid, points)
        print(f"bem, {points} nodes: {used / points:.0f} bytes a node; the model has {bem.error_model.BYTES_NODE}")
    for terms in RESOLVED:
        used, points = _measured(_on_layer, terms)
        print(
            f"hybrid, {points:g} nodes: {used / points:.0f} bytes a node; the model has "
            f"{hybrid.error_model.BYTES_NODE}"
        )
    for terms in TERMS:
        used, contacts = _measured(_exact, terms)
        print(
            f"patches, {2 ** (terms - 1)} waves, {contacts:g} contacts: {used / 1e6:.2g} MB; "
            f"the model has {patches.error_model.memory(2 ** (terms - 1), contacts) / 1e6:.2g} MB"
        )


def _measured(run: Callable[[int], float], size: int) -> tuple[float, float]:
    """Bytes at most, beyond those of a small run before, and what `run` returns."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(_peak, (run, size))


def _peak(run: Callable[[int], float], size: int) -> tuple[float, float]:
    run(1 if run is _on_layer else 2 if run is _exact else 256)  # loads compiled code
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    found = run(size)
    return UNIT * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before), found


def _grid(points: int) -> float:
    return bem.curve(Profile(1.5, 2, 5, random_phases(1)), LOADS, points=points, max_residual=1e-6).points


def _on_layer(terms: int) -> float:
    hybrid.curve(Profile(1.5, 2, float("inf"), random_phases(1)), LOADS[1:], terms)
    return POINTS_PER_WAVE * 2 ** (terms - 1)


def _exact(terms: int) -> float:
    return float(patches.curve(Profile(1.7, 2, terms, random_phases(1)), LOADS).patch_count.max())


if __name__ == "__main__":
    main()
