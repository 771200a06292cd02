"""The explorer of curves: the reader chooses a case and methods, and reads values under the pointer."""

from __future__ import annotations

from collections import Counter
from importlib.resources import files
from typing import Any

import numpy as np
import xarray as xr
from bokeh.layouts import column, row
from bokeh.models import CDSView, Column, ColumnDataSource, CustomJS, HoverTool, IndexFilter
from bokeh.models.widgets import CheckboxGroup, Select
from bokeh.plotting import figure

from weier.data.variables import CURVE, VARIABLES
from weier.figures import style
from weier.figures.page.cells import coordinate_text
from weier.methods.registry import numerical_names
from weier.theory.profile import PARAMETERS

MAX_CASES = 2000  # 40 loads by four methods take 1.7 MB of the page for each thousand cases
# The last tells apart what is left: studies, seeds and settings.
LABELS = ("trace", *PARAMETERS, "phase", "case")
NONE = "-"  # what a trace or a series has no label for; a list of nothing else is hidden
TITLES = {"gamma": "\N{GREEK SMALL LETTER GAMMA}", "phase": "phase \N{GREEK SMALL LETTER PHI}, rad"}
MIN_WIDTHS = dict.fromkeys(PARAMETERS, 6) | {"trace": 12, "phase": 18, "case": 18}  # of the drop-down lists, in rem
QUANTITIES = {name: entry.plot for name, entry in VARIABLES.items() if entry.plot and entry.dims == CURVE}
LEGENDS: dict[str, Any] = {"resistance": "bottom_left"}  # where no curve goes; of others "top_left"
MAX_POINTS = 30  # of a curve that is drawn as points
LINE_WIDTH = 2  # pixels
WRAP: dict[str, Any] = {"flex-wrap": "wrap", "gap": "0.5rem 1rem"}
WRAP_BOXES = """
.bk-input-group { display: flex; flex-wrap: wrap; gap: 0.3rem 0.8rem; }
.bk-input-group.bk-inline > *:not(:first-child) { margin-left: 0; }
"""
# A legend so small that it stands beside the curves in a narrow window, too.
SMALL_LEGEND: dict[str, Any] = {"label_text_font_size": "12px", "label_height": 17, "glyph_height": 17, "spacing": 0}
SMALL_LEGEND |= {"padding": 5, "margin": 5, "background_fill_alpha": 0.6}


def curve_explorer(data: xr.Dataset) -> Column:
    """Two plots of one case, and the lists and boxes that choose it.

    Parameters
    ----------
    data : Dataset
        In memory, over case, solution_method and mean_pressure.

    """
    data = data.isel(case=np.lexsort([data[name].values for name in reversed(PARAMETERS)]))
    labels = {name: _labels(data, name) for name in LABELS}
    methods = data["solution_method"].values.tolist()
    table = {f"{quantity} {method}": data[quantity].values[:, number].astype("f4").ravel()
             for quantity in QUANTITIES for number, method in enumerate(methods)}  # fmt: skip
    all_curves = ColumnDataSource(table, name="all curves")
    sources = [_source(data, number, method) for number, method in enumerate(methods)]
    solved = [number for number in range(len(methods)) if np.isfinite(data["compliance"].values[:, number]).any()]
    # Beside the line of the most accurate numerical method others are points.
    as_points = [name for name in numerical_names() if name in [methods[number] for number in solved]][1:]
    plots = [_plot(quantity, methods, sources, as_points) for quantity in QUANTITIES]
    selects = [_select(name, labels[name][0]) for name in LABELS]
    stretched: dict[str, Any] = {"sizing_mode": "stretch_width"}
    boxes = CheckboxGroup(labels=[_label(method) for method in methods], active=solved, name="method", inline=True,
                          stylesheets=[WRAP_BOXES], **stretched)  # fmt: skip
    of_first_case = np.isfinite(data["compliance"].values[0]).any(axis=-1).tolist()
    for plot in plots:
        for item, known in zip(plot.legend.items, of_first_case, strict=True):
            item.visible = item.renderers[0].visible = known
    _fill_options(selects, labels)
    choose = CustomJS(
        args={"selects": selects, "labels": labels, "allCurves": all_curves, "sources": sources, "methods": methods,
              "loads": data.sizes["mean_pressure"], "boxes": boxes, "legends": [plot.legend[0] for plot in plots]},
        code=files("weier.figures.page").joinpath("choose.js").read_text(encoding="utf-8"),
    )  # fmt: skip
    for select in selects:
        select.js_on_change("value", choose)
    boxes.js_on_change("active", choose)
    return column(row(*selects, styles=WRAP, **stretched), boxes, row(*plots, styles=WRAP, **stretched), **stretched)


def _select(name: str, value: str) -> Select:
    width = f"{MIN_WIDTHS[name]}rem"
    grow: dict[str, Any] = {"flex": f"{MIN_WIDTHS[name]} 1 {width}", "min-width": width}
    title = TITLES.get(name, name)
    return Select(title=title, name=name, value=value, options=[], sizing_mode="stretch_width", styles=grow)


def _labels(data: xr.Dataset, name: str) -> list[str]:
    """One label of each case, as text."""
    if name == "case":
        return _case_labels(data)
    if name != "phase":
        values = data[name].values.tolist() if name in data.variables else [""] * data.sizes["case"]
        texts = [value if isinstance(value, str) else f"{value:.6g}" for value in values]
        return [NONE if text in ("", "nan") else text for text in texts]
    seeds = data["seed"].values if "seed" in data.variables else np.full(data.sizes["case"], np.nan)
    return [
        _phase_label(phase[np.isfinite(phase)], seed) if np.isfinite(D) else NONE
        for phase, seed, D in zip(data["phases"].values, seeds, data["D"].values, strict=True)
    ]


def _case_labels(data: xr.Dataset) -> list[str]:
    """Study, seed and settings of each case, unless they are the same for all; numbered where nothing differs."""
    names = [str(name) for name in data.coords if data[name].dims == ("case",)]
    names = [name for name in names if name not in ("key", "seed", *LABELS) and not name.startswith("trace_")]
    columns = {name: [coordinate_text(value) for value in data[name].values.tolist()] for name in names}
    differing = {name.replace("_", " "): texts for name, texts in columns.items() if len(set(texts)) > 1}
    found = [", ".join(f"{name} {texts[case]}" for name, texts in differing.items() if texts[case])
             for case in range(data.sizes["case"])]  # fmt: skip
    profiles = zip(*(_labels(data, name) for name in LABELS[:-1]), strict=True)
    seen: Counter[tuple[str, ...]] = Counter()
    labels = []
    for profile, label in zip(profiles, found, strict=True):
        seen[*profile, label] += 1
        again = seen[*profile, label]
        labels.append(f"{label or 'case'} ({again})" if again > 1 else label or "case")
    return labels


def _phase_label(phase: Any, seed: float) -> str:
    """The phase of all terms but the first, or all phases where these differ, with the seed of random ones."""
    if np.isfinite(seed):
        return f"seed {seed:g}: {', '.join(f'{value:.3g}' for value in phase)}".rstrip(": ")
    if phase.size < 2:
        return "any" if phase.size == 0 or phase[0] == 0 else f"{phase[0]:.4g}"
    equal = phase[0] == 0 and np.ptp(phase[1:]) == 0
    return f"{phase[1]:.4g}" if equal else ", ".join(f"{value:.3g}" for value in phase)


def _fill_options(selects: list[Select], labels: dict[str, list[str]]) -> None:
    """Offer at first the labels of those cases that agree with the first case in all labels further left."""
    rows = list(range(len(labels["D"])))
    for select in selects:
        values = labels[str(select.name)]
        options = list(dict.fromkeys(values[case] for case in rows))
        select.update(options=options, visible=options != [NONE] and (select is not selects[-1] or len(options) > 1))
        rows = [case for case in rows if values[case] == select.value]


def _source(data: xr.Dataset, number: int, method: str) -> ColumnDataSource:
    curves = {quantity: data[quantity].values[0, number] for quantity in QUANTITIES}
    return ColumnDataSource({"mean_pressure": data["mean_pressure"].values, **curves}, name=f"curve {method}")


def _label(method: str) -> str:
    return str(style.line(method)["label"])


def _plot(quantity: str, methods: list[str], sources: list[ColumnDataSource], as_points: list[str]) -> Any:
    plot = figure(
        height=400, x_axis_type="log", y_axis_type="log" if quantity == "resistance" else "linear",
        x_axis_label=_with_subscripts(VARIABLES["mean_pressure"].plot),
        y_axis_label=_with_subscripts(QUANTITIES[quantity]),
        tools="pan,wheel_zoom,box_zoom,reset", name=quantity, sizing_mode="stretch_width",
        styles={"flex": "1 1 22rem", "min-width": "min(22rem, 100%)"},
    )  # fmt: skip
    for method, source in zip(methods, sources, strict=True):
        line = (_draw_points if method in as_points else _draw_line)(plot, method, quantity, source)
        tips = [
            ("method", _label(method)),
            ("mean pressure", "@mean_pressure{0.0000e+0}"),
            (quantity, f"@{quantity}{{0.00000}}"),
        ]
        plot.add_tools(HoverTool(renderers=[line], tooltips=tips, mode="mouse"))
    plot.legend.location = LEGENDS.get(quantity, "top_left")
    plot.legend.name = f"legend of {quantity}"
    plot.legend[0].update(**SMALL_LEGEND)
    return plot


def _with_subscripts(label: str) -> str:
    return label.replace("_0", "\N{SUBSCRIPT ZERO}")


def _draw_line(plot: Any, method: str, quantity: str, source: ColumnDataSource) -> Any:
    look = style.line(method)
    dash = [] if look["linestyle"] == "-" else [round(LINE_WIDTH * length) for length in look["linestyle"][1]]
    return plot.line("mean_pressure", quantity, source=source, legend_label=look["label"], color=look["color"],
                     line_dash=dash, line_width=LINE_WIDTH)  # fmt: skip


def _draw_points(plot: Any, method: str, quantity: str, source: ColumnDataSource) -> Any:
    """Points at some of the loads, evenly spread, so that they do not hide what lies below them."""
    count = len(source.data["mean_pressure"])
    view = CDSView(filter=IndexFilter(indices=list(range(0, count, -(-count // MAX_POINTS)))))
    look = style.line(method)
    return plot.scatter("mean_pressure", quantity, source=source, view=view, legend_label=look["label"],
                        line_color=look["color"], fill_color="white", size=6)  # fmt: skip
