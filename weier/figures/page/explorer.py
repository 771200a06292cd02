"""The explorer of curves: the reader chooses a case, hides methods, and reads values under the pointer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any

import numpy as np
import xarray as xr
from bokeh.document import Document
from bokeh.layouts import column, row
from bokeh.models import (
    CDSView,
    Column,
    ColumnDataSource,
    CustomJS,
    DataRange1d,
    FixedTicker,
    IndexFilter,
    LogAxis,
    NoOverlap,
    PrintfTickFormatter,
)
from bokeh.models.widgets import Select
from bokeh.plotting import figure

from weier.data.bodies import Bodies
from weier.data.selection import case_names, label_text
from weier.figures import style
from weier.figures.traces import names_of_traces
from weier.figures.values import plain
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES
from weier.methods.registry import numerical_names
from weier.surface.profile import PARAMETERS
from weier.units import unit_of

# labels that select a case; the last one distinguishes studies and settings
LABELS = ("trace", *PARAMETERS, "phase", "case")
NONE = "-"  # Replaces a missing label; a list without other values is hidden.
# Titles of lists, if different from their names.
TITLES = {
    "gamma": "\N{GREEK SMALL LETTER GAMMA}",
    "phase": "phases, in rad (a single one is of all terms but the first)",
}
MIN_WIDTHS = dict.fromkeys(LABELS, 6) | {"trace": 12, "phase": 18, "case": 18}  # minimum width of each list (rem)
SHOWN = [*QUANTITIES, *(f"{quantity}_error" for quantity in QUANTITIES)]
MAX_POINTS = 30  # More points of a curve would hide the line below them.
LINE_WIDTH = 2  # pixels
# Ticks of logarithmic axes at 1, 2 and 5 times powers of ten, of which those are named that have room: the ticker of
# bokeh names none over two decades.
DECADES = [10.0**power for power in range(-20, 21)]
TICKS = [times * decade for decade in DECADES for times in (1, 2, 5)]
MINOR_TICKS = [times * decade for decade in DECADES for times in range(2, 10)]
STRETCHED: dict[str, Any] = {"sizing_mode": "stretch_width"}
WRAPPED: dict[str, Any] = {"styles": {"flex-wrap": "wrap", "gap": "0.5rem 1rem"}, **STRETCHED}
# The legend is small enough for a narrow window.
SMALL_LEGEND: dict[str, Any] = {"label_text_font_size": "12px", "label_height": 17, "glyph_height": 17, "spacing": 0}
SMALL_LEGEND |= {"padding": 5, "margin": 5, "background_fill_alpha": 0.6}


def curve_explorer(data: xr.Dataset, interface: Bodies | None = None) -> Column:
    """Return two plots of one case with controls for its choice; a script fills them when the page opens.

    The data are in memory, over case, solution_method and mean_pressure; with an interface, SI units are shown.
    """
    order = np.lexsort([data[name].values for name in reversed(PARAMETERS)])
    first = int(np.argmin(order))  # The page opens on the first case of the scene.
    data = data.isel(case=order)
    methods = data["solution_method"].values.tolist()
    labels = {name: _labels(data, name) for name in LABELS}
    curves = data if interface is None or "mu_1" in data.attrs else interface.in_si(data)
    pressures, values = _at_own_loads(curves)
    count = pressures.shape[1]
    table = {"mean_pressure": pressures.astype("f4").ravel()} | {
        f"{name} {method}": own[:, number].astype("f4").ravel()
        for name, own in values.items()
        for number, method in enumerate(methods)
    }
    nothing = dict.fromkeys(["mean_pressure", *SHOWN], np.full(count, np.nan))
    sources = [ColumnDataSource(nothing, name=f"curve {method}") for method in methods]
    solved = np.isfinite(data["compliance"].values).any(axis=(0, 2))
    # All numerical methods but the most accurate one are drawn as points.
    as_points = [name for name in numerical_names() if name in np.array(methods)[solved]][1:]
    labels_of_axes = style.labels_of(interface, unit_of(curves["mean_pressure"]))
    axes = {name: plain(label) for name, label in labels_of_axes.items()}
    plots = [_plot(quantity, methods, sources, as_points, axes) for quantity in QUANTITIES]
    selects = [_select(name, labels[name][first]) for name in LABELS]
    choose = CustomJS(
        args={
            "selects": selects,
            "labels": labels,
            "methods": methods,
            "allCurves": ColumnDataSource(table),
            "sources": sources,
            "loads": count,
            "shown": [name for name in SHOWN if name in values],
            "legends": [plot.legend[0] for plot in plots],
        },
        code=files("weier.figures.page").joinpath("choose.js").read_text(encoding="utf-8"),
    )
    for select in selects:
        select.js_on_change("value", choose)
    parts = column(row(*selects, **WRAPPED), row(*plots, **WRAPPED), **STRETCHED)
    document = Document()
    document.add_root(parts)
    document.js_on_event("document_ready", choose)
    return parts


def _at_own_loads(data: xr.Dataset) -> tuple[Array, dict[str, Array]]:
    """Return the loads and the values of each case at the loads of its study, padded with NaN."""
    known = np.isfinite(data["compliance"].values).any(axis=1)
    order = np.argsort(~known, axis=1, kind="stable")[:, : max(known.sum(axis=1))]
    pressures = np.where(np.take_along_axis(known, order, 1), data["mean_pressure"].values[order], np.nan)
    shown = {name: data[name].values for name in SHOWN if name in data}
    return pressures, {name: np.take_along_axis(own, order[:, None], 2) for name, own in shown.items()}


def _select(name: str, value: str) -> Select:
    width = f"{MIN_WIDTHS[name]}rem"
    grow: dict[str, Any] = {"flex": f"{MIN_WIDTHS[name]} 1 {width}", "min-width": width}
    return Select(title=TITLES.get(name, name), name=name, value=value, styles=grow, **STRETCHED)


def _labels(data: xr.Dataset, name: str) -> list[str]:
    """Return a label of each case as text."""
    if name == "case":
        return [text or name for text in case_names(data, but=(*LABELS, "phases", "seed", "trace_digest"))]
    if name == "trace" and name in data.variables:
        labels = data.coords.to_dataset()
        return [text or NONE for text in names_of_traces(labels.isel(case=at) for at in range(data.sizes["case"]))]
    if name != "phase":
        return [text or NONE for text in _texts(data, name)]
    both = zip(_texts(data, "seed"), _texts(data, "phases"), strict=True)
    return [f"seed {seed}: {phase}".rstrip(": ") if seed else phase or NONE for seed, phase in both]


def _texts(data: xr.Dataset, name: str) -> list[str]:
    """Return the values of a coordinate as texts; empty if the data do not have it."""
    return [label_text(value) for value in data[name].values] if name in data.variables else [""] * data.sizes["case"]


def _plot(
    quantity: str,
    methods: Sequence[str],
    sources: Sequence[ColumnDataSource],
    as_points: Sequence[str],
    axes: Mapping[str, str],
) -> Any:
    read = {
        "mean pressure": "mean_pressure",
        quantity.replace("_", " "): quantity,
        "numerical error": f"{quantity}_error",
    }
    plot = figure(
        height=400,
        x_axis_type="log",
        y_axis_type="log" if quantity == "resistance" else "linear",
        x_axis_label=axes["mean_pressure"],
        y_axis_label=axes[quantity],
        tools="pan,wheel_zoom,box_zoom,reset",
        name=quantity,
        tooltips=[("method", "$name"), *((name, f"@{own}{{0.0000e+0}}") for name, own in read.items())],
        styles={"flex": "1 1 22rem", "min-width": "min(22rem, 100%)"},
        **STRETCHED,
    )
    for method, source in zip(methods, sources, strict=True):
        _draw(plot, method, quantity, source, method in as_points)
    # The axis follows the methods that count, if any; other curves may leave the frame.
    counting: Any = [glyph for method, glyph in zip(methods, plot.renderers, strict=True) if style.counts(method)]
    start: dict[str, Any] = {"start": 0} if quantity == "compliance" else {}
    plot.y_range = DataRange1d(renderers=counting or "auto", **start)
    for axis in (axis for axis in plot.axis if isinstance(axis, LogAxis)):
        ticker, formatter = FixedTicker(ticks=TICKS, minor_ticks=MINOR_TICKS), PrintfTickFormatter(format="%g")
        axis.update(ticker=ticker, formatter=formatter, major_label_policy=NoOverlap())
    plot.legend.location = "bottom_left" if quantity == "resistance" else "top_left"  # curves leave this corner free
    plot.legend.name = f"legend of {quantity}"
    plot.legend[0].update(click_policy="hide", **SMALL_LEGEND)
    return plot


def _draw(plot: Any, method: str, quantity: str, source: ColumnDataSource, as_points: bool) -> None:
    """Draw a line, or points at some of the loads, evenly spread, so that they do not hide the lines below."""
    look = style.line(method)
    curve = {"x": "mean_pressure", "y": quantity, "source": source}
    curve |= dict.fromkeys(("name", "legend_label"), look["label"])
    if as_points:
        count = len(source.data["mean_pressure"])
        view = CDSView(filter=IndexFilter(indices=list(range(0, count, -(-count // MAX_POINTS)))))
        plot.scatter(**curve, view=view, line_color=look["color"], fill_color="white", size=6)
    else:
        dash = [] if look["linestyle"] == "-" else [round(LINE_WIDTH * length) for length in look["linestyle"][1]]
        plot.line(**curve, color=look["color"], line_dash=dash, line_width=LINE_WIDTH)
