"""Curves of many cases by the parameters that a scene names: for colours, for panels, and to take the median over.

So a figure of a sweep answers the question of the sweep: what does this parameter change?
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from weier.figures import lines, style
from weier.kernels.arrays import Array
from weier.methods.registry import names
from weier.pipeline import curves
from weier.scene import Grouping

LEGEND_ROW, LOW = 0.17, 1.9  # inches: a row of the legend, and a panel among more than two
MAX_NAMED = 8  # values of a parameter in a legend
PHASES = {"phase", "phases", "seed"}  # names of what differs between profiles of the same D, gamma and m
BAND: dict[str, Any] = {"alpha": 0.16, "linewidth": 0}

Panel = tuple[Axes, list[xr.Dataset]]


class Curve(NamedTuple):
    """The values of one case by one method, the loads where they are drawn, and the parameters by name."""

    case: xr.Dataset
    method: str
    loads: Array
    values: Array
    parameters: Mapping[str, Hashable]


def compare(
    studies: Sequence[xr.Dataset], title: str, quantity: str, grouping: Grouping
) -> tuple[Figure, list[Panel]]:
    """The quantity in panels, colours and medians as a scene asks for them, with a legend below.

    Returns
    -------
    figure : Figure
    panels : list of (Axes, cases)
        Limits and scales are left to the caller.

    """
    drawn = _curves(studies, quantity)
    title, panels = style.limit_panels(title, _values(drawn, grouping.facet), grouping.facet or "curves")
    figure, axes = style.column(len(panels), style.HEIGHT if len(panels) <= 2 else LOW)
    result = []
    for number, (panel, value) in enumerate(zip(axes, panels, strict=True)):
        members = [each for each in drawn if each.parameters[grouping.facet] == value]
        _draw(panel, members, drawn, grouping)
        style.name_panel(panel, number, len(panels), _panel_name(members, drawn, grouping))
        panel.set_ylabel(style.LABELS[quantity])
        result.append((panel, [each.case for each in members]))
    axes[-1].set_xlabel(style.LABELS["mean_pressure"])
    handles = _legend(drawn, grouping)
    figure.set_figheight(figure.get_figheight() + LEGEND_ROW * -(-len(handles) // 2))
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    style.set_title(figure, title)
    return figure, result


def _curves(studies: Sequence[xr.Dataset], quantity: str) -> list[Curve]:
    """All curves there are, in the order of the methods."""
    found = [
        Curve(case, method, *drawn, parameters | {"method": method})
        for case in curves.cases(studies)
        for parameters in [_parameters(case)]
        for method in case["solution_method"].values.tolist()
        if (drawn := lines.line(case, quantity, method))
    ]
    if not found:
        raise ValueError(f"there are no curves of {quantity} to draw in these studies")
    order = names()
    return sorted(found, key=lambda each: order.index(each.method) if each.method in order else len(order))


def _parameters(case: xr.Dataset) -> dict[str, Hashable]:
    """What a scene may group a case by: numbers, and the phases of all terms."""
    phase = case["phases"].values
    phases = tuple(phase[np.isfinite(phase)].round(9).tolist())
    seed = float(case.get("seed", np.nan))
    numbers = {name: float(case[name]) for name in ("D", "gamma", "m")}
    angle = round(curves.phase_angle(case), 9)
    return {"": None, **numbers, "phase": angle, "phases": phases, "seed": seed if np.isfinite(seed) else phases}


def _values(drawn: Iterable[Curve], name: str) -> list[Hashable]:
    """The values of a parameter, numbers in their order and others in that of their appearance."""
    values = list(dict.fromkeys(curve.parameters[name] for curve in drawn))
    return sorted(values, key=float) if name in ("D", "gamma", "m", "phase") else values  # type: ignore[arg-type]


def _label(drawn: Sequence[Curve], name: str, value: Hashable) -> str:
    """A value of a parameter as a legend writes it."""
    first = next(curve for curve in drawn if curve.parameters[name] == value)
    if name == "method":
        return str(style.line(first.method)["label"])
    if isinstance(value, float) and name == "seed":
        return f"seed {value:g}"
    if name in ("phases", "seed"):
        return f"{_values(drawn, name).index(value) + 1}. phases"
    return style.describe(first.case, name) or rf"$\phi={value:.3g}$"


def _panel_name(members: Sequence[Curve], drawn: Sequence[Curve], grouping: Grouping) -> str:
    """What all curves of a panel share: the value of the panel, and what is one and the same in the whole figure."""
    parameters = {grouping.facet, *(name for name in ("D", "gamma", "m") if len(_values(drawn, name)) == 1)} - {""}
    ordered = [name for name in ("method", "D", "gamma", "m", "phase", "phases", "seed") if name in parameters]
    return r",  ".join(_label(members, name, members[0].parameters[name]) for name in ordered)


def _looks(drawn: Sequence[Curve], grouping: Grouping) -> Callable[[Curve], dict[str, Any]]:
    """How a curve is drawn: its colour by the parameter of the scene, its dashes by the method if these differ."""
    if grouping.colour in ("", "method"):
        return lambda curve: style.line(curve.method) | {"label": None}
    values = _values(drawn, grouping.colour)
    family = dict(zip(values, style.family(len(values)), strict=True))
    by_method = grouping.facet != "method" and len(_values(drawn, "method")) > 1

    def look(curve: Curve) -> dict[str, Any]:
        own = family[curve.parameters[grouping.colour]]
        return own | ({"linestyle": style.line(curve.method)["linestyle"]} if by_method else {})

    return look


def _draw(axes: Axes, members: Sequence[Curve], drawn: Sequence[Curve], grouping: Grouping) -> None:
    """The median of the curves that differ in nothing else, within a band that holds all of them."""
    look = _looks(drawn, grouping)
    phases = () if PHASES & {*grouping.median_over} else ("seed",)
    apart = [name for name in ("method", "D", "gamma", "m", *phases) if name not in grouping.median_over]
    groups: dict[tuple[Hashable, ...], list[Curve]] = {}
    for curve in members:
        groups.setdefault(tuple(curve.parameters[name] for name in apart), []).append(curve)
    for same in groups.values():
        loads, values = lines.on_common_loads([(curve.loads, curve.values) for curve in same])
        style_of_line = look(same[0])
        axes.plot(loads, np.median(values, axis=0), **style_of_line)
        if len(same) > 1:
            axes.fill_between(loads, values.min(axis=0), values.max(axis=0), color=style_of_line["color"], **BAND)


def _legend(drawn: Sequence[Curve], grouping: Grouping) -> list[Any]:
    """What each colour, each dash and the band say."""
    look = _looks(drawn, grouping)
    colour = grouping.colour or "method"
    values = _values(drawn, colour)
    shown = [values[number] for number in np.unique(np.linspace(0, len(values) - 1, MAX_NAMED).round().astype(int))]
    by_dash = colour != "method" and grouping.facet != "method" and len(_values(drawn, "method")) > 1
    handles: list[Any] = []
    for value in shown:
        first = next(curve for curve in drawn if curve.parameters[colour] == value)
        own = look(first) | ({"linestyle": "-"} if by_dash else {})
        handles.append(Line2D([], [], **own | {"label": _label(drawn, colour, value)}))
    if by_dash:
        methods = _values(drawn, "method")
        handles += [Line2D([], [], **style.line(str(method)) | {"color": style.GREY}) for method in methods]
    if grouping.median_over:
        over = " and ".join(grouping.median_over)
        handles += [
            Line2D([], [], color=style.GREY, label=f"line: median over {over}"),
            Patch(color=style.GREY, label="band: all of them", **BAND),
        ]
    return handles
