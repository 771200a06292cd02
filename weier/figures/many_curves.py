"""Figs 3 to 6: curves of many cases and methods, with the colours, panels and medians that a scene chooses.

A figure of a sweep shows the effect of its parameters. By default, each of few cases has a panel, and curves of many
cases are medians over the phases.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from weier.data.bodies import Bodies
from weier.figures import style
from weier.figures.tables import Values, common_loads, extent, refined_loads, smooth_compliance, table_of
from weier.figures.values import band, line
from weier.kernels.arrays import Array
from weier.methods.curve import COMPLIANCE
from weier.methods.registry import names, numerical_names
from weier.scene import BY_DEFAULT, Grouping
from weier.scene.figure import EACH_CASE
from weier.surface.profile import PARAMETERS
from weier.units import unit_of

# styles of bands around medians, of a solid line under dashed ones of its colour, and of bands of stated errors
BAND_STYLE: dict[str, Any] = {"alpha": 0.16, "linewidth": 0}
BEHIND_STYLE: dict[str, Any] = {"facecolor": "0.86", "edgecolor": "0.7", "linewidth": 0.4, "zorder": 1.0}
BELOW_STYLE: dict[str, Any] = {"linewidth": 2.6, "alpha": 0.5}
ERROR_STYLE: dict[str, Any] = {"alpha": 0.35, "linewidth": 0, "zorder": 1.8}
# A narrower band of stated errors is hidden by its line: widths over the largest compliance, and over the resistance.
VISIBLE = {"compliance": 0.01, "resistance": 0.05}
PERCENTILES = 50, 10, 90  # the median and the ends of its band
BAND_NAME = "10 to 90 %"
NOUNS = {"method": "methods", "trace": "traces", "phases": "phases", "seed": "phases"}  # have no symbol
SURFACES = (*PARAMETERS, "trace")  # parameters other than phases that distinguish surfaces
MAX_VALUES = 2**22  # maximum number of loads times curves reduced at once, 32 MB


class PlottedCurve(NamedTuple):
    """The curves of one method that look alike, reduced to a line and a band.

    own : the values of the study of the first curve
    first : the row of the first curve in the table of curves
    loads, values : the line
    band : the low and the high end of the band, shape (2, loads); None for a single curve
    members : number of curves
    points : whether to draw points instead of a line, next to a more accurate curve
    """

    own: Values
    first: Mapping[str, Any]
    loads: Array
    values: Array
    band: Array | None
    members: int
    points: bool

    @property
    def method(self) -> str:
        """The common method."""
        return str(self.first["method"])

    @property
    def case(self) -> xr.Dataset:
        """The first case."""
        return self.own.study.isel(case=self.first["row"])


def draw(
    studies: Sequence[xr.Dataset],
    title: str,
    quantity: str,
    grouping: Grouping = BY_DEFAULT,
    interface: Bodies | None = None,
    behind: Sequence[xr.Dataset] = (),
) -> Figure:
    """Draw compliance over mean pressure up to full contact, or another quantity on logarithmic axes.

    The studies belong to one scene. Panels, colours and medians are those of a grouping; with an interface, axes are
    in SI units. The most accurate curves of the studies behind are a grey band in panels of the same D, gamma and m.
    ValueError is raised if there are no such curves, or some could not be distinguished.
    """
    tables = [Values(study, quantity, interface) for study in studies]
    table = table_of(tables)
    if table.empty:
        raise ValueError(f"there are no curves of {quantity} to draw in these studies")
    if quantity != COMPLIANCE and not any((own.values > 0).any() for own in tables):
        raise ValueError(f"there is no {quantity} above 0 to draw: take lighter loads, or bodies that resist")
    grouping = grouping.with_defaults(table["case"].nunique())
    drawn = _curves(table, tables, quantity, grouping)
    facet_values = [_values(drawn, name) for name in grouping.facet]
    noun = " and ".join(grouping.facet) or "curves"
    title, shown = style.limit_panels(title, list(itertools.product(*facet_values)), noun, style.MAX_GRID)
    labels = style.labels_of(interface, unit_of(studies[0]["mean_pressure"]))
    figure, panels = style.grid(len(shown), labels["mean_pressure"], labels[quantity], *map(len, facet_values[1:]))
    in_legend = ("method",) * (grouping.colour in ("", "method"))
    names = [name for name in ("method", *SURFACES, "seed") if table[name].nunique(dropna=False) == 1]
    alike = {name: table[name].iloc[0] for name in names if name not in (*grouping.facet, *in_legend)}
    in_panels = grouping.facet == EACH_CASE.facet
    shared = "" if in_panels else _join(_label(drawn, name, value) for name, value in alike.items() if value != "")
    bands: dict[str, Patch] = {}
    ensembles = [Values(study, quantity, interface) for study in behind]
    for axes in panels:  # otherwise each band would rescale all panels
        axes.set_autoscale_on(False)
    for number, (axes, value) in enumerate(zip(panels, shown, strict=True)):
        members = [curve for curve in drawn if tuple(curve.first[name] for name in grouping.facet) == value]
        if band := _draw_behind(axes, ensembles, members, quantity):
            bands["behind"] = band
        _draw(axes, members, drawn, grouping)
        if grouping.colour in ("", "method") and not grouping.median_over:
            bands |= {curve.method: band for curve in members if (band := _draw_errors(axes, curve, quantity))}
        own = _join(_label(drawn, *parameter) for parameter in zip(grouping.facet, value, strict=True))
        style.name_panel(axes, number, len(shown), own if len(shown) > 1 else _join([own, shared]))
    seen = [curve for curve in drawn if tuple(curve.first[name] for name in grouping.facet) in shown]
    _add_legend(figure, panels, _legend(seen, drawn, grouping) + list(bands.values()))
    for axes in panels:
        axes.autoscale()
        if interface:  # the power of ten of an axis is next to the title
            axes.yaxis.get_offset_text().set(x=-0.02, horizontalalignment="right")
    above = list(filter(None, [title, shared if len(shown) > 1 else ""]))
    figure.set_figheight(figure.get_figheight() + 0.2 * len(above))  # inches for each line
    style.set_title(figure, "\n".join(above))
    first_load, full_contact, *values = extent(tables)
    if quantity == COMPLIANCE:  # the axis must show light loads
        style.set_load_axis(panels[0], first_load, full_contact)
        panels[0].set_ylim(bottom=0)
    else:
        style.set_logarithmic_axes(panels[0], first_load, full_contact, *values)
    return figure


def _curves(table: pd.DataFrame, tables: Sequence[Values], quantity: str, grouping: Grouping) -> list[PlottedCurve]:
    """Return all lines, in the order in which they are drawn."""
    # The estimates, from the least accurate on, then methods that are not listed, then the numerical ones on top.
    numerical = numerical_names()
    order = [*(name for name in names() if name not in numerical), "", *numerical]
    rank = {name: order.index(name if name in order else "") for name in table["method"].unique()}
    keys = list(dict.fromkeys([*filter(None, (grouping.colour, *grouping.facet)), "method"]))
    groups = (same for _, same in table.groupby(keys, sort=False, dropna=False))
    ranked = sorted(groups, key=lambda same: (rank[same["method"].iloc[0]], same["case"].iloc[0]))
    return [_reduced(same, tables, quantity, grouping) for same in ranked]


def _reduced(same: pd.DataFrame, tables: Sequence[Values], quantity: str, grouping: Grouping) -> PlottedCurve:
    """Return the median of curves that look alike, and their band, or the single curve."""
    first = same.iloc[0].to_dict()
    own = tables[first["study"]]
    points = first["method"] in numerical_names() and not first["best"] and "method" not in grouping.facet
    if len(same) == 1:
        place = first["row"], first["column"]
        loads, values = (own.loads, own.values[place]) if points else own.line(*place)
        return PlottedCurve(own, first, loads, values, None, 1, points)
    if hidden := grouping.hidden(_differing(same)):
        raise ValueError(hidden)
    loads, (line, *band) = _reduce(same, tables, quantity)
    return PlottedCurve(own, first, loads, line, np.array(band), len(same), points)


def _reduce(same: pd.DataFrame, tables: Sequence[Values], quantity: str) -> tuple[Array, Array]:
    """Return loads, and the line and both ends of the band there, shape (3, loads)."""
    parts = [(tables[study], part["row"], part["column"]) for study, part in same.groupby("study", sort=False)]
    loads = common_loads([own for own, _, _ in parts])
    values = np.concatenate([own.values[rows, columns] for own, rows, columns in parts])
    slope = np.concatenate([own.slope[rows, columns] for own, rows, columns in parts])
    if quantity != COMPLIANCE or not (smooth := smooth_compliance(loads, values, slope)):
        return loads, np.percentile(values, PERCENTILES, axis=0)
    fine = refined_loads(loads)
    pieces = np.array_split(fine, math.ceil(fine.size * len(same) / MAX_VALUES))
    return fine, np.concatenate([np.percentile(smooth(piece), PERCENTILES, axis=0) for piece in pieces], axis=1)


def _values(drawn: Iterable[PlottedCurve], name: str) -> list[Hashable]:
    """Return the distinct values of a parameter: numbers are sorted, others in order of appearance."""
    values = list(dict.fromkeys(curve.first[name] for curve in drawn))
    return sorted(values) if all(isinstance(value, float) for value in values) else values


def _label(drawn: Sequence[PlottedCurve], name: str, value: Hashable) -> str:
    """Return a value of a parameter as a legend writes it."""
    first = next(curve for curve in drawn if curve.first[name] == value)
    if name == "method":
        return str(style.line(first.method)["label"])
    if name in ("case", "trace"):
        return str(first.first["trace"]) or style.describe(first.case)
    if name in PARAMETERS:
        return "" if first.first["trace"] else style.describe(first.case, name)
    if isinstance(value, float):
        return rf"$\phi={value:.3g}$" if value == first.first["phases"] else f"seed {value:.0f}"
    return f"{_values(drawn, name).index(value) + 1}. phases" if value else ""


def _join(labels: Iterable[str]) -> str:
    return ",  ".join(filter(None, labels))


def _by_dash(drawn: Sequence[PlottedCurve], grouping: Grouping) -> bool:
    """Return whether dashes must distinguish the methods because colours and panels do not."""
    return "method" not in (grouping.colour or "method", *grouping.facet) and len(_values(drawn, "method")) > 1


def _look(curve: PlottedCurve, drawn: Sequence[PlottedCurve], grouping: Grouping) -> dict[str, Any]:
    """Return the style of a curve: the style of its method, or a parameter's colour and the method's dashes."""
    look = style.points(curve.method) if curve.points else style.line(curve.method)
    if grouping.colour in ("", "method"):
        return look
    values = _values(drawn, grouping.colour)
    own = style.family(len(values))[values.index(curve.first[grouping.colour])]
    if not _by_dash(drawn, grouping):
        return look | own
    return look | {"color": own["color"]} | (BELOW_STYLE if look["linestyle"] == "-" else {})


def _draw(axes: Axes, members: Sequence[PlottedCurve], drawn: Sequence[PlottedCurve], grouping: Grouping) -> None:
    """Draw the lines of a panel, each with its band."""
    for curve in members:
        look = _look(curve, drawn, grouping)
        if curve.method in numerical_names():
            look["zorder"] = 1.9  # draws it below the thinner or dashed estimates
        parts = dict.fromkeys(filter(None, (grouping.colour, "method")))
        name = _join(_label(drawn, part, curve.first[part]) for part in parts)
        line(axes, name, curve.loads, curve.values, **look | {"label": name})
        if curve.band is not None:
            band(axes, f"{name}, {BAND_NAME}", curve.loads, *curve.band, color=look["color"], **BAND_STYLE)


def _draw_behind(
    axes: Axes, tables: Sequence[Values], members: Sequence[PlottedCurve], quantity: str
) -> Patch | None:
    """Draw the band of the most accurate curves of an ensemble behind a panel; returns its legend entry."""
    if not tables:
        return None
    table = table_of(tables)
    drawn = [tuple(curve.first[name] for name in PARAMETERS) for curve in members]
    here = pd.Series(list(zip(*(table[name] for name in PARAMETERS), strict=True))).isin(drawn)
    entry = None
    for _, same in table[here & table["best"]].groupby("method", sort=False):
        loads, reduced = _reduce(same, tables, quantity)
        label = f"{BAND_NAME} of {len(same)} phases"
        band(axes, label, loads, *reduced[1:], **BEHIND_STYLE)
        entry = Patch(label=label, **BEHIND_STYLE)
    return entry


def _differing(same: pd.DataFrame) -> list[str]:
    """Return the parameters in which curves differ; phases count for m > 1 if all curves have the same m."""
    differing = [name for name in SURFACES if same[name].nunique(dropna=False) > 1]
    by_phases = "m" not in differing and same["phases"][same["m"] != 1].nunique() > 1
    return differing + ["seed" if same["seeded"].all() else "phases"] * by_phases


def _draw_errors(axes: Axes, curve: PlottedCurve, quantity: str) -> Patch | None:
    """Draw the stated errors of a method as a band; returns its legend entry, or None if the band is invisible."""
    own, place = curve.own, (curve.first["row"], curve.first["column"])
    if quantity not in VISIBLE or own.stated is None or not np.isfinite(own.stated[place]).any():
        return None
    stated, values = own.stated[place], own.values[place]
    width = np.where(np.isfinite(stated) & (values > 0), stated, 0.0)
    of = np.where(values > 0, values, 1.0) if quantity == "resistance" else values.max()  # R has a logarithmic axis
    wide = width / of >= VISIBLE[quantity]
    if not (wide[1:] & wide[:-1]).any():
        return None
    look = style.line(curve.method)
    name, low = f"error stated by {look['label']}", np.maximum(values - width, values * np.finfo(float).eps)
    band(axes, name, own.loads, low, values + width, color=look["color"], **ERROR_STYLE)
    return Patch(color=look["color"], label=name, **ERROR_STYLE)


def _legend(seen: Sequence[PlottedCurve], drawn: Sequence[PlottedCurve], grouping: Grouping) -> list[Any]:
    """Return legend entries for colours, dashes and bands of the curves seen, which have the looks of all."""
    colour, by_dash = grouping.colour or "method", _by_dash(drawn, grouping)
    handles: list[Any] = []
    for value in _values(seen, colour):
        first = next(curve for curve in seen if curve.first[colour] == value)
        look = _look(first, drawn, grouping)
        own = {"color": look["color"]} if by_dash else look
        handles.append(Line2D([], [], **{**own, "label": _label(drawn, colour, value), "markevery": None}))
    if by_dash:
        looks = {curve.method: _look(curve, drawn, grouping) for curve in seen}
        handles += [Line2D([], [], **look | {"color": style.GREY, "markevery": None}) for look in looks.values()]
    if grouping.median_over:
        over = dict.fromkeys(NOUNS.get(name) or f"${style.symbol(name)}$" for name in grouping.median_over)
        counts = sorted({curve.members for curve in seen})
        number = " to ".join(map(str, dict.fromkeys([counts[0], counts[-1]])))
        handles += [
            Line2D([], [], color=style.GREY, label=f"line: median over {' and '.join(over)}"),
            Patch(color=style.GREY, label=f"band: {BAND_NAME} of {number}", **BAND_STYLE),
        ]
    return handles


def _add_legend(figure: Figure, panels: Sequence[Axes], handles: Sequence[Any]) -> None:
    """Place the legend inside a single panel if it is short, otherwise below all panels."""
    if len(panels) == 1 and len(handles) <= 6:  # longer legends would cover the curves
        panels[0].legend(handles=handles, loc="best")
        return
    columns = 2 if len(panels) == 1 else 3
    figure.set_figheight(figure.get_figheight() + style.LEGEND_ROW * -(-len(handles) // columns))
    figure.legend(handles=handles, loc="outside lower center", ncols=columns)
