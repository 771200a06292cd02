"""The one table of variables: dimensions, meaning, unit, symbol of the paper and range of each."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

CURVE = ("case", "method", "mean_pressure")
RUN = ("case", "method")
LOADS = ("case", "mean_pressure")
ROUNDING = 1e-9  # a difference of heights that is 0 may come out this much below


class Status(IntEnum):
    """Why a curve is there, or is not."""

    solved = 0
    not_requested = 1
    not_applicable = 2
    not_converged = 3


class Variable(NamedTuple):
    """What a variable means: dimensions, long name, what it is normalised by, symbol of the paper, type, range."""

    dims: tuple[str, ...]
    long_name: str
    unit: str = "1"
    symbol: str = ""
    dtype: str = "f8"
    least: float | None = None
    most: float | None = None


# Text has a fixed width, so that files of many cases can be joined, compressed and read by any netCDF library.
VARIABLES = {
    "method": Variable(("method",), "method of solution", dtype="U16"),
    "mean_pressure": Variable(("mean_pressure",), "mean contact pressure", "p_0*", "p", least=0),
    "key": Variable(("case",), "name of the case, a digest of its definition", dtype="U12"),
    "D": Variable(("case",), "fractal dimension", symbol="D", least=1, most=2),
    "gamma": Variable(("case",), "ratio of successive wavelengths", symbol="gamma", least=1),
    "m": Variable(("case",), "number of terms of the series", symbol="m", least=1),
    "phase": Variable(("case", "term"), "phase of each term", "rad", "phi_n"),
    "total_amplitude": Variable(("case",), "sum of the amplitudes of the terms", "g_0", "G - G_m", least=0),
    "tail_amplitude": Variable(("case",), "sum of the amplitudes of the terms left out", "g_0", "G_m", least=0),
    "first_contact": Variable(("case",), "compliance at first contact", "g_0", least=-ROUNDING),
    "compliance": Variable(CURVE, "compliance from the profile whose waves peak together", "g_0", "h", least=0),
    "resistance": Variable(
        CURVE, "specific contact resistance dh/dp", "g_0/p_0*", "R A/(M (rho_1 + rho_2))", least=0
    ),
    "compliance_lower": Variable(
        CURVE, "lower bound on the compliance of the endless series, from where all its waves peak together", "g_0"
    ),
    "compliance_upper": Variable(
        CURVE, "upper bound on the compliance of the endless series, from where all its waves peak together", "g_0"
    ),
    "resistance_lower": Variable(CURVE, "lower bound on the resistance of the endless series", "g_0/p_0*", least=0),
    "resistance_upper": Variable(CURVE, "upper bound on the resistance of the endless series", "g_0/p_0*", least=0),
    "compliance_error": Variable(CURVE, "error of the compliance, estimated or measured", "g_0", least=0),
    "resistance_error": Variable(CURVE, "error of the resistance, estimated or measured", "g_0/p_0*", least=0),
    "indentation": Variable(CURVE, "compliance from first contact", "g_0", least=-ROUNDING),
    "contact_fraction": Variable(CURVE, "fraction of the surface in contact", least=0, most=1),
    "patch_count": Variable(CURVE, "contacts in one period, 0 in full contact", least=0),
    "residual": Variable(CURVE, "largest violation of a contact condition", "g_0", least=0),
    "work": Variable(CURVE, "pairs of FFTs, dense solutions or Newton steps", least=0),
    "points": Variable(RUN, "nodes in one period", least=1),
    "settings": Variable(RUN, "settings of the solution, those not given at their defaults, as JSON", dtype="U240"),
    "status": Variable(RUN, "whether and why there is a curve", dtype="i1"),
}  # fmt: skip

CONTACT_EDGE = Variable(
    ("case", "mean_pressure", "edge"), "left and right edge of each contact, in turn, by method patches", "lambda_0"
)
PLANNED = {
    "planned_method": Variable(LOADS, "method that the plan took at this load, for method planned", dtype="U16"),
    "planned_terms": Variable(LOADS, "terms that it modelled, for method planned", least=1),
    "planned_points": Variable(LOADS, "nodes of its grid in one period, for method planned", least=1),
}
SECONDS = Variable(RUN, "time to solve all loads", "s", least=0)

COORDINATES = ("method", "mean_pressure", "key", "D", "gamma", "m", "phase")
COST = ("key", "D", "gamma", "m", "phase", "settings", "seconds")


def variable(name: str) -> Variable:
    """The entry of a variable in the table."""
    return (VARIABLES | PLANNED | {"contact_edge": CONTACT_EDGE, "seconds": SECONDS})[name]


def blank(name: str, sizes: Mapping[str, int]) -> tuple[tuple[str, ...], NDArray[Any], dict[str, Any]]:
    """Dimensions, values and attributes of a variable with nothing in it yet."""
    entry = variable(name)
    shape = [sizes[dim] for dim in entry.dims]
    values = np.full(shape, np.nan) if entry.dtype == "f8" else np.zeros(shape, entry.dtype)
    return entry.dims, values, attributes(name)


def attributes(name: str) -> dict[str, Any]:
    """The attributes of a variable in a file, by the CF conventions."""
    entry = variable(name)
    normalised = entry.unit not in ("1", "rad", "s")
    found: dict[str, Any] = {"long_name": entry.long_name, "units": "1" if normalised else entry.unit}
    found["coverage_content_type"] = _content(name)
    if normalised:
        found["normalised_by"] = entry.unit
    if entry.symbol:
        found["symbol"] = entry.symbol
    for attribute, limit in (("valid_min", entry.least), ("valid_max", entry.most)):
        if limit is not None:
            found[attribute] = float(limit)
    if name == "status":
        found["flag_values"] = np.array(list(Status), "i1")
        found["flag_meanings"] = " ".join(status.name for status in Status)
    return found


def _content(name: str) -> str:
    """What kind of thing a variable holds, in the words of ISO 19115."""
    if name in COORDINATES:
        return "coordinate"
    if name in ("status", "residual"):
        return "qualityInformation"
    return "auxiliaryInformation" if name in ("settings", "seconds", "work", "points", *PLANNED) else "modelResult"
