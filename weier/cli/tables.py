"""Tables of curves: `weier table` writes those of a file, and `weier report` solves several measured lines."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from weier import units
from weier.cli import options
from weier.cli.options import FILE, FORCE, SI, Output
from weier.data.ensembles import CLOSE_CUTOFFS
from weier.data.files import write_text
from weier.scene import Grouping

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from weier.surface.measured.trace import Trace

# columns of a report, of those in the table of ensembles
COLUMNS = (
    *("mean_pressure", "cases", "resistance_median", "resistance_percentile_10", "resistance_percentile_90"),
    *("resistance_numerical_error", "compliance_median", "contact_fraction_median", "contact_pressure_median"),
)


@click.command()
@click.argument("contact", type=FILE)
@click.argument("path", type=Output(".csv"), required=False)
@click.option("--si", "bodies", type=FILE, help=f"Write SI units. {SI}")
@click.option(
    "--ensemble",
    is_flag=True,
    help="Write the mean of each ensemble, the cases of a study that differ in phases, seed or file alone, with the "
    "standard deviation and the numerical error.",
)
def table(contact: Path, path: Path | None, bodies: Path | None, ensemble: bool) -> None:
    """Write the curves of a file as a table, also in SI units.

    CONTACT is a netCDF file, of a scene or of `weier solve`, in SI units if the loads of the scene are. The table has
    one row a load. It goes to PATH or, without one, to standard output.

    \b
    weier table results/paper/contact.nc curves.csv
    weier table curve.nc --si bodies.yaml
    weier table results/paper/contact.nc --ensemble --si bodies.yaml
    """
    from weier.cli.call import read_bodies
    from weier.data import dataset  # xarray takes half a second, and the help of the command needs none of it

    with dataset.open_dataset(contact) as data:
        curves = data if bodies is None else read_bodies(bodies).in_si(data)
        frame = curves.weier.ensemble() if ensemble else curves.weier.table()
        text = str(_with_units(frame, curves).to_csv(index=False))
    if path is None:
        click.echo(text, nl=False)
    else:
        write_text(path, text)
        click.echo(f"the table is in {path}", err=True)


@click.command(
    params=[*options.TRACE_OPTIONS, *options.bodies_options(True), options.TOLERANCE_OPTION, options.WORKERS_OPTION]
)
@click.argument("files", nargs=-1, required=True, type=FILE)
@click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=Output(".csv", ".png", ".pdf", ".svg", ".nc"),
    help="Write here, by the suffix: the table as .csv, a figure as .png, .pdf or .svg, all curves as .nc; "
    "repeatable. By default, the table is printed.",
)
@FORCE
def report(
    files: Sequence[Path],
    outputs: Sequence[Path],
    force: bool,
    bodies: Path,
    pressures: str,
    tolerance: float | None,
    workers: int,
    **trace_options: Any,
) -> None:
    """Report the contact resistance of measured lines.

    FILES are traces of heights, one line of one surface each. A row of the table has the median of the resistance
    over the lines, its 10 and 90 % percentiles and its largest numerical error, in the unit of the pressures and in
    SI units. `weier table` makes the tables of each line from a report as .nc. After Ctrl-C, the report covers the
    lines solved so far.

    \b
    weier report shaft*.csv --si bodies.yaml --pressures 1:100:20MPa -o report.csv -o report.png
    weier report shaft.csv --x-unit mm --height-unit um --si bodies.yaml --pressures 1,10MPa
    """
    for path in outputs:  # is checked before any file is read
        if path.resolve() in {file.resolve() for file in files}:
            raise click.BadParameter(f"{path} is one of FILES: name another output")
        options.check_free(path, force)
    from weier.cli.call import Call, check_solved  # xarray takes half a second, and the help needs none of it
    from weier.data import dataset

    lines = _lines(files, trace_options)
    call = Call.of(lines, bodies, pressures, tolerance=tolerance)
    if any(path.suffix not in (".csv", ".nc") for path in outputs):
        call.check_figure()
    curves, stop = call.solve(workers)
    done = curves["compliance"].notnull().all(("solution_method", "mean_pressure")).values
    solved_lines = list(compress(lines, done))
    if not solved_lines:
        raise stop or ValueError("no line could be solved at all loads, for the reasons above")
    solved = curves.isel(case=done)
    data = call.in_units(solved)
    sources = ", ".join(dict.fromkeys(line.source for line in solved_lines))
    title = f"{len(solved_lines)} of {len(lines)} lines: {sources}"
    ensemble = data.weier.ensemble()
    frame = _with_units(ensemble[[name for name in COLUMNS if name in ensemble]], data)
    for path in outputs:
        if path.suffix == ".csv":
            write_text(path, frame.to_csv(index=False))
        elif path.suffix == ".nc":
            dataset.write(data, path, title)
        else:
            call.draw(solved, path, "resistance", Grouping(median_over=("trace",) * (len(solved_lines) > 1)))
    click.echo(title, err=bool(outputs))
    if not outputs:
        click.echo(frame.to_string(index=False, float_format="{:.5g}".format, line_width=100))
    if stop is not None:
        raise stop
    check_solved(curves)


def _lines(files: Sequence[Path], trace_options: dict[str, Any]) -> list[Trace]:
    """Return the distinct lines of all files; ValueError unless they have one shortest wavelength, within 1 %."""
    from weier.cli.call import trace_of

    lines = {line.digest: line for line in (trace_of(file, trace_options) for file in files)}
    shortest = sorted(line.shortest for line in lines.values())
    if shortest[-1] > (1 + CLOSE_CUTOFFS) * shortest[0]:
        raise ValueError(
            f"lines must have one shortest wavelength, got {shortest[0]:.4g} to {shortest[-1]:.4g} m, two steps of "
            f"each file by default: give {shortest[-1]:.4g} m or more by --shortest, in m or in the unit of positions"
        )
    return list(lines.values())


def _with_units(frame: pd.DataFrame, data: xr.Dataset) -> pd.DataFrame:
    """Return a table of curves, or of their ensembles, with units in brackets in its headings."""

    def heading(column: str) -> str:
        # A statistic, such as resistance_median, has the unit of its quantity. contact_pressure is no variable.
        quantities = (str(name) for name in data.variables if column.startswith(str(name)))
        unit = units.unit_of(data[max(quantities, key=len, default="mean_pressure")])
        return column if unit in units.WITHOUT else f"{column} ({unit})"

    return frame.rename(columns=heading)
