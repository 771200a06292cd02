"""What the pipeline does with a scene, a command a rule: `weier compile`, `batch`, `figures`, `claims` and `page`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path

import click

import weier
from weier.cli.job import job
from weier.cli.options import FILE, SCENE, output

# From a folder, since the names of some thousands of files fit no command.
BATCHES = click.argument("batches", type=FILE)


@click.command()
@click.argument("methods", nargs=-1)
def compile(methods: Sequence[str]) -> None:
    """Compile the kernels of METHODS, or all, once for all later runs."""
    from weier.methods.compile import compile_kernels  # only this command needs it

    with job("compile", *methods, announce_compiling=not methods):
        compile_kernels(methods)


@click.command(hidden=True)
@click.argument("description", type=FILE)
@output("data")
def batch(description: Path, data: Path) -> None:
    """Solve the batch that the Snakefile has described in the file DESCRIPTION.

    The curves go to DATA, with the seconds that they took.
    """
    from weier.data import dataset
    from weier.pipeline.batch import solve_batch
    from weier.pipeline.batches import read_batch

    wanted = read_batch(description)
    with job("solve", wanted.title):
        curves = solve_batch(
            wanted.cases,
            wanted.common["loads"],
            wanted.common["contact_edges"],
            done=lambda far: click.echo(f"solve {wanted.title}: {far}", err=True),
        )
        dataset.write(curves, data, wanted.title, "solved")


@click.command(hidden=True)
@SCENE
@BATCHES
@click.argument("folder", type=FILE)
@click.argument("names", nargs=-1)
def figures(scene_file: Path, batches: Path, folder: Path, names: Sequence[str]) -> None:
    """Draw the figures NAMES of a scene, or all that it has.

    The curves come from the folder BATCHES. Each figure is written into FOLDER as PDF, SVG and PNG.
    """
    from weier.figures import draw
    from weier.pipeline.batches import Solutions
    from weier.pipeline.gather import read_study

    with job("figures", scene_file.stem, *names):
        loaded = weier.load_scene(scene_file)
        study = cache(partial(read_study, Solutions(loaded, batches)))
        for name in names or loaded.figures:
            one = loaded.figure(name)
            studies = [study(each) for each in one.studies]
            path = folder / f"{name}.png"
            draw(one.draw, studies, one.title, path, one.grouping, one.x, one.y, one.size, one.interface)


@click.command(hidden=True)
@SCENE
@BATCHES
@output("path")
@output("table")
def claims(scene_file: Path, batches: Path, path: Path, table: Path) -> None:
    """Check the claims of a scene, and write its whole dataset.

    The curves come from the folder BATCHES. The dataset goes to PATH, and the claims to TABLE.
    """
    from weier.pipeline import claims as claim
    from weier.pipeline.batches import Solutions

    with job("claims", scene_file.stem):
        claim.write(Solutions(weier.load_scene(scene_file), batches), path, table)


@click.command(hidden=True)
@SCENE
@BATCHES
@click.argument("contact", type=FILE)
@output("path")
@click.argument("drawn", metavar="FIGURES", type=FILE)
def page(scene_file: Path, batches: Path, contact: Path, path: Path, drawn: Path) -> None:
    """Write the page of a scene to PATH.

    It is made from the scene's dataset CONTACT, the folder FIGURES, and the seconds in the folder BATCHES.
    """
    from weier.figures import page as pages  # bokeh takes a second, and only this command needs it
    from weier.pipeline.batches import Solutions
    from weier.pipeline.gather import read_cost

    with job("page", scene_file.stem):
        loaded = weier.load_scene(scene_file)
        pictures = [drawn / f"{name}.png" for name in loaded.figures]
        pages.write(loaded, contact, pictures, read_cost(Solutions(loaded, batches)), path)
