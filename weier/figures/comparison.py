"""Curves of many cases and methods, with the colours, panels and medians that a scene chooses.

A figure of a sweep shows the effect of its parameters. By default, each of few cases has a panel, and curves of many
cases are medians over the phases.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from weier.data import curves
from weier.figures import lines, style
from weier.figures.captions import PLURALS
from weier.figures.traces import names_of_traces
from weier.kernels.arrays import Array
from weier.methods.registry import names, numerical_names
from weier.scene import Grouping
from weier.scene.figure import EACH_CASE
from weier.surface.profile import PARAMETERS
from weier.theory.conduction import Bodies

TITLE_ROW = 0.2  # inches: the height of a line of the title.
MAX_NAMED = 8  # A legend has at most so many values of a parameter, to fit below the panels.
# The looks of bands around medians, of a solid line that dashed ones of its colour cover, and of bands of stated
# errors.
BAND: dict[str, Any] = {"alpha": 0.16, "linewidth": 0}
BELOW: dict[str, Any] = {"linewidth": 2.6, "alpha": 0.5}
STATED: dict[str, Any] = {"alpha": 0.35, "linewidth": 0, "zorder": 1.8}
# A narrower band of stated errors is hidden by its line: widths over the largest compliance, and over the resistance.
VISIBLE = {"compliance": 0.01, "resistance": 0.05}
SURFACES = (*PARAMETERS, "trace")  # These distinguish the surfaces of curves beside phases.


class PlottedCurve(NamedTuple):
    """A curve in a figure: its case and method, its loads and values, and its parameters by name.

    points : whether it is drawn as points beside a more accurate curve
    """

    case: xr.Dataset
    method: str
    loads: Array
    values: Array
    points: bool
    parameters: Mapping[str, Hashable]


def compare(
    studies: Sequence[xr.Dataset], title: str, quantity: str, grouping: Grouping, interface: Bodies | None = None
) -> tuple[Figure, Sequence[Axes], Sequence[xr.Dataset]]:
    """A figure of a quantity with the panels, colours and medians of a grouping; in SI units with an interface.

    Returns
    -------
    figure : Figure
    panels : sequence of Axes
        They have common axes, whose limits and scales the caller sets.
    cases : sequence of Dataset
        The cases that are drawn.

    Raises
    ------
    ValueError
        If there are no such curves, or some could not be distinguished.

    """
    cases = [case for case in curves.cases(studies) if np.isfinite(case[quantity]).any()]
    if not cases:
        raise ValueError(f"there are no curves of {quantity} to draw in these studies")
    grouping = grouping.of(len(cases))
    drawn = _curves(cases, quantity, grouping, interface)
    of_each = [_values(drawn, name) for name in grouping.facet]
    noun = " and ".join(grouping.facet) or "curves"
    title, shown = style.limit_panels(title, list(itertools.product(*of_each)), noun, style.MAX_GRID)
    labels = style.SI_LABELS if interface else style.LABELS
    figure, panels = style.grid(len(shown), labels["mean_pressure"], labels[quantity], *map(len, of_each[1:]))
    of_all = {name: _values(drawn, name) for name in ("method", *SURFACES, "seed") if name not in grouping.facet}
    alike = {name: values[0] for name, values in of_all.items() if len(values) == 1 and values[0] != ""}
    shared = "" if grouping == EACH_CASE else _join(_label(drawn, *parameter) for parameter in alike.items())
    stated: dict[str, Patch] = {}
    for number, (axes, value) in enumerate(zip(panels, shown, strict=True)):
        members = [curve for curve in drawn if tuple(curve.parameters[name] for name in grouping.facet) == value]
        _draw(axes, members, drawn, grouping)
        if grouping.colour in ("", "method") and not grouping.median_over:
            stated |= {curve.method: band for curve in members if (band := _draw_errors(axes, curve, quantity))}
        own = _join(_label(drawn, *parameter) for parameter in zip(grouping.facet, value, strict=True))
        style.name_panel(axes, number, len(shown), own if len(shown) > 1 else _join([own, shared]))
    _add_legend(figure, panels, _legend(drawn, grouping) + list(stated.values()))
    if interface:  # a power of ten stands beside the title
        for axes in panels:
            axes.yaxis.get_offset_text().set(x=-0.02, horizontalalignment="right")
    above = list(filter(None, [title, shared if len(shown) > 1 else ""]))
    figure.set_figheight(figure.get_figheight() + TITLE_ROW * len(above))
    style.set_title(figure, "\n".join(above))
    return figure, panels, list({id(curve.case): curve.case for curve in drawn}.values())


def _curves(
    cases: Sequence[xr.Dataset], quantity: str, grouping: Grouping, interface: Bodies | None
) -> list[PlottedCurve]:
    """All curves, in normalised or SI units, in the order in which they are drawn."""
    numerical, found = numerical_names(), []
    traces = names_of_traces(cases)
    for position, (case, trace) in enumerate(zip(cases, traces, strict=True)):
        of = interface and interface.at(case)
        units = (of.pressure(1.0), getattr(of, quantity)(1.0)) if of else (1.0, 1.0)
        shown = of.in_si(case) if of else case
        parameters = _parameters(case, position, trace)
        for method in case["solution_method"].values.tolist():
            beside = method in numerical and method != curves.numerical_method(case)
            points = beside and "method" not in grouping.facet
            # The line between the loads uses both quantities before their conversion to SI units.
            drawn = (lines.points if points else lines.line)(case, quantity, method)
            if drawn:
                loads, values = (own * unit for own, unit in zip(drawn, units, strict=True))
                found.append(PlottedCurve(shown, method, loads, values, points, parameters | {"method": method}))
    # The estimates, from the least accurate on, then methods that are not listed, then the numerical ones on top.
    estimates = [name for name in names() if name not in numerical]
    order = {name: rank for rank, name in enumerate([*estimates, "", *numerical])}
    return sorted(found, key=lambda curve: order.get(curve.method, order[""]))


def _parameters(case: xr.Dataset, position: int, trace: str) -> dict[str, Hashable]:
    """The values of a case for grouping: equal phases are one number, and a seed stands for its phases."""
    phase = case["phases"].values[1:]
    phase = phase[np.isfinite(phase)].round(9)
    phases = float(phase[0]) if phase.size and np.ptp(phase) == 0 else tuple(phase.tolist())
    seed = float(case.get("seed", np.nan))
    numbers = {name: float(case[name]) for name in PARAMETERS}
    known = {name: None if trace else value for name, value in numbers.items()} | {"trace": trace}
    return {"": None, "case": position, **known, "phases": phases, "seed": seed if np.isfinite(seed) else phases}


def _values(drawn: Iterable[PlottedCurve], name: str) -> list[Hashable]:
    """The distinct values of a parameter: numbers are sorted, others in order of appearance."""
    values = list(dict.fromkeys(curve.parameters[name] for curve in drawn))
    return sorted(values) if all(isinstance(value, float) for value in values) else values  # type: ignore[type-var]  # all are floats


def _label(drawn: Sequence[PlottedCurve], name: str, value: Hashable) -> str:
    """A value of a parameter as a legend writes it."""
    first = next(curve for curve in drawn if curve.parameters[name] == value)
    if name == "method":
        return str(style.line(first.method)["label"])
    if name in ("case", "trace"):
        return str(first.parameters["trace"]) or style.describe(first.case)
    if name in PARAMETERS:
        return "" if first.parameters["trace"] else style.describe(first.case, name)
    if isinstance(value, float):
        return rf"$\phi={value:.3g}$" if value == first.parameters["phases"] else f"seed {value:g}"
    return f"{_values(drawn, name).index(value) + 1}. phases" if value else ""


def _join(labels: Iterable[str]) -> str:
    return ",  ".join(filter(None, labels))


def _by_dash(drawn: Sequence[PlottedCurve], grouping: Grouping) -> bool:
    """Whether dashes distinguish the methods, since colours and panels do not."""
    return "method" not in (grouping.colour or "method", *grouping.facet) and len(_values(drawn, "method")) > 1


def _look(curve: PlottedCurve, drawn: Sequence[PlottedCurve], grouping: Grouping) -> dict[str, Any]:
    """The look of a curve: that of its method, or the colour of a parameter, with dashes for several methods."""
    look = style.points(curve.method) if curve.points else style.line(curve.method)
    if grouping.colour in ("", "method"):
        return look
    values = _values(drawn, grouping.colour)
    own = style.family(len(values))[values.index(curve.parameters[grouping.colour])]
    if not _by_dash(drawn, grouping):
        return look | own
    return look | {"color": own["color"]} | (BELOW if look["linestyle"] == "-" else {})


def _draw(axes: Axes, members: Sequence[PlottedCurve], drawn: Sequence[PlottedCurve], grouping: Grouping) -> None:
    """Draw the median of all curves of the same look in a band that contains them, or the single curve."""
    alike: dict[tuple[Hashable, Hashable], list[PlottedCurve]] = {}
    for curve in members:
        alike.setdefault((curve.parameters[grouping.colour], curve.method), []).append(curve)
    for same in alike.values():
        if hidden := grouping.hidden(_differing(same)):
            raise ValueError(grouping.proposal(hidden))
        loads, values = lines.on_common_loads([(curve.loads, curve.values) for curve in same])
        look = _look(same[0], drawn, grouping)
        if same[0].method in numerical_names():
            look["zorder"] = 1.9  # below the estimates, which are thinner than it or have gaps
        axes.plot(loads, np.median(values, axis=0), **look)
        if len(same) > 1:
            axes.fill_between(loads, values.min(axis=0), values.max(axis=0), color=look["color"], **BAND)


def _differing(same: Sequence[PlottedCurve]) -> list[str]:
    """The parameters in which some curves differ; phases where they have several waves, as many each."""
    differing = [name for name in SURFACES if len(_values(same, name)) > 1]
    several = [curve for curve in same if curve.parameters["m"] != 1]
    by_phases = "m" not in differing and len(_values(several, "phases")) > 1
    return differing + ["seed" if isinstance(same[0].parameters["seed"], float) else "phases"] * by_phases


def _draw_errors(axes: Axes, curve: PlottedCurve, quantity: str) -> Patch | None:
    """Draw the stated errors of a method as a band; returns its legend entry, or None if the band is invisible."""
    stated = curves.curve(curve.case, f"{quantity}_error", curve.method)
    values = curves.curve(curve.case, quantity, curve.method)
    if stated is None or values is None:
        return None
    width = np.where(np.isfinite(stated) & (values > 0), stated, 0.0)
    of = np.where(values > 0, values, 1.0) if quantity == "resistance" else values.max()  # by its logarithmic axis
    wide = width / of >= VISIBLE[quantity]
    if not (wide[1:] & wide[:-1]).any():
        return None
    line = style.line(curve.method)
    low = np.maximum(values - width, values * np.finfo(float).eps)  # on a logarithmic axis, too
    axes.fill_between(curve.case["mean_pressure"].values, low, values + width, color=line["color"], **STATED)
    return Patch(color=line["color"], label=f"error stated by {line['label']}", **STATED)


def _legend(drawn: Sequence[PlottedCurve], grouping: Grouping) -> list[Any]:
    """Legend entries for colours, dashes and bands."""
    colour, by_dash = grouping.colour or "method", _by_dash(drawn, grouping)
    values = _values(drawn, colour)
    shown = [values[number] for number in np.unique(np.linspace(0, len(values) - 1, MAX_NAMED).round().astype(int))]
    handles: list[Any] = []
    for value in shown:
        first = next(curve for curve in drawn if curve.parameters[colour] == value)
        look = _look(first, drawn, grouping)
        own = {"color": look["color"]} if by_dash else look
        handles.append(Line2D([], [], **{**own, "label": _label(drawn, colour, value), "markevery": None}))
    if by_dash:
        looks = {curve.method: _look(curve, drawn, grouping) for curve in drawn}
        handles += [Line2D([], [], **look | {"color": style.GREY, "markevery": None}) for look in looks.values()]
    if grouping.median_over:
        over = dict.fromkeys(PLURALS.get(name) or f"${style.symbol(name)}$" for name in grouping.median_over)
        handles += [
            Line2D([], [], color=style.GREY, label=f"line: median over {' and '.join(over)}"),
            Patch(color=style.GREY, label="band: all of them", **BAND),
        ]
    return handles


def _add_legend(figure: Figure, panels: Sequence[Axes], handles: Sequence[Any]) -> None:
    """The legend inside a single panel if it is short, else below all panels."""
    if len(panels) == 1 and len(handles) <= MAX_NAMED:
        panels[0].legend(handles=handles, loc="best")
        return
    columns = 2 if len(panels) == 1 else 3
    figure.set_figheight(figure.get_figheight() + style.LEGEND_ROW * -(-len(handles) // columns))
    figure.legend(handles=handles, loc="outside lower center", ncols=columns)
