"""One profile: `weier solve` and `weier plot`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click
import numpy as np
from click.core import ParameterSource

from weier import units
from weier.cli.bodies_file import read_bodies
from weier.cli.options import (
    FORCE,
    INTO,
    LOADS,
    MAX_SECONDS,
    MIN_LOADS,
    PLOTTED_LOADS,
    Pressures,
    SolvingCommand,
    check_free,
    listed_in_si,
    one_profile_options,
    output,
    profile_or_trace,
)
from weier.data.si import with_pressures_in
from weier.data.variables import VARIABLES
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES
from weier.methods.errors import ConvergenceError
from weier.methods.load_progress import INTERRUPTIONS, reporting_to
from weier.methods.registry import PLOTTED
from weier.methods.settings import TOLERANCE
from weier.scene import Case, Figure

if TYPE_CHECKING:
    import xarray as xr

    from weier.api.interface import Interface
    from weier.api.task import Known

ERROR = "mean_pressure_error"
RESUMED = ".nc"  # files with this suffix can be resumed


class Request(NamedTuple):
    """One profile and its loads in p_0*, in the order given.

    bodies : both bodies, for results in SI units
    unit : the unit in which pressures were given
    given : the loads as they were given in Pa, or with their errors by `weier.find_load`; None if in p_0*
    """

    profile: Mapping[str, Any]
    loads: Array
    bodies: Interface | None = None
    unit: str = ""
    given: xr.Dataset | None = None

    def with_units(self, data: xr.Dataset) -> xr.Dataset:
        """Return the curves at some or all loads, in SI units if bodies are given."""
        loads = self.loads.tolist()
        at = [loads.index(load) for load in data["mean_pressure"].values.tolist()]
        data = data if self.bodies is None else self.bodies.in_si(data)
        if self.given is not None:
            own = self.given.isel(mean_pressure=at)
            exact = ("mean_pressure", own["mean_pressure"].values, data["mean_pressure"].attrs)
            data = data.assign_coords(mean_pressure=exact)
            if ERROR in own:
                data[ERROR] = (("case", "mean_pressure"), [own[ERROR].values], own[ERROR].attrs)
        return with_pressures_in(data, self.unit) if self.unit else data


def _request(
    loads: Array, bodies: Path | None, pressures: Pressures | None, wanted: Mapping[str, str | None], **series: Any
) -> Request:
    """Return the profile and its loads from the options of a command."""
    import xarray as xr

    from weier.api.inverse import find_load
    from weier.pipeline.single import surface_of

    profile = profile_or_trace(**series)
    asked = {name: text for name, text in wanted.items() if text is not None}
    from_shell = click.get_current_context().get_parameter_source("loads") is ParameterSource.COMMANDLINE
    options = ["pressures"] * (pressures is not None) + ["loads"] * from_shell + list(asked)
    if len(options) > 1:
        raise click.UsageError(f"loads are given once, got --{' and --'.join(options)}".replace("_", "-"))
    if pressures is not None and bodies is None:
        raise click.UsageError("--pressures are in Pa: name the two bodies by --si, or take --loads, in p_0*")
    both = None if bodies is None else read_bodies(bodies)
    if both is None and not asked:
        return Request(profile, loads)
    surface = surface_of(profile)
    own = both and both.at(surface)
    if pressures is not None and own:
        given = xr.Dataset(coords={"mean_pressure": pressures.values})
        return Request(profile, own.normalised_pressure(pressures.values), both, pressures.unit, given)
    for name, text in asked.items():
        unit, in_si = VARIABLES[name].unit, own.scales if own else {}
        values = listed_in_si(name, text, in_si[unit][1]) if unit in in_si else units.listed(name, text, unit)
        given = both.find_pressure(surface, **{name: values}) if both else find_load(surface, **{name: values})
        found = given["mean_pressure"].values
        return Request(profile, own.normalised_pressure(found) if own else found, both, given=given)
    return Request(profile, loads, both)


def _case(
    default: Sequence[str],
    request: Request,
    methods: Sequence[str],
    tolerance: float | None,
    settings: dict[str, Any],
) -> Case:
    """Return the profile with the requested methods, or with the default methods that apply to it."""
    from weier.pipeline import single

    if not methods:
        methods, refusals = single.applicable(request.profile, default, tolerance is not None)
        for refusal in refusals:
            click.echo(refusal, err=True)
    settings = settings if tolerance is None else settings | {TOLERANCE: tolerance}
    return single.case_of(request.profile, methods, settings)


@click.command(cls=SolvingCommand, params=one_profile_options(LOADS))
@INTO
@click.option("--csv", is_flag=True, help="Print comma-separated values instead of JSON, one row per load.")
@FORCE
@MAX_SECONDS
@click.option(
    "--resistance",
    help="Find the loads for these resistances, in g_0/p_0*, or with --si in ohm m^2, or in K m^2/W for heat.",
)
@click.option("--compliance", help="Find the loads for these compliances, in g_0, or with --si in m or a unit.")
@click.option("--contact-fraction", help="Find the loads for these contact fractions.")
def solve(
    output: Path | None,
    csv: bool,
    force: bool,
    methods: Sequence[str],
    tolerance: float | None,
    settings: dict[str, Any],
    workers: int,
    max_seconds: float | None,
    resistance: str | None,
    compliance: str | None,
    contact_fraction: str | None,
    **options: Any,
) -> None:
    """Compute the compliance and resistance of one profile.

    Prints JSON to standard output and progress to standard error. After Ctrl-C or --max-seconds, the loads that
    patches, bem or auto have solved are printed, or with an output in curve.part.nc, from which the same command goes
    on; a kill loses ten seconds. A netCDF file of the same problem with fewer loads gets the others. Lengths
    along x are in lambda_0, heights in g_0, pressures in p_0*. Loads may come in any order, which the output keeps;
    netCDF has each once, increasing.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --phases 0,1,2 --loads 0.01,0.1,1
    weier solve -D 1.5 --gamma 5/2 -m 4 --seed 7 --method layer --method patches -o curves.nc
    weier solve -D 1.25 --gamma 5 -m inf --method demelio --loads 1e-3:4:40 -o limit.json
    weier solve -D 1.25 --gamma 5 -m inf --tolerance 1e-3
    weier solve -D 1.25 --gamma 5 -m 3 --method bem --set bem.points_per_wave=256
    weier solve --trace shaft.csv --shortest 0.01 --x-unit mm --height-unit um --loads 0.01:10:20 -o shaft.nc
    weier solve --trace lab.txt --skip 12 --columns 0,2 --decimal , --unit um
    weier solve --trace map.x3p --line 120 --detrend form --missing interpolate
    weier solve --trace shaft.csv --si bodies.yaml --pressures 1,10MPa -o ohms.csv
    weier solve --trace shaft.csv --against bush.csv --si bodies.yaml --pressures 1,10MPa
    weier solve --trace shaft.csv --si bodies.yaml --resistance 1e-10
    weier solve -D 1.25 --gamma 5 -m 3 --contact-fraction 0.01,0.1
    """  # noqa: D301 - click wants the character
    from weier.cli import result  # xarray takes half a second, and the help of the command needs none of it
    from weier.cli.output import Output
    from weier.pipeline.single import solve_one

    if output is not None:
        check_free(output, force or output.suffix == RESUMED)
    wanted = {"resistance": resistance, "compliance": compliance, "contact_fraction": contact_fraction}
    request, stop = _request(wanted=wanted, **options), None
    known: dict[str, Known] = {}
    case = _case((), request, methods, tolerance, settings)
    kept = None if output is None else Output(output, request, case)
    if kept is not None and not force:
        known = kept.known(case)
        request = kept.request
    try:
        with nullcontext() if kept is None else reporting_to(kept):
            data = solve_one(case, np.unique(request.loads), workers, max_seconds, known)
    except INTERRUPTIONS as stopped:
        if getattr(stopped, "curve", None) is None:
            raise
        data, stop = vars(stopped)["curve"], stopped
    except ConvergenceError as failed:
        if kept is not None and (solved := getattr(failed, "curve", None)) is not None:
            kept.save(solved)
            click.echo(f"weier: what is solved is in {kept.part}, from which the same command goes on", err=True)
        raise
    done = np.isin(request.loads, data["mean_pressure"].values)
    in_order, where = request.with_units(data.sel(mean_pressure=request.loads[done])), "printed"
    if kept is None:
        click.echo(result.as_csv(in_order) if csv else result.as_json(in_order))
    elif stop is None:
        kept.finish(data, in_order)
    else:
        kept.save(data)
        where = f"in {kept.part}{', from which the same command goes on' if kept.goes_on else ''}"
    if stop is not None:
        click.echo(f"weier: {done.sum()} of {done.size} loads are solved, and {where}", err=True)
        raise stop
    result.check_solved(data)


@click.command(cls=SolvingCommand, params=one_profile_options(PLOTTED_LOADS))
@click.option("--quantity", type=click.Choice(QUANTITIES), default="compliance", show_default=True)
@FORCE
@output("path", "", ".pdf", ".svg", ".png", required=False)
def plot(
    path: Path | None,
    force: bool,
    quantity: str,
    methods: Sequence[str],
    tolerance: float | None,
    settings: dict[str, Any],
    workers: int,
    **options: Any,
) -> None:
    """Draw the curves of one profile.

    PATH ends in .png, .pdf or .svg; without such an end, the figure is written in all three formats. Without PATH, it
    is a PNG file with the name of the quantity.

    \b
    weier plot -D 1.25 --gamma 5 -m 3
    weier plot -D 1.25 --gamma 5 -m 3 --phases 1 curves.png
    weier plot -D 1.5 --gamma 3 -m 2 --quantity resistance --method layer --method patches resistance.pdf
    weier plot --trace shaft.csv --si bodies.yaml --pressures 1:100:40MPa --quantity resistance ohms.png
    """  # noqa: D301 - click wants the character
    from weier.cli import result
    from weier.figures import METADATA, draw  # matplotlib takes half a second, and only some commands need it
    from weier.pipeline.single import solve_one

    path = path or Path(f"{quantity}.png")
    formats = [path.suffix[1:]] if path.suffix else list(METADATA)
    for suffix in formats:
        check_free(path.with_suffix(f".{suffix}"), force)
    request = _request(wanted={}, **options)
    if (count := np.unique(request.loads).size) < MIN_LOADS:
        raise click.BadParameter(
            f"a curve takes at least {MIN_LOADS} loads, got {count}: give a range, such as {LOADS}",
            param_hint="--loads",
        )
    case = _case(PLOTTED, request, methods, tolerance, settings)
    data = solve_one(case, np.unique(request.loads), workers)
    if request.bodies:
        data = data.assign_coords(mean_pressure=request.with_units(data)["mean_pressure"])
    figure = Figure(quantity, interface=request.bodies)
    draw(figure, [data], path, formats)
    click.echo(f"the figure is in {path}" + ("" if path.suffix else f".{{{','.join(METADATA)}}}"), err=True)
    result.check_solved(data)
