"""Speed against accuracy: all variants of methods on the profiles of a scene, against the exact contact."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

import click
import numpy as np

from weier.accuracy.comparison import Compared, compare
from weier.accuracy.measurement import measurement, number
from weier.accuracy.runner import MAX_POINTS, Problem, Variant
from weier.data.markdown import plain, table
from weier.kernels.arrays import Array
from weier.methods import bem, registry
from weier.methods.method import Settings
from weier.methods.settings import TOLERANCE, defaults
from weier.scene import load
from weier.surface.profile import Profile
from weier.surface.waves import check_resolvable

SCENE = Path("config/accuracy/tradeoff.yaml")
# runs per median: other processes lengthen some runs, and the clock of a virtual machine may shorten others
REPEAT = 5
TOLERANCES = tuple(float(f"1e-{decade}") for decade in range(1, 13))  # g_0
ERROR_COLUMNS = ("90 %", "largest", "stated: median")
HEADER = [
    *("method and setting", "profiles", "ms a load"),
    *("error of h: median", *ERROR_COLUMNS, "error of R: median", *ERROR_COLUMNS),
]


def measure(profiles: Iterable[Profile], loads: Array) -> list[Compared]:
    """Run all variants on finite series in turn; skip variants that do not converge."""
    problems = (Problem(profile.describe(), profile, loads, variants(profile)) for profile in profiles)
    return [one for one in compare(problems, REPEAT) if not one.result.message]


def variants(profile: Profile) -> dict[str, Variant]:
    """Return all variants with compliance and resistance of a finite series, the coarsest of each method first."""
    check_resolvable(profile)
    found = list[Variant]()
    for method in registry.METHODS:
        by_tolerance = TOLERANCE in defaults(method)
        if not method.stiffness or not method.takes(profile) or (by_tolerance and not method.numerical):  # "auto"
            continue
        every: list[Settings] = [{TOLERANCE: value} for value in TOLERANCES] if by_tolerance else [{}]
        for settings in every:
            with suppress(ValueError):
                method.check(profile, **settings)
                if method is not bem.METHOD or bem.points_of(profile, **settings) <= MAX_POINTS:
                    found.append(Variant(method.name, settings))
    return {variant.name: variant for variant in found}


def errors(one: Compared) -> Array:
    """Return the measured and the stated errors of h and R, shape (2, 2, loads).

    Errors of h are in g_0, and errors of R relative to the larger of R and 1 g_0/p_0*: R falls from several g_0/p_0*
    at light loads to 0 at full contact, so that relative errors are meaningless near full contact, and absolute ones
    at light loads. Stated errors are NaN where the method states none.
    """
    R = np.maximum(one.reference.values[1].astype(float), 1)
    return np.stack([one.error, one.result.stated]) / [np.ones(R.size), R]


def table_of(found: Sequence[Compared]) -> str:
    """Return a row for each variant: milliseconds per load, measured and stated errors of h and R."""
    rows = []
    for name in dict.fromkeys(one.name for one in found):
        own = [one for one in found if one.name == name]
        milliseconds = np.median([1e3 * one.result.seconds / one.problem.loads.size for one in own])
        cells = [plain(name), str(len(own)), number(float(milliseconds), ".2g")]
        for measured, stated in np.concatenate([errors(one) for one in own], axis=2).swapaxes(0, 1):
            quantiles = np.median(measured), np.quantile(measured, 0.9), measured.max(), np.median(stated)
            cells += map(number, quantiles)
        rows.append(cells)
    return table(HEADER, rows)


@measurement("Speed against accuracy")
@click.option("--scene", type=click.Path(path_type=Path), default=SCENE, help="Its profiles and loads.")
def main(scene: Path) -> list[str]:
    """Measure the errors and seconds of all methods and settings.

    Each row is one method at one setting, on all profiles that it was run on. `bem 0.001` and `patches 1e-06` have
    these tolerances of the compliance, in g_0.

    Errors are distances from the exact contact: the closed form for one wave, and otherwise contact patches at a
    tolerance of 1e-12 on the same profile shifted along x. The error of the compliance h is in g_0, that
    of the resistance R is relative to the larger of R and 1 g_0/p_0*. The quantiles are over all loads of all
    profiles, and stated errors are those of the method itself.

    Milliseconds are processor time on one core, the median over the profiles, each the median of five runs. A finer
    grid is run on fewer profiles, so compare rows that have equally many.
    """
    loaded = load(scene)
    return [table_of(measure([case.profile for case in loaded.distinct], loaded.loads))]
