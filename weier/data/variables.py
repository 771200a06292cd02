"""The one table of variables: dimensions, meaning, unit, symbol of the paper and range of each."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

CURVE = ("case", "solution_method", "mean_pressure")
RUN = ("case", "solution_method")
LOADS = ("case", "mean_pressure")
EDGES = ("case", "mean_pressure", "edge")
ROUNDING = 1e-9  # a difference of heights that is 0 may come out this much below
QUALITY, ASIDE, LABEL = "qualityInformation", "auxiliaryInformation", "coordinate"


class Status(IntEnum):
    """Why a curve is there, or is not."""

    solved = 0
    not_requested = 1
    not_applicable = 2
    not_converged = 3


class Variable(NamedTuple):
    """What a variable means, and where there is such a variable.

    dims, long_name : its dimensions and what it is
    unit, symbol : what it is normalised by, and the symbol of the paper
    dtype, least, most, flags : its type ("O" for texts of any length) and range, or what its numbers stand for
    content : what kind of thing it is, in the words of ISO 19115
    only_with : a method, if no other has it
    apart : whether it differs from run to run, and so is kept in a file of its own
    """

    dims: tuple[str, ...]
    long_name: str
    unit: str = "1"
    symbol: str = ""
    dtype: str = "f8"
    least: float | None = None
    most: float | None = None
    flags: type[IntEnum] | None = None
    content: str = "modelResult"
    only_with: str = ""
    apart: bool = False


# Text has a fixed width, so that files of many cases can be joined, compressed and read by any netCDF library.
VARIABLES = {
    "solution_method": Variable(("solution_method",), "method of solution", dtype="U16", content=LABEL),
    "mean_pressure": Variable(("mean_pressure",), "mean contact pressure", "p_0*", "p", least=0, content=LABEL),
    "key": Variable(("case",), "name of the case, a digest of its definition", dtype="U12", content=LABEL),
    "D": Variable(("case",), "fractal dimension", symbol="D", least=1, most=2, content=LABEL),
    "gamma": Variable(("case",), "ratio of successive wavelengths", symbol="gamma", least=1, content=LABEL),
    "m": Variable(("case",), "number of terms of the series", symbol="m", least=1, content=LABEL),
    "phase": Variable(("case", "term"), "phase of each term", "rad", "phi_n", content=LABEL),
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
    "residual": Variable(CURVE, "largest violation of a contact condition", "g_0", least=0, content=QUALITY),
    "work": Variable(CURVE, "pairs of FFTs, dense solutions or Newton steps", least=0, content=ASIDE),
    "points": Variable(RUN, "nodes in one period", least=1, content=ASIDE),
    "settings": Variable(
        RUN, "settings of the solution, those not given at their defaults, as JSON", dtype="U240", content=ASIDE
    ),
    "status": Variable(RUN, "whether and why there is a curve", dtype="i1", flags=Status, content=QUALITY),
    "contact_edge": Variable(EDGES, "left and right edge of each contact, in turn, by method patches", "lambda_0"),
    "planned_method": Variable(
        LOADS, "method that the plan took at this load, for method planned", dtype="U16", content=ASIDE,
        only_with="planned",
    ),
    "planned_terms": Variable(
        LOADS, "terms that it modelled, for method planned", least=1, content=ASIDE, only_with="planned"
    ),
    "planned_points": Variable(
        LOADS, "nodes of its grid in one period, for method planned", least=1, content=ASIDE, only_with="planned"
    ),
    "seconds": Variable(RUN, "time to solve all loads", "s", least=0, content=ASIDE, apart=True),
}  # fmt: skip

COORDINATES = tuple(name for name, entry in VARIABLES.items() if entry.content == LABEL)
COST = ("key", "D", "gamma", "m", "phase", "settings", "seconds")


def of_curves(methods: Collection[str], edges: bool) -> list[str]:
    """The variables of curves by these methods, with the edges of contact or without."""
    return [
        name
        for name, entry in VARIABLES.items()
        if not entry.apart and (not entry.only_with or entry.only_with in methods) and (edges or entry.dims != EDGES)
    ]


def blank(
    name: str, sizes: Mapping[str, int], table: Mapping[str, Variable] = VARIABLES
) -> tuple[tuple[str, ...], NDArray[Any], dict[str, Any]]:
    """Dimensions, values and attributes of a variable with nothing in it yet."""
    entry = table[name]
    shape = [sizes[dim] for dim in entry.dims]
    nothing = {"f8": np.nan, "O": ""}.get(entry.dtype)
    values = np.zeros(shape, entry.dtype) if nothing is None else np.full(shape, nothing, entry.dtype)
    return entry.dims, values, attributes(name, table)


def attributes(name: str, table: Mapping[str, Variable] = VARIABLES) -> dict[str, Any]:
    """The attributes of a variable in a file, by the CF conventions."""
    entry = table[name]
    normalised = entry.unit not in ("1", "rad", "s")
    found: dict[str, Any] = {"long_name": entry.long_name, "units": "1" if normalised else entry.unit}
    found["coverage_content_type"] = entry.content
    if normalised:
        found["normalised_by"] = entry.unit
    if entry.symbol:
        found["symbol"] = entry.symbol
    for attribute, limit in (("valid_min", entry.least), ("valid_max", entry.most)):
        if limit is not None:
            found[attribute] = float(limit)
    return found | (flags(entry.flags) if entry.flags else {})


def flags(meanings: type[IntEnum]) -> dict[str, Any]:
    """The attributes that tell what the numbers of a variable stand for, by the CF conventions."""
    return {
        "flag_values": np.array(list(meanings), "i1"),
        "flag_meanings": " ".join(each.name for each in meanings),
    }
