"""Curves of a file for a spreadsheet: `weier table`."""

from __future__ import annotations

from pathlib import Path

import click

from weier.cli.options import FILE, SI, output
from weier.data.files import write_text


@click.command()
@click.argument("contact", type=FILE)
@output("path", ".csv", required=False)
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
    """  # noqa: D301 - click wants the character
    from weier.cli.call import read_bodies
    from weier.cli.result import table_of
    from weier.data import dataset  # xarray takes half a second, and the help of the command needs none of it
    from weier.data.selection import as_cases

    with dataset.open_dataset(contact) as data:
        curves = as_cases(data) if bodies is None else read_bodies(bodies).in_si(as_cases(data))
        text = str(table_of(curves, ensemble).to_csv(index=False))
    if path is None:
        click.echo(text, nl=False)
    else:
        write_text(path, text)
