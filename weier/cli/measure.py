"""What weier measures of itself, and how that is drawn: `weier tradeoff`, `endless`, `extremes` and `draw`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from weier import scene
from weier.cli.options import FILES, SCENE, output
from weier.data import dataset


@click.command()
@SCENE
@output("path")
@output("table")
def tradeoff(scene_file: Path, path: Path, table: Path) -> None:
    """Measure the errors and seconds of all methods and settings.

    On the profiles of a scene.
    """
    from weier.accuracy import tradeoff as trade  # scipy.optimize, which only this command needs

    loaded = scene.load(scene_file)
    measured = trade.measure(loaded)
    dataset.write(measured, path, loaded.title, "measured", loaded.text)
    trade.write_table(measured, loaded.title, table)


@click.command()
@SCENE
@output("path")
@click.option(
    "--terms", type=click.IntRange(1, 100), default=8, show_default=True, help="Waves to resolve, from 1 up to this."
)
def endless(scene_file: Path, path: Path, terms: int) -> None:
    """Endless series by the number of terms resolved.

    Best estimates and bounds of the cases of a scene.
    """
    from weier.accuracy.convergence import convergence

    loaded = scene.load(scene_file)
    profiles = [case.profile for case in loaded.cases.values()]
    found = convergence(profiles, loaded.loads, terms)
    dataset.write(found, path, loaded.title, "solved", loaded.text)


@click.command()
@output("path")
@output("table")
def extremes(path: Path, table: Path) -> None:
    """Examine every method where digits are lost."""
    from weier.accuracy import extremes as extreme  # mpmath, which only this command needs

    title = "Stability at the extremes"
    found = extreme.measure()
    dataset.write(found, path, title, "examined")
    extreme.write_table(found, title, table)


@click.command()
@click.argument("kind")
@output("path")
@FILES
def draw(kind: str, path: Path, files: Sequence[Path]) -> None:
    """Draw a kind of figure from files.

    As PDF, SVG and PNG beside PATH.
    """
    from weier.figures import draw as draw_files  # matplotlib, as in weier.cli.profile

    draw_files(kind, [dataset.read(file) for file in files], "", path)


COMMANDS = (tradeoff, endless, extremes, draw)
