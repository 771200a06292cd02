"""A product of a scene: its dataset with the claims, its explorer, or a figure."""

from __future__ import annotations

from pathlib import Path

from weier import figures
from weier.pipeline import claims
from weier.pipeline.needed_curves import Curves
from weier.pipeline.products import CLAIMS, DATA, PAGE, made_of


def make_product(curves: Curves, name: str, folder: Path) -> None:
    """Make a product in a new folder, which is named by the digest of what it is made of.

    ValueError is raised if a curve is not solved, if a figure cannot be drawn, or if the code changes meanwhile.
    """
    folder.mkdir(parents=True)
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
        figures.draw(figure, studies, folder / name, (*figures.WRITTEN, figures.VALUES))
    if not folder.name.startswith(made_of(curves, name)):
        raise ValueError("weier has changed meanwhile: run snakemake again")
