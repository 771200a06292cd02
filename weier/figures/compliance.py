"""Figs 3 and 4: the estimates of compliance against the numerical curve. All curves meet at full contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from weier.figures import style
from weier.figures.comparison import compare


def draw(studies: Sequence[xr.Dataset], title: str, **options: Any) -> Figure:
    """Draw compliance over mean pressure by every method, up to full contact, on an axis that shows light loads."""
    figure, panels, extent = compare(studies, title, "compliance", **options)
    style.set_load_axis(panels[0], extent.first_load, extent.full_contact)
    panels[0].set_ylim(bottom=0)
    return figure
