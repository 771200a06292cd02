"""The figures: one module a kind, each with `draw(studies, title)`, in the one style of `style`."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import matplotlib.style
import xarray as xr
from matplotlib.figure import Figure

from weier.data.files import replacing
from weier.figures import style

KINDS = (
    "borodich_galanov",
    "compliance",
    "contact_tree",
    "phases",
    "profiles",
    "resistance",
    "truncated_compliance",
    "truncated_resistance",
)

# Of other files than those of a scene: the command that writes such a file, and what it alone has.
MEASURES = {
    "convergence": ("convergence", "resolved_terms"),
    "extremes": ("extremes", "compliance_digits"),
    "work_precision": ("tradeoff", "seconds"),
}

# No dates: the same data make the same bytes.
METADATA: dict[str, dict[str, Any]] = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": {}}


def draw(kind: str, studies: Sequence[xr.Dataset], title: str, path: str | Path) -> None:
    """Draw one figure, as PDF, SVG and PNG beside each other.

    Parameters
    ----------
    kind : str
        A module of weier.figures, one of KINDS or MEASURES.
    studies : sequence of Dataset
        What it shows, over case, method, mean_pressure and term.
    title : str
        One line over the figure; empty for none.
    path : path
        Where to write: its suffix gives way to .pdf, .svg and .png.

    Raises
    ------
    ValueError
        If there is no such kind, the studies are of another, or there is nothing in them that it could show.

    """
    if kind not in (*KINDS, *MEASURES):
        raise ValueError(f"there is no figure {kind!r}: choose from {', '.join((*KINDS, *MEASURES))}")
    if kind in MEASURES:
        command, own = MEASURES[kind]
        if [own in study for study in studies] != [True]:
            raise ValueError(f"the figure {kind} is drawn from one file, that of `weier {command}`")
    # The reset keeps the matplotlibrc of whoever draws out of the figure.
    with matplotlib.style.context(style.RC, after_reset=True):
        save(import_module(f"weier.figures.{kind}").draw(studies, title), path)


def save(figure: Figure, path: str | Path) -> None:
    """Save a figure in the style that is set, as PDF, SVG and PNG beside each other."""
    path = Path(path)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out once: saving would do it again for each format
    for suffix, metadata in METADATA.items():
        with replacing(path.with_suffix(f".{suffix}")) as beside:
            figure.savefig(beside, format=suffix, metadata=metadata)
