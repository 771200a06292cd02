"""Units of length: their names, and their notation in files and arrays."""

from __future__ import annotations

import re
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
SPELLINGS = {
    **{name: name for name in UNITS},
    **dict.fromkeys(("meter", "meters", "metre", "metres"), "m"),
    **dict.fromkeys(("centimeter", "centimeters", "centimetre", "centimetres"), "cm"),
    **dict.fromkeys(("millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
    **dict.fromkeys(("micrometer", "micrometers", "micrometre", "micrometres", "micron", "microns", "mum"), "um"),
    **dict.fromkeys(("nanometer", "nanometers", "nanometre", "nanometres"), "nm"),
    **dict.fromkeys(("picometer", "picometers", "picometre", "picometres"), "pm"),
    **dict.fromkeys(("\u00e5", "\u212b", "angstroms", "\u00e5ngstr\u00f6m", "ang"), "angstrom"),
    **dict.fromkeys(("inches",), "inch"),
    **dict.fromkeys(("mils", "thou"), "mil"),
    **dict.fromkeys(("\u00b5in", "\u03bcin", "microinch", "microinches"), "uin"),
}
BRACKETED = {"in": "inch", "a": "angstrom"}  # These are units only in brackets, and words elsewhere.

# The unit at the end of the cell of a heading: in brackets, after a sign, or as the last word.
_NAME = "|".join(sorted(map(re.escape, SPELLINGS), key=len, reverse=True))
_IN_BRACKETS = rf"[\[({{<]\s*({_NAME}|{'|'.join(BRACKETED)})\s*[\])}}>]"
_BEHIND_A_SIGN = rf"[_/:=]\s*({_NAME})"
_LAST_WORD = rf"(?:^|\s)({_NAME})"
UNIT = re.compile(f"(?:{_IN_BRACKETS}|{_BEHIND_A_SIGN}|{_LAST_WORD})$", re.IGNORECASE)
OTHER_UNIT = re.compile(rf"{_IN_BRACKETS}|(?:^|[\s/*(\[])(?:{_NAME})$", re.IGNORECASE)
# A factor in front of it: an operator with a number, a number in brackets, or a decimal or power of ten.
FACTOR = re.compile(
    r"[x\u00d7*\u00b7/^]\s*[-+]?\d|\d\s*[x\u00d7*\u00b7^]|\d[eE][-+]?\d|[\[({<][^\])}>]*\d|(?<!\d)(10+|\d*[.,]\d+)\W*$"
)
NUMBER_AT_THE_END = re.compile(r"\d\s*$")


def units_of_heading(heading: str, columns: int, delimiter: str) -> list[str]:
    """Return the unit that a heading names for each column of a table, empty where it names none.

    The heading has a cell for each column, between the signs of the table or other ones, as in `x (mm),z [um]`,
    `x_mm z_um`, `x (mm) z (um)` or `mm um`.
    """
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
            return list(map(unit_of_cell, cells))
    return [""] * columns


def unit_of_cell(cell: str) -> str:
    """Return the unit at the end of the cell of a heading; none if a factor or another unit stands before it."""
    found = UNIT.search(cell)
    if found is None:
        return ""
    name = cell[: found.start()]
    is_value = found[1] is None and NUMBER_AT_THE_END.search(name)
    if is_value or FACTOR.search(name) or OTHER_UNIT.search(name):
        return ""
    return _known(next(filter(None, found.groups())))


def in_words(unit: float) -> str:
    """Return the first name of a unit of length."""
    return next(name for name, size in UNITS.items() if size == unit)


def length_unit(name: str) -> str:
    """Return the unit of length for a name in a file or an array; ValueError if it is unknown."""
    known = _known(name.strip())
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
    spellings = SPELLINGS | BRACKETED
    return "" if name == "M" else spellings.get(name, spellings.get(name.lower(), ""))
