"""The command line: thin, over the same functions as the Python interface."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from weier import batch as batches
from weier import claims as claim
from weier import dataset, jit, scene, study
from weier.errors import ConvergenceError
from weier.profile import Profile
from weier.solve import METHODS, solve
from weier.version import VERSION

Command = Callable[..., Any]

SCENE = click.argument("scene_file", type=click.Path(path_type=Path))
FILES = click.argument("files", nargs=-1, type=click.Path(path_type=Path))


def output(name: str) -> Callable[[Command], Command]:
    """An argument that is a file to write."""
    return click.argument(name, type=click.Path(path_type=Path))


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(VERSION)
def cli() -> None:
    """Contact stiffness and contact resistance of the Weierstrass profile."""


@cli.command()
def compile() -> None:
    """Compile all kernels, once for all later runs."""
    if jit.disabled():
        return
    profile = Profile(D=1.25, gamma=2, m=2)
    for method in METHODS:
        if method != "westergaard":
            solve(profile, [0.1], method)
    solve(profile, [0.1], "bem", solver="direct")


@cli.command()
@SCENE
@click.argument("name")
@output("data")
@output("cost")
def batch(scene_file: Path, name: str, data: Path, cost: Path) -> None:
    """Solve one batch of a scene."""
    loaded = scene.load(scene_file)
    curves, seconds = batches.solve_batch(loaded, loaded.batch_named(name))
    dataset.write(seconds, cost, f"{loaded.title}: seconds")
    dataset.write(curves, data, loaded.title)


@cli.command()
@SCENE
@click.argument("name")
@output("path")
@FILES
def gather(scene_file: Path, name: str, path: Path, files: Sequence[Path]) -> None:
    """Put the cases of one study into one file."""
    loaded = scene.load(scene_file)
    keys = [case.key for case in loaded.studies[name]]
    gathered = study.gather([dataset.read(file) for file in files], keys)
    dataset.write(gathered, path, f"{loaded.title}: {name}")


@cli.command()
@output("gathered")
@output("path")
def bounds(gathered: Path, path: Path) -> None:
    """Add the bounds on the endless series to a gathered file."""
    data = dataset.read(gathered)
    dataset.write(study.add_bounds(data), path, data.attrs["title"])


@cli.command()
@SCENE
@click.argument("name")
@output("path")
@FILES
def figure(scene_file: Path, name: str, path: Path, files: Sequence[Path]) -> None:
    """Draw one figure of a scene from its studies, as PDF, SVG and PNG beside PATH."""
    from weier.figures import draw  # matplotlib takes half a second, and only this command needs it

    loaded = scene.load(scene_file)
    wanted = loaded.figures[name]
    draw(wanted.draw, [dataset.read(file) for file in files], wanted.title, path)


@cli.command()
@SCENE
@output("path")
@output("table")
@FILES
def claims(scene_file: Path, path: Path, table: Path, files: Sequence[Path]) -> None:
    """Check the claims of a scene, and write its whole dataset."""
    loaded = scene.load(scene_file)
    studies = dict(zip(loaded.studies, map(dataset.read, files), strict=True))
    claim.write(loaded, studies, path, table)


def main() -> None:
    """Run the command line; bad input and failed solves end in one sentence and exit code 1."""
    try:
        cli()
    except (ValueError, ConvergenceError, OSError) as error:
        print(f"weier: {error}", file=sys.stderr)
        sys.exit(1)


if __name__ == "__main__":
    main()
