"""Curves of a file for a spreadsheet: `weier table`."""

from __future__ import annotations

from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING

import click

from weier.checks import suggestion
from weier.cli.options import FILE, STDOUT, output
from weier.data.files import write_text
from weier.scene.yaml import number, parse_yaml
from weier.theory.conduction import Bodies

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]  # its stubs are a package more
    import xarray as xr


@click.command()
@click.argument("contact", type=FILE)
@output("path", ".csv", default=STDOUT)
@click.option(
    "--si",
    "bodies",
    type=FILE,
    help="Give SI units; this YAML file has the eight values of weier.Interface, with mu_1 or E_1 for the stiffness "
    "of a body. Traces have their own g_0 and lambda_0.",
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

    with dataset.open_dataset(contact) as data:
        frame = data.weier.table() if bodies is None else _table_in_si(data, bodies)
    text = str(frame.to_csv(index=False))
    if str(path) == STDOUT:
        click.echo(text, nl=False)
    else:
        write_text(path, text)


def _table_in_si(data: xr.Dataset, path: Path) -> pd.DataFrame:
    """The table in SI units, which the headings name, for the bodies of a file; traces have their own scale."""
    from weier.data.selection import as_cases

    data = as_cases(data)
    curves = _read_interface(path).in_si(data)
    units = {name: values.attrs.get("units", "1") for name, values in curves.variables.items()}
    table = curves.weier.table()
    return table.rename(columns={name: f"{name} ({units[name]})" for name in table if units.get(name, "1") != "1"})


def _read_interface(path: Path) -> Bodies:
    """The bodies of a file."""
    given, known = parse_yaml(path.read_text(encoding="utf-8")), signature(Bodies).parameters
    needed = [name for name, value in known.items() if value.default is value.empty]
    given = given if isinstance(given, dict) else {}
    if strange := [name for name in given if name not in known]:
        raise ValueError(
            f"{path} has a key {strange[0]!r}, which is none of {', '.join(known)}{suggestion(strange[0], known)}"
        )
    if missing := [name for name in needed if name not in given]:
        raise ValueError(
            f"{path} must have {', '.join(needed)} and a modulus of each body, and lacks {', '.join(missing)}"
        )
    return Bodies(**{name: number(name, value) for name, value in given.items()})
