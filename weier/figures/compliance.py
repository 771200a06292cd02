"""Figs 3 and 4: the estimates of compliance against the numerical curve. All curves meet at full contact."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from weier.figures.comparison import compare
from weier.pipeline import curves
from weier.scene import BY_DEFAULT, Grouping

CAPTION = (
    "Compliance over mean pressure. {methods} All curves of one profile meet at full contact, where h = sum g_n."
)


def draw(studies: Sequence[xr.Dataset], title: str, grouping: Grouping = BY_DEFAULT) -> Figure:
    """Compliance over mean pressure by every method, up to full contact."""
    figure, panels = compare(studies, title, "compliance", grouping)
    for axes, cases in panels:
        axes.set_xlim(0, curves.full_contact_load(cases))
        axes.set_ylim(bottom=0)
        if grouping == BY_DEFAULT:
            axes.legend(loc="lower right")
    return figure
