"""Units of length: their names, and how files and arrays name them."""

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

# Patterns of units in headings: in brackets, after a sign, or as the last word.
_NAME = "|".join(sorted(map(re.escape, SPELLINGS), key=len, reverse=True))
_IN_BRACKETS = rf"[\[(]\s*({_NAME}|{'|'.join(BRACKETED)})\s*[\])]"
_BEHIND_A_SIGN = rf"[_/:=]\s*({_NAME})(?=\s|$)"
# The last word is a unit, unless it follows the value of a quantity.
_LAST_WORD = rf"(?:^|(?<![\d.])\s)({_NAME})$"
UNIT = re.compile(f"{_IN_BRACKETS}|{_BEHIND_A_SIGN}|{_LAST_WORD}", re.IGNORECASE)


def units_in(heading: str) -> list[str]:
    """The units that the cells of a heading name: as in `x (mm),z [um]`, `x_mm z_um`, `x in mm; z / um` or `mm um`.

    A cell without a unit has an empty name in the list, unless blanks alone may stand between the cells.
    """
    cells = [cell.strip() for cell in re.split(r"[,;\t]|\s{2,}", heading.strip()) if cell.strip()]
    words = heading.split()
    if len(cells) == 1 and not BRACKETED.keys() & {*words} and all(map(_known, words)):
        return [_known(word) for word in words]
    found = [[_known(next(filter(None, unit.groups()))) for unit in UNIT.finditer(cell)] for cell in cells]
    return found[0] if len(cells) == 1 else [units[-1] if units else "" for units in found]


def length_unit(name: str) -> str:
    """The unit of length for a name in a file or an array; ValueError if it is unknown."""
    known = _known(name.strip())
    if not known:
        raise ValueError(f"the unit of heights and positions must be one of {', '.join(UNITS)}, got {shown(name)}")
    return known


def agreed_unit(what: str, given: Mapping[str, Any], named: Collection[str]) -> str:
    """The common unit that a call and a file or an array name, or none; ValueError if they disagree.

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
    """The unit that a call, a file or an array names; ValueError if none does: see `agreed_unit`."""
    if unit := agreed_unit(what, given, named):
        return unit
    raise ValueError(
        f'{what} must have a unit: name it, as in {list(given)[-1]}="um", or unit="m" for heights and length in m; '
        f"units are {', '.join(UNITS)}"
    )


def _known(name: str) -> str:
    """A unit by one of its spellings; an empty name if it is none."""
    spellings = SPELLINGS | BRACKETED
    return "" if name == "M" else spellings.get(name, spellings.get(name.lower(), ""))
