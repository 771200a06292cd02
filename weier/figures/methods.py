"""All methods beside each other on one quantity: what Figs 3 to 6 share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import style
from weier.methods.registry import numerical_names
from weier.pipeline import curves


def compare(
    studies: Sequence[xr.Dataset], title: str, quantity: str
) -> tuple[Figure, list[tuple[Axes, list[xr.Dataset]]]]:
    """The quantity by each method: a panel a case where there are few, else all cases in one.

    Returns
    -------
    figure : Figure
    panels : list of (Axes, cases)
        For limits and scales; the legend and labels are in place.

    Raises
    ------
    ValueError
        If no case has a curve.

    """
    cases = [case for case in curves.cases(studies) if np.isfinite(case[quantity]).any()]
    if not cases:
        raise ValueError(f"there are no curves of {quantity} to draw in these studies")
    few = len(cases) <= style.PANELS
    shown = [[case] for case in cases] if few else [cases]
    figure, axes = style.column(len(shown))
    for number, (panel, group) in enumerate(zip(axes, shown, strict=True)):
        (_one if few else _many)(panel, group, quantity)
        label = style.describe(group[0]) if few else f"{len(cases)} cases and their median"
        style.name_panel(panel, number, len(shown), label)
        panel.set_ylabel(style.LABELS[quantity])
    axes[-1].set_xlabel(style.LABELS["mean_pressure"])
    style.set_title(figure, title)
    return figure, list(zip(axes, shown, strict=True))


def _one(axes: Axes, cases: Sequence[xr.Dataset], quantity: str) -> None:
    (case,) = cases
    reference = curves.numerical_method(case)
    for method, row in _rows(case, quantity).items():
        look = style.line(method)
        if method in numerical_names():
            look |= {} if method == reference else style.POINTS
            look["zorder"] = 1.9  # below the estimates, which are thinner than it or have gaps
        axes.plot(case["mean_pressure"].values, row, **look)


def _many(axes: Axes, cases: Sequence[xr.Dataset], quantity: str) -> None:
    rows = [_rows(case, quantity) for case in cases]
    for method in dict.fromkeys(method for row in rows for method in row):
        loads, values = cases[0]["mean_pressure"].values, np.array([row[method] for row in rows if method in row])
        look = style.line(method)
        axes.plot(loads, values.T, color=look["color"], linewidth=0.3, alpha=style.FAINT)
        axes.plot(loads, np.median(values, axis=0), **look, zorder=3)


def _rows(case: xr.Dataset, quantity: str) -> dict[str, np.ndarray]:
    """The curves there are, in the order of the estimates, then other methods, then the numerical ones on top."""
    others = [m for m in case["solution_method"].values.tolist() if m not in (*curves.ESTIMATES, *numerical_names())]
    found = {m: curves.curve(case, quantity, m) for m in (*curves.ESTIMATES, *others, *numerical_names())}
    return {method: row for method, row in found.items() if row is not None}
