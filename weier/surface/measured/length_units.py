"""Units of length: their names, and their notation in files and arrays."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Mapping
from typing import Any

from weier.checks import checked_word, shown

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
# Further names in files. Names are compared in lower case, except for M, which never stands for a metre.
PREFIXES = {"": "m", "centi": "cm", "milli": "mm", "micro": "um", "nano": "nm", "pico": "pm"}
SPELLINGS = {
    **{name: name for name in UNITS},
    **{prefix + name: unit for prefix, unit in PREFIXES.items() for name in ("meter", "meters", "metre", "metres")},
    **dict.fromkeys(("micron", "microns", "mum"), "um"),
    **dict.fromkeys(("\u00e5", "\u212b", "angstroms", "\u00e5ngstr\u00f6m", "ang"), "angstrom"),
    **dict.fromkeys(("inches",), "inch"),
    **dict.fromkeys(("mils", "thou"), "mil"),
    **dict.fromkeys(("\u00b5in", "\u03bcin", "microinch", "microinches"), "uin"),
}
BRACKETED = {"in": "inch", "a": "angstrom"}  # These are units only in brackets, and words elsewhere.

# Words that may precede a unit in the cell of a heading. Next to any other word, the unit may be a multiple or belong
# to another quantity. A letter x or z decides, as in `position z`.
POSITIONS, HEIGHTS = "x", "z"
POSITION_WORDS = "x|positions?|pos|distance|lateral|length|travel|abscissa|width|weg|l\u00e4nge"
HEIGHT_WORDS = "z|heights?|depth|elevation|profile?|roughness|h\u00f6he|values?|data"
NEUTRAL_WORDS = "y|h|s|r|p|w|raw|measured|filtered|surface|scan|axis|coordinate|primary|waviness|in|units?"
_NAMES = "|".join(sorted(map(re.escape, SPELLINGS), key=len, reverse=True))
CELL = re.compile(
    rf"((?:(?:{POSITION_WORDS}|{HEIGHT_WORDS}|{NEUTRAL_WORDS})\d?(?:[\s_:./,=-]+|$|(?=[\[({{<])))*)"
    rf"(?:[\[({{<]\s*({_NAMES}|{'|'.join(BRACKETED)})\s*[\])}}>]|({_NAMES}))?",
    re.IGNORECASE,
)


def heading_cells(heading: str, columns: int, delimiter: str) -> list[str]:
    """Return the cells of a heading, one for each column of a table; empty ones if it has none.

    They stand between the signs of the table or other ones, as in `x (mm),z [um]`, `x_mm z_um`, `x (mm) z (um)` or
    `mm um`.
    """
    heading = unicodedata.normalize("NFKC", heading)  # signs that look alike, such as micro and mu, become equal
    for cells in (
        heading.split(delimiter) if delimiter != " " else [],
        re.split(r"[,;\t]|\s{2,}", heading),
        re.split(r"(?<=[\])])\s+", heading),
        heading.split(),
    ):
        cells = [cell.strip(" \t\"'") for cell in cells]
        while len(cells) > 1 and not cells[-1]:
            cells.pop()
        if len(cells) == columns:
            return cells
    return [""] * columns


def cell_unit(cell: str) -> str:
    """Return the unit in the cell of a heading; none if it has words other than names of positions and heights."""
    found = CELL.fullmatch(cell)
    return _known((found[2] or found[3] or "").strip()) if found else ""


def cell_quantity(cell: str) -> str:
    """Return what a cell of a heading names: positions, heights, or neither."""
    found = CELL.fullmatch(cell)
    words = re.findall(r"[^\W\d_]+", found[1].casefold()) if found else []
    if (POSITIONS in words) != (HEIGHTS in words):
        return POSITIONS if POSITIONS in words else HEIGHTS
    quantities = ((POSITIONS, POSITION_WORDS), (HEIGHTS, HEIGHT_WORDS))
    return next((name for name, known in quantities for word in words if re.fullmatch(known, word)), "")


def in_words(unit: float) -> str:
    """Return the first name of a unit of length."""
    return next(name for name, size in UNITS.items() if size == unit)


def length_unit(name: str) -> str:
    """Return the unit of length for a name in a file or an array; ValueError if it is unknown."""
    known = _known(name.strip()) or _known(unicodedata.normalize("NFKC", name.strip()))
    if not known:
        raise ValueError(f"the unit of heights and positions must be one of {', '.join(UNITS)}, got {shown(name)}")
    return known


def agreed_unit(what: str, given: Mapping[str, Any], named: Collection[str]) -> str:
    """Return the common unit that a call and a file or an array name, or none; ValueError if they disagree.

    Parameters
    ----------
    what : str
        What the unit is of, in words.
    given : mapping
        Arguments of the call by their names; None where one is left out.
    named : collection of str
        The units that the file or the array names.
    """
    own = {name: checked_word(name, unit, UNITS) for name, unit in given.items() if unit is not None}
    found = [*own.values(), *named]
    if len({UNITS[unit] for unit in found}) > 1:
        sources = [f"{name}={unit!r}" for name, unit in own.items()] + [f"{unit!r} by itself" for unit in named]
        raise ValueError(
            f"{what} must have one unit, got {' and '.join(dict.fromkeys(sources))}: leave out what is wrong"
        )
    return found[0] if found else ""


def known_unit(what: str, given: Mapping[str, Any], named: Collection[str]) -> str:
    """Return the unit that a call, a file or an array names; ValueError if none does: see `agreed_unit`."""
    if unit := agreed_unit(what, given, named):
        return unit
    raise ValueError(
        f'{what} must have a unit: name it, as in {list(given)[-1]}="um", or unit="m" for heights and length in m; '
        f"units are {', '.join(UNITS)}"
    )


def _known(name: str) -> str:
    """Return a unit by one of its spellings; an empty name if it is none."""
    spellings = {**SPELLINGS, **BRACKETED}
    return "" if name == "M" else spellings.get(name, spellings.get(name.lower(), ""))
