"""Curves of many cases and methods by the parameters that a scene names: for colours, panels and medians.

So a figure of a sweep answers the question of the sweep: what does this parameter change? Where a scene names none,
each case has a panel if there are few, and medians are taken over the phases of many.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from weier.figures import lines, style
from weier.figures.captions import PLURALS
from weier.figures.traces import names_of_traces
from weier.kernels.arrays import Array
from weier.methods import curves
from weier.methods.plan_part import COMPLIANCE, RESISTANCE
from weier.methods.registry import PLANNED, names, numerical_names
from weier.scene import Grouping
from weier.scene.figure import EACH_CASE
from weier.theory.conduction import Interface, at_scale_of
from weier.theory.profile import PARAMETERS

TITLE_ROW = 0.2  # inches
MAX_NAMED = 8  # values of a parameter in a legend
BAND: dict[str, Any] = {"alpha": 0.16, "linewidth": 0}
BELOW: dict[str, Any] = {"linewidth": 2.6, "alpha": 0.5}  # a solid line, where dashes of its colour may hide it
STATED: dict[str, Any] = {"alpha": 0.35, "linewidth": 0, "zorder": 1.8}  # band of stated errors
# A narrower band of stated errors, or one at a single load, hides behind its line: of the largest compliance, and of
# the resistance there.
VISIBLE = {"compliance": 0.01, "resistance": 0.05}
SURFACES = (*PARAMETERS, "trace")  # what distinguishes the surfaces of curves beside phases


class PlottedCurve(NamedTuple):
    """The values of one case by one method, the loads where they are drawn, and the parameters by name.

    points : whether it is drawn as points beside a more accurate curve
    """

    case: xr.Dataset
    method: str
    loads: Array
    values: Array
    points: bool
    parameters: Mapping[str, Hashable]


def compare(
    studies: Sequence[xr.Dataset], title: str, quantity: str, grouping: Grouping, interface: Interface | None = None
) -> tuple[Figure, Sequence[Axes], Sequence[xr.Dataset]]:
    """The quantity in panels, colours and medians as a scene names them; in SI units if there is an interface.

    Returns
    -------
    figure : Figure
    panels : sequence of Axes
        They share their axes, whose limits and scales are left to the caller.
    cases : sequence of Dataset
        What is drawn.

    Raises
    ------
    ValueError
        If there are no such curves, or some that could not be distinguished.

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
    shared = "" if grouping == EACH_CASE else _join(_title(drawn, *each) for each in alike.items())
    stated: dict[str, Patch] = {}
    for number, (axes, value) in enumerate(zip(panels, shown, strict=True)):
        members = [each for each in drawn if tuple(each.parameters[name] for name in grouping.facet) == value]
        _draw(axes, members, drawn, grouping)
        if grouping.colour in ("", "method") and not grouping.median_over:
            stated |= {each.method: band for each in members if (band := _draw_errors(axes, each, quantity))}
        own = _join(_title(drawn, *each) for each in zip(grouping.facet, value, strict=True))
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
    cases: Sequence[xr.Dataset], quantity: str, grouping: Grouping, interface: Interface | None
) -> list[PlottedCurve]:
    """All curves there are, in the units of their bodies and in the order in which they are drawn."""
    numerical, found = numerical_names(), []
    traces = names_of_traces(cases)
    for position, (case, trace) in enumerate(zip(cases, traces, strict=True)):
        of = interface and at_scale_of(case, interface)
        units = (of.pressure(1.0), getattr(of, quantity)(1.0)) if of else (1.0, 1.0)
        shown = of.in_si(case) if of else case
        parameters = _parameters(case, position, trace)
        for method in case["solution_method"].values.tolist():
            beside = method in numerical and method != curves.numerical_method(case)
            points = beside and "method" not in grouping.facet
            # A line between the loads is drawn while the resistance is the slope of the compliance.
            drawn = (lines.points if points else lines.line)(case, quantity, method)
            if drawn:
                loads, values = (own * unit for own, unit in zip(drawn, units, strict=True))
                found.append(PlottedCurve(shown, method, loads, values, points, parameters | {"method": method}))
    # The estimates, from the least accurate on, then methods that are not listed, then the numerical ones on top.
    estimates = [name for name in names() if name not in numerical]
    order = {name: rank for rank, name in enumerate([*estimates, "", *numerical])}
    return sorted(found, key=lambda each: order.get(each.method, order[""]))


def _parameters(case: xr.Dataset, position: int, trace: str) -> dict[str, Hashable]:
    """What a case may be grouped by: numbers, the phases (one number if they are equal), the seed or else phases."""
    phase = case["phases"].values[1:]
    phase = phase[np.isfinite(phase)].round(9)
    phases = float(phase[0]) if phase.size and np.ptp(phase) == 0 else tuple(phase.tolist())
    seed = float(case.get("seed", np.nan))
    numbers = {name: float(case[name]) for name in PARAMETERS}
    known = {name: None if trace else value for name, value in numbers.items()} | {"trace": trace}
    return {"": None, "case": position, **known, "phases": phases, "seed": seed if np.isfinite(seed) else phases}


def _values(drawn: Iterable[PlottedCurve], name: str) -> list[Hashable]:
    """The values of a parameter, numbers in their order and others in that of their appearance."""
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


def _title(drawn: Sequence[PlottedCurve], name: str, value: Hashable) -> str:
    """A value of a parameter as it stands over panels: of plans, with what they were asked for."""
    settings = [
        str(curve.case["settings"].sel(solution_method=PLANNED).item())
        for curve in drawn
        if (name, value, curve.method) == ("method", PLANNED, PLANNED)
    ]
    wanted = [(plan["quantity"], plan["tolerance"]) for plan in map(json.loads, filter(None, settings))]
    if not wanted:
        return _label(drawn, name, value)
    parts = [
        f"{quantity} within {max(tolerance for other, tolerance in wanted if other == quantity):g}{unit}"
        for quantity, unit in ((COMPLIANCE, " $g_0$"), (RESISTANCE, ""))
        if quantity in dict(wanted)
    ]
    return f"planned: {' or '.join(parts)}"


def _join(labels: Iterable[str]) -> str:
    return ",  ".join(filter(None, labels))


def _by_dash(drawn: Sequence[PlottedCurve], grouping: Grouping) -> bool:
    """Whether dashes distinguish the methods, since colours and panels do not."""
    return "method" not in (grouping.colour or "method", *grouping.facet) and len(_values(drawn, "method")) > 1


def _look(curve: PlottedCurve, drawn: Sequence[PlottedCurve], grouping: Grouping) -> dict[str, Any]:
    """How a curve is drawn: by its method, or in the colour of a parameter, with the dashes of several methods."""
    look = style.points(curve.method) if curve.points else style.line(curve.method)
    if grouping.colour in ("", "method"):
        return look
    values = _values(drawn, grouping.colour)
    own = style.family(len(values))[values.index(curve.parameters[grouping.colour])]
    if not _by_dash(drawn, grouping):
        return look | own
    return look | {"color": own["color"]} | (BELOW if look["linestyle"] == "-" else {})


def _draw(axes: Axes, members: Sequence[PlottedCurve], drawn: Sequence[PlottedCurve], grouping: Grouping) -> None:
    """The median of the curves that look alike, within a band that holds all of them, or the one curve there is."""
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
    """The errors that a method states, as a band with what the legend says of it, if anywhere one can see it."""
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
    """What each colour, each dash and the band say."""
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
        each = {curve.method: _look(curve, drawn, grouping) for curve in drawn}
        handles += [Line2D([], [], **look | {"color": style.GREY, "markevery": None}) for look in each.values()]
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
