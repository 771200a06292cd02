"""The data: one table of variables, and the only code that reads and writes netCDF.

A file holds `case` x `method` x `mean_pressure`; what describes a case (D, gamma, m, phase) are coordinates.
Where a number is missing, `status` says why.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import IntEnum
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.files import replacing
from weier.version import VERSION

Array = NDArray[np.float64]

CURVE = ("case", "method", "mean_pressure")
RUN = ("case", "method")


class Status(IntEnum):
    """Why a curve is there, or is not."""

    solved = 0
    not_requested = 1
    not_applicable = 2
    not_converged = 3


class Variable(NamedTuple):
    """What a variable means: dimensions, long name, what it is normalised by, symbol of the paper."""

    dims: tuple[str, ...]
    long_name: str
    unit: str = "1"
    symbol: str = ""
    dtype: str = "f8"


VARIABLES = {
    "method": Variable(("method",), "method of solution", dtype="U16"),
    "mean_pressure": Variable(("mean_pressure",), "mean contact pressure", "p_0*", "p"),
    "key": Variable(("case",), "name of the case, a digest of its definition", dtype="U12"),
    "D": Variable(("case",), "fractal dimension", symbol="D"),
    "gamma": Variable(("case",), "ratio of successive wavelengths", symbol="gamma"),
    "m": Variable(("case",), "number of terms of the series", symbol="m"),
    "phase": Variable(("case", "term"), "phase of each term", "rad", "phi_n"),
    "total_amplitude": Variable(("case",), "sum of the amplitudes of the terms", "g_0", "G - G_m"),
    "tail_amplitude": Variable(("case",), "sum of the amplitudes of the terms left out", "g_0", "G_m"),
    "first_contact": Variable(("case",), "compliance at first contact", "g_0"),
    "compliance": Variable(CURVE, "compliance from the profile whose waves peak together", "g_0", "h"),
    "resistance": Variable(CURVE, "specific contact resistance dh/dp", "g_0/p_0*", "R A/(M (rho_1 + rho_2))"),
    "compliance_lower": Variable(CURVE, "lower bound on the compliance of the endless series", "g_0"),
    "compliance_upper": Variable(CURVE, "upper bound on the compliance of the endless series", "g_0"),
    "resistance_lower": Variable(CURVE, "lower bound on the resistance of the endless series", "g_0/p_0*"),
    "resistance_upper": Variable(CURVE, "upper bound on the resistance of the endless series", "g_0/p_0*"),
    "indentation": Variable(CURVE, "compliance from first contact", "g_0"),
    "contact_fraction": Variable(CURVE, "fraction of the surface in contact"),
    "patch_count": Variable(CURVE, "contacts in one period, 0 in full contact"),
    "residual": Variable(CURVE, "largest violation of a contact condition", "g_0"),
    "work": Variable(CURVE, "pairs of FFTs, dense solutions or Newton steps"),
    "points": Variable(RUN, "nodes in one period"),
    "status": Variable(RUN, "whether and why there is a curve", dtype="i1"),
}  # fmt: skip

CONTACT_EDGE = Variable(
    ("case", "mean_pressure", "edge"), "left and right edge of each contact, in turn, by method patches", "lambda_0"
)
SECONDS = Variable(RUN, "time to solve all loads", "s")

COORDINATES = ("method", "mean_pressure", "key", "D", "gamma", "m", "phase")

NORMALISED = "Lengths along x are in lambda_0, heights in g_0, pressures in p_0* = 2 pi M g_0/lambda_0."
PAPER = (
    "M. Ciavarella, G. Murolo, G. Demelio, J. R. Barber, Elastic contact stiffness and contact resistance for the "
    "Weierstrass profile, J. Mech. Phys. Solids 52 (2004) 1247-1265, doi:10.1016/j.jmps.2003.12.002"
)


def curve(loads: Array, values: Mapping[str, Any], settings: Mapping[str, Any]) -> xr.Dataset:
    """One curve over mean_pressure; scalars among the values, and the settings, become attributes."""
    arrays = {name: value for name, value in values.items() if np.ndim(value) > 0}
    scalars = {name: value for name, value in values.items() if np.ndim(value) == 0}
    data = xr.Dataset({name: (_over_loads(name), value, _attributes(name)) for name, value in arrays.items()})
    data = data.assign_coords(mean_pressure=("mean_pressure", loads, _attributes("mean_pressure")))
    return data.assign_attrs(normalisation=NORMALISED, references=PAPER, **{**settings, **scalars})


def blank(cases: int, methods: Sequence[str], loads: Array, terms: int, edges: int = 0) -> xr.Dataset:
    """Every variable of the table, for so many cases, terms and edges of contact, with nothing in it yet."""
    sizes = {"case": cases, "method": len(methods), "mean_pressure": loads.size, "term": terms, "edge": edges}
    names = [*VARIABLES, *(["contact_edge"] if edges else [])]
    data = xr.Dataset({name: _blank(name, sizes) for name in names}).set_coords(COORDINATES)
    data["status"].values[:] = Status.not_requested
    return data.assign_coords(
        method=("method", list(methods), _attributes("method")),
        mean_pressure=("mean_pressure", loads, _attributes("mean_pressure")),
    )


def blank_cost(cases: int, methods: Sequence[str]) -> xr.Dataset:
    """The seconds of each case and method, with nothing in it yet."""
    sizes = {"case": cases, "method": len(methods)}
    data = xr.Dataset({name: _blank(name, sizes) for name in ("key", "seconds")}).set_coords(["key"])
    return data.assign_coords(method=("method", list(methods), _attributes("method")))


def write(data: xr.Dataset, path: str | Path, title: str) -> None:
    """Write a netCDF file whole or not at all: beside its place first, then renamed."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    data = data.assign_attrs(
        Conventions="CF-1.11, ACDD-1.3",
        title=title,
        source=f"weier {VERSION}",
        history=f"made by weier {VERSION}",
        normalisation=NORMALISED,
        references=PAPER,
    )
    with replacing(path) as beside:
        data.to_netcdf(beside, encoding={name: {"_FillValue": None} for name in data.coords})


def read(path: str | Path) -> xr.Dataset:
    """Read a netCDF file of weier into memory.

    Raises
    ------
    ValueError
        If the file is missing, cut short, or not of this kind.

    """
    try:
        with xr.open_dataset(path, engine="netcdf4") as data:
            data.load()
    except (OSError, ValueError, RuntimeError) as error:
        raise ValueError(f"{path} is not a whole netCDF file: delete it and make it again ({error})") from None
    if "key" not in data.variables:
        raise ValueError(f"{path} is a netCDF file, but not of weier: its cases have no key")
    return data


def _variable(name: str) -> Variable:
    return (VARIABLES | {"contact_edge": CONTACT_EDGE, "seconds": SECONDS})[name]


def _over_loads(name: str) -> tuple[str, ...]:
    return tuple(dim for dim in _variable(name).dims if dim not in RUN)


def _blank(name: str, sizes: Mapping[str, int]) -> tuple[tuple[str, ...], NDArray[Any], dict[str, Any]]:
    variable = _variable(name)
    shape = [sizes[dim] for dim in variable.dims]
    values = np.full(shape, np.nan) if variable.dtype == "f8" else np.zeros(shape, variable.dtype)
    return variable.dims, values, _attributes(name)


def _attributes(name: str) -> dict[str, Any]:
    variable = _variable(name)
    normalised = variable.unit not in ("1", "rad", "s")
    attributes: dict[str, Any] = {
        "long_name": variable.long_name,
        "units": "1" if normalised else variable.unit,
    }
    if normalised:
        attributes["normalised_by"] = variable.unit
    if variable.symbol:
        attributes["symbol"] = variable.symbol
    if name == "status":
        attributes["flag_values"] = np.array(list(Status), "i1")
        attributes["flag_meanings"] = " ".join(status.name for status in Status)
    return attributes
