"""Curves of a file for a spreadsheet: `weier table`."""

from __future__ import annotations

from pathlib import Path

import click

from weier.cli.options import FILE, SI, STDOUT, output
from weier.data.files import write_text

SELF = Path("-")  # stands for the data file itself


@click.command()
@click.argument("contact", type=FILE)
@output("path", ".csv", ".nc", default=STDOUT)
@click.option(
    "--si",
    "bodies",
    type=FILE,
    is_flag=False,
    flag_value=SELF,
    help=f"Write SI units. {SI} By default, CONTACT itself, if its scene has an interface.",
)
@click.option(
    "--ensemble",
    is_flag=True,
    help="Write the mean of each ensemble, the cases of a study that differ in phases, seed or file alone, with the "
    "standard deviation and the numerical error.",
)
@click.option("--study", multiple=True, help="Use the cases of this study; repeatable.")
def table(contact: Path, path: Path, bodies: Path | None, ensemble: bool, study: tuple[str, ...]) -> None:
    """Write the curves of a file as a table, also in SI units.

    CONTACT is a netCDF file, of a scene or of `weier solve`, in SI units if the loads of the scene are. The table has
    one row a load. It goes to PATH or, without one or for "-", to standard output.

    \b
    weier table results/paper/contact.nc curves.csv
    weier table results/paper/contact.nc rough.csv --study rough
    weier table curve.nc --si bodies.yaml
    weier table results/paper/contact.nc --ensemble --si bodies.yaml
    weier table results/paper/contact.nc ohms.csv --si bodies.yaml
    weier table curve.nc ohms.nc --si bodies.yaml
    """  # noqa: D301 - click wants the character
    from weier.cli.bodies_file import read_bodies, table_of
    from weier.data import dataset  # xarray takes half a second, and the help of the command needs none of it
    from weier.data.selection import as_cases

    with dataset.open_dataset(contact) as data:
        curves = data.weier.cases(study=list(study)) if study else as_cases(data)
        if bodies is not None and not (bodies == SELF and "mu_1" in data.attrs):
            curves = read_bodies(contact if bodies == SELF else bodies).in_si(curves)
        if path.suffix == ".nc":
            curves = curves.drop_vars("case", errors="ignore").load()
            return dataset.write(
                curves, path, data.attrs.get("title", contact.stem), "converted", data.attrs.get("scene", "")
            )
        text = str(table_of(curves, ensemble).to_csv(index=False))
    if str(path) == STDOUT:
        click.echo(text, nl=False)
    else:
        write_text(path, text)
