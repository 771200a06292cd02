"""Two bodies on the command line: the file that holds them, and results in SI units."""

from __future__ import annotations

import re
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

from weier.checks import suggestion
from weier.scene.yaml import parse_yaml
from weier.theory.conduction import BODIES, RANGES, Bodies
from weier.units import NONE, WITHOUT, parsed, unit_of

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]  # its stubs are a package more
    import xarray as xr

    from weier.pipeline.interface import Interface

OF_AN_ENSEMBLE = re.compile("_(mean|deviation|numerical_error|standard_error)$")  # the ends of columns for a quantity
INTERFACE = "interface"  # The key of a scene with its bodies.


def read_bodies(path: Path) -> Interface:
    """Return the bodies of a YAML file, of the key `interface` of a scene, or of a data file, which has its scene.

    Values may have units, as in "210 GPa".
    """
    from weier.pipeline.interface import Interface  # xarray takes half a second

    given, known = _given(path), signature(Bodies).parameters
    needed = [name for name, value in known.items() if value.default is value.empty]
    if strange := [name for name in given if name not in known]:
        raise ValueError(
            f"{path} has a key {strange[0]!r}, which is none of {', '.join(known)}{suggestion(strange[0], known)}"
        )
    if missing := [name for name in needed if name not in given]:
        raise ValueError(
            f"{path} must have {', '.join(needed)} and a modulus of each body, and lacks {', '.join(missing)}"
        )
    return Interface(**{name: parsed(name, value, RANGES[name][2]) for name, value in given.items()})


def _given(path: Path) -> dict[str, Any]:
    """Return the values of a file of bodies, as they are written."""
    if path.suffix == ".nc":
        from weier.data import dataset

        with dataset.reading(path) as data:
            if "mu_1" in data.attrs:
                return {name: data.attrs[name] for name in (*BODIES, "lambda_0", "g_0") if name in data.attrs}
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
    """Return the table of curves, or of their mean, with units in its headings."""
    table = data.weier.ensemble() if ensemble else data.weier.table()
    known = {str(name): unit_of(values) for name, values in data.variables.items()}
    named = {name: known.get(name) or known.get(OF_AN_ENSEMBLE.sub("", name)) or NONE for name in table}
    return table.rename(columns={name: f"{name} ({unit})" for name, unit in named.items() if unit not in WITHOUT})
