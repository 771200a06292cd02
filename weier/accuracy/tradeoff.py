"""Speed against accuracy: all variants of methods on the profiles of a scene, against the exact contact."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import click
import matplotlib.style
import numpy as np
from matplotlib.figure import Figure

from weier.accuracy.measurement import measurement, number
from weier.accuracy.reference import contact_reference, deviation
from weier.accuracy.runner import MAX_POINTS, Variant, run
from weier.data.markdown import plain, table
from weier.figures import VALUES, WRITTEN, save, style
from weier.figures.values import line
from weier.kernels.arrays import Array
from weier.methods import bem, registry
from weier.methods.errors import ConvergenceError
from weier.methods.method import Settings
from weier.methods.settings import TOLERANCE, defaults
from weier.scene import load
from weier.surface.profile import Profile
from weier.surface.waves import check_resolvable

SCENE, FIGURE = Path("config/accuracy/tradeoff.yaml"), Path("results/tradeoff/tradeoff.pdf")
# runs per median: other processes lengthen some runs, and the clock of a virtual machine may shorten others
REPEAT = 5
TOLERANCES = tuple(float(f"1e-{decade}") for decade in range(1, 13))  # g_0
# settings compared in addition to tolerances, by method: the grid of the paper, meshes of half a wave
OTHER_SETTINGS: dict[str, tuple[Settings, ...]] = {
    "bem": ({"staircase": "kept", "points_per_wave": 12},),
    "layer": ({"points": 6}, {"points": 24}),
}
ERROR_COLUMNS = ("90 %", "largest", "stated: median")
HEADER = [
    *("method and setting", "profiles", "ms a load"),
    *("error of h: median", *ERROR_COLUMNS, "error of R: median", *ERROR_COLUMNS),
]
FLOOR = 1e-15  # smaller errors are drawn here
OPEN = {"markerfacecolor": "white", "linewidth": 0.5, "label": None}  # the look of stated errors


class Measured(NamedTuple):
    """A variant on a profile: milliseconds per load, and errors of h and R over the loads, shape (2, loads).

    Errors of h are in g_0, and errors of R relative to the larger of R and 1 g_0/p_0*: R falls from several g_0/p_0*
    at light loads to 0 at full contact, so that relative errors are meaningless near full contact, and absolute ones
    at light loads. Stated errors are NaN where the method states none.
    """

    profile: Profile
    variant: Variant
    milliseconds: float
    error: Array
    stated: Array


def measure(profiles: Sequence[Profile], loads: Array) -> list[Measured]:
    """Run all variants on finite series in turn; skip variants that do not converge."""
    found = []
    for profile in profiles:
        print(profile.describe(), file=sys.stderr)
        right = contact_reference(profile, tuple(loads.tolist())).values
        unit = np.stack([np.ones(loads.size), np.maximum(right[1].astype(float), 1)])
        for variant in variants(profile):
            try:
                result = run(variant, profile, loads, REPEAT)
            except ConvergenceError as error:
                print(f"{profile.describe()}, {variant.name}: {error}", file=sys.stderr)
                continue
            milliseconds = 1e3 * result.seconds / loads.size
            found.append(
                Measured(profile, variant, milliseconds, deviation(result.values, right) / unit, result.stated / unit)
            )
    return found


def variants(profile: Profile) -> Iterator[Variant]:
    """Yield all variants with compliance and resistance of a finite series, the coarsest of each method first."""
    check_resolvable(profile)
    for method in registry.METHODS:
        by_tolerance = TOLERANCE in defaults(method)
        if not method.stiffness or not method.takes(profile) or (by_tolerance and not method.numerical):  # "auto"
            continue
        tolerances = [{TOLERANCE: value} for value in TOLERANCES if by_tolerance]
        for settings in [*OTHER_SETTINGS.get(method.name, ()), *tolerances] or [{}]:
            with suppress(ValueError):
                method.check(profile, **settings)
                if method is not bem.METHOD or bem.points_of(profile, **settings) <= MAX_POINTS:
                    yield Variant(method.name, settings)


def by_variant(found: Sequence[Measured]) -> dict[str, list[Measured]]:
    """Return the measurements of each variant on all profiles."""
    names = dict.fromkeys(one.variant.name for one in found)
    return {name: [one for one in found if one.variant.name == name] for name in names}


def table_of(found: Sequence[Measured]) -> str:
    """Return a row for each variant."""
    return table(HEADER, [_row(name, own) for name, own in by_variant(found).items()])


def _row(name: str, own: Sequence[Measured]) -> list[str]:
    """Return the results of a variant: milliseconds per load, measured and stated errors of h and R."""
    cells = [plain(name), str(len(own)), number(np.median([one.milliseconds for one in own]), ".2g")]
    errors, stated = (np.stack([getattr(one, kind) for one in own], axis=1) for kind in ("error", "stated"))
    for measured, claimed in zip(errors, stated, strict=True):
        quantiles = np.median(measured), np.quantile(measured, 0.9), measured.max(), np.median(claimed)
        cells += map(number, quantiles)
    return cells


def draw(found: Sequence[Measured]) -> Figure:
    """Draw the largest and the stated errors of h and R against the time; a line joins the settings of a method.

    Settings that were not run on all profiles are left out.
    """
    figure, panels = style.column("", ["Compliance", "Resistance"])
    profiles = len({id(one.profile) for one in found})
    variants = [own for own in by_variant(found).values() if len(own) == profiles]
    labels = r"error of $h/g_0$", r"error of $R$, in max$(R,\,g_0/p_0^{*})$"
    for quantity, (axes, label) in enumerate(zip(panels, labels, strict=True)):
        axes.set(xscale="log", yscale="log", xlabel="milliseconds per load", ylabel=label)
        for method in dict.fromkeys(own[0].variant.method for own in variants):
            settings = [own for own in variants if own[0].variant.method == method]
            milliseconds = [np.median([one.milliseconds for one in own]) for own in settings]
            look = style.line(method) | {"marker": style.points(method)["marker"], "markersize": 3}
            if method in registry.numerical_names()[1:]:
                look["color"] = style.PURPLE  # other figures draw all numerical methods in black
            for kind, more in (("stated", OPEN), ("error", {})):
                worst = [np.max([getattr(one, kind)[quantity] for one in own]) for own in settings]
                line(axes, f"{look['label']}, {kind}", milliseconds, np.maximum(worst, FLOOR), **look | more)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


@measurement("Speed against accuracy")
@click.option("--scene", type=click.Path(path_type=Path), default=SCENE, help="Its profiles and loads.")
@click.option("--figure", type=click.Path(path_type=Path), default=FIGURE, help="The figure, in several formats.")
def main(scene: Path, figure: Path) -> list[str]:
    """Measure the errors and seconds of all methods and settings.

    Each row is one method at one setting, on all profiles that it was run on. `bem 0.001` and `patches 1e-06` have
    these tolerances of the compliance, in g_0. `bem kept 12` has the paper's 12 points for each of the finest waves
    and keeps the staircase, and `layer 24` has 24 points a wave.

    Errors are distances from the exact contact: the closed form for one wave, and otherwise contact patches at a
    tolerance of 1e-12 on the same profile shifted along x. The error of the compliance h is in g_0, that
    of the resistance R is relative to the larger of R and 1 g_0/p_0*. The quantiles are over all loads of all
    profiles, and stated errors are those of the method itself.

    Milliseconds are processor time on one core, the median over the profiles, each the median of five runs. A finer
    grid is run on fewer profiles, so compare rows that have equally many. The figure shows the largest errors over
    the time.
    """
    loaded = load(scene)
    found = measure([case.profile for case in loaded.distinct], loaded.loads)
    with matplotlib.style.context(style.SHEET, after_reset=True):
        save(draw(found), figure, (*WRITTEN, VALUES))
    return [table_of(found)]
