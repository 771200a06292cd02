"""Tables of curves: `weier table` writes those of a file, and `weier report` solves several measured lines."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from weier import units
from weier.cli import options
from weier.cli.options import FILE, FORCE, Output
from weier.data.ensembles import CLOSE_CUTOFFS
from weier.data.files import write_text
from weier.scene import Grouping

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

# columns of a report, of those in the table of ensembles
COLUMNS = (
    *("mean_pressure", "cases", "resistance_median", "resistance_percentile_10", "resistance_percentile_90"),
    *("resistance_numerical_error", "compliance_median", "contact_fraction_median", "contact_pressure_median"),
)


@click.command(params=[options.si_option()])
@click.argument("contact", type=FILE)
@click.argument("path", type=Output(".csv"), required=False)
@click.option(
    "--ensemble",
    is_flag=True,
    help="Write the mean of each ensemble, the cases of a study that differ in phases, seed or file alone, with the "
    "standard deviation and the numerical error.",
)
@FORCE
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


@click.command(params=options.solution_options(required=True))
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
def report(files: Sequence[Path], outputs: Sequence[Path], **given: Any) -> None:
    """Report the contact resistance of measured lines.

    FILES are traces of heights, one line of one surface each. A row of the table has the median of the resistance
    over the lines, its 10 and 90 % percentiles and its largest numerical error, in the unit of the pressures and in
    SI units. `weier table` makes the tables of each line from a report as .nc. After Ctrl-C, the report covers the
    lines solved so far.

    \b
    weier report shaft*.csv --si bodies.yaml --pressures 1:100:20MPa -o report.csv -o report.png
    weier report shaft.csv --x-unit mm --height-unit um --si bodies.yaml --pressures 1,10MPa
    """
    if overwritten := {file.resolve() for file in files} & {path.resolve() for path in outputs}:
        raise click.UsageError(f"{overwritten.pop()} is one of FILES: name another output")
    from weier.cli import call  # xarray takes half a second, and the help needs none of it
    from weier.data import dataset

    lines = call.take_lines(files, given)
    shortest = sorted(line.shortest for line in lines)
    if shortest[-1] > (1 + CLOSE_CUTOFFS) * shortest[0]:
        raise ValueError(
            f"lines must have one shortest wavelength, got {shortest[0]:.4g} to {shortest[-1]:.4g} m, two steps of "
            f"each file by default: give {shortest[-1]:.4g} m or more by --shortest, in m or in the unit of positions"
        )
    found = call.solve(lines, drawn=any(path.suffix not in (".csv", ".nc") for path in outputs), **given)
    done = found.curves["compliance"].notnull().all(("solution_method", "mean_pressure")).values
    if not done.any():
        raise found.stopped or ValueError("no line could be solved at all loads, for the reasons above")
    solved, count = found.curves.isel(case=done), int(done.sum())
    data = found.in_units(solved)
    title = ", ".join(dict.fromkeys(line.source for line in compress(lines, done)))
    if len(lines) > 1:
        title = f"{count} of {len(lines)} lines: {title}"
    ensemble = data.weier.ensemble()
    frame = _with_units(ensemble[[name for name in COLUMNS if name in ensemble]], data)
    for path in sorted(outputs, key=lambda path: path.suffix not in (".csv", ".nc")):  # a figure may be refused
        if path.suffix == ".csv":
            write_text(path, frame.to_csv(index=False))
        elif path.suffix == ".nc":
            dataset.write(data, path, title)
        else:
            found.draw(solved, path, "resistance", Grouping(median_over=("trace",) * (count > 1)))
    click.echo(title, err=bool(outputs))
    if not outputs:
        click.echo(frame.to_string(index=False, float_format="{:.5g}".format, line_width=100))
    found.check_whole()


def _with_units(frame: pd.DataFrame, data: xr.Dataset) -> pd.DataFrame:
    """Return a table of curves, or of their ensembles, with units in brackets in its headings."""

    def heading(column: str) -> str:
        # A statistic, such as resistance_median, has the unit of its quantity. contact_pressure is no variable.
        quantities = (str(name) for name in data.variables if column.startswith(str(name)))
        unit = units.unit_of(data[max(quantities, key=len, default="mean_pressure")])
        return column if unit in units.WITHOUT else f"{column} ({unit})"

    return frame.rename(columns=heading)
