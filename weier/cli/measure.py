"""What weier measures of itself, and how that is drawn: `weier tradeoff`, `convergence`, `extremes` and `draw`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

import weier
from weier.cli.job import job
from weier.cli.options import FILES, SCENE, output


@click.command(hidden=True)
@SCENE
@output("path")
@output("table")
def tradeoff(scene_file: Path, path: Path, table: Path) -> None:
    """Measure the errors and seconds of all methods and settings.

    The profiles are those of a scene. The data go to PATH, and the page to TABLE.
    """
    from weier.accuracy import tradeoff as trade  # scipy.optimize and mpmath, which few commands need
    from weier.data import dataset

    with job("tradeoff", scene_file.stem):
        loaded = weier.load_scene(scene_file)
        data = trade.measure(loaded)
        dataset.write(data, path, loaded.title, "measured", loaded.text)
        trade.write_table(data, loaded.title, table)


@click.command(hidden=True)
@SCENE
@output("path")
@click.option(
    "--terms", type=click.IntRange(1, 100), default=8, show_default=True, help="Waves to resolve, from 1 up to this."
)
def convergence(scene_file: Path, path: Path, terms: int) -> None:
    """Solve infinite series by the number of terms resolved.

    The cases are those of a scene. PATH will hold the best estimate of each, and bounds on it.
    """
    from weier.accuracy import convergence as study
    from weier.data import dataset

    with job("convergence", scene_file.stem):
        loaded = weier.load_scene(scene_file)
        profiles = [case.profile for case in loaded.cases.values()]
        data = study.measure_convergence(profiles, loaded.loads, terms)
        dataset.write(data, path, loaded.title, "solved", loaded.text)


@click.command(hidden=True)
@output("path")
@output("summary")
def extremes(path: Path, summary: Path) -> None:
    """Examine every method where digits are lost.

    The data go to PATH, and a page of the worst to SUMMARY.
    """
    from weier.accuracy import extremes as report  # as in tradeoff
    from weier.data import dataset

    title = "Stability at the extremes"
    with job("extremes"):
        data = report.measure()
        dataset.write(data, path, title, "examined")
        report.write_summary(data, title, summary)


@click.command(hidden=True)
@click.argument("kind")
@output("path")
@FILES
def draw(kind: str, path: Path, files: Sequence[Path]) -> None:
    """Draw a kind of figure from files.

    It is written as PDF, SVG and PNG beside PATH.
    """
    from weier.data import dataset
    from weier.figures import draw as draw_files  # matplotlib, as in weier.cli.profile

    with job("draw", kind):
        draw_files(kind, [dataset.read(file) for file in files], "", path)
