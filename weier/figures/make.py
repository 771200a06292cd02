"""A product of a scene: its dataset with the claims, its explorer, or a figure."""

from __future__ import annotations

from pathlib import Path

from weier import figures
from weier.pipeline import claims
from weier.pipeline.needed_curves import Curves
from weier.pipeline.products import CLAIMS, DATA, PAGE, made_of


def make_product(curves: Curves, name: str, folder: Path) -> None:
    """Make a product in a folder that is named by the digest of what the plan saw.

    ValueError is raised if the scene or the code has changed since, if a curve is not solved, or if a figure cannot
    be drawn.
    """
    try:
        if not folder.name.startswith(made_of(curves, name)):
            raise ValueError(f"{curves.scene.name} or weier has changed since the plan: run snakemake again")
        folder.mkdir(parents=True)
        _make(curves, folder, name)
    except ValueError as error:
        raise ValueError(f"{name} cannot be made: {error}") from error


def _make(curves: Curves, folder: Path, name: str) -> None:
    if name == DATA:
        claims.write(curves, folder / DATA, folder / CLAIMS)
    elif name == PAGE:
        from weier.figures import page  # bokeh takes half a second to import and is an extra

        page.write(curves, folder / PAGE)
    else:
        from weier.pipeline.gather import read_study  # imports xarray, which takes half a second

        figure = curves.scene.figure(name)
        unread = figures.undrawn(figure.draw)
        studies = [read_study(curves, study, unread) for study in figure.all_studies]
        figures.draw(figure, studies, folder / name, (*figures.METADATA, figures.VALUES))
