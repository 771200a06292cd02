"""Curves of a file for a spreadsheet: `weier table`."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

import click

from weier.cli.options import FILE, STDOUT, output

if TYPE_CHECKING:
    from weier.theory.conduction import Interface


@click.command()
@click.argument("contact", type=FILE)
@output("path", ".csv", default=STDOUT)
@click.option(
    "--si",
    "bodies",
    type=FILE,
    help="Give SI units; this YAML file has the eight values of weier.Interface, as mu_1.",
)
def table(contact: Path, path: Path, bodies: Path | None) -> None:
    """Write the curves of a file as comma-separated values.

    CONTACT is a netCDF file, of a scene or of `weier solve`. The table has one row a load. It goes to PATH or,
    without one or for "-", to standard output.

    \b
    weier table results/paper/contact.nc curves.csv
    weier table curve.nc --si bodies.yaml
    """  # noqa: D301 - click wants the character
    from weier.data import dataset  # xarray takes half a second, and the help of the command needs none of it
    from weier.data.files import write_text

    with dataset.open(contact) as data:
        curves = data if bodies is None else _read_interface(bodies).in_si(data)
        frame = curves.weier.table()
    if bodies is not None:
        units = {name: curves[name].attrs.get("units", "1") for name in frame if name in curves}
        frame = frame.rename(columns={name: f"{name} ({unit})" for name, unit in units.items() if unit != "1"})
    text = str(frame.to_csv(index=False))
    if str(path) == STDOUT:
        click.echo(text, nl=False)
    else:
        write_text(path, text)


def _read_interface(path: Path) -> Interface:
    from weier.data.yaml import parse_yaml
    from weier.theory.conduction import Interface

    given = parse_yaml(path.read_text(encoding="utf-8"))
    names = [field.name for field in fields(Interface)]
    if not isinstance(given, dict) or set(given) != set(names):
        raise ValueError(f"{path} must have the keys {', '.join(names)} and no others")
    return Interface(**given)
