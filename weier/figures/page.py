"""The explorer of a scene: one HTML file in which the reader chooses a case, hides methods, and reads values.

The file is self-contained, so that it can be read without a network; `snakemake --report` includes it with figures
and claims. The same data give the same bytes. It shows a selection of at most MAX_CASES cases.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from bokeh.core.types import ID
from bokeh.embed import json_item
from bokeh.layouts import column
from bokeh.models import (
    Column,
    ColumnDataSource,
    CustomJS,
    DataRange1d,
    FixedTicker,
    LogAxis,
    NoOverlap,
    PrintfTickFormatter,
)
from bokeh.models.widgets import Select
from bokeh.plotting import figure
from bokeh.resources import Resources
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from weier.data import provenance
from weier.data.bodies import Bodies
from weier.data.files import write_text
from weier.data.selection import name_cases
from weier.figures import UNDRAWN, UNGROUPED, style
from weier.figures.values import plain
from weier.methods.curve import QUANTITIES
from weier.methods.registry import numerical_names
from weier.pipeline.gather import read_cases
from weier.pipeline.needed_curves import Curves
from weier.units import unit_of

MAX_CASES = 1000  # With errors, this many cases at 40 loads by four methods take 4 MB of the page.
EXPLORER_ID = ID("curves-explorer")
SHOWN = [*QUANTITIES, *(f"{quantity}_error" for quantity in QUANTITIES)]
LINE_WIDTH = 2  # pixels
# ticks of logarithmic axes, labelled if there is room; bokeh's own ticker labels none over two decades
TICKS = [float(f"{times}e{power}") for power in range(-20, 21) for times in (1, 2, 5)]
CHOOSE = """
const start = cb_obj.options.indexOf(cb_obj.value) * loads
sources.forEach((source, number) => {
  const slice = ([name, values]) => [name, Array.from(values.slice(start, start + loads))]
  source.data = Object.fromEntries(Object.entries(curves[number].data).map(slice))
})
"""


def write(curves: Curves, path: Path) -> None:
    """Write the explorer of a scene atomically, in SI units if the scene has an interface."""
    scene, count = curves.scene, curves.scene.count
    shown = np.unique(np.linspace(0, count - 1, min(count, MAX_CASES)).round().astype(int))
    write_text(path, render(read_cases(curves, shown, (*UNDRAWN, *UNGROUPED)), scene.title, count, scene.interface))


def render(data: xr.Dataset, title: str, count: int, interface: Bodies | None = None) -> str:
    """Return the explorer of a selection of `count` cases as HTML."""
    shown = data.sizes["case"]
    cases = f"This page has all {count} cases." if count > 1 else "This page has one case."
    if shown < count:
        cases = f"This page has {shown} of {count} cases, evenly spread; the figures and contact.nc have all."
    units = [] if interface else [provenance.NORMALISED]  # the axes have those of SI
    # All components would double the file size.
    library = Resources(mode="inline", components=["bokeh", "bokeh-widgets"]).render()
    item = json.dumps(json_item(explorer(data, interface), EXPLORER_ID))
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined)
    template = files("weier.figures").joinpath("page.html").read_text(encoding="utf-8")
    return environment.from_string(template).render(
        title=title,
        library=Markup(library),
        item=Markup(item.replace("</", "<\\/")),
        explorer=EXPLORER_ID,
        texts=[cases, *units, "A click on a name in a legend hides its curve."],
    )


def explorer(data: xr.Dataset, interface: Bodies | None = None) -> Column:
    """Return two plots of one case with a list of all cases.

    The data are in memory, over case, solution_method and mean_pressure; with an interface, SI units are shown.
    """
    data = data if interface is None or "mu_1" in data.attrs else interface.in_si(data)
    methods: list[str] = data["solution_method"].values.tolist()
    tables, loads = _tables(data)
    sources = [
        ColumnDataSource({name: values[:loads] for name, values in table.items()}, name=f"curve {method}")
        for method, table in zip(methods, tables, strict=True)
    ]
    labels = style.labels_of(interface, unit_of(data["mean_pressure"]))
    plots = [
        _plot(quantity, methods, sources, plain(labels["mean_pressure"]), plain(labels[quantity]))
        for quantity in QUANTITIES
    ]
    names: Any = name_cases(data)["case"].values.tolist()
    # The list tells cases apart by their names alone, and numbers in these are rounded.
    names = [name if names.count(name) == 1 else f"{name}, case {at + 1}" for at, name in enumerate(names)]
    select = Select(title="case", name="case", value=names[0], options=names)
    curves = [ColumnDataSource(table) for table in tables]
    select.js_on_change("value", CustomJS(args={"curves": curves, "sources": sources, "loads": loads}, code=CHOOSE))
    return column(select, *plots, sizing_mode="stretch_width")


def _tables(data: xr.Dataset) -> tuple[list[dict[str, Any]], int]:
    """Return the values of each method, case by case at the loads of its study, padded with NaN to one number."""
    known = np.isfinite(data["compliance"].values).any(axis=1)
    order = np.argsort(~known, axis=1, kind="stable")[:, : max(known.sum(axis=1))]
    pressures = np.where(np.take_along_axis(known, order, 1), data["mean_pressure"].values[order], np.nan)
    values = {name: np.take_along_axis(data[name].values, order[:, None], 2) for name in SHOWN if name in data}
    tables = [
        {name: own[:, number].astype("f4").ravel() for name, own in values.items()}
        | {"mean_pressure": pressures.astype("f4").ravel()}
        for number in range(data.sizes["solution_method"])
    ]
    return tables, order.shape[1]


def _plot(quantity: str, methods: Sequence[str], sources: Sequence[ColumnDataSource], x: str, y: str) -> Any:
    read = {
        "mean pressure": "mean_pressure",
        quantity: quantity,
        "numerical error": f"{quantity}_error",
    }
    plot: Any = figure(
        height=400,
        x_axis_type="log",
        y_axis_type="log" if quantity == "resistance" else "linear",
        x_axis_label=x,
        y_axis_label=y,
        tools="pan,wheel_zoom,box_zoom,reset",
        name=quantity,
        tooltips=[("method", "$name"), *((name, f"@{own}{{0.0000e+0}}") for name, own in read.items())],
        sizing_mode="stretch_width",
    )
    as_points = [name for name in numerical_names() if name in methods][1:]
    for method, source in zip(methods, sources, strict=True):
        look = style.line(method)
        curve: dict[str, Any] = {"x": "mean_pressure", "y": quantity, "source": source}
        curve |= dict.fromkeys(("name", "legend_label"), look["label"])
        if method in as_points:  # draws the most accurate numerical method alone as a line
            plot.scatter(**curve, line_color=look["color"], fill_color="white", size=5)
        else:
            dash = [] if look["linestyle"] == "-" else [round(LINE_WIDTH * length) for length in look["linestyle"][1]]
            plot.line(**curve, color=look["color"], line_dash=dash, line_width=LINE_WIDTH)
    # The axis follows the methods that count, if any; other curves may leave the frame.
    counting: Any = [glyph for method, glyph in zip(methods, plot.renderers, strict=True) if style.sets_axes(method)]
    plot.y_range = DataRange1d(renderers=counting or "auto")
    if quantity == "compliance":
        plot.y_range.start = 0
    for axis in (axis for axis in plot.axis if isinstance(axis, LogAxis)):
        formatter = PrintfTickFormatter(format="%g")
        axis.update(ticker=FixedTicker(ticks=TICKS), formatter=formatter, major_label_policy=NoOverlap())
    plot.legend.location = "bottom_left" if quantity == "resistance" else "top_left"  # curves leave this corner free
    plot.legend.click_policy = "hide"
    return plot
