"""Layout of a table of text: the arguments of the call, and the separators of its numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from weier.checks import checked_count, checked_word, shown
from weier.surface.measured.units import unit_of_cell

BLANK = " "  # The delimiter that stands for any blanks between columns.
SEPARATORS = {".": ".", ",": ",", " ": " \u00a0\u2007\u2009\u202f", "'": "'\u2019"}  # of thousands
DIGITS = re.compile(r"[+\-\u2010-\u2013\u2212\ufe63\uff0d]?[\d.,]*\d[\d.,]*([eEdD][+-]?\d+)?", re.ASCII)
QUOTED = re.compile(r'"[^"]*"')
# Numbers that may have separators between thousands: all their digits are in groups of three.
GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}([.,]\d{3})+", re.ASCII)
GROUP = re.compile(r"[+-]?\d{1,3}", re.ASCII)
FILLED_COLUMN = re.compile(r",0\d", re.ASCII)  # No whole number begins with 0: the comma is a decimal one.


class UnclearError(ValueError):
    """A sign with two readings in a text of a table, as in `0,5`; the message has the arguments that settle it."""

    def __init__(self, problem: str, text: str, remedy: str) -> None:
        super().__init__(f"{problem}, got {shown(text)}: say {remedy}")
        self.text = text


@dataclass(frozen=True)
class Layout:
    """What a call says of a table of text; None where the file itself shall tell.

    skip, rows : lines above the table, and rows in it
    columns : numbers from 0: that of the heights, or those of the positions and of the heights
    valid : number of a column that says which heights are valid, by 1 or true
    delimiter, decimal, thousands : signs between columns, in front of decimals, and between thousands
    encoding : of the file
    comment : prefixes of lines to skip; "" means empty lines
    missing : further texts for missing heights; "" means empty lines
    """

    skip: int | None = None
    rows: int | None = None
    columns: tuple[int, ...] | None = None
    valid: int | None = None
    delimiter: str | None = None
    decimal: str | None = None
    thousands: str | None = None
    encoding: str | None = None
    comment: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()

    @classmethod
    def checked(cls, missing: tuple[str, ...] = (), **given: Any) -> Layout:
        """Return the layout of arguments as of `Trace.read`, which may be None."""
        own = {name: value for name, value in given.items() if value is not None}
        for name, least in {"skip": 0, "rows": 1, "valid": 0}.items():
            if name in own:
                own[name] = checked_count(name, own[name], least)
        if "columns" in own:
            own["columns"] = _checked_columns(own["columns"])
        if "comment" in own:
            own["comment"] = _checked_texts("comment", own["comment"])
        for name, choices in {"decimal": (".", ","), "thousands": tuple(SEPARATORS)}.items():
            if name in own:
                checked_word(name, own[name], choices)
        if own.get("thousands") in (".", ","):
            own.setdefault("decimal", "," if own["thousands"] == "." else ".")
            if own["thousands"] == own["decimal"]:
                raise ValueError(f"thousands must differ from decimal, got {own['decimal']!r} for both")
        sign = own.get("delimiter", BLANK)
        if not isinstance(sign, str) or len(sign) != 1 or sign.isalnum() or sign in "+-.":
            raise ValueError(f"delimiter must be one sign, such as ';', or ' ' for blanks, got {shown(sign)}")
        return cls(missing=missing, **own)


def _checked_columns(columns: Any) -> tuple[int, ...]:
    listed = columns if isinstance(columns, list | tuple) else (columns,)
    numbers = tuple(checked_count("columns", column, 0) for column in listed)
    if not 1 <= len(numbers) <= 2 or len(set(numbers)) < len(numbers):
        raise ValueError(
            f"columns must be the number of the column of heights, from 0, or those of positions and heights, "
            f"got {shown(columns)}"
        )
    return numbers


def _checked_texts(name: str, texts: Any) -> tuple[str, ...]:
    listed = (texts,) if isinstance(texts, str) else texts
    if not isinstance(listed, list | tuple) or not all(isinstance(text, str) for text in listed):
        raise ValueError(f"{name} must be a text, or a list of texts, got {shown(texts)}")
    return tuple(listed)


def find_delimiter(rows: Sequence[str], heading: str, layout: Layout) -> str:
    """Return the sign between the columns of these rows: semicolon, tab, comma or blanks.

    A comma between digits may also stand before decimals. Then other signs in the rows decide, and the heading.

    Raises
    ------
    UnclearError
        If every row has one comma, between digits, and no other sign.
    """
    if layout.delimiter is not None:
        return layout.delimiter
    bare = [QUOTED.sub("_", row) for row in rows]
    if sign := next((sign for sign in ";\t" if any(sign in row for row in bare)), None):
        return sign
    commas = [row for row in bare if "," in row]
    if not commas:
        return "\t" if layout.thousands == BLANK else BLANK
    if any(re.search(r"(?<!\d),|,(?!\d)", row) for row in commas):
        return ","
    if "," in (layout.decimal, layout.thousands) or any(FILLED_COLUMN.search(row) for row in commas):
        return BLANK
    if any(BLANK in row for row in bare):
        return BLANK
    if layout.decimal is None and all(re.search("[:|]", row) and "." not in row for row in bare):
        raise UnclearError("has a comma of decimals or between columns", commas[0], "decimal=',' or delimiter=")
    if layout.decimal == "." or any("." in row or row.count(",") > 1 for row in bare):
        return ","
    if heading.count(",") == 1:
        return ","
    if "," not in heading and unit_of_cell(heading):
        return BLANK
    raise UnclearError("has a comma of decimals or between columns", commas[0], "decimal=',' or delimiter=','")


def find_decimal(columns: Sequence[Sequence[str]], layout: Layout) -> str:
    """Return the sign before decimals in the columns of a table.

    Raises
    ------
    UnclearError
        If it may also be one between thousands: all digits of the table are in groups of three, or those of a column
        in which some numbers are without it.
    """
    if layout.decimal is not None:
        return layout.decimal
    numbers = [number for column in columns for number in column]
    signs = [sign for sign in ".," if any(sign in number for number in numbers)]
    if len(signs) != 1:
        return "."
    (sign,) = signs
    grouped = next(filter(GROUPED.fullmatch, numbers), None)
    mixed = any(_is_grouped(column) and any(map(GROUP.fullmatch, column)) for column in columns)
    if layout.thousands is None and grouped and (mixed or _is_grouped(numbers)):
        remedy = f"decimal={sign!r} or thousands={sign!r}"
        raise UnclearError("has a sign of decimals or between thousands", grouped, remedy)
    return sign


def number_pattern(decimal: str, thousands: str | None) -> re.Pattern[str]:
    """Return a pattern of numbers below 1e100 with these signs, in groups of three digits or without any."""
    whole = r"\d+" if thousands is None else rf"(?:\d{{1,3}}(?:[{SEPARATORS[thousands]}]\d{{3}})+|\d+)"
    sign = re.escape(decimal)
    return re.compile(rf"[+-]?(?:{whole}(?:{sign}\d*)?|{sign}\d+)(?:[eEdD](?:[+-]?0*\d{{1,2}}|-\d{{3}}))?", re.ASCII)


def _is_grouped(numbers: Sequence[str]) -> bool:
    """Return whether numbers have thousands separators: some have groups, the others at most three digits."""
    every = all(GROUPED.fullmatch(number) or GROUP.fullmatch(number) for number in numbers)
    return every and any(map(GROUPED.fullmatch, numbers))
