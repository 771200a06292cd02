"""Curves of series over the load, in one panel for each value of their parameters, for Figs 2, 7 and 8."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.data import curves
from weier.figures import style
from weier.figures.tables import Values
from weier.figures.values import line
from weier.methods.registry import numerical_names


def column(
    studies: Sequence[xr.Dataset], title: str, quantity: str, *names: str
) -> tuple[Figure, list[tuple[Axes, list[Values]]]]:
    """Return a single-column figure with a panel for each value of the named parameters, and its solved cases."""
    solved = [case for case in curves.cases(studies) if curves.numerical_method(case)]
    title, series = style.limit_panels(title, curves.groups(solved, *names), "series")
    figure, panels = style.column(title, [style.describe(cases[0], *names) for cases in series])
    for axes in panels:
        axes.set_ylabel(style.LABELS[quantity])
    panels[-1].set_xlabel(style.LABELS["mean_pressure"])
    own = [[Values(case.reset_coords().expand_dims("case"), quantity) for case in cases] for cases in series]
    return figure, list(zip(panels, own, strict=True))


def draw_sparse_points(axes: Axes, rows: Iterable[tuple[Values, float, style.Color]]) -> None:
    """Draw a few points of other numerical methods on each of many curves, given as (case, datum, colour).

    The datum is added to the values. The legend has each method once, in black.
    """
    drawn: dict[str, dict[str, Any]] = {}
    for own, datum, color in rows:
        for column, method in enumerate(own.methods):
            if method in numerical_names() and column != own.best[0] and own.known[0, column]:
                drawn[method] = look = style.points(method) | style.SPARSE_POINTS
                values, coloured = own.values[0, column] + datum, look | {"color": color, "label": None}
                line(axes, look["label"], own.loads, values, **coloured)
    for look in drawn.values():
        axes.plot([], [], **look | {"color": style.BLACK})
