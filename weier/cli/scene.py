"""What the pipeline does with a scene, a command a rule: `weier compile`, `batch`, `figure`, `claims` and `page`."""

from __future__ import annotations

import socket
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from weier.cli.job import job
from weier.cli.options import FILE, FILES, SCENE, output
from weier.kernels import jit

if TYPE_CHECKING:
    from weier.scene import Scene

# From a folder, since the names of some thousands of files fit no command.
BATCHES = click.argument("batches", type=FILE)


@click.command()
def compile() -> None:
    """Compile all kernels, once for all later runs."""
    from weier.pipeline.compile import compile_kernels  # only this command needs it

    with job("compile"):
        compile_kernels()


@click.command()
@SCENE
@click.argument("name")
@output("data")
@output("cost")
@click.option("--threads", type=click.IntRange(1), default=1, show_default=True, help="Cases at a time.")
def batch(scene_file: Path, name: str, data: Path, cost: Path, threads: int) -> None:
    """Solve the batch NAME of a scene.

    The curves go to DATA, and the seconds that they took to COST.
    """
    from weier.data import dataset
    from weier.pipeline.batch import solve_batch
    from weier.pipeline.compile import compile_for

    with job("solve", scene_file.stem, name):
        loaded = _load(scene_file)
        cases = list(loaded.batch(name))
        compile_for(cases)
        curves, seconds = solve_batch(loaded, cases, threads)
        dataset.write(seconds, cost, f"{loaded.title}: seconds", "solved", loaded.text)
        dataset.write(curves, data, loaded.title, "solved", loaded.text)


@click.command()
@SCENE
@click.argument("name")
@output("path")
@BATCHES
def figure(scene_file: Path, name: str, path: Path, batches: Path) -> None:
    """Draw one figure of a scene from the folder BATCHES.

    It is written as PDF, SVG and PNG beside PATH.
    """
    from weier.figures import draw
    from weier.pipeline import gather

    with job("figure", scene_file.stem, name):
        loaded = _load(scene_file)
        wanted = loaded.figure(name)
        studies = [gather.read_study(loaded, study, batches) for study in wanted.studies]
        draw(wanted.draw, studies, wanted.title, path, wanted.grouping, wanted.x, wanted.y, wanted.size)


@click.command()
@SCENE
@output("path")
@output("table")
@BATCHES
def claims(scene_file: Path, path: Path, table: Path, batches: Path) -> None:
    """Check the claims of a scene, and write its whole dataset.

    The curves come from the folder BATCHES. The dataset goes to PATH, and the claims to TABLE.
    """
    from weier.pipeline import claims as claim

    with job("claims", scene_file.stem):
        claim.write(_load(scene_file), batches, path, table)


@click.command()
@SCENE
@output("path")
@click.argument("contact", type=FILE)
@FILES
def page(scene_file: Path, path: Path, contact: Path, files: Sequence[Path]) -> None:
    """Write the page of a scene.

    The page is made from the scene's dataset CONTACT, its figures (.png) and its costs (.nc).
    """
    from weier.figures import page as pages  # bokeh takes a second, and only this command needs it

    figures = [file for file in files if file.suffix == ".png"]
    costs = [file for file in files if file.suffix == ".nc"]
    with job("page", scene_file.stem):
        pages.write(_load(scene_file), contact, figures, costs, path)


@click.command()
@click.argument("descriptor", type=int)
def serve(descriptor: int) -> None:
    """Do the work of the jobs of a run, until standard input ends.

    DESCRIPTOR is the number of an open socket. The Snakefile starts this.
    """
    from weier.cli import main
    from weier.pipeline import server

    jit.LISTENERS.clear()  # each job has its own
    server.serve(socket.socket(fileno=descriptor), main)


def _load(scene_file: Path) -> Scene:
    """A scene, all of it checked."""
    from weier.figures import checks

    return checks.load(scene_file)
