"""A product of a scene: its dataset with the claims, its explorer, or a figure."""

from __future__ import annotations

from pathlib import Path

from weier import figures
from weier.data.files import remove_leftovers
from weier.pipeline import claims
from weier.pipeline.curves import Curves
from weier.pipeline.products import CLAIMS, DATA, PAGE, fill_stamp, made_of


def make_product(curves: Curves, stamp: Path) -> None:
    """Make the product that a stamp is of, next to the stamp, and fill the stamp.

    Raises
    ------
    ValueError
        If the scene or the code has changed since the stamp was named, if a curve is not solved, or if a figure
        cannot be drawn. The stamp is removed, so that the next run begins anew.
    """
    folder, name = stamp.parents[2], stamp.parent.name
    try:
        if not stamp.name.startswith(made_of(curves, name)):
            raise ValueError(f"{curves.scene.name} or weier has changed since the plan: run snakemake again")
        _make(curves, folder, name)
    except ValueError as error:
        stamp.unlink(missing_ok=True)
        raise ValueError(f"{name} cannot be made: {error}") from error
    fill_stamp(stamp)
    remove_leftovers(folder)


def _make(curves: Curves, folder: Path, name: str) -> None:
    if name == DATA:
        claims.write(curves, folder / DATA, folder / CLAIMS)
    elif name == PAGE:
        from weier.figures import page  # bokeh takes half a second, and is in an extra

        page.write(curves, folder / PAGE)
    else:
        from weier.pipeline.gather import read_study  # xarray, which claims import late, too

        figure = curves.scene.figure(name)
        unread = figures.undrawn(figure.draw)
        studies = [read_study(curves, study, unread) for study in figure.all_studies]
        figures.draw(figure, studies, folder / "figures" / name, (*figures.METADATA, figures.VALUES))
