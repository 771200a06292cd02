"""Series truncated after m terms, with the bounds on the effect of their tails, for Figs 7 and 8."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import style
from weier.figures.tables import Values, extent, panels_of_series
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
    figure, panels = panels_of_series(studies, title, quantity, *(name for name in PARAMETERS if name != "m"))
    for axes, own in panels:
        cases = sorted(own, key=lambda case: case.study["m"].item())
        _draw_bounds(axes, cases[-1], quantity)
        _draw_curves(axes, cases, quantity)
        if quantity == COMPLIANCE:
            axes.set(ylabel=LABEL, xlim=(0, extent(cases)[1]))  # to full contact
            axes.set_ylim(bottom=0)
            axes.legend(loc="lower right")
        else:
            style.set_logarithmic_axes(axes, *extent(cases[-1:]))
            axes.legend(loc="lower left")
    return figure


def _draw_curves(axes: Axes, cases: Sequence[Values], quantity: str) -> None:
    """Draw the curves of one panel in order of m."""
    names = [style.describe(case.study.isel(case=0), "m") for case in cases]
    looks = dict(zip(shown := list(dict.fromkeys(names)), style.family(len(shown)), strict=True))
    for number, (name, case) in enumerate(zip(names, cases, strict=True)):
        loads, values = case.line(0, case.best[0])
        label = name if name not in names[:number] else None
        line(axes, name, loads, values + datum(case.study, quantity), label=label, **looks[name])


def datum(case: xr.Dataset, quantity: str) -> float:
    """Return the datum added to the values of all m: compliances count from the peaks of the infinite series."""
    return case["tail_amplitude"].item() if quantity == COMPLIANCE else 0.0


def _draw_bounds(axes: Axes, longest: Values, quantity: str) -> None:
    names = f"{quantity}_lower", f"{quantity}_upper"
    ends = [longest.study[name].values[0, longest.best[0]] for name in names if name in longest.study]
    if len(ends) == 2 and np.isfinite(ends).any():
        label = f"bounds from {style.describe(longest.study.isel(case=0), 'm')}"
        band(axes, label, longest.loads, *ends, **style.BOUND_STYLE)
