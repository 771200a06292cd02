"""One profile: `weier solve` and `weier plot`."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from weier.cli.options import (
    FILE,
    FORCE,
    LOADS,
    PLOTTED_LOADS,
    Pressures,
    SolvingCommand,
    check_free,
    check_line,
    one_profile_options,
    output,
    writable,
)
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES
from weier.methods.load_progress import reporting_to
from weier.methods.registry import PLOTTED, find_method

if TYPE_CHECKING:
    from weier.cli.call import Call


def _call(
    loads: Array,
    bodies: Path | None,
    pressures: Pressures | None,
    methods: Sequence[str],
    tolerance: float | None,
    settings: dict[str, Any],
    default: Sequence[str] = (),
    **surface: Any,
) -> Call:
    """Return the call for the options of a command, with the applicable default methods."""
    from weier.cli.call import Call, surface_of  # xarray takes half a second, and the help of the command needs none

    from_shell = click.get_current_context().get_parameter_source("loads") is ParameterSource.COMMANDLINE
    if pressures is not None and from_shell:
        raise click.UsageError("loads are given once, got --pressures and --loads")
    one = surface_of(**surface)
    methods = methods or [name for name in default if find_method(name).takes(one)]
    return Call.from_options([one], loads, bodies, pressures, methods, tolerance, settings)


@click.command(cls=SolvingCommand, params=one_profile_options(LOADS))
@click.option("-o", "--output", type=FILE, callback=writable(".nc"), help="Write netCDF here.")
@FORCE
def solve(output: Path | None, force: bool, workers: int, **options: Any) -> None:
    """Compute the compliance and resistance of one profile.

    Prints JSON to standard output and progress to standard error. After Ctrl-C, the loads that patches, bem or auto
    have solved are printed or, with an output, kept in curve.part.nc, from which the same command resumes; a kill
    loses ten seconds. A netCDF file of the same problem with fewer loads gets the others. Lengths along x are in
    lambda_0, heights in g_0, pressures in p_0*. The output has each load once, increasing.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --phases 0,1,2 --loads 0.01,0.1,1
    weier solve -D 1.5 --gamma 5/2 -m 4 --seed 7 --method layer --method patches -o curves.nc
    weier solve -D 1.25 --gamma 5 -m inf --method demelio --loads 1e-3:4:40
    weier solve -D 1.25 --gamma 5 -m inf --tolerance 1e-2
    weier solve -D 1.25 --gamma 5 -m 3 --method bem --set bem.points_per_wave=256
    weier solve --trace shaft.csv --shortest 0.01 --x-unit mm --height-unit um --loads 0.01:10:20 -o shaft.nc
    weier solve --trace lab.txt --skip 12 --columns 0,2 --decimal , --unit um
    weier solve --trace map.x3p --line 120 --detrend form --max-gap 5
    weier solve --trace shaft.csv --si bodies.yaml --pressures 1,10MPa
    weier solve --trace shaft.csv --against bush.csv --si bodies.yaml --pressures 1,10MPa
    """  # noqa: D301 - click wants the character
    call = _call(**options)
    from weier.cli.call import solved_loads
    from weier.cli.output import Output
    from weier.cli.result import as_json, check_solved

    kept = None if output is None else Output(output, call)
    known = kept.known() if kept and not force else None
    with nullcontext() if kept is None else reporting_to(kept):
        curves, stop = call.solve(workers, known)
    curves, where = curves if stop is None else solved_loads(curves), "printed"
    if kept is None:
        click.echo(as_json(call.in_units(curves), str(call.surfaces[0].describe())))
    elif stop is None:
        kept.finish(curves)
    else:
        kept.save(curves)
        where = f"in {kept.part}" + ("" if force else ", from which the same command goes on")
    if stop is not None:
        solved, count = curves.sizes["mean_pressure"], call.loads.size
        click.echo(f"weier: {solved} of {count} loads are solved, and {where}", err=True)
        raise stop
    check_solved(curves)


@click.command(cls=SolvingCommand, params=one_profile_options(PLOTTED_LOADS))
@click.option("--quantity", type=click.Choice(QUANTITIES), default="compliance", show_default=True)
@FORCE
@output("path", ".pdf", ".svg", ".png", required=False)
def plot(path: Path | None, force: bool, quantity: str, workers: int, **options: Any) -> None:
    """Draw the curves of one profile.

    PATH ends in .png, .pdf or .svg. Without PATH, the figure is a PNG file with the name of the quantity.

    \b
    weier plot -D 1.25 --gamma 5 -m 3
    weier plot -D 1.25 --gamma 5 -m 3 --phases 1 curves.png
    weier plot -D 1.5 --gamma 3 -m 2 --quantity resistance --method layer --method patches resistance.pdf
    weier plot --trace shaft.csv --si bodies.yaml --pressures 1:100:40MPa --quantity resistance ohms.png
    """  # noqa: D301 - click wants the character
    path = path or Path(f"{quantity}.png")
    check_free(path, force)
    call = _call(**options, default=PLOTTED)
    check_line(call.loads)
    from weier.cli.result import check_solved

    curves, stop = call.solve(workers)
    if stop is not None:
        raise stop
    call.draw(curves, path, quantity)
    click.echo(f"the figure is in {path}", err=True)
    check_solved(curves)
