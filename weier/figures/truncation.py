"""Series cut off after m terms, and what the terms left out could change: what Figs 7 and 8 share."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import style
from weier.pipeline import curves

Datum = Callable[[np.ndarray, float], np.ndarray]  # to a common datum, of a series of this total amplitude


def compare(
    studies: Sequence[xr.Dataset], title: str, quantity: str, datum: Datum
) -> tuple[Figure, list[tuple[Axes, list[xr.Dataset]]]]:
    """The numerical curves of all m with the bounds from the longest series, one panel a pair of D and gamma.

    Returns
    -------
    figure : Figure
    panels : list of (Axes, cases)
        For limits, labels and the legend; the cases have m ascending.

    Raises
    ------
    ValueError
        If no case has a numerical solution.

    """
    solved = [case for case in curves.cases(studies) if curves.numerical_method(case)]
    title, series = style.shown(title, curves.groups(solved, "D", "gamma"), "series")
    figure, axes = style.column(len(series))
    ordered = [sorted(cases, key=lambda case: float(case["m"])) for cases in series]
    for number, (panel, cases) in enumerate(zip(axes, ordered, strict=True)):
        draw_curves(panel, cases, quantity, datum)
        style.name_panel(panel, number, len(series), style.describe(cases[-1], "D", "gamma"))
    axes[-1].set_xlabel(style.LABELS["mean_pressure"])
    style.set_title(figure, title)
    return figure, list(zip(axes, ordered, strict=True))


def draw_curves(axes: Axes, cases: Sequence[xr.Dataset], quantity: str, datum: Datum) -> None:
    """The curves of one panel, m ascending, the bounds below them."""
    _bounds(axes, cases[-1], quantity, datum)
    by_terms = curves.groups(cases, "m")
    looks = style.family(len(by_terms))
    for look, same in zip(looks, by_terms, strict=True):
        many = {"linewidth": 0.4, "alpha": style.FAINT} if len(same) > 1 else {}
        for number, case in enumerate(same):
            label = style.describe(case, "m") if number == 0 else None
            values = datum(numerical(case, quantity), float(case["total_amplitude"]))
            axes.plot(case["mean_pressure"].values, values, label=label, **look | many)
    alone = [(same[0], look["color"]) for look, same in zip(looks, by_terms, strict=True) if len(same) == 1]
    checks = [(_check(case, quantity, datum), color) for case, color in alone]
    style.draw_points(axes, cases[0]["mean_pressure"].values, checks)


def _check(case: xr.Dataset, quantity: str, datum: Datum) -> np.ndarray | None:
    """The other numerical method of a case, if there is one."""
    values = curves.second(case, quantity)
    return None if values is None else datum(values, float(case["total_amplitude"]))


def numerical(case: xr.Dataset, quantity: str) -> np.ndarray:
    """The numerical curve of a case; all NaN if it has none, which draws nothing."""
    values = curves.numerical(case, quantity)
    return np.full(case.sizes["mean_pressure"], np.nan) if values is None else values


def _bounds(axes: Axes, longest: xr.Dataset, quantity: str, datum: Datum) -> None:
    method = curves.numerical_method(longest)
    low, high = (curves.curve(longest, f"{quantity}_{side}", method) for side in ("lower", "upper"))
    if low is not None and high is not None:
        label = f"bounds from {style.describe(longest, 'm')}"
        loads = longest["mean_pressure"].values
        endless = float(longest["total_amplitude"] + longest["tail_amplitude"])
        axes.fill_between(loads, datum(low, endless), datum(high, endless), label=label, **style.BOUND)
