"""What the pipeline does with a scene, a command a rule: `weier compile`, `batch`, `gather` ... `page`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from weier import scene
from weier.cli.options import FILE, FILES, SCENE, output
from weier.data import dataset
from weier.figures import check_kinds, draw
from weier.pipeline import batch as batches
from weier.pipeline import claims as claim
from weier.pipeline import gather as study


@click.command()
def compile() -> None:
    """Compile all kernels, once for all later runs."""
    from weier.pipeline.compile import compile_kernels  # only this command needs it

    compile_kernels()


@click.command()
@SCENE
@click.argument("name")
@output("data")
@output("cost")
@click.option("--threads", type=click.IntRange(1), default=1, show_default=True, help="Cases at a time.")
def batch(scene_file: Path, name: str, data: Path, cost: Path, threads: int) -> None:
    """Solve one batch of a scene."""
    loaded = _load(scene_file)
    curves, seconds = batches.solve_batch(loaded, loaded.batch_named(name), threads)
    dataset.write(seconds, cost, f"{loaded.title}: seconds", "solved", loaded.text)
    dataset.write(curves, data, loaded.title, "solved", loaded.text)


@click.command()
@SCENE
@click.argument("name")
@output("path")
@click.argument("folder", type=FILE)
def gather(scene_file: Path, name: str, path: Path, folder: Path) -> None:
    """Put the cases of a study into one file, from batches in FOLDER."""
    loaded = _load(scene_file)
    keys = [case.key for case in loaded.study_named(name)]
    files = [folder / f"{batch}.nc" for batch in loaded.batches_of(name)]
    study.gather(files, keys, path, f"{loaded.title}: {name}", scene=loaded.text)


@click.command()
@click.argument("gathered", type=FILE)
@output("path")
def bounds(gathered: Path, path: Path) -> None:
    """Add the bounds on the endless series to a gathered file."""
    with dataset.reading(gathered) as data:
        if "compliance" not in data:
            raise ValueError(f"{gathered} has no curves: take a file of `weier gather`")
        about = data.attrs
    study.gather(
        [gathered], study.keys_of([gathered]), path, about.get("title", ""),
        step="bounded", scene=about.get("scene", ""), change=study.add_bounds,
    )  # fmt: skip


@click.command()
@SCENE
@click.argument("name")
@output("path")
@FILES
def figure(scene_file: Path, name: str, path: Path, files: Sequence[Path]) -> None:
    """Draw one figure of a scene from its studies.

    As PDF, SVG and PNG beside PATH.
    """
    loaded = _load(scene_file)
    wanted = loaded.figure_named(name)
    draw(wanted.draw, [dataset.read(file) for file in files], wanted.title, path)


@click.command()
@SCENE
@output("path")
@output("table")
@FILES
def claims(scene_file: Path, path: Path, table: Path, files: Sequence[Path]) -> None:
    """Check the claims of a scene, and write its whole dataset."""
    loaded = _load(scene_file)
    if len(files) != len(loaded.studies):
        raise click.UsageError(f"there must be a file for each of {len(loaded.studies)} studies, got {len(files)}")
    claim.write(loaded, dict(zip(loaded.studies, files, strict=True)), path, table)


@click.command()
@SCENE
@output("path")
@click.argument("contact", type=FILE)
@FILES
def page(scene_file: Path, path: Path, contact: Path, files: Sequence[Path]) -> None:
    """Write the page of a scene.

    From its dataset CONTACT, its figures (.png) and its costs (.nc).
    """
    from weier.figures import page as pages  # bokeh takes a second, and only this command needs it

    figures = [file for file in files if file.suffix == ".png"]
    costs = [file for file in files if file.suffix == ".nc"]
    pages.write(_load(scene_file), contact, figures, costs, path)


def _load(scene_file: Path) -> scene.Scene:
    """A scene whose figures can be drawn and whose claims exist."""
    loaded = scene.load(scene_file)
    check_kinds(loaded)
    claim.check_names(loaded)
    return loaded


COMMANDS = (compile, batch, gather, bounds, figure, claims, page)
