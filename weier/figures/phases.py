"""Fig. 2: the effect of the phase between the waves. All curves meet at full contact, where h = sum g_n."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure

from weier.data import curves
from weier.figures import style
from weier.figures.tables import Values, common_loads, extent, panels_of_series
from weier.figures.values import line
from weier.methods.curve import COMPLIANCE
from weier.surface.profile import PARAMETERS


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw compliance over mean pressure for each phase, one panel a series, with the average as a solid line."""
    figure, panels = panels_of_series(studies, title, COMPLIANCE, *PARAMETERS)
    for axes, cases in panels:
        _draw_phases(axes, cases)
    colors = ScalarMappable(Normalize(0, np.pi), ListedColormap(style.shade(np.linspace(0, 1, 256))))
    bar = figure.colorbar(colors, ax=figure.axes, label=r"phase $|\phi|$", aspect=30)
    bar.set_ticks([0, np.pi / 2, np.pi], labels=["0", r"$\pi/2$", r"$\pi$"])
    return figure


def _draw_phases(axes: Axes, cases: Sequence[Values]) -> None:
    common_loads(cases)
    drawn = [own.line(0, own.best[0]) for own in cases]
    fine, h = drawn[0][0], np.array([values for _, values in drawn])
    average = f"average of {len(cases)} phase{'s' * (len(cases) > 1)}"
    look: dict[str, Any] = {"linewidth": 0.7, "linestyle": style.DASHES[1]}
    for own, row in zip(cases, h, strict=True):
        angle = curves.phase_angle(own.study.isel(case=0))
        (color,) = style.shade([angle / np.pi])
        line(axes, f"phase {angle:.3g}", fine, row, color=color, label=None, **look)
    line(axes, average, fine, h.mean(axis=0), color=style.BLACK, linewidth=1.6, zorder=3)
    axes.plot([], [], color=style.GREY, label="one phase", **look)
    axes.set_xlim(0, extent(cases)[1])  # full contact
    axes.set_ylim(bottom=0)
    axes.legend(loc="lower right")
