"""Work-precision diagram: time and error of each method for several tolerances or numbers of points."""

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
from matplotlib.ticker import LogLocator

from weier.accuracy.metrics import MEASURED, STATED, pareto, seconds_per_load, worst_over_loads
from weier.figures import style
from weier.figures.values import line
from weier.kernels.arrays import Array
from weier.methods import registry

WIDTH = 7.09  # inches: 180 mm is the width of a page of a journal.
FLOOR, CEILING = 1e-15, 10.0  # range of the error axis; smaller errors are drawn at its lower end
LABELS = {"compliance": r"error of $h/g_0$", "resistance": r"error of $R$, in max$(R,\,g_0/p_0^{*})$"}
# The looks of errors, stated errors, backgrounds, the legend and names.
SYMBOLS: dict[str, Any] = {"markersize": 2.8, "linewidth": 0.9, "linestyle": "-"}
OPEN: dict[str, Any] = {"markerfacecolor": "white", "linewidth": 0.5, "markeredgewidth": 0.5}
NAME: dict[str, Any] = {"fontsize": 7, "linespacing": 1, "verticalalignment": "bottom"}


class Line(NamedTuple):
    """Mean time per load over the profiles (ms) and largest errors, for each setting of a method."""

    method: str
    milliseconds: Array
    measured: Array
    stated: Array


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw a column of panels for each number of terms: errors of the compliance above, of the resistance below."""
    (data,) = studies
    if not np.isfinite(data["seconds"]).any():
        raise ValueError("there are no times to draw in these data")
    title, columns = style.limit_panels(title, _series(data), "series", most=6)  # six columns fit the width
    # Two panels of 1.75 inches and the legend leave space for text on a page.
    figure = Figure(figsize=(WIDTH, 1.75 * len(LABELS) + 0.4), layout="constrained")
    axes = figure.subplots(len(LABELS), len(columns), sharex=True, sharey=True, squeeze=False)
    axes[0, 0].set(xscale="log", yscale="log", ylim=(FLOOR, CEILING))
    for row, (quantity, label) in zip(axes, LABELS.items(), strict=True):
        row[0].set_ylabel(label)
        for panel, cases in zip(row, columns, strict=True):
            _draw_panel(panel, list(_lines(cases, quantity)), named=panel is row[-1])
    for (above, *_, below), cases in zip(axes.T, columns, strict=True):
        above.set_title(style.describe(cases.isel(case=0), "m", "gamma"))
        below.set_xlabel("milliseconds a load")
    # More labels would overlap those of other panels.
    axes[0, 0].xaxis.set_major_locator(LogLocator(numticks=5))
    axes[0, 0].yaxis.set_major_locator(LogLocator(numticks=6))
    style.set_title(figure, title)
    figure.legend(handles=_legend(data), loc="outside lower center", ncols=7, handlelength=1.6, columnspacing=1.2)
    return figure


def _series(data: xr.Dataset) -> list[xr.Dataset]:
    """Return the cases of each number of terms and ratio of wavelengths, in increasing order."""
    keys = np.column_stack([data["m"].values, data["gamma"].values])
    return [data.isel(case=(keys == key).all(axis=1)) for key in np.unique(keys, axis=0)]


def _lines(cases: xr.Dataset, quantity: str) -> Iterator[Line]:
    """Yield a line for each method, through the settings that were run on all cases."""
    methods = cases["solution_method"].values
    milliseconds = 1e3 * seconds_per_load(cases).mean(axis=0)
    errors = [worst_over_loads(cases, quantity, kind).max(axis=0) for kind in (MEASURED, STATED)]
    for method in _methods(cases):
        run = np.flatnonzero((methods == method) & np.isfinite(milliseconds))
        if run.size:
            at = _most_alike(run, cases["settings"].values[0])
            yield Line(method, milliseconds[at], *(np.maximum(error[at], FLOOR) for error in errors))


def _methods(data: xr.Dataset) -> list[str]:
    return list(dict.fromkeys(data["solution_method"].values.tolist()))


def _most_alike(variants: np.ndarray, settings: np.ndarray) -> np.ndarray:
    """Return the variants that differ in the values of the same settings; the largest such group, or the last one."""
    kinds = [sorted(json.loads(settings[at])) for at in variants]
    kind = max(reversed(kinds), key=kinds.count)
    return variants[[own == kind for own in kinds]]


def _draw_panel(axes: Axes, lines: Sequence[Line], named: bool) -> None:
    """Draw the lines over the colours of the fastest methods, optionally with their names."""
    for method, low, high in _fastest(lines):
        color = _look(method)["color"]
        axes.axhspan(low, high, color=color, alpha=0.16, linewidth=0)
        if named and high / low >= 300:  # a background that spans this factor of errors has room for a name
            text = f"fastest:\n{_look(method)['label']}"
            axes.text(0.05, 1.5 * low, text, transform=axes.get_yaxis_transform(), **NAME)
    for own in lines:
        look = _look(own.method)
        line(axes, f"{look['label']}, stated", own.milliseconds, own.stated, **look | OPEN | {"label": None})
        line(axes, look["label"], own.milliseconds, own.measured, **look)


def _fastest(lines: Sequence[Line]) -> Iterator[tuple[str, float, float]]:
    """Yield the fastest methods from large errors to small ones, each with the range of errors."""
    cost, error = (np.concatenate([getattr(line, name) for line in lines]) for name in ("milliseconds", "measured"))
    methods, high = np.concatenate([[line.method] * line.measured.size for line in lines]), CEILING
    for method, members in groupby(pareto(cost, error), lambda at: str(methods[at])):
        low = min(error[at] for at in members)
        yield method, low, high
        high = low


def _look(method: str) -> dict[str, Any]:
    """Return line and symbol of a method; other figures draw all numerical methods in black."""
    look = style.line(method) | {"marker": style.points(method)["marker"]} | SYMBOLS
    return look | ({"color": style.PURPLE} if method in registry.numerical_names()[1:] else {})


def _legend(data: xr.Dataset) -> list[Any]:
    look = SYMBOLS | {"color": style.GREY, "marker": "o"}
    return [
        *(Line2D([], [], **_look(method)) for method in _methods(data)),
        Line2D([], [], label="error", **look),
        Line2D([], [], label="stated error", **look | OPEN),
    ]
