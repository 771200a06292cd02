"""The paper's message: finer terms make the contact area vanish, and hardly change the resistance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from weier.data import curves
from weier.data.ensembles import CLOSE
from weier.figures import style
from weier.figures.values import band, keep, line
from weier.methods import cascade, persson

BAND = (10, 90)  # percentiles
QUANTITIES = ("contact_fraction", "resistance")
THEORIES: tuple[tuple[Any, str, Any], ...] = (
    (cascade, cascade.METHOD.label, (0, cascade.METHOD.style.dashes)),
    (persson, persson.METHOD.label, ":"),
)
WIDTH, HEIGHT = 2.9, 2.3  # size of a panel (inches)
# light, intermediate and heavy loads (p_0*)
STYLES = {0.01: (style.BLUE, "o"), 0.1: (style.VERMILLION, "s"), 1.0: (style.BLACK, "^")}


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw contact fraction and resistance over the number of terms: a column of panels for each D and gamma."""
    table = pd.concat([_table(study, load) for study in studies for load in STYLES])
    if table.empty:
        raise ValueError("there are no numerical curves at loads of 0.01, 0.1 or 1 p_0* in these studies")
    title, shown = style.limit_panels(title, list(table.groupby(["D", "gamma"])), "series", most=3)
    figure = Figure(figsize=(WIDTH * len(shown), HEIGHT * len(QUANTITIES)), layout="constrained")
    grid = figure.subplots(len(QUANTITIES), len(shown), squeeze=False, sharex=True, sharey="row")
    for column, ((D, gamma), own) in enumerate(shown):
        for axes, quantity in zip(grid[:, column], QUANTITIES, strict=True):
            for load, found in own.groupby("load"):
                _draw(axes, found, quantity, *STYLES[load])
            axes.set_yscale("log")
            if column == 0:
                axes.set_ylabel(style.LABELS[quantity])
        style.name_panel(grid[0, column], column, len(shown), rf"$D={D:g}$,  $\gamma={gamma:g}$")
        grid[-1, column].set_xlabel("number of terms $m$")
    figure.legend(handles=_legend(table), loc="outside lower center", ncols=min(len(shown) + 1, 3))
    style.set_title(figure, title)
    return figure


def _table(study: xr.Dataset, load: float) -> pd.DataFrame:
    """Return the values by the most accurate method at a load, if the study has it, of the cases that it solved."""
    solved, best = curves.most_accurate(study)
    off = np.abs(np.log(study["mean_pressure"].values / load))
    rows, column = np.flatnonzero(solved & np.isfinite(study["m"].values) & (off.min() < CLOSE)), int(off.argmin())
    parameters = {name: study[name].values[rows] for name in ("D", "gamma", "m")}
    names = (*QUANTITIES, "resistance_lower", "resistance_upper")
    return pd.DataFrame(
        {**parameters, "load": load}
        | {name: study[name].values[rows, best[rows], column] for name in names if name in study}
    )


def _draw(axes: Axes, found: pd.DataFrame, quantity: str, color: str, marker: str) -> None:
    """Draw the median and the band of a quantity at one load, the theories, and bounds on the infinite series."""
    by_terms = found.groupby("m")
    D, gamma, load = found[["D", "gamma", "load"]].iloc[0]
    terms = np.array(list(by_terms.groups))
    rows = np.transpose([np.percentile(own[quantity], [BAND[0], 50, BAND[1]]) for _, own in by_terms])
    low, middle, high = np.where(rows > 0, rows, np.nan)  # R = 0 in full contact
    label = f"p = {load:g}"
    band(axes, f"{label}, {BAND[0]} to {BAND[1]} %", terms, low, high, color=color, alpha=0.18, linewidth=0)
    line(axes, f"{label}, median", terms, middle, color=color, marker=marker, markersize=3, linestyle="-")
    for theory, name, dashes in THEORIES:
        if function := getattr(theory, quantity, None):
            values = [float(function(load, D, gamma, m)) for m in terms]
            line(axes, f"{label}, {name}", terms, values, color=color, linestyle=dashes, linewidth=0.9)
    if quantity == "resistance":
        longest = by_terms.get_group(terms[-1]).median()
        lower, upper, place = longest["resistance_lower"], longest["resistance_upper"], terms[-1] + 0.55
        keep(axes, f"{label}, bounds for m = inf", [place], {", low": [lower], ", high": [upper]})
        ends = [[middle[-1] - lower], [upper - middle[-1]]]
        axes.errorbar([place], [middle[-1]], ends, color=color, linewidth=1.4, capsize=3, fmt="none")
        axes.set_xlim(terms[0] - 0.3, place + 0.3)
        axes.set_xticks(terms)


def _legend(table: pd.DataFrame) -> list[Any]:
    """Return entries for the loads, the band with the number of its members, the theories, and the bounds."""
    count = table.groupby(["D", "gamma", "m", "load"]).size().max()
    return [
        *(
            Line2D([], [], color=color, marker=marker, markersize=3, label=rf"$\bar{{p}}={load:g}\,p_0^*$")
            for load, (color, marker) in STYLES.items()
            if (table["load"] == load).any()
        ),
        Patch(color=style.GREY, alpha=0.18, linewidth=0, label=f"{BAND[0]} to {BAND[1]} % of {count} phases"),
        *(
            Line2D([], [], color=style.GREY, linestyle=dashes, linewidth=0.9, label=name)
            for _, name, dashes in THEORIES
        ),
        Line2D([], [], color=style.GREY, marker="|", markersize=8, linestyle="none", label="bounds for $m=\\infty$"),
    ]
