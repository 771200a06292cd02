"""Two bodies on the command line: the file that holds them, and results in SI units."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from weier.data.curves import CONTACT_PRESSURE
from weier.data.ensembles import PERCENTILES
from weier.data.si import INTERFACE_ATTRIBUTES
from weier.methods.curve import QUANTITIES
from weier.scene.yaml import parse_yaml
from weier.units import NONE, WITHOUT, unit_of

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from weier.api.interface import Interface

# end of a column name that follows the name of a quantity
STATISTIC_SUFFIX = re.compile(f"_(mean|deviation|{'|'.join(PERCENTILES)}|numerical_error|standard_error)$")
INTERFACE = "interface"  # key of a scene that holds the bodies


def read_bodies(path: Path) -> Interface:
    """Return the bodies of a YAML file, of the key `interface` of a scene, or of a data file, which has its scene.

    Values may have units, as in "210 GPa".
    """
    from weier.api.interface import Interface  # importing it takes some tenths of a second

    try:
        return Interface.from_texts(_given(path))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _given(path: Path) -> dict[str, Any]:
    """Return the values of a file of bodies, as they are written."""
    if path.suffix == ".nc":
        from weier.data import dataset

        with dataset.open_lazily(path) as data:
            if "mu_1" in data.attrs:
                return {name: data.attrs[name] for name in INTERFACE_ATTRIBUTES if name in data.attrs}
            given = parse_yaml(str(data.attrs.get("scene", "")))
    else:
        given = parse_yaml(path.read_text(encoding="utf-8"))
    given = given if isinstance(given, dict) else {}
    if INTERFACE in given or path.suffix == ".nc":
        given = given.get(INTERFACE)
        if not isinstance(given, dict):
            raise ValueError(f"{path} knows no bodies: its scene has no key {INTERFACE}")
    return given


def table_of(data: xr.Dataset, ensemble: bool = False) -> pd.DataFrame:
    """Return the table of curves, or of their ensembles, with units in headings, and errors called numerical."""
    table = data.weier.ensemble() if ensemble else data.weier.table()
    table = table.rename(columns={f"{name}_error": f"{name}_numerical_error" for name in QUANTITIES})
    known = {str(name): unit_of(values) for name, values in data.variables.items()}
    known[CONTACT_PRESSURE] = known["mean_pressure"]
    named = {name: known.get(name) or known.get(STATISTIC_SUFFIX.sub("", name)) or NONE for name in table}
    return table.rename(columns={name: f"{name} ({unit})" for name, unit in named.items() if unit not in WITHOUT})
