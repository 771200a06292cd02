"""Fig. 2: the effect of the phase between the waves. All curves meet at full contact, where h = sum g_n."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure

from weier.data import curves
from weier.figures import interpolation, style
from weier.figures.values import line
from weier.surface.profile import PARAMETERS


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw compliance over mean pressure for each phase, one panel a series, with the average as a solid line."""
    figure, panels = style.column_of_series(studies, title, "compliance", *PARAMETERS)
    for axes, cases in panels:
        _draw_phases(axes, cases)
    colors = ScalarMappable(Normalize(0, np.pi), ListedColormap(style.shade(np.linspace(0, 1, 256))))
    bar = figure.colorbar(colors, ax=figure.axes, label=r"phase $|\phi|$", aspect=30)
    bar.set_ticks([0, np.pi / 2, np.pi], labels=["0", r"$\pi/2$", r"$\pi$"])
    return figure


def _draw_phases(axes: Axes, cases: Sequence[xr.Dataset]) -> None:
    drawn = [
        curve for case in cases if (curve := interpolation.line(case, "compliance", curves.numerical_method(case)))
    ]
    fine, h = drawn[0][0], np.array([values for _, values in drawn])
    average = f"average of {len(cases)} phase{'s' * (len(cases) > 1)}"
    colors = style.shade(curves.phase_angle(case) / np.pi for case in cases)
    for case, row, color in zip(cases, h, colors, strict=True):
        look = {"color": color, "linewidth": 0.7, "linestyle": style.DASHES[1], "label": None}
        line(axes, f"phase {curves.phase_angle(case):.3g}", fine, row, **look)
    line(axes, average, fine, h.mean(axis=0), color=style.BLACK, linewidth=1.6, zorder=3)
    axes.plot([], [], color=style.GREY, linewidth=0.7, linestyle=style.DASHES[1], label="one phase")
    interpolation.draw_sparse_points(axes, "compliance", zip(cases, [0.0] * len(cases), colors, strict=True))
    axes.set_xlim(0, curves.full_contact_load(cases))
    axes.set_ylim(bottom=0)
    axes.legend(loc="lower right")
