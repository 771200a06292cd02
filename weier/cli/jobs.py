"""Commands for the rules of the pipeline."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import click

import weier
from weier.cli.options import FILE, output
from weier.pipeline.curves import PART, Batch, Store, title_of
from weier.scene import Figure

if TYPE_CHECKING:
    import xarray as xr

SCENE = click.argument("scene_file", type=FILE)


@contextmanager
def job(*words: str) -> Iterator[None]:
    """Print one line after a job: its command, its subject, and the seconds that it took."""
    start = perf_counter()
    yield
    click.echo(f"{' '.join(words)}: {perf_counter() - start:.1f} s", err=True)


@contextmanager
def ending_at_once() -> Iterator[None]:
    """Let Ctrl-C end the process at once: Python would handle it after LLVM has compiled a kernel, up to 20 s later.

    No cleanup is needed, since files of the cache are written atomically.
    """
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:  # The signal is ignored in the background of a script.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@click.command()
@click.argument("methods", nargs=-1)
def compile(methods: Sequence[str]) -> None:
    """Compile the kernels of METHODS, or all, once for all later runs."""
    from weier.pipeline.compile import compile_kernels  # only this command needs it

    with job("compile", *methods), ending_at_once():
        compile_kernels(methods)


@click.command(hidden=True)
@click.argument("description", type=FILE)
@output("data")
def batch(description: Path, data: Path) -> None:
    """Solve the batch that the Snakefile has described in the file DESCRIPTION, after the others of its job.

    The curves go to DATA, with the seconds that they took, and those of the others to files next to it, unless they
    are already there. Ctrl-C, or SIGTERM of a cluster, leaves those that are solved in a further file, from which the
    next run of the job continues.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    *others, last = Store(description.parent).job(description.stem)
    with job("solve", title_of([*others, last])):
        for other in others:
            if not (path := data.with_name(f"{other.name}.nc")).exists():
                _solve(other, path)
        _solve(last, data)


def _solve(wanted: Batch, data: Path) -> None:
    """Solve a batch, or continue with it."""
    from weier.api.batch import solve_batch
    from weier.data import dataset, netcdf

    part, known = data.with_suffix(PART), None
    if part.exists():
        netcdf.check_sealed(part, wanted.name)
        known = dataset.read(part)

    def keep(curves: xr.Dataset) -> None:
        dataset.write(curves, part, wanted.title, "solved", name=wanted.name)
        click.echo(f"solve {wanted.title}: stopped after {curves.sizes['case']} cases, which {part} keeps", err=True)

    curves = solve_batch(
        wanted.cases,
        wanted.kind.loads,
        wanted.kind.contact_edges,
        done=lambda far: click.echo(f"solve {wanted.title}: {far}", err=True),
        loads_of=wanted.kind.loads_of,
        known=known,
        keep=keep,
    )
    dataset.write(curves.assign_attrs(wanted.kind.numerics), data, wanted.title, "solved", name=wanted.name)
    part.unlink(missing_ok=True)


@click.command(hidden=True)
@SCENE
@click.argument("batches", type=FILE)
@click.argument("files", nargs=-1, type=FILE, required=True)
def products(scene_file: Path, batches: Path, files: Sequence[Path]) -> None:
    """Make the products of a scene with these FILES: those that are missing or outdated, or all if none is.

    The files are contact.nc and claims.md, page.html, the explorer, and those of figures. The curves come from the
    folder BATCHES. A figure that cannot be drawn is removed and named at the end; the others are drawn.
    """
    from weier.figures.products import make_products
    from weier.pipeline.batches import Solutions
    from weier.pipeline.products import products_with

    solutions = Solutions(weier.load_scene(scene_file), batches)
    folder, names = products_with(solutions.scene, files)

    def report(name: str) -> None:
        click.echo(f"make {scene_file.stem}: {name}", err=True)

    with job("products", scene_file.stem, *names):
        for line in make_products(solutions, folder, names, report):
            click.echo(f"weier: {line}", err=True)


@click.command(hidden=True)
@click.argument("kind")
@output("path")
@click.argument("files", nargs=-1, type=FILE)
def draw(kind: str, path: Path, files: Sequence[Path]) -> None:
    """Draw a kind of figure from files.

    It is written as PDF, SVG and PNG next to PATH.
    """
    from weier.data import dataset
    from weier.figures import draw as draw_files  # matplotlib, as in `weier plot`

    with job("draw", kind):
        draw_files(Figure(kind), [dataset.read(file) for file in files], path)
