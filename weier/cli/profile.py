"""One profile: `weier solve` and `weier plot`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from weier.cli.options import INTO, LOADS, PLOTTED_LOADS, SolvingCommand, of_one_profile, output, profile_or_trace
from weier.kernels.arrays import Array
from weier.methods.method import QUANTITIES
from weier.methods.registry import PLOTTED
from weier.methods.settings import with_tolerance
from weier.scene import Figure

if TYPE_CHECKING:
    import xarray as xr

MIN_LOADS = 2  # A line needs two points.


def _solve(
    default: Sequence[str],
    loads: Array,
    methods: Sequence[str],
    tolerance: float | None,
    settings: Mapping[str, Any],
    workers: int,
    **series: Any,
) -> xr.Dataset:
    from weier.pipeline import single  # xarray, as in `solve`

    profile = profile_or_trace(**series)
    if not methods:
        methods, refusals = single.applicable(profile, default, tolerance is not None)
        for refusal in refusals:
            click.echo(refusal, err=True)
    settings = with_tolerance(methods, settings, tolerance)
    return single.solve_one(profile, np.unique(loads), methods, settings, workers)


@click.command(cls=SolvingCommand, params=of_one_profile(LOADS))
@INTO
@click.option("--csv", is_flag=True, help="Print comma-separated values instead of JSON, one row a load.")
def solve(output: Path | None, csv: bool, **options: Any) -> None:
    """Compute the compliance and resistance of one profile.

    Prints JSON to standard output and progress to standard error. Lengths along x are in lambda_0, heights in g_0,
    pressures in p_0*. Loads may come in any order, which the output keeps; netCDF has each once, increasing.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --phases 0,1,2 --loads 0.01,0.1,1
    weier solve -D 1.5 --gamma 5/2 -m 4 --seed 7 --method layer --method patches -o curves.nc
    weier solve -D 1.25 --gamma 5 -m inf --method demelio --loads 1e-3:4:40 -o limit.json
    weier solve -D 1.25 --gamma 5 -m inf --tolerance 1e-3
    weier solve -D 1.25 --gamma 5 -m 3 --method bem --set bem.points_per_wave=256
    weier solve --trace shaft.csv --shortest 0.01 --x-unit mm --height-unit um --loads 0.01:10:20 -o shaft.nc
    weier solve --trace lab.txt --skip 12 --columns 0,2 --decimal , --unit um
    weier solve --trace map.x3p --line 120 --detrend form --missing interpolate
    """  # noqa: D301 - click wants the character
    from weier.cli import result  # xarray takes half a second, and the help of the command needs none of it

    data = _solve((), **options)
    in_order = data.sel(mean_pressure=options["loads"])
    if output is None:
        click.echo(result.as_csv(in_order) if csv else result.as_json(in_order))
    else:
        result.write(in_order if output.suffix in result.TEXTS else data, output)
    result.check_solved(data)


@click.command(cls=SolvingCommand, params=of_one_profile(PLOTTED_LOADS))
@click.option("--quantity", type=click.Choice(QUANTITIES), default="compliance", show_default=True)
@output("path", "", ".pdf", ".svg", ".png", required=False)
def plot(path: Path | None, quantity: str, **options: Any) -> None:
    """Draw the curves of one profile.

    PATH ends in .png, .pdf or .svg; without such an end, the figure is written in all three formats. Without PATH, a
    window shows it, or a PNG file is written where there is no display.

    \b
    weier plot -D 1.25 --gamma 5 -m 3
    weier plot -D 1.25 --gamma 5 -m 3 --phases 1 curves.png
    weier plot -D 1.5 --gamma 3 -m 2 --quantity resistance --method layer --method patches resistance.pdf
    """  # noqa: D301 - click wants the character
    from weier.cli import result
    from weier.figures import METADATA, draw, show  # matplotlib takes half a second, and only some commands need it

    if (count := np.unique(options["loads"]).size) < MIN_LOADS:
        raise click.BadParameter(
            f"a curve takes at least {MIN_LOADS} loads, got {count}: give a range, such as {LOADS}",
            param_hint="--loads",
        )
    data = _solve(PLOTTED, **options)
    if path is None and show(Figure(quantity), [data]):
        return result.check_solved(data)
    path = path or Path(f"{quantity}.png")
    draw(Figure(quantity), [data], path, formats=[path.suffix[1:]] if path.suffix else tuple(METADATA))
    click.echo(f"the figure is in {path}" + ("" if path.suffix else f".{{{','.join(METADATA)}}}"), err=True)
    result.check_solved(data)
