"""Compare programs on the same grids: `python -m benchmarks same_grid`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click
import numpy as np

from benchmarks import report
from benchmarks.measure import compare
from benchmarks.problem import Problem
from benchmarks.programs import PROGRAMS, seconds
from weier import Profile
from weier.accuracy.measurement import CONTEXT
from weier.data.files import write_text

PHASES = (0.0, 1.0, 2.0)  # radians: an unsymmetric profile, as in the README.


def parse_numbers(context: click.Context, parameter: click.Parameter, text: str) -> list[int]:
    """Parse comma-separated whole numbers, such as 512 and 2^20."""
    try:
        return [int(base) ** int(power or 1) for base, _, power in (part.partition("^") for part in _parts(text))]
    except ValueError:
        raise click.BadParameter(f'must be whole numbers with commas, such as "512,2^17", got {text!r}') from None


def parse_names(context: click.Context, parameter: click.Parameter, text: str) -> list[str]:
    """Parse comma-separated names of programs."""
    for name in _parts(text):
        if name not in PROGRAMS:
            raise click.BadParameter(f"must be among {', '.join(PROGRAMS)}, got {name!r}")
    return _parts(text)


def _parts(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]


def installed(programs: Sequence[str]) -> list[str]:
    """Return the installed programs, and print how to install the others."""
    present = []
    for name in programs:
        try:
            PROGRAMS[name].version(PROGRAMS[name].package)
            present.append(name)
        except LookupError as why:
            click.echo(why.args[0], err=True)
    return present


@click.command(context_settings=CONTEXT)
@click.option(
    "--points", callback=parse_numbers, default="512,2048,8192,32768", help="Numbers of nodes, for all programs."
)
@click.option("--alone", callback=parse_numbers, default="2^17", help="Numbers of nodes, for weier alone.")
@click.option("--programs", callback=parse_names, default=",".join(PROGRAMS), help="Programs to compare.")
@click.option("--repeats", type=click.IntRange(1), default=3, help="Timed runs of each program, taken in turn.")
@click.option("--loads", type=click.IntRange(2), default=40, help="Number of loads, log-spaced in [1e-3, 2] p_0*.")
@click.option("--m", type=click.IntRange(1, 6), default=3, help="Terms of the series: 6 need 6251 nodes or more.")
@click.option(
    "--tolerance",
    type=click.FloatRange(0, min_open=True),
    default=1e-8,
    help="Residual to be reached, in g_0.",
)
@click.option("--output", type=click.Path(path_type=Path), default="results/benchmark", help="Folder to write to.")
def main(
    points: list[int],
    alone: list[int],
    programs: list[str],
    repeats: int,
    loads: int,
    m: int,
    tolerance: float,
    output: Path,
) -> None:
    """Compare weier with tamaas, ContactMechanics, slippy and the paper's dense inversion on the same problem.

    Writes benchmark.md and benchmark.{png,svg,pdf}.
    """
    programs = installed(programs)
    profile = Profile(D=1.25, gamma=5, m=m, phases=(*PHASES, *np.arange(3.0, m))[:m])
    pressure = np.geomspace(1e-3, 2, loads)
    plan = dict.fromkeys(alone, (report.OURS,)) | {size: _able(programs, size) for size in points}
    plan = dict(sorted(plan.items()))
    for name in programs:  # compile first
        seconds(PROGRAMS[name], Problem(profile, pressure[-1:], min(plan), tolerance), np.full(1, tolerance))
    data = compare(profile, pressure, plan, tolerance, repeats, _progress)
    write_text(output / "benchmark.md", report.table(data))
    report.draw(data, output / "benchmark.pdf")
    click.echo(report.table(data))


def _able(programs: Sequence[str], points: int) -> tuple[str, ...]:
    return tuple(name for name in programs if points <= PROGRAMS[name].max_points)


def _progress(text: str) -> None:
    click.echo(text, err=True)
