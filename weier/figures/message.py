"""The paper's message: finer terms make the contact area vanish, and hardly change the resistance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from weier.data import curves
from weier.figures import style
from weier.figures.values import band, keep_band, line
from weier.kernels.arrays import Array
from weier.methods import cascade, persson

SHOWN_LOADS = (0.01, 0.1, 1.0)  # p_0*: light, intermediate and heavy
BAND = (10, 90)  # percentiles
QUANTITIES = ("contact_fraction", "resistance")
SERIES = ("D", "gamma")  # one column of panels per value
THEORIES: tuple[tuple[Any, str, Any], ...] = (
    (cascade, cascade.METHOD.label, (0, cascade.METHOD.style.dashes)),
    (persson, persson.METHOD.label, ":"),
)
WIDTH, HEIGHT = 2.9, 2.3  # inches, of a panel
LOOKS = ((style.BLUE, "o"), (style.VERMILLION, "s"), (style.BLACK, "^"))  # of the loads


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw contact fraction and resistance over the number of terms: a column of panels for each D and gamma."""
    tables = [_table(study) for study in studies]
    series = sorted({(D, gamma) for table in tables for D, gamma in zip(table["D"], table["gamma"], strict=True)})
    if not series:
        raise ValueError("there are no numerical curves to draw in these studies")
    title, shown = style.limit_panels(title, series, "series", most=3)
    figure = Figure(figsize=(WIDTH * len(shown), HEIGHT * len(QUANTITIES)), layout="constrained")
    grid = figure.subplots(len(QUANTITIES), len(shown), squeeze=False, sharex=True, sharey="row")
    for column, own in enumerate(shown):
        for row, quantity in enumerate(QUANTITIES):
            axes = grid[row, column]
            for number, load in enumerate(SHOWN_LOADS):
                _draw(axes, [_members(table, own, load) for table in tables], quantity, own, load, LOOKS[number])
            axes.set_yscale("log")
            if column == 0:
                axes.set_ylabel(style.LABELS[quantity])
        style.name_panel(grid[0, column], column, len(shown), rf"$D={own[0]:g}$,  $\gamma={own[1]:g}$")
        grid[-1, column].set_xlabel("number of terms $m$")
    figure.legend(handles=_legend(tables), loc="outside lower center", ncols=min(len(shown) + 1, 3))
    style.set_title(figure, title)
    return figure


def _table(study: xr.Dataset) -> dict[str, Array]:
    """Return the cases that a numerical method solved, with the values of the most accurate one over the loads."""
    names = ("contact_fraction", "resistance", "resistance_lower", "resistance_upper")
    solved, best = curves.most_accurate(study)
    solved &= np.isfinite(study["m"].values)
    table = {name: study[name].values[solved] for name in ("D", "gamma", "m")}
    rows = np.flatnonzero(solved)
    return (
        table
        | {name: study[name].values[rows, best[rows]] for name in names}
        | {"mean_pressure": study["mean_pressure"].values}
    )


def _members(table: dict[str, Array], series: tuple[float, float], load: float) -> dict[str, Array]:
    """Return the cases of a series at the load closest to a given one."""
    here = (table["D"] == series[0]) & (table["gamma"] == series[1])
    column = int(np.argmin(np.abs(np.log(table["mean_pressure"] / load))))
    return {
        name: values[here][:, column] if values.ndim > 1 else values[here]
        for name, values in table.items()
        if name != "mean_pressure"
    }


def _draw(
    axes: Axes,
    found: Sequence[dict[str, Array]],
    quantity: str,
    series: tuple[float, float],
    load: float,
    look: tuple[str, str],
) -> None:
    """Draw the median and the band of a quantity at one load, Persson's theory, and bounds on the infinite series."""
    color, marker = look
    together = {name: np.concatenate([table[name] for table in found]) for name in found[0]}
    terms = np.unique(together["m"])
    rows = [np.percentile(together[quantity][together["m"] == m], [BAND[0], 50, BAND[1]]) for m in terms]
    low, middle, high = np.where(np.transpose(rows) > 0, np.transpose(rows), np.nan)  # no resistance in full contact
    label = f"p = {load:g}"
    band(axes, f"{label}, {BAND[0]} to {BAND[1]} %", terms, low, high, color=color, alpha=0.18, linewidth=0)
    line(axes, f"{label}, median", terms, middle, color=color, marker=marker, markersize=3, linestyle="-")
    for theory, name, dashes in THEORIES:
        if function := getattr(theory, quantity, None):
            values = [float(function(load, *series, m)) for m in terms]
            line(axes, f"{label}, {name}", terms, values, color=color, linestyle=dashes, linewidth=0.9)
    if quantity == "resistance":
        longest = together["m"] == terms[-1]
        lower, upper = (np.median(together[f"resistance_{side}"][longest]) for side in ("lower", "upper"))
        place = terms[-1] + 0.55  # distance of the bounds from the longest series, in terms
        bars: dict[str, Any] = {"color": color, "linewidth": 1.4, "capsize": 3, "fmt": "none"}
        keep_band(axes, f"{label}, bounds for m = inf", [place], [lower], [upper])
        axes.errorbar([place], [middle[-1]], [[middle[-1] - lower], [upper - middle[-1]]], **bars)
        axes.set_xlim(terms[0] - 0.3, place + 0.3)
        axes.set_xticks(terms)


def _legend(tables: Sequence[dict[str, Array]]) -> list[Any]:
    """Return entries for the loads, the band with the number of its members, Persson's theory, and the bounds."""
    count = max(
        np.unique(np.stack([table[name] for name in ("D", "gamma", "m")]), axis=1, return_counts=True)[1].max()
        for table in tables
    )
    loads = [
        Line2D([], [], color=color, marker=marker, markersize=3, label=rf"$\bar{{p}}={load:g}\,p_0^*$")
        for load, (color, marker) in zip(SHOWN_LOADS, LOOKS, strict=True)
    ]
    return [
        *loads,
        Patch(color=style.GREY, alpha=0.18, linewidth=0, label=f"{BAND[0]} to {BAND[1]} % of {count} phases"),
        *(
            Line2D([], [], color=style.GREY, linestyle=dashes, linewidth=0.9, label=name)
            for _, name, dashes in THEORIES
        ),
        Line2D([], [], color=style.GREY, marker="|", markersize=8, linestyle="none", label="bounds for $m=\\infty$"),
    ]
