"""One profile: `weier solve` and `weier plot`."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from weier import units
from weier.cli import options
from weier.cli.options import FORCE, Output, Pressures
from weier.data.provenance import NORMALISED
from weier.data.variables import VARIABLES
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES
from weier.methods.load_progress import reporting_to
from weier.methods.registry import PLOTTED, find_method

if TYPE_CHECKING:
    import xarray as xr

    from weier.cli.call import Call

LOADS = "1e-3:4:40"  # covers a single contact to full contact for usual profiles
PLOTTED_LOADS = "1e-3:4:400"  # This many loads resolve the drops of the resistance at births.
# The numbers that describe a profile.
PROFILE = tuple(
    name
    for name, entry in VARIABLES.items()
    if entry.dims in (("case",), ("case", "term")) and entry.dtype == "f8" and not entry.optional
)


def _call(
    default_loads: str,
    loads: Array | None,
    bodies: Path | None,
    pressures: Pressures | None,
    methods: Sequence[str],
    tolerance: float | None,
    settings: Sequence[tuple[str, str, Any]],
    trace_file: Path | None,
    plotted: Sequence[str] = (),
    **of_surface: Any,
) -> Call:
    """Return the call for the options of a command, by the methods `plotted` that apply if none is given."""
    from weier.cli.call import Call, surface_of  # xarray takes half a second, and the help of the command needs none

    if pressures is not None and loads is not None:
        raise click.UsageError("loads are given once, got --pressures and --loads")
    if pressures is not None and bodies is None:
        raise click.UsageError("--pressures are in Pa: name the two bodies by --si, or take --loads, in p_0*")
    surface = surface_of(trace_file, of_surface)
    methods = methods or [name for name in plotted if find_method(name).takes(surface)]
    if loads is None:
        loads = options.read_loads(default_loads)
    return Call.of([surface], bodies, pressures or loads, methods, tolerance, settings)


@click.command(params=options.one_profile_options(LOADS), epilog=options.SETTINGS)
@click.option("-o", "--output", type=Output(".nc"), help="Write netCDF here.")
@FORCE
def solve(output: Path | None, force: bool, workers: int, **given: Any) -> None:
    """Compute the compliance and resistance of one profile.

    Prints JSON to standard output and progress to standard error. After Ctrl-C, the loads that patches, bem or auto
    have solved are printed or, with an output, kept in curve.part.nc, from which the same command resumes; a kill
    loses ten seconds. A netCDF file of the same problem with fewer loads gets the others. Lengths along x are in
    lambda_0, heights in g_0, pressures in p_0*. The output has each load once, increasing.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --phases 0,1,2 --loads 0.01,0.1,1
    weier solve -D 1.5 --gamma 5/2 -m 4 --seed 7 --method layer --method patches -o curves.nc
    weier solve -D 1.25 --gamma 5 -m inf --tolerance 1e-2
    weier solve -D 1.25 --gamma 5 -m 3 --method bem --set bem.points_per_wave=256
    weier solve --trace lab.txt --skip 12 --columns 0,2 --decimal , --unit um
    weier solve --trace map.x3p --line 120 --detrend form --max-gap 5
    weier solve --trace shaft.csv --against bush.csv --si bodies.yaml --pressures 1,10MPa
    """
    call = _call(LOADS, **given)
    from weier.cli.call import check_solved, solved_loads
    from weier.cli.output import SolutionFile

    kept = None if output is None else SolutionFile(output, call)
    known = kept.known() if kept and not force else None
    with nullcontext() if kept is None else reporting_to(kept):
        curves, stop = call.solve(workers, known)
    curves, where = curves if stop is None else solved_loads(curves), "printed"
    if kept is None:
        click.echo(_as_json(call, curves))
    elif stop is None:
        kept.finish(curves)
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
    options.check_free(path, force)
    call = _call(PLOTTED_LOADS, plotted=PLOTTED, **given)
    options.check_line(call.loads)
    from weier.cli.call import check_solved

    curves, stop = call.solve(workers)
    if stop is not None:
        raise stop
    call.draw(curves, path, quantity)
    click.echo(f"the figure is in {path}", err=True)
    check_solved(curves)


def _as_json(call: Call, curves: xr.Dataset) -> str:
    """Return the curves of one case as JSON, by method; null is a missing number or minus infinity."""
    data, (surface,) = call.in_units(curves), call.surfaces
    case, header = data.isel(case=0), dict[str, Any](title=str(surface.describe()))
    header |= {"interface": call.bodies.at(surface).given} if call.bodies else {"normalisation": NORMALISED}
    numbers = [values for values in data.values() if values.dtype.kind == "f"]
    header["units"] = {str(values.name): units.unit_of(values) or units.NONE for values in numbers}
    header |= {name: _plain(case[name].values) for name in PROFILE}
    header |= {str(name): case[name].item() for name in case.coords if str(name).startswith("trace")}
    methods = {method: _curves(case, method) for method in case["solution_method"].values.tolist()}
    header |= {"mean_pressure": case["mean_pressure"].values.tolist(), "methods": methods}
    return json.dumps(header, indent=1, allow_nan=False)


def _curves(case: xr.Dataset, method: str) -> dict[str, Any]:
    """Return the variables of one method that have values."""
    run = case.sel(solution_method=method).drop_vars([*PROFILE, "status"], errors="ignore")
    own = {str(name): _plain(values.values) for name, values in run.items()}
    own = {name: plain for name, plain in own.items() if {*np.ravel(plain)} - {None, ""}}
    return own | {"settings": json.loads(own["settings"])}


def _plain(values: Array) -> Any:
    """Return numbers and texts for JSON, which has no nan and no inf."""
    if values.dtype.kind in "UO":
        return values.tolist()
    plain = values.astype(object)
    plain[~np.isfinite(values)] = None
    plain[np.isposinf(values)] = "inf"
    return plain.tolist()
