"""Lines of measured heights, their positions, and the notation of units of length in files and arrays."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from weier.checks import checked_word, shown
from weier.kernels.arrays import Array
from weier.units import unit_of

# The names that calls, scenes and options take, in m. The prefix is the micro sign or the Greek letter mu.
UNITS = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "\u00b5m": 1e-6,
    "\u03bcm": 1e-6,
    "nm": 1e-9,
    "pm": 1e-12,
    "angstrom": 1e-10,
    "inch": 0.0254,
    "mil": 2.54e-5,
    "uin": 2.54e-8,
}
# Further names in files. Names are compared in lower case, but M in a heading never stands for a metre.
PREFIXES = {"": "m", "centi": "cm", "milli": "mm", "micro": "um", "nano": "nm", "pico": "pm"}
SPELLINGS = {
    **{name: name for name in UNITS},
    **{prefix + name: unit for prefix, unit in PREFIXES.items() for name in ("meter", "meters", "metre", "metres")},
    **dict.fromkeys(("micron", "microns"), "um"),
    **dict.fromkeys(("\u00e5", "angstroms"), "angstrom"),
}

# Words that may precede a unit in the cell of a heading. Next to any other word, the unit may be a multiple or belong
# to another quantity. A letter x or z decides, as in `position z`.
POSITIONS, HEIGHTS = "x", "z"
POSITION_WORDS = "x|positions?|pos|distance|lateral|length|travel|abscissa|width|weg|l\u00e4nge"
HEIGHT_WORDS = "z|heights?|depth|elevation|profile?|roughness|h\u00f6he|values?|data"
NEUTRAL_WORDS = "y|h|s|r|p|w|raw|measured|filtered|surface|scan|axis|coordinate|primary|waviness|in|units?"
_NAMES = "|".join(sorted(map(re.escape, SPELLINGS), key=len, reverse=True))
CELL = re.compile(
    rf"((?:(?:{POSITION_WORDS}|{HEIGHT_WORDS}|{NEUTRAL_WORDS})\d?(?:[\s_:./,=-]+|$|(?=[\[({{<])))*)"
    rf"(?:[\[({{<]\s*({_NAMES})\s*[\])}}>]|({_NAMES}))?",
    re.IGNORECASE,
)

# Positions may deviate from equal steps by 1.5 units of their last decimal altogether, as rounded or cut ones do, or
# by the first fraction of a step, but by less than the second one: a row that is left out shifts those behind it by
# a whole step. They must also give the length within the third number.
EQUAL, MAX_ROUNDING, MAX_ERROR = 0.02, 0.4, 0.0075


class Line(NamedTuple):
    """Heights, with their positions and units as far as they are known.

    heights : array, shape (samples,); masked, NaN or None for missing heights
    positions : array, shape (samples,), along the line; None if it has none
    x_unit, height_unit : the units that are named for positions and for heights; empty if none is
    """

    heights: Any
    positions: Any = None
    x_unit: str = ""
    height_unit: str = ""


def line_of_array(heights: Any) -> Line:
    """Return the line of an array: its positions have a scale if they are a coordinate of xarray with a unit."""
    (dim,) = [*getattr(heights, "dims", ())][:1] or [None]
    along = getattr(heights, "coords", {}).get(dim, getattr(heights, "index", None))  # a list has a method index
    x: Any = getattr(along, "values", None)
    are_numbers = x is not None and x.dtype.kind in "iuf"  # times and names are no positions
    x_unit = length_unit(unit_of(along)) if are_numbers else ""
    if are_numbers and not x_unit:
        length_of_steps(x, None)  # refuses rows that are left out
    return Line(heights, x if x_unit else None, x_unit, length_unit(unit_of(heights)))


def length_of_steps(x: Array, length: float | None) -> float:
    """Return the length of a line, the step times the number of heights, from rising positions, which may be rounded.

    ValueError is raised unless the steps are equal and agree with the `length`.
    """
    rows, rise = np.arange(x.size), np.diff(x)
    step = float(np.polyfit(rows, x, 1)[0]) if np.isfinite(x).all() else math.nan
    most = min(MAX_ROUNDING, MAX_ERROR * rows[-1]) * step
    if not (
        step > 0
        and (rise >= 0).all()
        and np.ptp(x - step * rows) <= min(max(EQUAL * step, 1.5 * _last_decimal(x)), most)
    ):
        unknown = ~np.isfinite(x)
        at = int(unknown.argmax() if unknown.any() else np.abs(rise - np.median(rise)).argmax() + 1)
        raise ValueError(
            f"positions must rise in equal steps, got {x[at]} at height {at + 1}: say columns=(1, 0) if those are in "
            'the second column, decimal="," for decimal commas, skip= or rows= for a part of the file, '
            "interpolate the heights at equal steps by numpy.interp, which takes rising positions, or, if no row is "
            "left out, take the heights alone, as in columns=1, with the length"
        )
    own = step * x.size
    if length is not None and abs(length - own) > most:
        raise ValueError(
            f"length must be that of {x.size} steps where positions go from {x[0]:g} to {x[-1]:g}, about {own:.6g}, "
            f"got {length:g}: leave out the length, or take the heights alone, as in columns=1"
        )
    return own if length is None else length


def _last_decimal(x: Array) -> float:
    """Return the unit of the last decimal of numbers, 0 if they have more than nine."""
    for n in range(10):
        if np.allclose(np.rint(x * 10.0**n), x * 10.0**n, rtol=0, atol=1e-4):
            return float(10.0**-n)
    return 0.0


def heading_of(line: str, columns: int, delimiter: str | None) -> list[tuple[str, str]]:
    """Return what each column of a table contains by its heading, and its unit; both empty if it does not say.

    The cells stand between the signs of the table or other ones, as in `x (mm),z [um]`, `x_mm z_um`, `x (mm) z (um)`
    or `mm um`.
    """
    line = unicodedata.normalize("NFKC", line)  # signs that look alike, such as micro and mu, become equal
    for cells in (
        re.split(r"\s*[,;]\s*|\t|\s{2,}|(?<=[\])])\s+", line),
        line.split(delimiter),
        line.split(),
    ):
        cells = [cell.strip(" \t\"'") for cell in cells]
        while len(cells) > 1 and not cells[-1]:
            cells.pop()
        if len(cells) == columns:
            return [*map(_meaning, cells)]
    return [("", "")] * columns


def _meaning(cell: str) -> tuple[str, str]:
    """Return what a cell of a heading names, if it does, and its unit if it has no words but known ones."""
    if not (found := CELL.fullmatch(cell)):
        return "", ""
    words = re.findall(r"[^\W\d_]+", found[1].casefold())
    if (POSITIONS in words) != (HEIGHTS in words):
        words = [POSITIONS if POSITIONS in words else HEIGHTS]
    quantities = ((POSITIONS, POSITION_WORDS), (HEIGHTS, HEIGHT_WORDS))
    named = (name for name, known in quantities for word in words if re.fullmatch(known, word))
    unit = found[2] or found[3] or ""
    return next(named, ""), "" if unit == "M" else length_unit(unit)


def length_unit(name: str) -> str:
    """Return the unit of length for a name in a file or an array, none for none; ValueError if it is unknown."""
    known = SPELLINGS.get(unicodedata.normalize("NFKC", name.strip()).lower(), "")
    if name and not known:
        raise ValueError(f"the unit of heights and positions must be one of {', '.join(UNITS)}, got {shown(name)}")
    return known


def known_unit(what: str, given: Mapping[str, Any], named: str = "", required: bool = True) -> str:
    """Return the common unit that the arguments of a call and a file or an array name.

    ValueError is raised if they disagree, or name none, unless none is required: then the unit is empty.
    """
    found = {f"{name}={unit!r}": checked_word(name, unit, UNITS) for name, unit in given.items() if unit is not None}
    found |= {f"{named!r} by itself": named} if named else {}
    if len({UNITS[unit] for unit in found.values()}) > 1:
        raise ValueError(f"{what} must have one unit, got {' and '.join(found)}: leave out what is wrong")
    if required and not found:
        raise ValueError(
            f'{what} must have a unit: name it, as in {list(given)[-1]}="um", or unit="m" for heights and length in '
            f"m; units are {', '.join(UNITS)}"
        )
    return next(iter(found.values()), "")
