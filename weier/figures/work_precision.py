"""Speed against accuracy: what each method takes and how far it is off, as its tolerance or another setting changes."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator

from weier.accuracy.metrics import MEASURED, STATED, pareto, seconds_per_load, worst_over_loads
from weier.figures import style
from weier.kernels.arrays import Array
from weier.methods import registry

CAPTION = (
    "Milliseconds for one load against the largest error over the loads of all profiles that have so many terms. A "
    "line joins the settings of a method, such as tolerances from 0.1 to 1e-12: filled for the error, open for what "
    "the method states of it. The background has the colour of the method that takes the least time for this error."
)
COMMAND = "tradeoff"
VARIABLE = "reference_resistance"

PAGE_WIDTH, PANEL_HEIGHT, LEGEND_HEIGHT = 7.09, 1.75, 0.6  # inches: 180 mm, the width of a page
MAX_COLUMNS = 6
FLOOR, CEILING = 1e-15, 3.0  # of the errors that are drawn
LABELS = {
    "compliance": r"error of $h/g_0$",
    "resistance": r"error of $R$, in max$(R,\,g_0/p_0^{*})$",
}
BAND_ALPHA = 0.16
STATED_LOOK: dict[str, Any] = {"markerfacecolor": "white", "linewidth": 0.5, "markeredgewidth": 0.5}


class Line(NamedTuple):
    """The settings of one kind of a method, such as its tolerances; each array over them.

    method : its name
    milliseconds : for one load, the mean over the profiles
    measured, stated : errors, the largest over loads and profiles, NaN where nothing is stated
    """

    method: str
    milliseconds: Array
    measured: Array
    stated: Array


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """A column of panels for each number of terms: errors of the compliance above, of the resistance below."""
    (data,) = studies
    if not np.isfinite(data["seconds"]).any():
        raise ValueError("there are no times to draw in these data")
    terms = np.unique(data["m"].values)
    title, columns = style.limit_panels(title, [data.isel(case=data["m"].values == m) for m in terms], "numbers of terms", MAX_COLUMNS)
    figure = Figure(figsize=(PAGE_WIDTH, 2 * PANEL_HEIGHT + LEGEND_HEIGHT), layout="constrained")
    axes = figure.subplots(2, len(columns), sharex=True, sharey=True, squeeze=False)
    for row, quantity in zip(axes, LABELS, strict=True):
        for panel, cases in zip(row, columns, strict=True):
            _draw_panel(panel, list(_lines(cases, quantity)))
        row[0].set_ylabel(LABELS[quantity])
    for panel, cases in zip(axes[0], columns, strict=True):
        panel.set_title(f"$m={float(cases['m'][0]):g}$")
    axes[0, 0].set(xscale="log", yscale="log", ylim=(FLOOR, CEILING))
    axes[0, 0].yaxis.set_major_locator(LogLocator(numticks=6))
    axes[0, 0].xaxis.set_major_locator(LogLocator(numticks=5))
    figure.supxlabel("milliseconds a load, one core", fontsize=9)
    style.set_title(figure, title)
    figure.legend(handles=_legend(data), loc="outside lower center", ncols=4)
    return figure


def _lines(cases: xr.Dataset, quantity: str) -> Iterator[Line]:
    """The lines of a panel; a setting that was not run on all cases is left out."""
    seconds = 1e3 * seconds_per_load(cases).mean(axis=0)
    errors = [worst_over_loads(cases, quantity, kind).max(axis=0) for kind in (MEASURED, STATED)]
    kinds = [(method, sorted(json.loads(settings or "{}"))) for method, settings in zip(cases["solution_method"].values, _settings(cases), strict=True)]
    for (method, _), members in groupby(np.flatnonzero(np.isfinite(seconds)), lambda at: kinds[at]):
        at = list(members)
        yield Line(str(method), seconds[at], *(np.clip(error[at], FLOOR, None) for error in errors))


def _settings(cases: xr.Dataset) -> list[str]:
    return [max(column) for column in cases["settings"].values.T.tolist()]


def _draw_panel(axes: Axes, lines: Sequence[Line]) -> None:
    _shade_front(axes, lines)
    for line in lines:
        look = _look(line.method)
        axes.plot(line.milliseconds, line.stated, **look | STATED_LOOK)
        axes.plot(line.milliseconds, line.measured, **look)


def _shade_front(axes: Axes, lines: Sequence[Line]) -> None:
    """Colour each error by the method that takes the least time to be within it."""
    cost, error = (np.concatenate([getattr(line, name) for line in lines]) for name in ("milliseconds", "measured"))
    methods = np.concatenate([np.full(line.measured.size, line.method) for line in lines])
    front = pareto(cost, error)
    for at, above in zip(front, [CEILING, *error[front]], strict=False):
        axes.axhspan(error[at], above, color=_look(methods[at])["color"], alpha=BAND_ALPHA, linewidth=0)


def _look(method: str) -> dict[str, Any]:
    found = {each.name: each for each in registry.METHODS}[method]
    look = style.line(method) | {"marker": found.style.marker, "markersize": 2.8, "linewidth": 0.9, "linestyle": "-"}
    return look | ({"color": style.PURPLE} if method in registry.numerical_names()[1:] else {})


def _legend(data: xr.Dataset) -> list[Any]:
    present = [name for name in dict.fromkeys(data["solution_method"].values.tolist())]
    own = [Line2D([], [], **_look(name)) for name in present]
    grey = {"color": style.GREY, "marker": "o", "markersize": 2.8}
    return [
        *own,
        Line2D([], [], label="error", linestyle="none", **grey),
        Line2D([], [], label="stated error", linestyle="none", **grey, markerfacecolor="white"),
        Patch(color=style.GREY, alpha=BAND_ALPHA, label="least time within this error"),
    ]
