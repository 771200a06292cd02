"""Tables of curves: `weier table` writes those of a file, and `weier report` solves several measured lines."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from importlib import import_module
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from weier import units
from weier.cli import options
from weier.cli.options import FILE, FORCE, SI, Output
from weier.data import markdown
from weier.data.curves import CONTACT_PRESSURE
from weier.data.ensembles import CLOSE_CUTOFFS, PERCENTILES
from weier.data.files import replacing, write_text
from weier.methods.curve import QUANTITIES
from weier.scene import Grouping

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from weier.surface.measured.trace import Trace

# Columns of ensembles in a report, and their headings.
COLUMNS = {
    "mean_pressure": "mean pressure",
    "resistance_median": "resistance, median",
    "resistance_percentile_10": "resistance, 10 %",
    "resistance_percentile_90": "resistance, 90 %",
    "resistance_numerical_error": "resistance, numerical error",
    "compliance_median": "compliance, median",
    "contact_fraction_median": "contact fraction, median",
    "contact_pressure_median": "mean pressure of the contacts, median",
}
MAX_DIGITS = 5
TABLES, PICTURES, DATA = (".csv", ".xlsx", ".tex", ".md"), (".png", ".pdf", ".svg"), ".nc"
PACKAGES = {".xlsx": "openpyxl", ".tex": "jinja2"}
# end of a column name that follows the name of a quantity
STATISTIC_SUFFIX = re.compile(f"_(mean|deviation|{'|'.join(PERCENTILES)}|numerical_error)$")


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
        text = str(_table(curves, ensemble).to_csv(index=False))
    if path is None:
        click.echo(text, nl=False)
    else:
        write_text(path, text)
        click.echo(f"the table is in {path}", err=True)


@click.command(
    params=[*options.TRACE_OPTIONS, *options.BODIES_OPTIONS, options.TOLERANCE_OPTION, options.WORKERS_OPTION]
)
@click.argument("files", nargs=-1, required=True, type=FILE)
@click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=Output(*TABLES, *PICTURES, DATA),
    help="Write here, by the suffix: a table as .csv, .xlsx, .tex or .md, a figure as .png, .pdf or .svg, all "
    "curves as .nc; repeatable. By default, the table is printed.",
)
@click.option("--all", "everything", is_flag=True, help="Write tables of all columns and digits, one row per line.")
@FORCE
def report(
    files: Sequence[Path],
    outputs: Sequence[Path],
    everything: bool,
    force: bool,
    bodies: Path | None,
    pressures: str | None,
    tolerance: float | None,
    workers: int,
    **trace_options: Any,
) -> None:
    """Report the contact resistance of measured lines.

    FILES are traces of heights, one line of one surface each. A row of the table has the median of the resistance
    over the lines, its 10 and 90 % percentiles and its largest numerical error, in the unit of the pressures and in
    SI units, rounded to the first digit of the numerical error. After Ctrl-C, it covers the lines solved so far.

    \b
    weier report shaft*.csv --si bodies.yaml --pressures 1:100:20MPa -o report.csv -o report.png
    weier report shaft.csv --x-unit mm --height-unit um --si bodies.yaml --pressures 1,10MPa
    """
    if bodies is None or pressures is None:
        raise click.UsageError("a report needs the two bodies, by --si, and the mean pressures, by --pressures")
    for path in outputs:  # is checked before any file is read
        if path.resolve() in {file.resolve() for file in files}:
            raise click.BadParameter(f"{path} is one of FILES: name another output")
        options.check_free(path, force)
        if path.suffix in PACKAGES:
            import_module(PACKAGES[path.suffix])  # an extra installs it; the error names it
    from weier.cli.call import Call, check_solved  # xarray takes half a second, and the help needs none of it
    from weier.data import dataset

    lines = _lines(files, trace_options)
    call = Call.of(lines, bodies, pressures, tolerance=tolerance)
    if any(path.suffix in PICTURES for path in outputs):
        options.check_line(call.loads)
    curves, stop = call.solve(workers)
    done = curves["compliance"].notnull().all(("solution_method", "mean_pressure")).values
    all_count, lines = len({line.digest for line in lines}), list(compress(lines, done))
    if not lines:
        raise stop or ValueError("no line could be solved at all loads, for the reasons above")
    solved = curves.isel(case=done)
    data, count = call.in_units(solved), len({line.digest for line in lines})
    counted = f"{count} of {all_count}" if count < all_count else f"{count}"
    title = f"{counted} line{'s' * (all_count > 1)}: {', '.join(dict.fromkeys(line.source for line in lines))}"
    frame = _table(data) if everything else _summary(data, count > 1)
    for path in outputs:
        if path.suffix == DATA:
            dataset.write(data, path, title, "solved")
        elif path.suffix in PICTURES:
            call.draw(solved, path, "resistance", Grouping(median_over=("trace",) * (count > 1)))
        else:
            _write_table(frame, path)
    click.echo(title, err=bool(outputs))
    if not outputs:
        click.echo(_markdown(frame), nl=False)
    if stop is not None:
        raise stop
    check_solved(curves)


def _lines(files: Sequence[Path], trace_options: dict[str, Any]) -> list[Trace]:
    """Return the lines of all files; ValueError unless they have one shortest wavelength, within 1 %."""
    from weier.cli.call import traces_of

    lines = [line for file in files for line in traces_of(file, trace_options)]
    shortest = sorted(line.shortest for line in lines)
    if shortest[-1] > (1 + CLOSE_CUTOFFS) * shortest[0]:
        raise ValueError(
            f"lines must have one shortest wavelength, got {shortest[0]:.4g} to {shortest[-1]:.4g} m, two steps of "
            f"each file by default: give {shortest[-1]:.4g} m or more by --shortest, in m or in the unit of positions"
        )
    return lines


def _frame(data: xr.Dataset, ensemble: bool = False) -> pd.DataFrame:
    """Return the table of curves, or of their ensembles, with errors called numerical."""
    found = data.weier.ensemble() if ensemble else data.weier.table()
    return found.rename(columns={f"{name}_error": f"{name}_numerical_error" for name in QUANTITIES})


def _table(data: xr.Dataset, ensemble: bool = False) -> pd.DataFrame:
    """Return the table of curves, or of their ensembles, with units in its headings."""
    return _frame(data, ensemble).rename(columns=lambda name: name + _unit(data, name))


def _unit(data: xr.Dataset, column: str) -> str:
    """Return the end of the heading of a column: its unit in brackets."""
    name = column if column in data.variables else STATISTIC_SUFFIX.sub("", column)
    unit = units.unit_of(data.get("mean_pressure" if name == CONTACT_PRESSURE else name))
    return "" if unit in units.WITHOUT else f" ({unit})"


def _summary(data: xr.Dataset, several: bool) -> pd.DataFrame:
    """Return the table of a report: the columns of `COLUMNS`, rounded by their numerical errors.

    A single line has no percentiles, and its headings name the quantity alone.
    """
    frame, found = _frame(data, ensemble=True), {}
    for name, heading in COLUMNS.items():
        if name in frame and (several or "percentile" not in name):
            errors = frame.get(f"{STATISTIC_SUFFIX.sub('', name)}_numerical_error", 0 * frame[name])
            heading = heading if several else heading.removesuffix(", median")
            found[heading + _unit(data, name)] = list(map(_rounded, frame[name], errors))
    return type(frame)(found)


def _rounded(value: float, error: float) -> float:
    """Return a value rounded to the first digit of its error, and an error to its second; at most five digits."""
    if not (value and math.isfinite(value)):
        return value
    below = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) if error > 0 else MAX_DIGITS
    return float(f"{value:.{min(max(below + 1 + (value == error), 1), MAX_DIGITS)}g}")


def _write_table(frame: pd.DataFrame, path: Path) -> None:
    """Write a table in the format of a suffix."""
    if path.suffix == ".csv":
        write_text(path, frame.to_csv(index=False))
    elif path.suffix == ".tex":
        write_text(path, frame.to_latex(index=False, escape=True, float_format=str))
    elif path.suffix == ".md":
        write_text(path, _markdown(frame))
    else:
        with replacing(path) as temporary, temporary.open("wb") as file:
            frame.to_excel(file, index=False, engine="openpyxl")


def _markdown(frame: pd.DataFrame) -> str:
    head, *rows = ([markdown.plain(str(cell)) for cell in row] for row in (frame, *frame.to_numpy().tolist()))
    return f"{markdown.table(head, rows)}\n"
