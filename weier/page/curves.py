"""Curves to look through: a case by its labels, methods at will, values under the mouse."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

import numpy as np
import xarray as xr
from bokeh.layouts import column, row
from bokeh.models import Column, ColumnDataSource, CustomJS, HoverTool
from bokeh.models.widgets import CheckboxGroup, Select
from bokeh.plotting import figure

from weier.figures.style import METHODS

MOST_CASES = 2000  # 40 loads by four methods take 1.7 MB of the page for each thousand
LABELS = ("D", "gamma", "m", "phase", "key")  # the last tells apart cases of different settings
QUANTITIES = {"compliance": "compliance h/g_0", "resistance": "resistance (dh/dp) p_0*/g_0"}
DASHES = {"archard": "dashed", "demelio": "dashdot", "layer": "dotted", "patches": "dotdash"}
COLORS = {name: line.color for name, line in METHODS.items()} | {"patches": "#56B4E9"}  # apart from the elements
OTHER = "#E69F00"


def explorer(data: xr.Dataset) -> Column:
    """Two plots of one case, and what chooses it; data over case, method and mean_pressure, in memory."""
    labels = {name: _labels(data, name) for name in LABELS}
    methods = data["method"].values.tolist()
    table = {f"{quantity} {method}": data[quantity].values[:, number].astype("f4").ravel()
             for quantity in QUANTITIES for number, method in enumerate(methods)}  # fmt: skip
    every = ColumnDataSource(table, name="every")
    sources = [_source(data, number, method) for number, method in enumerate(methods)]
    plots = [_plot(quantity, methods, sources) for quantity in QUANTITIES]
    selects = [Select(title=name, name=name, value=labels[name][0], options=[], width=110) for name in LABELS]
    chosen = [
        number for number, method in enumerate(methods) if np.isfinite(data["compliance"].values[:, number]).any()
    ]
    boxes = CheckboxGroup(labels=[_name(method) for method in methods], active=chosen, name="method")
    for plot in plots:
        for number, line in enumerate(plot.renderers):
            line.visible = number in chosen
    _fill_options(selects, labels)
    lines = [line for plot in plots for line in plot.renderers]
    choose = CustomJS(
        args={"selects": selects, "labels": labels, "every": every, "sources": sources, "methods": methods,
              "loads": data.sizes["mean_pressure"]},
        code=files("weier.page").joinpath("choose.js").read_text(encoding="utf-8"),
    )  # fmt: skip
    for select in selects:
        select.js_on_change("value", choose)
    show = "lines.forEach((line, i) => { line.visible = boxes.active.includes(i % count) })"
    boxes.js_on_change("active", CustomJS(args={"lines": lines, "boxes": boxes, "count": len(methods)}, code=show))
    return column(row(*selects, boxes), row(*plots))


def _labels(data: xr.Dataset, name: str) -> list[str]:
    """A label of each case as text; the phase of the second term, or all where they differ."""
    if name == "key":
        return data["key"].values.tolist()
    if name != "phase":
        return [f"{value:.6g}" for value in data[name].values.tolist()]
    return [_phase(phase[np.isfinite(phase)]) for phase in data["phase"].values]


def _phase(phase: Any) -> str:
    if phase.size < 2:
        return "any" if phase.size == 0 or phase[0] == 0 else f"{phase[0]:.4g}"
    alike = phase[0] == 0 and np.ptp(phase[1:]) == 0
    return f"{phase[1]:.4g}" if alike else ", ".join(f"{value:.4g}" for value in phase)


def _fill_options(selects: list[Select], labels: dict[str, list[str]]) -> None:
    """What may be chosen first: the labels of the cases that share all labels before with the first case."""
    rows = list(range(len(labels["D"])))
    for select in selects:
        values = labels[str(select.name)]
        select.update(options=list(dict.fromkeys(values[case] for case in rows)))
        rows = [case for case in rows if values[case] == select.value]


def _source(data: xr.Dataset, number: int, method: str) -> ColumnDataSource:
    curves = {quantity: data[quantity].values[0, number] for quantity in QUANTITIES}
    return ColumnDataSource({"mean_pressure": data["mean_pressure"].values, **curves}, name=f"curve {method}")


def _name(method: str) -> str:
    return METHODS[method].label if method in METHODS else method


def _plot(quantity: str, methods: list[str], sources: list[ColumnDataSource]) -> Any:
    plot = figure(
        width=470, height=400, x_axis_type="log", y_axis_type="log" if quantity == "resistance" else "linear",
        x_axis_label="mean pressure p/p_0*", y_axis_label=QUANTITIES[quantity], tools="pan,wheel_zoom,box_zoom,reset",
        name=quantity,
    )  # fmt: skip
    for method, source in zip(methods, sources, strict=True):
        look: dict[str, Any] = {
            "color": COLORS.get(method, OTHER),
            "line_dash": DASHES.get(method, "solid"),
            "line_width": 2,
        }
        line = plot.line("mean_pressure", quantity, source=source, legend_label=_name(method), **look)
        tips = [
            ("method", _name(method)),
            ("mean pressure", "@mean_pressure{0.0000e+0}"),
            (quantity, f"@{quantity}{{0.00000}}"),
        ]
        plot.add_tools(HoverTool(renderers=[line], tooltips=tips, mode="mouse"))
    plot.legend.location = "bottom_right" if quantity == "compliance" else "bottom_left"
    plot.legend.background_fill_alpha = 0.6
    return plot
