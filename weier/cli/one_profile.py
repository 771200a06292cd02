"""One profile: `weier solve` and `weier plot`."""

from __future__ import annotations

import json
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from weier.cli import options
from weier.cli.options import FORCE, Output
from weier.methods.curve import QUANTITIES
from weier.methods.load_progress import reporting_to
from weier.methods.registry import PLOTTED

if TYPE_CHECKING:
    import xarray as xr


LOADS = "1e-3:4:40"  # covers a single contact to full contact for usual profiles
PLOTTED_LOADS = "1e-3:4:400"  # This many loads resolve the drops of the resistance at births.


@click.command(params=options.one_profile_options(LOADS), epilog=options.SETTINGS)
@click.option("-o", "--output", type=Output(".nc"), help="Write netCDF here.")
@FORCE
def solve(output: Path | None, force: bool, workers: int, **given: Any) -> None:
    """Compute the compliance and resistance of one profile.

    Prints JSON to standard output, as of xarray's `Dataset.to_dict`, and progress to standard error. After Ctrl-C,
    the loads that patches, bem or auto have solved are printed or, with an output, kept in curve.part.nc, from which
    the same command resumes; a kill loses ten seconds. A netCDF file of the same problem with fewer loads gets the
    others. Lengths along x are in lambda_0, heights in g_0, pressures in p_0*. The output has each load once,
    increasing.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --phases 0,1,2 --loads 0.01,0.1,1
    weier solve -D 1.5 --gamma 5/2 -m 4 --seed 7 --method layer --method patches -o curves.nc
    weier solve -D 1.25 --gamma 5 -m inf --tolerance 1e-2
    weier solve -D 1.25 --gamma 5 -m 3 --method bem --set bem.points_per_wave=256
    weier solve --trace lab.txt --skip 12 --columns 0,2 --decimal , --unit um
    weier solve --trace shaft.csv --detrend form --max-gap 5
    weier solve --trace shaft.csv --against bush.csv --si bodies.yaml --pressures 1,10MPa
    """
    # xarray takes half a second, and the help of the commands needs none of these
    from weier.cli.call import check_solved, profile_call, solved_loads
    from weier.cli.output import SolutionFile

    call = profile_call(LOADS, **given)
    kept = None if output is None else SolutionFile(output, call)
    known = kept.known() if kept and not force else None
    with nullcontext() if kept is None else reporting_to(kept):
        curves, stop = call.solve(workers, known)
    curves, where = curves if stop is None else solved_loads(curves), "printed"
    if kept is None:
        click.echo(_as_json(call.in_units(curves)))
    elif stop is None:
        kept.save(curves, whole=True)
        click.echo(f"the curves are in {output}", err=True)
    else:
        kept.save(curves)
        where = f"in {kept.part}" + ("" if force else ", from which the same command goes on")
    if stop is not None:
        solved, count = curves.sizes["mean_pressure"], call.loads.size
        click.echo(f"weier: {solved} of {count} loads are solved, and {where}", err=True)
        raise stop
    check_solved(curves)


@click.command(params=options.one_profile_options(PLOTTED_LOADS), epilog=options.SETTINGS)
@click.option("--quantity", type=click.Choice(QUANTITIES), default="compliance", show_default=True)
@FORCE
@click.argument("path", type=Output(".pdf", ".svg", ".png"))
def plot(path: Path, force: bool, quantity: str, workers: int, **given: Any) -> None:
    """Draw the curves of one profile into PATH, which ends in .png, .pdf or .svg.

    \b
    weier plot -D 1.25 --gamma 5 -m 3 curves.png
    weier plot -D 1.5 --gamma 3 -m 2 --quantity resistance --method layer --method patches resistance.pdf
    weier plot --trace shaft.csv --si bodies.yaml --pressures 1:100:40MPa --quantity resistance ohms.png
    """
    from weier.cli.call import check_solved, profile_call

    options.check_free(path, force)
    call = profile_call(PLOTTED_LOADS, PLOTTED, **given)
    call.check_figure()
    curves, stop = call.solve(workers)
    if stop is not None:
        raise stop
    call.draw(curves, path, quantity)
    click.echo(f"the figure is in {path}", err=True)
    check_solved(curves)


def _as_json(curves: xr.Dataset) -> str:
    """Return the curves of one case in the form of `xarray.Dataset.to_dict`.

    JSON has no nan and no inf: null is a missing number or minus infinity.
    """
    values = json.dumps(curves.isel(case=0).to_dict())
    return json.dumps(json.loads(values, parse_constant={"Infinity": "inf"}.get), indent=1, allow_nan=False)
