"""Series truncated after m terms, with the bounds on the effect of their tails, for Figs 7 and 8."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.data import curves
from weier.figures import interpolation, style
from weier.figures.tables import Values, extent
from weier.figures.values import band, line
from weier.methods.curve import COMPLIANCE
from weier.surface.profile import PARAMETERS

# The datum belongs to the infinite series; in Fig. 3 it belongs to the m waves.
LABEL = "compliance $(h+G_m)/g_0$,\nfrom the infinite series"


def draw(studies: Sequence[xr.Dataset], title: str, quantity: str) -> Figure:
    """Draw the numerical curves of all m with the bounds from the longest series, one panel for each D and gamma.

    Notes
    -----
    (27) bounds the mean gap d, so that compliances of different m are compared as G - d with the same G, the
    amplitude of all terms, not at their own full contact nor at first contact.
    """
    figure, panels = style.column_of_series(studies, title, quantity, *(name for name in PARAMETERS if name != "m"))
    for axes, own in panels:
        cases = sorted(own, key=lambda case: float(case["m"]))
        draw_curves(axes, cases, quantity)
        if quantity == COMPLIANCE:
            axes.set(ylabel=LABEL, xlim=(0, curves.full_contact_load(cases)))
            axes.set_ylim(bottom=0)
            axes.legend(loc="lower right")
        else:
            longest = curves.as_study(cases[-1]).sel(solution_method=[curves.numerical_method(cases[-1])])
            style.set_logarithmic_axes(axes, *extent([Values(longest, quantity, None)]))
            axes.legend(loc="lower left")
    return figure


def draw_curves(axes: Axes, cases: Sequence[xr.Dataset], quantity: str) -> None:
    """Draw the curves of one panel in order of m, and the bounds below them."""
    _draw_bounds(axes, cases[-1], quantity)
    by_terms = curves.groups(cases, "m")
    looks = style.family(len(by_terms))
    for look, same in zip(looks, by_terms, strict=True):
        for case in same:
            drawn = interpolation.line(case, quantity, curves.numerical_method(case))
            if drawn is not None:
                name = style.describe(case, "m")
                label = name if case is same[0] else None
                line(axes, name, drawn[0], drawn[1] + datum(case, quantity), label=label, **look)
    rows = [
        (case, datum(case, quantity), look["color"])
        for look, same in zip(looks, by_terms, strict=True)
        for case in same
    ]
    interpolation.draw_sparse_points(axes, quantity, rows)


def datum(case: xr.Dataset, quantity: str) -> float:
    """Return the datum added to the values of all m: compliances count from the peaks of the infinite series."""
    return float(case["tail_amplitude"]) if quantity == "compliance" else 0.0


def _draw_bounds(axes: Axes, longest: xr.Dataset, quantity: str) -> None:
    method = curves.numerical_method(longest)
    low, high = (curves.curve(longest, f"{quantity}_{side}", method) for side in ("lower", "upper"))
    if low is not None and high is not None:
        label = f"bounds from {style.describe(longest, 'm')}"
        band(axes, label, longest["mean_pressure"].values, low, high, **style.BOUND_STYLE)
