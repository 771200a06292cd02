"""Fig. 9: bounds on the stiffness of the self-similar punch of Borodich and Galanov, Appendix B; without data."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from weier.figures import style
from weier.figures.values import line
from weier.theory.self_similar_punch import stiffness_bounds


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw both bounds on kappa = k/k_H over the roughness epsilon (B.16)."""
    figure, (axes,) = style.column(title, [""])
    epsilon = np.linspace(0, 1, 400, endpoint=False) ** 2  # The bounds leave the smooth punch as sqrt(epsilon).
    lower, upper = stiffness_bounds(epsilon)
    line(axes, "upper bound", epsilon, upper, color=style.VERMILLION, linestyle=style.DASHES[0])
    line(axes, "lower bound", epsilon, lower, color=style.BLUE, linestyle=style.DASHES[1])
    axes.axhline(1, color=style.BLACK, linewidth=0.5)
    axes.annotate("smooth punch", (0.98, 1), (0, 4), textcoords="offset points", ha="right", fontsize=8)
    axes.set(xlim=(0, 1), ylim=(0, 4))  # The upper bound tends to infinity as epsilon -> 1.
    axes.set_xlabel(r"roughness $\epsilon$")
    axes.set_ylabel(r"stiffness and conductance $\kappa = k/k_H$")
    axes.legend(loc="upper left")
    return figure
