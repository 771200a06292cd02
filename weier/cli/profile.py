"""One profile: `weier solve` and `weier plot`."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click
import numpy as np
from click.core import ParameterSource

from weier import units
from weier.cli.bodies import read_bodies
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
    of_one_profile,
    output,
    profile_or_trace,
)
from weier.data.bodies import to_normalised
from weier.data.si import marked, with_pressures_in
from weier.data.variables import VARIABLES
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES
from weier.methods.progress import STOPS
from weier.methods.registry import PLOTTED
from weier.methods.settings import with_tolerance
from weier.scene import Figure

if TYPE_CHECKING:
    import xarray as xr

    from weier.api.interface import Interface

ERROR = "mean_pressure_error"


class Request(NamedTuple):
    """One profile and its loads in p_0*, in the order given, with the bodies for SI units.

    pressures : the loads in Pa, and the unit in which they were given; None if they were in p_0*
    found : the loads for values of a quantity, by `weier.find_load`; None if loads were given
    """

    profile: Mapping[str, Any]
    loads: Array
    bodies: Interface | None
    pressures: Pressures | None
    found: xr.Dataset | None

    def with_units(self, data: xr.Dataset) -> xr.Dataset:
        """Return the curves of some or all of the loads, in SI units where there are bodies."""
        if self.found is not None:
            errors = dict(zip(self.loads.tolist(), self.found[ERROR].values.tolist(), strict=True))
            own = [errors[load] for load in data["mean_pressure"].values.tolist()]
            data = marked(data.assign({ERROR: (("case", "mean_pressure"), [own], self.found[ERROR].attrs)}))
        if self.bodies is None:
            return data
        curves = self.bodies.in_si(data)
        if self.pressures is None:
            return curves
        exact = dict(zip(self.loads.tolist(), self.pressures.values.tolist(), strict=True))
        given = [exact[load] for load in data["mean_pressure"].values.tolist()]
        curves = curves.assign_coords(mean_pressure=("mean_pressure", given, curves["mean_pressure"].attrs))
        return with_pressures_in(curves, self.pressures.unit)


def _request(
    loads: Array, bodies: Path | None, pressures: Pressures | None, wanted: Mapping[str, Any], **series: Any
) -> Request:
    """Return the profile and its loads, by the options of a command."""
    from weier.api import inverse  # xarray, as in `solve`
    from weier.pipeline import single

    profile, given = profile_or_trace(**series), click.get_current_context().get_parameter_source
    wanted = {name: text for name, text in wanted.items() if text is not None}
    options = ["pressures"] * (pressures is not None) + ["loads"] * (given("loads") is ParameterSource.COMMANDLINE)
    options += list(wanted)
    if len(options) > 1:
        raise click.UsageError(f"loads are given once, got --{' and --'.join(options)}".replace("_", "-"))
    if pressures is not None and bodies is None:
        raise click.UsageError("--pressures are in Pa: name the two bodies by --si, or take --loads, in p_0*")
    both = None if bodies is None else read_bodies(bodies)
    if not wanted and both is None:
        return Request(profile, loads, None, None, None)
    surface = single.surface_of(profile)
    own = both and both.at(surface)
    if pressures is not None and own:
        loads = own.normalised_pressure(pressures.values)
    if not wanted:
        return Request(profile, loads, both, pressures, None)
    ((name, text),) = wanted.items()
    unit = VARIABLES[name].unit
    if own and unit in own.scales:
        values: Any = listed_in_si(name, text, own.scales[unit][1])
    else:
        values = units.listed(name, text, unit)
    normalised = to_normalised(own, name, unit, values) if own else values
    found = inverse.loads_for(surface, name, normalised, own.scales if own else None)
    return Request(profile, found["mean_pressure"].values, both, None, found)


def _solve(
    default: Sequence[str],
    request: Request,
    methods: Sequence[str],
    tolerance: float | None,
    settings: Mapping[str, Any],
    workers: int,
    max_seconds: float | None = None,
) -> xr.Dataset:
    from weier.pipeline import single

    if not methods:
        methods, refusals = single.applicable(request.profile, default, tolerance is not None)
        for refusal in refusals:
            click.echo(refusal, err=True)
    settings = with_tolerance(methods, settings, tolerance)
    return single.solve_one(request.profile, np.unique(request.loads), methods, settings, workers, max_seconds)


@click.command(cls=SolvingCommand, params=of_one_profile(LOADS))
@INTO
@click.option("--csv", is_flag=True, help="Print comma-separated values instead of JSON, one row per load.")
@FORCE
@MAX_SECONDS
@click.option("--resistance", help="Find the loads for these resistances, in g_0/p_0*, or with --si in ohm m^2.")
@click.option("--compliance", help="Find the loads for these compliances, in g_0, or with --si in m or a unit.")
@click.option("--contact-fraction", help="Find the loads for these contact fractions.")
def solve(
    output: Path | None,
    csv: bool,
    force: bool,
    methods: Sequence[str],
    tolerance: float | None,
    settings: Mapping[str, Any],
    workers: int,
    max_seconds: float | None,
    resistance: str | None,
    compliance: str | None,
    contact_fraction: str | None,
    **options: Any,
) -> None:
    """Compute the compliance and resistance of one profile.

    Prints JSON to standard output and progress to standard error. After Ctrl-C or --max-seconds, the loads that
    patches, bem or auto have solved are printed, or written beside the output, as curve.part.nc for curve.nc. Lengths
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
    weier solve --trace shaft.csv --si bodies.yaml --resistance 1e-10
    weier solve -D 1.25 --gamma 5 -m 3 --contact-fraction 0.01,0.1
    """  # noqa: D301 - click wants the character
    from weier.cli import result  # xarray takes half a second, and the help of the command needs none of it

    wanted = {"resistance": resistance, "compliance": compliance, "contact_fraction": contact_fraction}
    request = _request(wanted=wanted, **options)
    if output is not None:
        check_free(output, force)
    stop = None
    try:
        data = _solve((), request, methods, tolerance, settings, workers, max_seconds)
    except STOPS as stopped:
        if getattr(stopped, "curve", None) is None:
            raise
        data, stop = vars(stopped)["curve"], stopped
    done = np.isin(request.loads, data["mean_pressure"].values)
    in_order = request.with_units(data.sel(mean_pressure=request.loads[done]))
    if output is None:
        click.echo(result.as_csv(in_order) if csv else result.as_json(in_order))
    else:
        path = output if stop is None else _part_beside(output)
        result.write(in_order if output.suffix in result.TEXTS else request.with_units(data), path)
    if stop is not None:
        where = "printed" if output is None else f"in {path}"
        click.echo(f"weier: {done.sum()} of {done.size} loads are solved, and {where}", err=True)
        raise stop
    result.check_solved(data)


def _part_beside(path: Path) -> Path:
    """Return the name of a new file for a part of the curve, such as curve.part.nc for curve.nc."""
    names = (path.with_name(f"{path.stem}.part{number or ''}{path.suffix}") for number in itertools.count())
    return next(name for name in names if not name.exists())


@click.command(cls=SolvingCommand, params=of_one_profile(PLOTTED_LOADS))
@click.option("--quantity", type=click.Choice(QUANTITIES), default="compliance", show_default=True)
@output("path", "", ".pdf", ".svg", ".png", required=False)
def plot(
    path: Path | None,
    quantity: str,
    methods: Sequence[str],
    tolerance: float | None,
    settings: Mapping[str, Any],
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

    request = _request(wanted={}, **options)
    if (count := np.unique(request.loads).size) < MIN_LOADS:
        raise click.BadParameter(
            f"a curve takes at least {MIN_LOADS} loads, got {count}: give a range, such as {LOADS}",
            param_hint="--loads",
        )
    data = _solve(PLOTTED, request, methods, tolerance, settings, workers)
    if request.bodies:
        data = data.assign_coords(mean_pressure=request.with_units(data)["mean_pressure"])
    figure = Figure(quantity, interface=request.bodies)
    path = path or Path(f"{quantity}.png")
    draw(figure, [data], path, formats=[path.suffix[1:]] if path.suffix else tuple(METADATA))
    click.echo(f"the figure is in {path}" + ("" if path.suffix else f".{{{','.join(METADATA)}}}"), err=True)
    result.check_solved(data)
