"""The table of all variables: their meaning, dimensions and units, and the files, figures and pages that have them.

To add a variable, add a row: batches, files, figures and pages are derived from the table.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from enum import IntEnum
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier import units

# Dimensions of variables.
CASE, LOADS = "case", "mean_pressure"
CURVE = (CASE, "solution_method", LOADS)
RUN = ("case", "solution_method")
EDGES = ("case", "mean_pressure", "edge")
# Phrases that several comments share.
DATUM = "It counts from the undeformed profile whose waves all peak together"
ESTIMATE = " Other methods state an estimate: the documentation has the fraction of numbers within it."
COMPLIANCE_ERROR = (
    "By contact patches it is an a-posteriori bound, evaluated on samples; by boundary elements a "
    "bound that is proved at first touch and was exceeded at no load that was tried."
)
RESISTANCE_ERROR = (
    "By boundary elements it is a bound if that of the compliance is one, from chords of the concave curve."
)
MOMENT = "Its square is the spectral moment m_{}, with wavenumbers in radians per length."
DIVERGES = "Infinite for m = inf, and beyond the range of floats."
# Kinds of content in the terms of ISO 19115, as ACDD requires.
QUALITY, AUXILIARY, LABEL = "qualityInformation", "auxiliaryInformation", "coordinate"


class Status(IntEnum):
    """The status of a curve: solved, or the reason why it is missing."""

    solved = 0
    not_requested = 1
    not_applicable = 2
    not_converged = 3


class Check(IntEnum):
    """The result of a claim of the paper, and of one member of an ensemble: flags of a file.

    not_measured : the data lack what the check needs
    not_decided : the data are there, and do not decide the question
    """

    no = 0
    yes = 1
    not_measured = 2
    not_decided = 3

    @property
    def text(self) -> str:
        """The result in words."""
        return self.name.replace("_", " ")


class Variable(NamedTuple):
    """The description of a variable.

    dims, long_name : its dimensions and meaning
    unit, symbol : the unit of its normalisation, and the symbol of the paper
    dtype, flags : its type, "O" for texts, and the meaning of its numbers
    comment : details beyond the long name, which labels axes
    content : the kind of its content, in the terms of ISO 19115
    optional : whether only files of methods that return it have it
    axis : its name on an axis of a figure, in mathtext
    """

    dims: tuple[str, ...]
    long_name: str
    unit: str = "1"
    symbol: str = ""
    dtype: str = "f8"
    flags: type[IntEnum] | None = None
    comment: str = ""
    content: str = "modelResult"
    optional: bool = False
    axis: str = ""


BOUND = (
    "Bounds theorem (27), widened by the stated error of the solution of the truncated series by contact patches or "
    "boundary elements."
)
SERIES_BOUND = f"{DATUM}, of that series. {BOUND}"
_label = partial(Variable, ("case",), content=LABEL)
_trace_label = partial(_label, optional=True)
_chosen = partial(Variable, ("case",), content=AUXILIARY, optional=True)
_returned = partial(Variable, CURVE, optional=True)


def _bound(side: str, quantity: str, unit: str, comment: str = BOUND) -> Variable:
    return _returned(f"{side} bound on the {quantity} of the infinite series", unit, comment=comment)


VARIABLES = {
    "solution_method": Variable(("solution_method",), "method of solution", dtype="O", content=LABEL),
    "mean_pressure": Variable(
        ("mean_pressure",),
        "mean contact pressure",
        "p_0*",
        "p",
        content=LABEL,
        axis=r"mean pressure $\bar{p}/p_0^{*}$",
    ),
    "term": Variable(("term",), "number of the term, from 0", symbol="n", dtype="i4", content=LABEL),
    "key": _label("digest of the surface, the methods with their settings, and the loads of the case", dtype="O"),
    "surface_key": _label("digest of the surface of the case, without methods and loads", dtype="O"),
    "D": _label("fractal dimension", symbol="D"),
    "gamma": _label("ratio of successive wavelengths", symbol="gamma"),
    "m": _label("number of terms of the series", symbol="m"),
    "phases": Variable(("case", "term"), "phase of each term", "rad", "phi_n", content=LABEL),
    "seed": _label("seed of the phases, where they are random"),
    "trace": _trace_label("name of the file of measured heights, with the line of a map", dtype="O"),
    "trace_digest": _trace_label("digest of the measured heights and of their extension", dtype="O"),
    "trace_ends": _trace_label("extension of the trace beyond its ends", dtype="O"),
    "trace_length": _trace_label("length of the trace of heights, lambda_0", "m"),
    "trace_height": _trace_label("root mean square height of the trace, g_0", "m"),
    "trace_shortest": _trace_label("shortest wavelength of the trace", "m"),
    "trace_detrend": _trace_label("component removed from the heights: mean, tilt or form", dtype="O"),
    "trace_filled": _trace_label("number of missing heights that were interpolated"),
    "trace_hurst": _trace_label("Hurst exponent of a random line", symbol="H"),
    "trace_rolloff": _trace_label("wavelength above which the spectrum of a random line is constant", "m"),
    "total_amplitude": Variable(
        ("case",),
        "sum of the amplitudes of the terms",
        "g_0",
        "G - G_m",
        comment="For a trace: height of the highest point above the mean, its compliance in full contact.",
    ),
    "tail_amplitude": Variable(("case",), "sum of the amplitudes of the terms left out", "g_0", "G_m"),
    "first_contact": Variable(("case",), "compliance at first contact", "g_0"),
    "rms_height": Variable(("case",), "root mean square height", "g_0", comment=MOMENT.format(0)),
    "rms_slope": Variable(
        ("case",), "root mean square slope", "g_0/lambda_0", "h'", comment=f"{MOMENT.format(2)} {DIVERGES}"
    ),
    "rms_curvature": Variable(
        ("case",), "root mean square curvature", "g_0/lambda_0^2", comment=f"{MOMENT.format(4)} {DIVERGES}"
    ),
    "compliance": Variable(
        CURVE,
        "compliance",
        "g_0",
        "h",
        comment=f"{DATUM}; for a trace, from first contact. Persson's theory gives negative values at light loads, "
        "and the theory of 2000 none.",
        axis="compliance $h/g_0$",
    ),
    "resistance": Variable(
        CURVE,
        "specific contact resistance",
        "g_0/p_0*",
        "R",
        comment="The slope dh/dp; in SI units times M and the sum of the resistivities or of 1/k, for heat.",
        axis=r"resistance $(\mathrm{d}h/\mathrm{d}\bar{p})\;p_0^{*}/g_0$",
    ),
    "compliance_lower": _bound("lower", "compliance", "g_0", SERIES_BOUND),
    "compliance_upper": _bound("upper", "compliance", "g_0", SERIES_BOUND),
    "resistance_lower": _bound("lower", "resistance", "g_0/p_0*"),
    "resistance_upper": _bound("upper", "resistance", "g_0/p_0*"),
    "compliance_error": _returned("numerical error of the compliance", "g_0", comment=COMPLIANCE_ERROR + ESTIMATE),
    "resistance_error": _returned(
        "numerical error of the resistance", "g_0/p_0*", comment=RESISTANCE_ERROR + ESTIMATE
    ),
    "indentation": _returned(
        "compliance, counted from first contact",
        "g_0",
        comment="Negative for estimates whose compliance is below that at first contact.",
    ),
    "contact_fraction": _returned("fraction of the surface in contact", symbol="A", axis="contact fraction $A$"),
    "contact_fraction_error": _returned(
        "numerical error of the contact fraction",
        comment="An estimate, by the errors of all edges and the widths of contacts and gaps that may be missing.",
    ),
    "elastic_energy": _returned(
        "elastic energy per area",
        "g_0 p_0*",
        "U",
        comment="The mean of half the pressure times the displacement, which is p h minus the integral of h over p.",
    ),
    "mean_gap": Variable(CURVE, "mean gap", "g_0", "d", comment="The sum of the amplitudes minus the compliance."),
    "area_coefficient": Variable(
        CURVE,
        "coefficient of the contact fraction in p/(E* h')",
        comment="The kappa in A = kappa p/(E* h'), with the contact fraction A, the mean pressure p, the contact "
        "modulus E* = 2 M and the root mean square slope h'. NaN for methods without a contact fraction, "
        "and where h' is infinite.",
    ),
    "patch_count": _returned("contacts in one period, 0 in full contact"),
    "residual": _returned("largest violation of a contact condition", "g_0", content=QUALITY),
    "work": _returned("pairs of FFTs or Newton steps", content=AUXILIARY),
    "points": Variable(RUN, "nodes in one period", content=AUXILIARY, optional=True),
    "second_attempts": Variable(RUN, "loads whose first attempt failed", content=AUXILIARY, optional=True),
    "settings": Variable(RUN, "settings of the method that were used, as JSON", dtype="O", content=AUXILIARY),
    "status": Variable(RUN, "whether there is a curve, or why not", dtype="i1", flags=Status, content=QUALITY),
    "contact_edge": Variable(EDGES, "left and right edge of each contact, in turn", "lambda_0"),
    "chosen_method": _chosen('method that "auto" chose', dtype="O"),
    "chosen_terms": _chosen('terms that the method chosen by "auto" solves'),
    "mean_pressure_error": Variable(
        ("case", "mean_pressure"),
        "largest distance to the load of the requested value",
        "p_0*",
        comment="From the stated error of the requested quantity.",
        content=QUALITY,
        optional=True,
    ),
    "origin": Variable(
        RUN,
        "number of the program and the processor that solved the curve",
        dtype="i2",
        content=AUXILIARY,
        comment="The attribute origin_N of the file describes origin N; -1 where there is no curve.",
        optional=True,
    ),
    "seconds": Variable(
        RUN,
        "time to solve all loads",
        "s",
        content=AUXILIARY,
        comment="It differs from run to run, and is omitted if SOURCE_DATE_EPOCH asks for reproducible bytes.",
        optional=True,
    ),
}

COORDINATES = tuple(name for name, entry in VARIABLES.items() if entry.content == LABEL)


def curve_variables(returned: Collection[str], edges: bool) -> list[str]:
    """Return the names of the variables of a file, given the results of its methods and whether it keeps edges."""
    return [
        name
        for name, entry in VARIABLES.items()
        if (not entry.optional or name in returned) and (edges or entry.dims != EDGES)
    ]


def blank(name: str, shape: Sequence[int]) -> NDArray[Any]:
    """Return missing values: NaN, an empty text, no origin, or the status of a curve that was not requested."""
    dtype = VARIABLES[name].dtype
    nothing: Any = Status.not_requested if name == "status" else {"f": np.nan, "i": -1}.get(dtype[0], "")
    return np.full(shape, nothing, dtype)


def attributes(name: str, unit: str = "") -> dict[str, Any]:
    """Return the CF attributes of a variable in a file; `unit` overrides that of the table."""
    entry = VARIABLES[name] if not unit else VARIABLES[name]._replace(unit=unit)
    known: dict[str, Any] = units.described(entry.long_name, entry.unit) | {"coverage_content_type": entry.content}
    if entry.dtype != "f8":  # texts and counts have no units
        del known["units"]
    known |= {attribute: text for attribute, text in (("symbol", entry.symbol), ("comment", entry.comment)) if text}
    return known | (flags(entry.flags) if entry.flags else {})


def flags(meanings: type[IntEnum]) -> dict[str, Any]:
    """Return the attributes with the meaning of the numbers of a variable, by the CF conventions."""
    return {"flag_values": np.array(list(meanings), "i1"), "flag_meanings": " ".join(flag.name for flag in meanings)}
