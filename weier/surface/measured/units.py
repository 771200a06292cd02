"""Units of length: their names, and their notation in files and arrays."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Mapping
from types import MappingProxyType
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
UNIT = re.compile(
    rf"(?:[\[({{<]\s*({_NAME}|{'|'.join(BRACKETED)})\s*[\])}}>]|[_/:=]\s*({_NAME})|(?:^|[\s,;])({_NAME}))$",
    re.IGNORECASE,
)
WORD = re.compile(r"[^\W\d_]+")
# A factor in front of it: an operator with a number, a number in brackets, or a decimal or power of ten.
FACTOR = re.compile(
    r"(?:[\d\s)\]]x|[\u00d7*\u00b7/^])\s*[-+]?\d|\d\s*[x\u00d7*\u00b7^]|\d[eE][-+]?\d|[\[({<][^\])}>]*\d"
    r"|(?<![^\W_])(10+|\d*[.,]\d+)\W*$"
)
NUMBER_AT_THE_END = re.compile(r"(?:^|[^\w.,])[\d.,]*\d\s*$")
# Words for a factor or for another quantity, more words between `in` and the unit, and a cell within the cell.
OTHER = re.compile(
    r"\b(half|quarter|ten|hundred|thousand)s?\b|tenth|hundredth|thousandth|zehntel|hundertstel|tausendstel|dixi.me"
    r"|centi.me|\bmilli.me|\b(per|pro|times|steps?|speed|tip|stylus|radius|filter|lambda)\b|\bof\W*$"
    r"|cut.?off|\u03bb|grenzwelle|spacing|interval|increment|resolution|sampling|wave.?length|bandwidth|uncertainty"
    r"|\b[PRSW](a|q|z|p|v|t|sm|sk|ku)\b|\bin\b(?=.*\w)|[,;].*\w",
    re.IGNORECASE,
)
# Names of positions and of heights. A letter decides, as in `position z`.
OF_POSITIONS = re.compile(r"pos(ition|\b)|distance|lateral|length|travel|abscissa|width|weg\b", re.IGNORECASE)
OF_HEIGHTS = re.compile(r"height|depth|elevation|profile?|roughness|h\u00f6he|value|data", re.IGNORECASE)
POSITIONS, HEIGHTS = "x", "z"
LETTER = re.compile(r"(?<![^\W_])([xz])\d*(?![^\W_])", re.IGNORECASE)


def cells_of_heading(heading: str, columns: int, delimiter: str) -> list[str]:
    """Return the cells of a heading, one for each column of a table; empty ones if it has none.

    They stand between the signs of the table or other ones, as in `x (mm),z [um]`, `x_mm z_um`, `x (mm) z (um)` or
    `mm um`.
    """
    heading = unicodedata.normalize("NFKC", heading)  # of the signs that look alike, as those of micro and mu
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


def unit_of_cell(cell: str) -> str:
    """Return the unit at the end of the cell of a heading; none if it has a factor, another unit or quantity."""
    found = UNIT.search(cell)
    if found is None:
        return ""
    name = cell[: found.start()].replace("_", " ")
    is_value = found[1] is None and NUMBER_AT_THE_END.search(name)
    if is_value or FACTOR.search(name) or OTHER.search(name) or any(map(_known, WORD.findall(name))):
        return ""
    return _known(next(filter(None, found.groups())), BRACKETED)


def quantity_of_cell(cell: str) -> str:
    """Return what a cell of a heading names: positions, heights, or neither."""
    letters = set(map(str.casefold, LETTER.findall(cell)))
    if len(letters) == 1:
        return letters.pop()
    return POSITIONS if OF_POSITIONS.search(cell) else HEIGHTS if OF_HEIGHTS.search(cell) else ""


def in_words(unit: float) -> str:
    """Return the first name of a unit of length."""
    return next(name for name, size in UNITS.items() if size == unit)


def length_unit(name: str) -> str:
    """Return the unit of length for a name in a file or an array; ValueError if it is unknown."""
    known = _known(name.strip(), BRACKETED) or _known(unicodedata.normalize("NFKC", name.strip()), BRACKETED)
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


def _known(name: str, more: Mapping[str, str] = MappingProxyType({})) -> str:
    """Return a unit by one of its spellings; an empty name if it is none."""
    spellings = {**SPELLINGS, **more}
    return "" if name == "M" else spellings.get(name, spellings.get(name.lower(), ""))
