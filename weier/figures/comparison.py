"""Several methods beside each other on one quantity: what Figs 3 to 6 share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import MAX_PANELS, grouped, lines, style
from weier.methods.registry import names, numerical_names
from weier.pipeline import curves
from weier.scene import BY_DEFAULT, Grouping


def compare(
    studies: Sequence[xr.Dataset], title: str, quantity: str, grouping: Grouping = BY_DEFAULT
) -> tuple[Figure, list[tuple[Axes, list[xr.Dataset]]]]:
    """The quantity by each method: one panel for each case if there are few, else all cases in one panel.

    If the scene says by which parameters, the figure is `weier.figures.grouped`.

    Returns
    -------
    figure : Figure
    panels : list of (Axes, cases)
        Limits and scales are left to the caller, and the legend unless the scene says how to draw; the labels
        are in place.

    """
    if grouping != BY_DEFAULT:
        return grouped.compare(studies, title, quantity, grouping)
    cases = [case for case in curves.cases(studies) if np.isfinite(case[quantity]).any()]
    if not cases:
        raise ValueError(f"there are no curves of {quantity} to draw in these studies")
    separate = len(cases) <= MAX_PANELS
    panels = [[case] for case in cases] if separate else [cases]
    figure, axes = style.column(len(panels))
    for number, (panel, group) in enumerate(zip(axes, panels, strict=True)):
        (_draw_case if separate else _draw_medians)(panel, group, quantity)
        label = style.describe(group[0]) if separate else f"{len(cases)} cases"
        style.name_panel(panel, number, len(panels), label)
        panel.set_ylabel(style.LABELS[quantity])
    axes[-1].set_xlabel(style.LABELS["mean_pressure"])
    style.set_title(figure, title)
    return figure, list(zip(axes, panels, strict=True))


def _draw_case(axes: Axes, cases: Sequence[xr.Dataset], quantity: str) -> None:
    """The most accurate numerical method as a line, further ones as points."""
    (case,) = cases
    reference, numerical = curves.numerical_method(case), numerical_names()
    for method in _methods(case, quantity):
        beside = method in numerical and method != reference
        look = style.points(method) if beside else style.line(method)
        if method in numerical:
            look["zorder"] = 1.9  # below the estimates, which are thinner than it or have gaps
        drawn = lines.points(case, quantity, method) if beside else lines.line(case, quantity, method)
        if drawn:
            axes.plot(*drawn, **look)
            _draw_errors(axes, case, quantity, method)


def _draw_errors(axes: Axes, case: xr.Dataset, quantity: str, method: str) -> None:
    """The errors that a method states, as bars: those shorter than a marker or a line is wide vanish behind it."""
    stated, values = curves.curve(case, f"{quantity}_error", method), curves.curve(case, quantity, method)
    if stated is not None and values is not None:
        known = np.isfinite(stated) & (values > 0)
        loads = case["mean_pressure"].values[known]
        axes.errorbar(loads, values[known], stated[known], **style.error_bars(method))


def _draw_medians(axes: Axes, cases: Sequence[xr.Dataset], quantity: str) -> None:
    """A thin line for each case, and a thick one, or points, for the median over those of other phases alone."""
    methods = _in_drawing_order(method for case in cases for method in _methods(case, quantity))
    as_points = style.drawn_as_points(methods)
    for method in methods:
        look = style.points(method) if method in as_points else style.line(method)
        for group in curves.groups(cases, "D", "gamma", "m"):
            drawn = [each for case in group if (each := lines.line(case, quantity, method))]
            if not drawn:
                continue
            loads, values = lines.on_common_loads(drawn)
            axes.plot(loads, values.T, color=look["color"], linewidth=0.3, alpha=style.FAINT_ALPHA)
            axes.plot(loads, np.median(values, axis=0), **look, zorder=3)
            look["label"] = None  # once in the legend
    axes.plot([], [], color=style.GREY, label="thick: median over phases")
    axes.plot([], [], color=style.GREY, linewidth=0.3, label="thin: a single profile")


def _methods(case: xr.Dataset, quantity: str) -> list[str]:
    """The methods that have a curve of a case, in the order in which they are drawn."""
    methods = _in_drawing_order(case["solution_method"].values.tolist())
    return [method for method in methods if curves.curve(case, quantity, method) is not None]


def _in_drawing_order(methods: Iterable[str]) -> list[str]:
    """The estimates from the least accurate on, then methods that are not listed, then the numerical ones on top."""
    numerical = numerical_names()
    estimates = [name for name in names() if name not in numerical]
    distinct = list(dict.fromkeys(methods))
    others = [name for name in distinct if name not in (*estimates, *numerical)]
    return [name for name in (*estimates, *others, *numerical) if name in distinct]
