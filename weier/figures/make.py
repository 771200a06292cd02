"""A product of a scene: its dataset with the claims, its explorer, or a figure."""

from __future__ import annotations

from pathlib import Path

from weier import figures
from weier.pipeline import claims
from weier.pipeline.needed_curves import Curves
from weier.pipeline.products import CLAIMS, DATA, PAGE, files_of, made_of, sum_of


def make_product(curves: Curves, name: str, folder: Path) -> None:
    """Make a product and its stamp in a folder.

    ValueError is raised if a curve is not solved, if a figure cannot be drawn, or if the code changes meanwhile.
    """
    made = made_of(curves, name)
    folder = folder / name / made
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
    if made != made_of(curves, name):
        raise ValueError("weier has changed meanwhile: run snakemake again")
    own = sum_of(folder / Path(file).name for file in files_of(name))
    folder.rename(folder.with_name(f"{made}.{own}"))
