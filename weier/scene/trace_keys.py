"""The keys of measured heights: keywords of `weier.Trace.read`, in scenes and on the command line."""

from __future__ import annotations

from typing import Any, NamedTuple

from weier.surface.measured.artefacts import DETREND
from weier.surface.measured.lines import UNITS
from weier.surface.measured.trace import ENDS, MIRRORED


class TraceKey(NamedTuple):
    """A key: its type or its words, its description, and whether it takes a list."""

    kind: Any
    says: str
    several: bool = False


TRACE_KEYS = {
    "against": TraceKey(
        str,
        "File of the other body, which is read as this one: the surface is the sum of both heights, as of "
        "weier.Trace.between.",
    ),
    "shortest": TraceKey(
        float,
        "Shortest wavelength, in m or in x_unit or unit; two steps by default. Several make one case each per file.",
        several=True,
    ),
    "length": TraceKey(float, "Length of the trace if the file does not give it, in m or in x_unit or unit."),
    "ends": TraceKey(ENDS, f"Extension of the trace beyond its ends; {MIRRORED} by default."),
    "unit": TraceKey((*UNITS,), "Unit of positions, length, shortest and heights, overriding the file."),
    "x_unit": TraceKey((*UNITS,), "Unit of positions, length and shortest."),
    "height_unit": TraceKey((*UNITS,), "Unit of heights."),
    "skip": TraceKey(int, "Number of lines above the table of a text file."),
    "rows": TraceKey(int, "Number of rows of the table."),
    "columns": TraceKey(int, "Column of heights, from 0, or columns of positions and heights.", several=True),
    "decimal": TraceKey((".", ","), "Decimal mark."),
    "detrend": TraceKey(
        DETREND,
        "Component removed from the heights: mean, tilt (a straight line, the default) or form (a parabola).",
    ),
    "max_gap": TraceKey(int, "Longest run of missing heights that is interpolated; 0, the default, refuses any."),
    "missing_value": TraceKey(float, "Numbers for missing heights, in the unit of the heights.", several=True),
}
