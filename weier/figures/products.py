"""The products of a scene: its dataset with the claims, its figures, and its explorer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

from weier import figures
from weier.pipeline import claims
from weier.pipeline.batches import Solutions
from weier.pipeline.gather import read_study
from weier.pipeline.products import CLAIMS, DATA, PAGE, files_of, inputs_of, is_fresh, mark
from weier.scene import Figure

if TYPE_CHECKING:
    import xarray as xr


def make_products(
    solutions: Solutions, folder: Path, names: Sequence[str], report: Callable[[str], None]
) -> list[str]:
    """Make those products of a scene that are missing or outdated, or all of them if none is.

    Parameters
    ----------
    solutions : Solutions
        The scene with its solved curves.
    folder : path
        The folder of the products.
    names : sequence of str
        Some of `names_of(scene)`.
    report : callable
        Called with the name of each product that is begun.

    Returns
    -------
    list of str
        The reason why a figure, or the explorer, cannot be drawn. Its files are removed, and all others are made.
    """
    inputs = {name: inputs_of(solutions, name) for name in names}
    outdated = [name for name in names if not is_fresh(folder, name, inputs[name])]
    study = cache(partial(read_study, solutions))  # of several figures, it is read once
    failed = []
    for name in outdated or names:
        report(name)
        if name == DATA:
            claims.write(solutions, folder / DATA, folder / CLAIMS)
            continue
        try:
            if name == PAGE:
                _write_explorer(solutions, folder / PAGE, mark(inputs[name]))
            else:
                _draw(solutions.scene.figure(name), study, folder / "figures" / f"{name}.png", mark(inputs[name]))
        except ValueError as error:
            failed.append(f"{name} cannot be drawn: {error}")
            for file in files_of(name):
                (folder / file).unlink(missing_ok=True)
    return failed


def _write_explorer(solutions: Solutions, path: Path, mark: str) -> None:
    from weier.figures import page  # bokeh takes half a second, and is in an extra

    page.write(solutions, path, mark)


def _draw(figure: Figure, study: Callable[..., xr.Dataset], path: Path, mark: str) -> None:
    studies = [study(name, figures.undrawn(figure.draw)) for name in figure.all_studies]
    figures.draw(figure, studies, path, (*figures.METADATA, figures.VALUES), mark)
