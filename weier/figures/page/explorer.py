"""The explorer of curves: the reader chooses a case and methods, and reads values under the pointer."""

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
    CustomJSTicker,
    DataRange1d,
    IndexFilter,
    LogAxis,
    NoOverlap,
)
from bokeh.models.widgets import Checkbox, Select
from bokeh.plotting import figure

from weier.data.bodies import Bodies
from weier.data.selection import case_names, label_text
from weier.data.variables import CURVE, VARIABLES
from weier.figures import style
from weier.figures.traces import names_of_traces
from weier.kernels.arrays import Array
from weier.methods.registry import numerical_names
from weier.surface.profile import PARAMETERS
from weier.units import unit_of

# Labels that select a case. The last one distinguishes cases by studies and settings.
LABELS = ("trace", *PARAMETERS, "phase", "case")
ENSEMBLE = [name for name in LABELS if name != "phase"]  # Cases that agree in these labels are an ensemble.
NONE = "-"  # Stands for a label that a case does not have; a list with no other value is hidden.
# Titles of lists that differ from their names.
TITLES = {
    "gamma": "\N{GREEK SMALL LETTER GAMMA}",
    "phase": "phases, rad (one: of all n \N{GREATER-THAN OR EQUAL TO} 1)",
}
# Widths of the drop-down lists, in rem, for labels of usual length.
MIN_WIDTHS = dict.fromkeys(PARAMETERS, 6) | {"trace": 12, "phase": 18, "case": 18}
NORMALISED_AXES = {name: entry.plot.replace("_0", "\N{SUBSCRIPT ZERO}") for name, entry in VARIABLES.items()}
SI_AXES = {
    "compliance": "compliance h, m",
    "resistance": "resistance times nominal area, \N{GREEK CAPITAL LETTER OMEGA} m\N{SUPERSCRIPT TWO}",
}
QUANTITIES = [name for name, entry in VARIABLES.items() if entry.plot and entry.dims == CURVE]
SHOWN = [*QUANTITIES, *(f"{quantity}_error" for quantity in QUANTITIES)]
MAX_POINTS = 30  # More points of a curve would hide the line below them.
LINE_WIDTH = 2  # The width of lines, in pixels.
STRETCHED: dict[str, Any] = {"sizing_mode": "stretch_width"}
WRAPPED: dict[str, Any] = {"styles": {"flex-wrap": "wrap", "gap": "0.5rem 1rem"}, **STRETCHED}
# The legend is small enough for a narrow window.
SMALL_LEGEND: dict[str, Any] = {"label_text_font_size": "12px", "label_height": 17, "glyph_height": 17, "spacing": 0}
SMALL_LEGEND |= {"padding": 5, "margin": 5, "background_fill_alpha": 0.6}


def curve_explorer(data: xr.Dataset, interface: Bodies | None = None) -> Column:
    """Return two plots of one case with controls for its choice; a script fills them when the page opens.

    Parameters
    ----------
    data : Dataset
        In memory, over case, solution_method and mean_pressure.
    interface : Bodies, optional
        Two bodies, for which the curves are shown in SI units.

    """
    order = np.lexsort([data[name].values for name in reversed(PARAMETERS)])
    first = int(np.argmin(order))  # The page opens on the first case of the scene.
    data = data.isel(case=order)
    methods = data["solution_method"].values.tolist()
    labels = {name: _labels(data, name) for name in LABELS}
    curves = data if interface is None or "mu_1" in data.attrs else interface.in_si(data)
    pressures, values = _at_own_loads(curves)
    count = pressures.shape[1]
    ensembles = _ensembles(labels)
    for members in ensembles:
        for name in LABELS:
            labels[name].append(f"median of {len(members)}" if name == "phase" else labels[name][members[0]])
    pressures = np.concatenate([pressures, *(pressures[members[:1]] for members in ensembles)])
    values = {name: _with_medians(name, own, ensembles) for name, own in values.items()}
    table = {
        f"{name} {method}": own[:, number].astype("f4").ravel()
        for name, own in values.items()
        for number, method in enumerate(methods)
    }
    table["mean_pressure"] = pressures.astype("f4").ravel()
    nothing = dict.fromkeys(["mean_pressure", *SHOWN], np.full(count, np.nan))
    sources = [ColumnDataSource(nothing, name=f"curve {method}") for method in methods]
    solved = np.isfinite(data["compliance"].values).any(axis=(0, 2))
    # All numerical methods but the most accurate one are drawn as points.
    as_points = [name for name in numerical_names() if name in np.array(methods)[solved]][1:]
    pressure = {"mean_pressure": f"mean pressure, {unit_of(curves['mean_pressure'])}"}
    axes = NORMALISED_AXES if interface is None else SI_AXES | pressure
    plots = [_plot(quantity, methods, sources, as_points, axes) for quantity in QUANTITIES]
    selects = [_select(name, labels[name][first]) for name in LABELS]
    boxes = [Checkbox(label=style.line(method)["label"], active=True) for method in methods]
    choose = CustomJS(
        args={
            "selects": selects,
            "labels": labels,
            "methods": methods,
            "allCurves": ColumnDataSource(table),
            "sources": sources,
            "loads": count,
            "shown": [name for name in SHOWN if name in values],
            "boxes": boxes,
            "legends": [plot.legend[0] for plot in plots],
        },
        code=_script("choose.js"),
    )
    for select in selects:
        select.js_on_change("value", choose)
    for box in boxes:
        box.js_on_change("active", choose)
    parts = column(row(*selects, **WRAPPED), row(*boxes, **WRAPPED), row(*plots, **WRAPPED), **STRETCHED)
    document = Document()
    document.add_root(parts)
    document.js_on_event("document_ready", choose)
    return parts


def _at_own_loads(data: xr.Dataset) -> tuple[Array, dict[str, Array]]:
    """Return the loads and the values of each case at the loads of its study; what is shorter ends in NaN."""
    known = np.isfinite(data["compliance"].values).any(axis=1)
    order = np.argsort(~known, axis=1, kind="stable")[:, : max(known.sum(axis=1))]
    pressures = np.where(np.take_along_axis(known, order, 1), data["mean_pressure"].values[order], np.nan)
    shown = {name: data[name].values for name in SHOWN if name in data}
    return pressures, {name: np.take_along_axis(own, order[:, None], 2) for name, own in shown.items()}


def _ensembles(labels: Mapping[str, Sequence[str]]) -> list[list[int]]:
    """Return the cases of each ensemble: series that differ in their phases alone."""
    groups: dict[tuple[str, ...], list[int]] = {}
    for case, key in enumerate(zip(*(labels[name] for name in ENSEMBLE), strict=True)):
        groups.setdefault(key, []).append(case)
    return [members for key, members in groups.items() if len(members) > 1 and key[0] == NONE]


def _with_medians(name: str, values: Array, ensembles: Sequence[Sequence[int]]) -> Array:
    """Return the values of all cases, then of ensembles: medians, and for errors their maximum, an upper bound."""
    summary = np.max if name.endswith("_error") else np.median
    return np.concatenate([values, *(summary(values[members], axis=0)[None] for members in ensembles)])


def _script(name: str) -> str:
    return files("weier.figures.page").joinpath(name).read_text(encoding="utf-8")


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
        cases = (labels.isel(case=case) for case in range(data.sizes["case"]))
        return [f"{text}{_fit(data, row)}" or NONE for row, text in enumerate(names_of_traces(cases))]
    if name != "phase":
        return [text or NONE for text in _texts(data, name)]
    return [
        f"seed {seed}: {phase}".rstrip(": ") if seed else phase or NONE
        for seed, phase in zip(_texts(data, "seed"), _texts(data, "phases"), strict=True)
    ]


def _fit(data: xr.Dataset, row: int) -> str:
    """The fit of a series to the trace of a case, if it has one, as the end of its label."""
    names = ("trace_fit_D", "trace_fit_D_error", "trace_fit_g_0", "trace_fit_g_0_error")
    if names[0] not in data.variables:
        return ""
    if np.isnan(data[names[0]].values[row]):
        remark = label_text(data["trace_fit_remark"].values[row]) if "trace_fit_remark" in data.variables else ""
        return f": no fit, since {remark}" if remark else ""
    D, D_error, g_0, g_0_error = (float(data[name].values[row]) for name in names)
    return f": D = {D:.2f} \N{PLUS-MINUS SIGN} {D_error:.2f}, g_0 = {g_0:.2g} \N{PLUS-MINUS SIGN} {g_0_error:.1g} m"


def _texts(data: xr.Dataset, name: str) -> list[str]:
    """Return the values of a coordinate as texts; empty if the data do not have it."""
    return [label_text(value) for value in data[name].values] if name in data.variables else [""] * data.sizes["case"]


def _plot(
    quantity: str, methods: list[str], sources: list[ColumnDataSource], as_points: list[str], axes: Mapping[str, str]
) -> Any:
    read = ("mean_pressure", quantity, f"{quantity}_error")
    names = (*(name.replace("_", " ") for name in read[:2]), "numerical error")
    values = [(name, f"@{own}{{0.0000e+0}}") for name, own in zip(names, read, strict=True)]
    plot = figure(
        height=400,
        x_axis_type="log",
        y_axis_type="log" if quantity == "resistance" else "linear",
        x_axis_label=axes["mean_pressure"],
        y_axis_label=axes[quantity],
        tools="pan,wheel_zoom,box_zoom,reset",
        name=quantity,
        tooltips=[("method", "$name"), *values],
        styles={"flex": "1 1 22rem", "min-width": "min(22rem, 100%)"},
        **STRETCHED,
    )
    for method, source in zip(methods, sources, strict=True):
        (_draw_points if method in as_points else _draw_line)(plot, method, quantity, source)
    # The axis follows the methods that count, if there are any; curves of others may leave the frame.
    counting: Any = [glyph for method, glyph in zip(methods, plot.renderers, strict=True) if style.counts(method)]
    start: dict[str, Any] = {"start": 0} if quantity == "compliance" else {}
    plot.y_range = DataRange1d(renderers=counting or "auto", **start)
    code = _script("ticks.js")
    for axis in (axis for axis in plot.axis if isinstance(axis, LogAxis)):
        # The default ticker of bokeh has no labels over two decades.
        axis.update(ticker=CustomJSTicker(major_code=code, minor_code=code), major_label_policy=NoOverlap())
    plot.legend.location = "bottom_left" if quantity == "resistance" else "top_left"  # where no curve is
    plot.legend.name = f"legend of {quantity}"
    plot.legend[0].update(**SMALL_LEGEND)
    return plot


def _draw_line(plot: Any, method: str, quantity: str, source: ColumnDataSource) -> None:
    look = style.line(method)
    dash = [] if look["linestyle"] == "-" else [round(LINE_WIDTH * length) for length in look["linestyle"][1]]
    plot.line(
        "mean_pressure",
        quantity,
        source=source,
        name=look["label"],
        legend_label=look["label"],
        color=look["color"],
        line_dash=dash,
        line_width=LINE_WIDTH,
    )


def _draw_points(plot: Any, method: str, quantity: str, source: ColumnDataSource) -> None:
    """Draw points at some of the loads, evenly spread, so that they do not hide the lines below."""
    count = len(source.data["mean_pressure"])
    view = CDSView(filter=IndexFilter(indices=list(range(0, count, -(-count // MAX_POINTS)))))
    look = style.line(method)
    plot.scatter(
        "mean_pressure",
        quantity,
        source=source,
        view=view,
        name=look["label"],
        legend_label=look["label"],
        line_color=look["color"],
        fill_color="white",
        size=6,
    )
