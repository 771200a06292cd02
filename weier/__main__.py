"""The command line: thin, over the same functions as the Python interface."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np

from weier import batch as batches
from weier import claims as claim
from weier import dataset, endless, jit, scene, single, study, tradeoff
from weier.errors import ConvergenceError
from weier.fields import events, fields
from weier.plan import QUANTITIES
from weier.plan_scene import plan
from weier.profile import Profile
from weier.solve import METHODS, solve
from weier.version import VERSION

Command = Callable[..., Any]

SCENE = click.argument("scene_file", type=click.Path(path_type=Path))
FILES = click.argument("files", nargs=-1, type=click.Path(path_type=Path))


def output(name: str) -> Callable[[Command], Command]:
    """An argument that is a file to write."""
    return click.argument(name, type=click.Path(path_type=Path))


EXIT = "Exit codes: 0 done; 1 bad input or a solver that missed its tolerance, told in one sentence; 2 wrong usage."


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100}, epilog=EXIT)
@click.version_option(VERSION)
def cli() -> None:
    """Contact stiffness and contact resistance of the Weierstrass profile.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --loads 0.01:1:5        one profile, as JSON
    weier plot -D 1.25 --gamma 5 -m 3 curves.png               its curves by several methods
    weier plan -D 1.25 --gamma 5 -m 3 --tolerance 1e-4         what a tolerance takes, and why
    weier solve -D 1.25 --gamma 5 -m 3 --method planned        curves within a tolerance
    snakemake --cores 2 --config scenes=minimal                a scene, in a checkout

    Completion of commands and options, for this shell or in ~/.bashrc (zsh_source, fish_source for others):

    \b
    eval "$(_WEIER_COMPLETE=bash_source weier)"
    """  # noqa: D301 - click wants the character


LOADS = "1e-3:4:40"


def series_options(required: bool) -> tuple[Callable[[Command], Command], ...]:
    """The options that name a profile."""
    return (
        click.option("-D", "D", type=float, required=required, help="Fractal dimension, between 1 and 2."),
        click.option("--gamma", required=required, help='Ratio of successive wavelengths: 5 or "5/2".'),
        click.option(
            "-m", "m", type=float, required=required,
            help="Number of waves, or inf for the methods archard, demelio, layer and planned.",
        ),
        click.option("--phase", type=float, help="Phase of every wave but the first, in radians [default: 0]."),
        click.option("--phases", help="Phases of all m waves, as 0,1,2."),
        click.option("--seed", type=int, help="Seed of random phases."),
    )  # fmt: skip


SOLVED = (
    click.option(
        "--loads", default=LOADS, show_default=True,
        help='Mean pressures in p_0*: "0.1,1", or first:last:count in equal ratios.',
    ),
    click.option(
        "--method", "methods", multiple=True, type=click.Choice(list(METHODS)),
        help="Once for each method [default: bem; plot: archard, demelio, layer and bem].",
    ),
    click.option(
        "--set", "settings", multiple=True, metavar="METHOD.NAME=VALUE", help="A setting, such as bem.points=512."
    ),
)  # fmt: skip


def of_one_profile(command: Command) -> Command:
    """The options that name a profile, its loads and the methods."""
    return with_options(command, *series_options(required=True), *SOLVED)


def of_any_profile(command: Command) -> Command:
    """The options that name a profile, for a command that can do without."""
    return with_options(command, *series_options(required=False))


def with_options(command: Command, *options: Callable[[Command], Command]) -> Command:
    """The command with these options, in this order."""
    for option in reversed(options):
        command = option(command)
    return command


def solve_options(loads: str, methods: Sequence[str], settings: Sequence[str], **series: Any) -> Any:
    """The dataset that these options ask for."""
    return single.solve_one(
        parameters(**series), single.parsed_loads(loads), methods, single.parsed_settings(settings)
    )


def parameters(
    D: float, gamma: str, m: float, phase: float | None, phases: str | None, seed: int | None
) -> dict[str, Any]:
    """The parameters of a profile as a scene has them."""
    chosen = {"phase": phase, "phases": single.parsed_phases(phases), "seed": seed}
    given = {name: value for name, value in chosen.items() if value is not None}
    if len(given) > 1:
        raise ValueError(f"a profile takes one of --phase, --phases and --seed, got {' and '.join(given)}")
    return {"D": D, "gamma": gamma, "m": m, **given}


@cli.command("solve")
@of_one_profile
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), help="Write here: .json, or netCDF by any other name."
)
def solve_command(output: Path | None, methods: Sequence[str], **options: Any) -> None:
    """Compliance and resistance of one profile against mean pressure.

    Prints JSON, and progress beside it; lengths along x are in lambda_0, heights in g_0, pressures in p_0*.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --phases 0,1,2 --loads 0.01,0.1,1
    weier solve -D 1.5 --gamma 5/2 -m 4 --seed 7 --method layer --method patches -o curves.nc
    weier solve -D 1.25 --gamma 5 -m inf --method demelio --loads 1e-3:4:40 -o limit.json
    weier solve -D 1.25 --gamma 5 -m 3 --method planned --set planned.tolerance=1e-4
    weier solve -D 1.25 --gamma 5 -m 3 --method bem --set bem.points=6400
    """  # noqa: D301 - click wants the character
    data = solve_options(methods=methods or ("bem",), **options)
    if output is None:
        click.echo(single.as_json(data))
    else:
        single.write(data, output)


@cli.command("plot")
@of_one_profile
@click.option("--quantity", type=click.Choice(QUANTITIES), default="compliance", show_default=True)
@output("path")
def plot(path: Path, quantity: str, methods: Sequence[str], **options: Any) -> None:
    """Draw the curves of one profile, as PDF, SVG and PNG beside PATH.

    \b
    weier plot -D 1.25 --gamma 5 -m 3 --phase 1 curves.png
    weier plot -D 1.5 --gamma 3 -m 2 --quantity resistance --method layer --method patches resistance.pdf
    """  # noqa: D301 - click wants the character
    from weier.figures import draw  # matplotlib takes half a second, and only some commands need it

    data = solve_options(methods=methods or ("archard", "demelio", "layer", "bem"), **options)
    draw(quantity, [data], "", path)


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
    solve(profile, np.geomspace(1e-3, 10, 12), "patches")  # few contacts and few gaps: both of its problems
    fields(profile, 0.1)
    events(profile, 1e-2, 10)


@cli.command()
@SCENE
@click.argument("name")
@output("data")
@output("cost")
@click.option("--threads", type=click.IntRange(1), default=1, show_default=True, help="Cases at a time.")
def batch(scene_file: Path, name: str, data: Path, cost: Path, threads: int) -> None:
    """Solve one batch of a scene."""
    loaded = scene.load(scene_file)
    curves, seconds = batches.solve_batch(loaded, loaded.batch_named(name), threads)
    dataset.write(seconds, cost, f"{loaded.title}: seconds", "solved", loaded.text)
    dataset.write(curves, data, loaded.title, "solved", loaded.text)


@cli.command()
@SCENE
@click.argument("name")
@output("path")
@click.argument("folder", type=click.Path(path_type=Path))
def gather(scene_file: Path, name: str, path: Path, folder: Path) -> None:
    """Put the cases of a study into one file, from batches in FOLDER."""
    loaded = scene.load(scene_file)
    keys = [case.key for case in loaded.study_named(name)]
    files = [folder / f"{batch}.nc" for batch in loaded.batches_of(name)]
    study.gather(files, keys, path, f"{loaded.title}: {name}", scene=loaded.text)


@cli.command()
@output("gathered")
@output("path")
def bounds(gathered: Path, path: Path) -> None:
    """Add the bounds on the endless series to a gathered file."""
    with dataset.reading(gathered) as data:
        about = data.attrs
    study.gather(
        [gathered], study.keys_of([gathered]), path, about.get("title", ""),
        step="bounded", scene=about.get("scene", ""), change=study.add_bounds,
    )  # fmt: skip


@cli.command()
@SCENE
@click.argument("name")
@output("path")
@FILES
def figure(scene_file: Path, name: str, path: Path, files: Sequence[Path]) -> None:
    """Draw one figure of a scene from its studies.

    As PDF, SVG and PNG beside PATH.
    """
    from weier.figures import draw  # as above

    loaded = scene.load(scene_file)
    wanted = loaded.figure_named(name)
    draw(wanted.draw, [dataset.read(file) for file in files], wanted.title, path)


@cli.command()
@SCENE
@output("path")
@output("table")
@FILES
def claims(scene_file: Path, path: Path, table: Path, files: Sequence[Path]) -> None:
    """Check the claims of a scene, and write its whole dataset."""
    loaded = scene.load(scene_file)
    claim.write(loaded, dict(zip(loaded.studies, files, strict=True)), path, table)


@cli.command("plan")
@click.argument("scene_file", metavar="[SCENE]", required=False, type=click.Path(path_type=Path))
@of_any_profile
@click.option("--loads", help=f"Mean pressures, as of `weier solve` [default: of the scene; {LOADS}].")
@click.option(
    "--tolerance",
    type=float,
    help="Of the compliance in g_0, of the resistance relative "
    "to the larger of itself and 1 g_0/p_0* [default: of the scene; 1e-3].",
)
@click.option("--quantity", type=click.Choice(QUANTITIES), help="[default: of the scene; compliance].")
def plan_command(
    scene_file: Path | None, loads: str | None, tolerance: float | None, quantity: str | None, **series: Any
) -> None:
    """What a tolerance takes, and why.

    Of one profile, or of each case of a scene: the cheapest methods, load by load, with their errors, seconds and
    memory. Nothing is solved.

    \b
    weier plan -D 1.25 --gamma 5 -m 3 --phases 0,1,2 --tolerance 1e-4
    weier plan -D 1.5 --gamma 2 -m 6 --loads 1e-3:4:40 --tolerance 0.01 --quantity resistance
    weier plan -D 1.1 --gamma 5 -m inf --loads 0.1,1
    weier plan config/scenes/planned.yaml
    weier plan config/scenes/planned.yaml --tolerance 1e-2
    """  # noqa: D301 - click wants the character
    given = any(value is not None for value in series.values())
    if given == (scene_file is not None):
        raise click.UsageError(
            f"a plan is of a SCENE or of a profile (-D, --gamma, -m), got {'both' if given else 'neither'}"
        )
    if scene_file is not None:
        own = None if loads is None else single.parsed_loads(loads)
        click.echo(plan(scene.load(scene_file), own, tolerance, quantity))
        return
    missing = [option for option, name in (("-D", "D"), ("--gamma", "gamma"), ("-m", "m")) if series[name] is None]
    if missing:
        raise click.UsageError(f"a profile takes -D, --gamma and -m, got no {' and no '.join(missing)}")
    click.echo(
        single.plan_one(
            parameters(**series), single.parsed_loads(LOADS if loads is None else loads), tolerance, quantity
        )
    )


@cli.command("tradeoff")
@SCENE
@output("path")
@output("table")
def tradeoff_command(scene_file: Path, path: Path, table: Path) -> None:
    """Measure the errors and seconds of all methods and settings.

    On the profiles of a scene.
    """
    loaded = scene.load(scene_file)
    measured = tradeoff.measure(loaded)
    dataset.write(measured, path, loaded.title, "measured", loaded.text)
    tradeoff.write_table(measured, loaded.title, table)


@cli.command("endless")
@SCENE
@output("path")
@click.option("--terms", default=8, show_default=True, help="Waves to resolve, from 1 up to this.")
def endless_command(scene_file: Path, path: Path, terms: int) -> None:
    """Endless series by the number of terms resolved.

    Best estimates and bounds of the cases of a scene.
    """
    loaded = scene.load(scene_file)
    profiles = [case.profile for case in loaded.cases.values()]
    found = endless.convergence(profiles, loaded.loads, terms)
    dataset.write(found, path, loaded.title, "solved", loaded.text)


@cli.command("extremes")
@output("path")
@output("table")
def extremes_command(path: Path, table: Path) -> None:
    """Examine every method where digits are lost."""
    from weier import extremes  # mpmath, which only this command needs

    title = "Stability at the extremes"
    found = extremes.measure()
    dataset.write(found, path, title, "examined")
    extremes.write_table(found, title, table)


@cli.command("draw")
@click.argument("kind")
@output("path")
@FILES
def draw_command(kind: str, path: Path, files: Sequence[Path]) -> None:
    """Draw a kind of figure from files.

    As PDF, SVG and PNG beside PATH.
    """
    from weier.figures import draw  # as above

    draw(kind, [dataset.read(file) for file in files], "", path)


@cli.command()
@SCENE
@output("path")
@click.argument("contact", type=click.Path(path_type=Path))
@FILES
def page(scene_file: Path, path: Path, contact: Path, files: Sequence[Path]) -> None:
    """Write the page of a scene.

    From its dataset CONTACT, its figures (.png) and its costs (.nc).
    """
    from weier import page as pages  # bokeh takes a second, and only this command needs it

    figures = [file for file in files if file.suffix == ".png"]
    costs = [file for file in files if file.suffix == ".nc"]
    pages.write(scene.load(scene_file), contact, figures, costs, path)


def main() -> None:
    """Run the command line; bad input and failed solves end in one sentence and exit code 1."""
    try:
        cli(prog_name="weier")
    except (ValueError, ConvergenceError, OSError, MemoryError) as error:
        print(f"weier: {error or 'not enough memory: ask for fewer points, loads or cases'}", file=sys.stderr)
        sys.exit(1)


if __name__ == "__main__":
    main()
