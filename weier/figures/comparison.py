"""Several methods beside each other on one quantity: what Figs 3 to 6 share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import style
from weier.methods.registry import names, numerical_names
from weier.pipeline import curves


def compare(
    studies: Sequence[xr.Dataset], title: str, quantity: str
) -> tuple[Figure, list[tuple[Axes, list[xr.Dataset]]]]:
    """The quantity by each method: one panel for each case if there are few, else all cases in one panel.

    Returns
    -------
    figure : Figure
    panels : list of (Axes, cases)
        The legend, limits and scales are left to the caller; the labels are in place.

    """
    cases = [case for case in curves.cases(studies) if np.isfinite(case[quantity]).any()]
    if not cases:
        raise ValueError(f"there are no curves of {quantity} to draw in these studies")
    separate = len(cases) <= style.MAX_PANELS
    panels = [[case] for case in cases] if separate else [cases]
    figure, axes = style.column(len(panels))
    for number, (panel, group) in enumerate(zip(axes, panels, strict=True)):
        (_draw_case if separate else _draw_medians)(panel, group, quantity)
        label = style.describe(group[0]) if separate else f"{len(cases)} cases and their median"
        style.name_panel(panel, number, len(panels), label)
        panel.set_ylabel(style.LABELS[quantity])
    axes[-1].set_xlabel(style.LABELS["mean_pressure"])
    style.set_title(figure, title)
    return figure, list(zip(axes, panels, strict=True))


def _draw_case(axes: Axes, cases: Sequence[xr.Dataset], quantity: str) -> None:
    """The most accurate numerical method as a line, further ones as points."""
    (case,) = cases
    reference, numerical = curves.numerical_method(case), numerical_names()
    for method, values in _curves_by_method(case, quantity).items():
        look = style.line(method) if method == reference or method not in numerical else style.points(method)
        if method in numerical:
            look["zorder"] = 1.9  # below the estimates, which are thinner than it or have gaps
        axes.plot(case["mean_pressure"].values, values, **look)


def _draw_medians(axes: Axes, cases: Sequence[xr.Dataset], quantity: str) -> None:
    """A thin line for each case, and a thick one, or points, for the median of each method."""
    loads, rows = cases[0]["mean_pressure"].values, [_curves_by_method(case, quantity) for case in cases]
    methods = _in_drawing_order(method for row in rows for method in row)
    as_points = style.drawn_as_points(methods)
    for method in methods:
        values = np.array([row[method] for row in rows if method in row])
        look = style.points(method) if method in as_points else style.line(method)
        axes.plot(loads, values.T, color=look["color"], linewidth=0.3, alpha=style.FAINT_ALPHA)
        axes.plot(loads, np.median(values, axis=0), **look, zorder=3)


def _curves_by_method(case: xr.Dataset, quantity: str) -> dict[str, np.ndarray]:
    """The curves of a case by their methods, in the order in which they are drawn."""
    methods = _in_drawing_order(case["solution_method"].values.tolist())
    rows = {method: curves.curve(case, quantity, method) for method in methods}
    return {method: row for method, row in rows.items() if row is not None}


def _in_drawing_order(methods: Iterable[str]) -> list[str]:
    """The estimates from the least accurate on, then methods that are not listed, then the numerical ones on top."""
    numerical = numerical_names()
    estimates = [name for name in names() if name not in numerical]
    distinct = list(dict.fromkeys(methods))
    others = [name for name in distinct if name not in (*estimates, *numerical)]
    return [name for name in (*estimates, *others, *numerical) if name in distinct]
