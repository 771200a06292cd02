"""Fig. 1: the profiles, over two of their longest wavelengths."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from weier.data import curves
from weier.figures import style
from weier.figures.values import line

LENGTH = 2  # lambda_0, as in the paper
SAMPLES_PER_WAVE = 32  # samples per finest wave, for a smooth polygon
MAX_SAMPLES = 2**13  # four samples per printed dot


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw heights of each profile, in g_0, over x, in lambda_0, to one scale."""
    finite = [case for case in curves.cases(studies) if np.isfinite(case["m"])]
    title, cases = style.limit_panels(title, finite, "profiles")
    figure, panels = style.column(title, list(map(style.describe, cases)), 1.35, sharex=True, sharey=True)
    for axes, case in zip(panels, cases, strict=True):
        profile = curves.profile(case)
        count = SAMPLES_PER_WAVE * LENGTH * float(profile.gamma) ** (profile.terms - 1)
        x = np.linspace(0, LENGTH, int(min(count, MAX_SAMPLES)) + 1)
        line(axes, "profile", x, profile.height(x), color=style.BLACK, linewidth=0.7)
        axes.set_ylabel(style.LABELS["height"])
    panels[-1].set_xlabel(style.LABELS["x"])
    panels[-1].set_xlim(0, LENGTH)
    return figure
