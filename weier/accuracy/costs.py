"""The cost of parts of weier: `python -m weier.accuracy.costs` prints one table.

Estimates against np.log of as many numbers, the layer's curve, a batch against the sum of its solves, the import,
and the compilation of all kernels. Each time is the least of several, taken in turn with what it is compared to.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr
from functools import partial
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from weier.data import markdown
from weier.methods import archard, demelio, layer
from weier.pipeline.batch import solve_batch
from weier.scene import Case

Row = tuple[str, str]

# Sizes of the measurements.
LOADS = 40
CASES, LONG, SOLVES = 1000, 10**6, 200
TERMS = (3, 10, math.inf)
REPEATS = 15  # The least time of so many runs counts.


def main() -> None:
    """Print all parts."""
    rows = [*estimates(CASES, LONG), *layers(LOADS), *batches(SOLVES), fresh_import(), compilation()]
    print(markdown.table(["part", "measured"], rows))


def least_seconds(*runs: Callable[[], object], repeats: int) -> list[float]:
    """The shortest time of each, after a run that compiles or fills caches."""
    least = [math.inf] * len(runs)
    for repeat in range(repeats + 1):
        for number, run in enumerate(runs):
            begin = perf_counter()
            run()
            if repeat:
                least[number] = min(least[number], perf_counter() - begin)
    return least


def estimates(cases: int, long: int) -> Iterator[Row]:
    """Times of both estimates over that of np.log: 40 loads of many cases, and many loads of one."""
    D = np.random.default_rng(0).uniform(1.05, 1.95, cases)[:, None]
    for what, loads, dimension in (
        (f"{LOADS} loads of {cases} cases", np.geomspace(1e-3, 10, LOADS), D),
        (f"{long} loads of one case", np.geomspace(1e-3, 10, long), np.float64(1.25)),
    ):
        numbers = np.broadcast_to(loads, np.broadcast_shapes(loads.shape, dimension.shape)).copy()
        for estimate in (archard, demelio):
            for m in TERMS:
                log, h, R = least_seconds(
                    partial(np.log, numbers),
                    partial(estimate.compliance, loads, dimension, 5, m),
                    partial(estimate.resistance, loads, dimension, 5, m),
                    repeats=REPEATS,
                )
                name = estimate.__name__.removeprefix("weier.")
                yield f"{name}, m = {m:g}, {what}", f"h {h / log:.2f}, R {R / log:.2f} times np.log"


def layers(loads: int) -> Iterator[Row]:
    """Time of the layer's curve."""
    p = np.geomspace(1e-3, 10, loads)
    for m in TERMS:
        (curve,) = least_seconds(partial(layer.curve, p, 1.25, 5, m), repeats=REPEATS)
        yield f"layer, m = {m:g}, {loads} loads", f"{1e3 * curve:.2f} ms"


def batches(solves: int) -> Iterator[Row]:
    """Time of a batch over the seconds of its solves."""
    cases = tuple(Case({"D": 1.25, "gamma": 5, "m": 3, "seed": seed}, ("bem",), {}) for seed in range(solves))
    loads = np.geomspace(1e-3, 2, LOADS)
    solved = []
    with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stderr(nowhere):
        (took,) = least_seconds(lambda: solved.append(float(solve_batch(cases, loads)["seconds"].sum())), repeats=3)
    alone = min(solved)
    yield f"batch of {solves} solves by bem", f"{took / alone:.2f} times the sum of its solves, {alone:.2f} s"


def fresh_import() -> Row:
    """Time of `import weier` in a process of its own, less that of an empty one."""
    with_it, without = least_seconds(lambda: _python("-c", "import weier"), lambda: _python("-c", ""), repeats=5)
    return "import weier", f"{with_it - without:.2f} s"


def compilation() -> Row:
    """Time to compile all kernels, into an empty folder, and to load them from it."""
    with TemporaryDirectory() as folder:
        begin = perf_counter()
        _python("-m", "weier", "compile", NUMBA_CACHE_DIR=folder)
        cold = perf_counter() - begin
        (warm,) = least_seconds(lambda: _python("-m", "weier", "compile", NUMBA_CACHE_DIR=folder), repeats=1)
    return "compiling all kernels", f"{cold:.1f} s, {warm:.1f} s once compiled"


def _python(*arguments: str, **environment: str) -> None:
    subprocess.run([sys.executable, *arguments], check=True, env=os.environ | environment)


if __name__ == "__main__":
    main()
