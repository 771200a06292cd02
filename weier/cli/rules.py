"""Commands for the rules of the pipeline."""

from __future__ import annotations

import shutil
import signal
import traceback
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import click

import weier
from weier.cli.options import FILE
from weier.data.provenance import origin
from weier.digests import numerics
from weier.pipeline.store import Store


@click.command()
@click.argument("methods", nargs=-1)
def compile(methods: Sequence[str]) -> None:
    """Compile the kernels of METHODS, or all, once for all later runs."""
    from weier.pipeline.compile import compile_kernels  # only this command needs it

    # LLVM calls Python, where KeyboardInterrupt may be ignored, and delays it for seconds. The cache has whole files.
    for sent in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(sent) is signal.default_int_handler:  # in the background of a script it is ignored
            signal.signal(sent, signal.SIG_DFL)
    compile_kernels(methods)


@click.command(hidden=True)
@click.argument("what")
@click.argument("share")
@click.argument("numerics")
@click.argument("folder", type=FILE)
@click.argument("scenes", type=FILE)
def curves(what: str, share: str, numerics: str, folder: Path, scenes: Path) -> None:
    """Solve a SHARE, such as 0-of-2, of the curves that the store in FOLDER lacks.

    WHAT names a product of scenes in the folder SCENES, and NUMERICS is the digest of the planning code. Curves in
    the store survive Ctrl-C, SIGTERM and a kill.
    """
    from weier.pipeline.jobs import solve
    from weier.pipeline.needed_curves import Curves
    from weier.pipeline.workflow import missing

    store = Store(folder, numerics)
    own = missing(what, lambda name: Curves(weier.load_scene(scenes / f"{name}.yaml"), store), share)
    click.echo(f"solve {sum(len(part.keys) for part in own)} curves", err=True)
    solve(own, store, origin(), lambda line: click.echo(line, err=True))


@click.command(hidden=True)
@click.argument("scene_file", type=FILE)
@click.argument("store", type=FILE)
@click.argument("folder", type=FILE)
def make(scene_file: Path, store: Path, folder: Path) -> None:
    """Make the outdated products of a scene from the curves in STORE, in FOLDER, WHAT.DIGEST.

    WHAT is a product or all of them, and DIGEST that of their stamps in the plan. Products that cannot be made are
    named. The exit code is 1 if none can.
    """
    from weier.figures.make import make_product
    from weier.pipeline.needed_curves import Curves
    from weier.pipeline.products import job_of, remove_older, stamp_of

    curves = Curves(weier.load_scene(scene_file), Store(store, numerics()))
    what = folder.name.rpartition(".")[0]
    unfinished = folder.with_name(f"{folder.name}.unfinished")  # FOLDER appears only as a whole
    shutil.rmtree(unfinished, ignore_errors=True)  # of a killed job: its stamps are not in the plan
    job, names = job_of(curves.scene, what, partial(stamp_of, curves, folder.parents[1]))
    if folder.name != job:
        raise ValueError(f"{scene_file.stem} or weier has changed since the plan: run snakemake again")
    made = []
    for name in names:
        click.echo(f"make {scene_file.stem} {name}", err=True)
        try:
            make_product(curves, name, unfinished)
            made.append(name)
        except (OSError, ModuleNotFoundError):  # a full disk or a missing package stops all
            raise
        except Exception as error:  # a bug in one figure must not cost the others
            shutil.rmtree(unfinished / name, ignore_errors=True)
            why = error if isinstance(error, ValueError) else traceback.format_exc()
            click.echo(f"weier: {name} cannot be made: {why}", err=True)
    if not made:
        shutil.rmtree(unfinished, ignore_errors=True)
        raise click.exceptions.Exit(1)
    unfinished.rename(folder)
    for name in made:
        remove_older(folder, name)


@click.command()
@click.argument("scenes", nargs=-1, type=FILE, required=True)
@click.option("--curves", "folder", type=FILE, default=Path("results/curves"), show_default=True, help="Their store.")
@click.option("--within-errors", is_flag=True, help="Also accept differences within the stated errors.")
def adopt(scenes: Sequence[Path], folder: Path, within_errors: bool) -> None:
    """Accept curves of older code, if this code gives the same numbers.

    Some 50 curves of each kind are solved again and compared to the last bit. The comparison and its verdict are kept
    next to the curves.
    """
    from weier.pipeline.adopt import adopt as adopt_curves
    from weier.pipeline.needed_curves import Curves

    store = Store(folder, numerics())
    wanted = [Curves(weier.load_scene(path), store) for path in scenes]
    compared = sum(1 for _ in map(click.echo, adopt_curves(wanted, store, within_errors)))
    click.echo(f"{compared} kinds of curves of other code were compared with that of {store.numerics}")
