"""Time and errors of each method on random series: `python -m weier.accuracy.random_series [SERIES]`.

The series are those of `weier.accuracy.families` that are not made to be hard. The reference is contact patches at
a tolerance of 1e-12 g_0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from time import process_time
from typing import Any, NamedTuple

import click
import numpy as np

from weier import Profile
from weier.accuracy.families import REFERENCE, relative_scale, usual_profile
from weier.data import markdown
from weier.kernels.arrays import Array
from weier.kernels.blas import one_thread
from weier.methods import patches
from weier.methods.registry import find_method

SEED = 11  # The numbers of the README are for this seed.
LOADS = 20  # So many loads of each series are compared.
MIN_LOAD, MAX_LOAD = 1e-3, 0.98  # The range of loads: in p_0*, and over the load of full contact.
MAX_WAVES = 64  # A load by contact patches takes milliseconds with so many waves in a period.
REPEATS = 3  # The least time of so many runs counts.
METHODS: dict[str, tuple[str, dict[str, Any]]] = {
    "Archard": ("archard", {}),
    "Demelio": ("demelio", {}),
    "layer": ("layer", {}),
    **{f"bem {tolerance:.0e}": ("bem", {"tolerance": tolerance}) for tolerance in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)},
    **{f"patches {tolerance:.0e}": ("patches", {"tolerance": tolerance}) for tolerance in (1e-4, 1e-10)},
}
HEADER = (
    "method",
    "ms a load",
    "error of h: median / 90 % / largest",
    "its bound: median",
    "largest ratio",
    "error of R: median / 90 % / largest",
    "its bound: median",
    "largest ratio",
)


class Case(NamedTuple):
    """A series under increasing loads, with its compliance and resistance by the reference.

    exact : compliance in g_0 and resistance in g_0/p_0*, shape (2, loads)
    uncertainty : what the reference states of their errors, of the same shape and units
    """

    profile: Profile
    loads: Array
    exact: Array
    uncertainty: Array


class Measured(NamedTuple):
    """A method on one case.

    seconds : processor time of the curve
    error : of h in g_0 and of R relative to itself, shape (2, loads); R below 1e-3 g_0/p_0* is compared with 1
    bound : the stated errors, shape (2, loads); NaN where there are none
    ratio : error over bound, shape (2, loads), after the uncertainty of the reference is taken off the error
    """

    seconds: float
    error: Array
    bound: Array
    ratio: Array


def random_case(random: np.random.Generator) -> Case:
    """A usual series under loads anywhere between 1e-3 p_0* and 0.98 of full contact, on a logarithmic scale."""
    profile = usual_profile(random, MAX_WAVES)
    most = max(MAX_LOAD * profile.full_contact_load, 2 * MIN_LOAD)
    loads = np.unique(np.exp(random.uniform(math.log(MIN_LOAD), math.log(most), LOADS)))
    exact = patches.curve(profile, loads, REFERENCE[0])
    uncertainty = np.array([exact.compliance_error, exact.resistance_error])
    return Case(profile, loads, np.array([exact.compliance, exact.resistance]), uncertainty)


def measure(case: Case, method: str, settings: dict[str, Any], repeats: int = REPEATS) -> Measured:
    """Time a method on a case, and compare it with the reference."""
    solve: Callable[..., Any] = find_method(method).solve
    least = math.inf
    for _ in range(repeats):
        begin = process_time()
        curve = solve(case.profile, case.loads, **settings)
        least = min(least, process_time() - begin)
    unknown = np.full(case.loads.size, math.nan)
    bound = [getattr(curve, f"{quantity}_error", unknown) for quantity in ("compliance", "resistance")]
    error = np.abs(np.array([curve.compliance, curve.resistance]) - case.exact)
    ratio = np.maximum(error - case.uncertainty, 0) / np.array(bound)
    scale = np.array([np.ones(case.loads.size), relative_scale(case.exact[1])])
    return Measured(least, error / scale, np.array(bound) / scale, ratio)


def row(label: str, measured: list[Measured]) -> list[str]:
    """The numbers of a method over all cases, below HEADER."""
    seconds, *arrays = zip(*measured, strict=True)
    of_both = [np.concatenate(of_case, axis=1) for of_case in arrays]
    cells = [label, f"{1e3 * sum(seconds) / of_both[0].shape[1]:.2g}"]
    for error, bound, ratio in zip(*of_both, strict=True):
        cells.append(" / ".join(f"{value:.0e}" for value in np.quantile(error, (0.5, 0.9, 1))))
        cells += ["", ""] if np.isnan(bound).all() else [f"{np.median(bound):.0e}", f"{ratio.max():.2g}"]
    return cells


@click.command()
@click.argument("series", type=click.IntRange(1), default=30)
def main(series: int) -> None:
    """Print time and errors of each method on SERIES random series, by default 30."""
    random = np.random.default_rng(SEED)
    with one_thread:
        cases = [random_case(random) for _ in range(series)]
        rows = []
        for label, (method, settings) in METHODS.items():
            measure(cases[0], method, settings, 1)  # compiles
            rows.append(row(label, [measure(case, method, settings) for case in cases]))
    print(markdown.table(HEADER, rows))


if __name__ == "__main__":
    main()
