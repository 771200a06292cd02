"""One profile: `weier solve` and `weier plot`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from weier.cli import options
from weier.cli.options import FORCE, Output
from weier.methods.curve import QUANTITIES
from weier.methods.registry import PLOTTED, find_method

if TYPE_CHECKING:
    import xarray as xr


LOADS = "1e-3:4:40"  # covers a single contact to full contact for usual profiles
PLOTTED_LOADS = "1e-3:4:400"  # This many loads resolve the drops of the resistance at births.


@click.command(params=options.one_profile_options(LOADS), epilog=options.SETTINGS)
@click.option("-o", "--output", type=Output(".nc"), help="Write netCDF here.")
@FORCE
def solve(output: Path | None, **given: Any) -> None:
    """Compute the compliance and resistance of one profile.

    Prints JSON to standard output, as of xarray's `Dataset.to_dict`, and progress to standard error. After Ctrl-C,
    the output has the loads that are solved. Lengths along x are in lambda_0, heights in g_0, pressures in p_0*. The
    output has each load once, increasing.

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
    from weier.cli import call
    from weier.data import dataset

    surface = call.take_profile(given)
    found = call.solve([surface], default_loads=LOADS, **given)
    curves = found.curves
    if found.stopped is not None:
        curves = curves.sel(mean_pressure=curves["compliance"].notnull().any(("case", "solution_method")))
        count = found.curves.sizes["mean_pressure"]
        click.echo(f"weier: {curves.sizes['mean_pressure']} of {count} loads are solved", err=True)
    curves = found.in_units(curves)
    if output is None:
        click.echo(_as_json(curves))
    else:
        dataset.write(curves, output, str(surface.describe()))
        click.echo(f"the curves are in {output}", err=True)
    found.check_whole()


@click.command(params=options.one_profile_options(PLOTTED_LOADS), epilog=options.SETTINGS)
@click.option("--quantity", type=click.Choice(QUANTITIES), default="compliance", show_default=True)
@FORCE
@click.argument("path", type=Output(".pdf", ".svg", ".png"))
def plot(path: Path, quantity: str, **given: Any) -> None:
    """Draw the curves of one profile into PATH, which ends in .png, .pdf or .svg.

    \b
    weier plot -D 1.25 --gamma 5 -m 3 curves.png
    weier plot -D 1.5 --gamma 3 -m 2 --quantity resistance --method layer --method patches resistance.pdf
    weier plot --trace shaft.csv --si bodies.yaml --pressures 1:100:40MPa --quantity resistance ohms.png
    """
    from weier.cli import call

    surface = call.take_profile(given)
    given["methods"] = given["methods"] or [name for name in PLOTTED if find_method(name).takes(surface)]
    found = call.solve([surface], default_loads=PLOTTED_LOADS, drawn=True, **given)
    if found.stopped is None:
        found.draw(found.curves, path, quantity)
        click.echo(f"the figure is in {path}", err=True)
    found.check_whole()


def _as_json(curves: xr.Dataset) -> str:
    """Return the curves of one case in the form of `xarray.Dataset.to_dict`.

    JSON has no nan and no inf: null is a missing number or minus infinity.
    """
    values = json.dumps(curves.isel(case=0).to_dict())
    return json.dumps(json.loads(values, parse_constant={"Infinity": "inf"}.get), indent=1, allow_nan=False)
