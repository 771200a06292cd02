"""Convergence of the estimate and the bounds of the infinite series with the number of resolved terms."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from weier.accuracy.page import Page, measurement, number
from weier.accuracy.runner import Variant, run
from weier.data.markdown import table
from weier.figures import lines, style
from weier.figures.values import band, line
from weier.kernels.arrays import Array
from weier.methods import bem
from weier.methods.errors import ConvergenceError, OutOfReachError
from weier.scene import load
from weier.surface.profile import PARAMETERS, Profile
from weier.theory.bounds import complete_bounds

SCENE = Path("config/accuracy/infinite.yaml")
MESH_FRACTION = 0.1  # ratio of mesh error to tail amplitude; the mesh widens the bounds by at most a tenth
MAX_TOLERANCE = 0.9  # g_0, the largest that boundary elements take; the tail of a gamma near 1 is much higher
HEADER = ("series", "resolved terms", "nodes", "half-width of the bounds", "error of the estimate")
HEIGHT = 2.1  # height of a panel (inches)
# The bounds for these numbers of resolved terms are drawn, from light to dark, and those for the largest number.
BANDS = (1, 2, 4)


class Resolved(NamedTuple):
    """The infinite series with some terms resolved by boundary elements, at all loads: bounds, and their middle."""

    terms: int
    nodes: float
    low: Array
    high: Array
    estimate: Array
    resistance: Array


Found = Mapping[Profile, Sequence[Resolved]]


def measure(profile: Profile, loads: Array, max_terms: int) -> list[Resolved]:
    """Return bounds on an infinite series with 1, 2, ... resolved terms; those out of reach are left out."""
    found = []
    for terms in range(1, max_terms + 1):
        kept = profile.truncated(terms)
        tolerance = min(MESH_FRACTION * kept.tail_amplitude, MAX_TOLERANCE)
        try:
            solved = run(Variant(str(terms), bem.METHOD.name, {"tolerance": tolerance}), kept, loads)
        except (ConvergenceError, OutOfReachError) as error:
            print(f"{profile.describe()}, {terms} terms resolved: {error}", file=sys.stderr)
            continue
        (h, R), error_of_h = solved.values, solved.stated[0]
        low, high = complete_bounds(h, kept.tail_amplitude, profile.total_amplitude, error_of_h)
        found.append(Resolved(terms, solved.others["points"], low, high, (low + high) / 2, R))
    return found


def errors(resolved: Sequence[Resolved]) -> list[tuple[float, float]]:
    """Return the largest half-width of the bounds over the loads, and the distance from the last estimate, or NaN."""
    last = resolved[-1]
    return [
        (
            float((one.high - one.low).max() / 2),
            np.nan if one is last else float(np.abs(one.estimate - last.estimate).max()),
        )
        for one in resolved
    ]


def table_of(found: Found) -> str:
    """Return a row for each number of resolved terms of a series."""
    return table(
        HEADER,
        [
            [name_of(profile), str(one.terms), number(one.nodes, ".0f"), *(number(error, ".1e") for error in own)]
            for profile, resolved in found.items()
            for one, own in zip(resolved, errors(resolved), strict=True)
        ],
    )


def name_of(profile: Profile) -> str:
    """Return the parameters of a series with its seed, if it has one."""
    seed = profile.labels["seed"]
    return profile.describe() + ("" if np.isnan(seed) else f", seed = {seed:.0f}")


def draw(loads: Array, found: Found) -> Figure:
    """Draw the best estimate within bounds, a panel per series, and the convergence of all series in one more."""
    names = [style.describe(_case(profile), *PARAMETERS) for profile in found]
    figure, axes = style.column("", [*names, "largest over the loads"], HEIGHT)
    figure.set_figheight(figure.get_figheight() + style.LEGEND_ROW * len(found))
    colors = style.BLACK, style.VERMILLION, style.BLUE, style.GREEN
    for panel, (profile, resolved), color in zip(axes, found.items(), colors, strict=False):
        _draw_bounds(panel, loads, resolved, profile.total_amplitude)
        _draw_convergence(axes[-1], style.describe(_case(profile), "gamma"), resolved, color)
    axes[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
    axes[-1].set(yscale="log", xlabel="resolved terms $k$", ylabel=r"error of $h/g_0$")
    figure.legend(*axes[-1].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _case(profile: Profile) -> dict[str, Any]:
    return profile.labels | {"phases": np.zeros(0)}


def _draw_bounds(axes: Axes, loads: Array, resolved: Sequence[Resolved], total: float) -> None:
    """Draw the best estimate as a line within the bounds, narrow bands over wide ones."""
    last = resolved[-1]
    fine, best = lines.compliance_line(loads, last.estimate, last.resistance)
    shown = [*(one for one in resolved[:-1] if one.terms in BANDS), last]
    for one, grey in zip(shown, np.linspace(0.92, 0.45, len(shown)), strict=True):
        lower, upper = (best + np.interp(fine, loads, side - last.estimate) for side in (one.low, one.high))
        upper = np.minimum(upper, total)  # The compliance at full contact is an upper bound.
        look: dict[str, Any] = {"facecolor": str(grey), "edgecolor": "0.35", "linewidth": 0.3}
        band(axes, f"bounds, $k={one.terms}$", fine, lower, upper, **look)
    line(axes, f"estimate, $k={last.terms}$", fine, best, color=style.BLACK, linewidth=1)
    axes.set(xscale="log", xlabel=style.LABELS["mean_pressure"], ylabel=style.LABELS["compliance"])
    axes.set_xlim(loads[0], loads[-1])
    axes.legend(loc="lower right", fontsize=7)


def _draw_convergence(axes: Axes, name: str, resolved: Sequence[Resolved], color: str) -> None:
    """Draw the half-width of the bounds, and the distance of estimates from the last one."""
    terms, (width, error) = [one.terms for one in resolved], np.transpose(errors(resolved))
    line(axes, f"{name}: half-width of bounds", terms, width, color=color, marker="s")
    look: dict[str, Any] = {"color": color, "marker": "o", "markerfacecolor": "white", "linestyle": style.DASHES[1]}
    line(axes, f"{name}: error of estimate", terms[:-1], error[:-1], **look)


@measurement("The infinite series, by the terms that are resolved")
@click.option("--scene", type=click.Path(path_type=Path), default=SCENE, help="Its infinite series and loads.")
@click.option("--terms", default=8, help="The largest number of resolved terms.")
def main(scene: Path, terms: int) -> Page:
    """Solve infinite series by the number of terms resolved.

    Heights are in g_0, at the worst load. The bounds hold for any phases of the terms that are not resolved. The
    estimate is their middle, as of the method "auto", and its error the distance from the estimate with most terms.
    Nodes are those of boundary elements.
    """
    loaded = load(scene)
    found = {case.profile: measure(case.profile, loaded.loads, terms) for case in loaded.cases.values()}
    return Page([table_of(found)], partial(draw, loaded.loads, found))
