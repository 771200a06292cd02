"""Text files with heights, or positions and heights, in the columns of one table.

The table is one block of lines. The delimiter and the decimal sign follow from a sample of the lines. One pattern
defines numbers: the message for any other text names its line and the arguments that settle it. Lines above and below
are kept as `Line.left_out`; lines next to the table are refused if they may belong to it.
"""

from __future__ import annotations

import codecs
import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mode
from typing import Any, NamedTuple, NoReturn

import numpy as np

from weier.checks import checked_count, checked_word, shown
from weier.kernels.arrays import Array
from weier.surface.measured import length_units
from weier.surface.measured.artefacts import MAX_HEIGHTS, MIN_HEIGHTS
from weier.surface.measured.line import Line

MAX_BYTES = 2 * 10**8  # 10^6 rows of 200 characters
MARKS = {b"\xff\xfe\0\0": "utf-32", b"\0\0\xfe\xff": "utf-32", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
BINARY = re.compile(rb"[\x00-\x08\x0e-\x19\x1c-\x1f]")  # control characters that no text has
END_OF_FILE = "\x1a"  # written by DOS programs at the end of a text
BLANK = " "  # the delimiter that stands for any blanks between columns
SEPARATORS = (".", ",", " ", "'")  # signs between thousands
TYPOGRAPHIC_SIGNS = {  # ASCII signs in numbers for typographic ones
    **dict.fromkeys(map(ord, "\u2010\u2011\u2012\u2013\u2212\ufe63\uff0d"), "-"),
    **dict.fromkeys(map(ord, "\u00a0\u2007\u2009\u202f\u200b\ufeff\f\v"), " "),
    ord("\u2019"): "'",
}
PREFIXES = "#%!/*; \t"  # characters that precede remarks and headings
MISSING = "nan NaN NAN -nan -NaN -nan(ind) 1.#QNAN -1.#IND NA N/A n/a #N/A #NV NULL null None none BAD bad -- ---"
VALIDITY = re.compile(r"(is[ _]?)?valid(ity)?", re.IGNORECASE)  # heading of a column that marks valid heights
VALID = re.compile(r"1([.,]0*)?|true|yes|valid", re.IGNORECASE)
SEPARATE_SIGNS = frozenset("+-(") | {"plus", "minus", "pos", "neg"}  # signs in a column of their own
SAMPLE_LINES = 200  # approximate number of lines sampled for the signs of a table
END_ROWS = 5  # rows at the start of one column that may be a count, a step or a length
# numbers with all digits in groups of three, and a single group
GROUPED_NUMBER, DIGIT_GROUP = (
    re.compile(r"[+-]?[1-9]\d{0,2}([.,]\d{3})+", re.ASCII),
    re.compile(r"[+-]?\d{1,3}", re.ASCII),
)
TABLE_END_ARGUMENTS = "skip= or rows= for the start or end of the table"


class NotTextError(ValueError):
    """Raised for a file that is not text, but may be in the format of an instrument."""


@dataclass(frozen=True)
class Layout:
    """Layout of a text table as given by the caller; None means: infer from the file.

    skip, rows : lines above the table, and rows in it
    columns : number of the column of heights, from 0, or numbers of the columns of positions and heights
    delimiter, decimal, thousands : signs between columns, before decimals, and between thousands
    encoding : of the file
    comment : prefixes of lines to skip
    missing : further texts for missing heights
    """

    skip: int | None = None
    rows: int | None = None
    columns: tuple[int, ...] | None = None
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
        for name, least in {"skip": 0, "rows": 1}.items():
            if name in own:
                own[name] = checked_count(name, own[name], least)
        for name, choices in {"decimal": (".", ","), "thousands": SEPARATORS}.items():
            if name in own:
                checked_word(name, own[name], choices)
        for name in {"columns", "comment"} & own.keys():
            own[name] = tuple(own[name]) if isinstance(own[name], list | tuple) else (own[name],)
        columns = [checked_count("columns", column, 0) for column in own.get("columns", (0,))]
        if not 1 <= len(set(columns)) == len(columns) <= 2:
            raise ValueError(
                "columns must be the number of the column of heights, from 0, or those of positions and heights, "
                f"got {shown(own['columns'])}"
            )
        if not all(isinstance(mark, str) and mark for mark in own.get("comment", ())):
            raise ValueError(f"comment must be a text, or a list of texts, got {shown(given['comment'])}")
        if own.get("thousands") in (".", ","):
            own.setdefault("decimal", "," if own["thousands"] == "." else ".")
        delimiter = own.get("delimiter", BLANK)
        if not isinstance(delimiter, str) or len(delimiter) != 1 or delimiter.isalnum() or delimiter in "+-.":
            raise ValueError(f"delimiter must be one sign, such as ';', or ' ' for blanks, got {shown(delimiter)}")
        signs = [own[name] for name in ("delimiter", "decimal", "thousands") if name in own]
        if len(set(signs)) < len(signs):
            raise ValueError(f"delimiter, decimal and thousands must differ, got {', '.join(map(shown, signs))}")
        return cls(missing=missing, **own)


def read_columns(path: Path, layout: Layout | None = None) -> Line:
    """Return the line of heights in a file of text.

    Raises
    ------
    NotTextError
        If the file is no text.
    ValueError
        If something in the table is not read, or may or may not belong to it: the message has the number of the line
        and the arguments that settle it.
    """
    layout = layout or Layout()
    text = _text(path, layout.encoding).rstrip(END_OF_FILE).translate(TYPOGRAPHIC_SIGNS)
    lines = [line.strip(" ") if line.strip(" ;,\t") else "" for line in re.split(r"\r*\n|\r", text)]
    return _Table(path, lines if lines[-1] else lines[:-1] or lines, layout).line()


class _Signs(NamedTuple):
    """The signs of a table between columns and in numbers, its words for missing heights, and its numbers."""

    delimiter: str
    decimal: str
    plain: Mapping[int, int | None]
    missing: frozenset[str]
    number: re.Pattern[str]

    @classmethod
    def of(cls, delimiter: str, decimal: str, layout: Layout) -> _Signs:
        sign, thousands = re.escape(decimal), re.escape(layout.thousands or "")
        whole = rf"(?:\d{{1,3}}(?:{thousands}\d{{3}})+|\d+)" if thousands else r"\d+"
        if delimiter == ",":  # No whole number begins with 0, so that this comma precedes decimals.
            whole = rf"(?!0\d){whole}"
        exponent = r"(?:[eEdD](?:[+-]?0*\d{1,2}|-\d{3}))?"  # below 1e100
        number = rf"[+-]?(?:{whole}(?:{sign}\d{'*' if decimal == '.' else '+'})?|{sign}\d+){exponent}"
        missing = frozenset(["", *MISSING.split(), *layout.missing])
        plain = str.maketrans(f"{decimal}dD", ".ee", layout.thousands or "")
        return cls(delimiter, decimal, plain, missing, re.compile(number, re.ASCII))

    def split(self, line: str) -> list[str]:
        """Return the fields of a line, without blanks and quotes around them."""
        if self.delimiter == BLANK:
            return [field.strip('"') for field in line.split()]
        if '"' in line:
            (fields,) = csv.reader([line], delimiter=self.delimiter, skipinitialspace=True)
        else:
            fields = line.split(self.delimiter)
        return [field.strip(" \t") for field in fields] if " " in line or "\t" in line else fields

    def is_number(self, field: str) -> bool:
        return self.number.fullmatch(field) is not None

    def is_known(self, field: str) -> bool:
        return field in self.missing or self.is_number(field)

    def value(self, field: str) -> float | None:
        """Return the value of a text, also with a Fortran exponent; NaN if it is missing, None if it is no number."""
        if self.number.fullmatch(field):
            return float(field.translate(self.plain))
        return math.nan if field in self.missing else None

    def is_row(self, fields: Sequence[str], columns: Sequence[int] | None) -> bool:
        """Return whether these columns of a line, or all, have numbers or words for missing heights."""
        if columns is not None and len(fields) <= max(columns):
            return False
        chosen = fields if columns is None else [fields[column] for column in columns]
        known = all(map(self.is_known, chosen))
        return known and not all(field in ("", "--", "---") for field in chosen)  # a line of signs may be a rule


class _Table:
    """The lines of a file, and the block of them that is the table: the numbers of its lines, from 0."""

    def __init__(self, path: Path, lines: list[str], layout: Layout) -> None:
        self.path, self.lines, self.layout = path, lines, layout
        self.every = [at for at, line in enumerate(lines) if not line.startswith(layout.comment)]
        every = [at for at in self.every if at >= (layout.skip or 0)]
        filled = [at for at in every if lines[at]]
        if not filled:
            raise ValueError(
                f"{path} must have a table of numbers, got no text in {len(lines)} lines: see skip= and comment="
            )
        self.signs, rows = self._find_signs(filled[:: max(len(filled) // SAMPLE_LINES, 1)])
        self.width = mode(map(len, rows))
        columns = list(zip(*(row for row in rows if len(row) == self.width), strict=True))
        # A delimiter may stand at the end of each row.
        self.count = 1 + max(at for at, column in enumerate(columns) if any(column))
        words = [sum(not self.signs.is_row([field], None) for field in column if field) for column in columns]
        self.of_numbers = [column for column, number in enumerate(words) if number < len(columns[0]) / 2]
        self.block = self._find_block(every)
        above = lines[: layout.skip or self.block[0]]
        heading = next((line for line in reversed(above) if re.search(r"[^\W_]", line)), "")
        self.cells = self._cells(heading)
        self.columns = self._find_columns()
        if len(self.columns) == 2:
            self.block = [at for at in self.block if lines[at]]

    def line(self) -> Line:
        """Return the heights of the table and their positions, with all that its heading says of them."""
        with_positions = len(self.columns) == 2
        if len(self.block) > MAX_HEIGHTS:
            raise ValueError(
                f"{self.path} must have at most {MAX_HEIGHTS} rows of heights, got {len(self.block)}: "
                f"say rows={MAX_HEIGHTS} or less for a part"
            )
        self._check_neighbours()
        texts = self._texts()
        values = self._values(texts)
        self._check_thousands(texts)
        if with_positions and (gone := np.isnan(values[:, 0])).any():
            remedy = "say columns=1 for heights alone, or rows= or skip= for a part"
            self._refuse(self.block[int(gone.argmax())], "has no position", remedy)
        if not with_positions:
            self._check_ends([text for (text,) in texts], values[:, 0])
        cells = [self.cells[column] for column in self.columns]
        others = (length_units.HEIGHTS, length_units.POSITIONS)[-len(cells) :]
        named = [
            "" if length_units.cell_quantity(cell) == other else length_units.cell_unit(cell)
            for cell, other in zip(cells, others, strict=True)
        ]
        within = set(self.block)
        return Line(
            values[:, -1],
            values[:, 0] if with_positions else None,
            x_units=tuple(filter(None, named[:-1])),
            height_units=tuple(filter(None, named[-1:])),
            numbers=tuple(at + 1 for at in self.block),
            decimals=self._decimals([row[0] for row in texts]) if with_positions else None,
            left_out=tuple(line for at, line in enumerate(self.lines) if line and at not in within),
        )

    def _find_signs(self, sample: Sequence[int]) -> tuple[_Signs, list[list[str]]]:
        """Return the signs that make rows of the most lines, and the fields of these lines."""
        layout, lines = self.layout, self.lines
        found = []
        for delimiter in layout.delimiter or ";\t, ":
            for decimal in layout.decimal or ".,":
                if delimiter not in (decimal, layout.thousands):
                    signs = _Signs.of(delimiter, decimal, layout)
                    found.append(
                        (signs, [at for at in sample if signs.is_row(signs.split(lines[at]), layout.columns)])
                    )
        most = max(len(rows) for _, rows in found)
        if not most:
            remedy = "say columns=, delimiter=, decimal=, thousands= or encoding= if the file has columns of numbers"
            self._refuse(sample[len(sample) // 2], "and the others, are no rows of numbers", remedy)
        (best, rows), *others = [(signs, rows) for signs, rows in found if len(rows) == most]
        commas = [at for at in rows if "," in lines[at]]
        if commas and not layout.delimiter:
            hidden = any((best.delimiter == ",") != (signs.delimiter == ",") for signs, _ in others)
            if best.delimiter == ",":  # Commas may precede decimals as well, as in `1:0,5`.
                hidden |= all(re.search("[:|]", lines[at]) and "." not in lines[at] for at in rows)
                if len(layout.columns or ()) == 1 and not layout.decimal:
                    whole = _Signs.of(BLANK, ",", layout)
                    hidden |= all(whole.is_number(lines[at].strip("\t ")) for at in rows)
            if hidden:
                problem = "has a comma of decimals, between columns or between thousands"
                remedy = "say decimal=',', thousands=',', or delimiter= for the sign between columns"
                self._refuse(commas[0], problem, remedy)
        return best, [best.split(lines[at]) for at in rows]

    def _find_block(self, every: list[int]) -> list[int]:
        """Return the lines from the first row to the last, unless the arguments give them."""
        rows = self.layout.rows
        if self.layout.skip is None:
            every = every[next(n for n, at in enumerate(every) if self._is_row(at)) :]
        counted = [at for at in every if self.lines[at]]
        if rows is not None and len(counted) < rows:
            raise ValueError(f"rows must be at most the {len(counted)} rows of {self.path}, got {rows}")
        last = counted[rows - 1] if rows else next(at for at in reversed(every) if self._is_row(at))
        return [at for at in every if at <= last]

    def _find_columns(self) -> tuple[int, ...]:
        """Return the column of the heights, or the columns of positions and heights."""
        given = self.layout.columns
        if given is None and self.count > 2:
            self._refuse(
                self.block[0],
                f"has {self.count} columns",
                "say columns=(0, 1) for positions and heights in the first two, columns=0 for heights in the first, "
                "or delimiter= or thousands= for a sign that is not between columns",
            )
        if given is not None and max(given) >= self.count:
            raise ValueError(
                f"columns must be numbers from 0 to {self.count - 1}, of {self.count} columns in line "
                f"{self.block[0] + 1} of {self.path}, got {max(given)}: say delimiter= if it has more"
            )
        named = [length_units.cell_quantity(cell) == length_units.POSITIONS for cell in self.cells]
        return given or ((1, 0) if named == [False, True] else tuple(range(self.count)))

    def _texts(self) -> list[list[str]]:
        """Return the fields of the rows in the columns that are read; ValueError if a row has other columns."""
        above = map(self._cells, self.lines[: self.block[0]])
        marks = {at for cells in above for at, cell in enumerate(cells) if VALIDITY.fullmatch(cell)}
        texts = []
        for at in self.block:
            fields = self.signs.split(self.lines[at])
            if not self.lines[at]:
                self._refuse(at, "is empty", "write nan if a height is missing, or leave out the line")
            elif len(fields) != self.width:
                problem = f"has {len(fields)} columns, and most others have {self.width}"
                self._refuse(at, problem, self._arguments(TABLE_END_ARGUMENTS, self.lines[at]))
            elif not SEPARATE_SIGNS.isdisjoint(fields):
                sign = min(SEPARATE_SIGNS & {*fields})
                problem = f"has {sign!r} in a column of its own, which may be the sign of a number"
                self._refuse(at, problem, "write the sign in front of the number, and nan for a missing value")
            elif fields[self.columns[-1]] not in self.signs.missing and not all(
                VALID.fullmatch(fields[mark]) for mark in marks
            ):
                problem = "has a height that is not valid by the column of validity"
                self._refuse(at, problem, "write nan for heights that are not valid, or leave out this column")
            texts.append([fields[column] for column in self.columns])
        return texts

    def _values(self, texts: Sequence[Sequence[str]]) -> Array:
        """Return the numbers in the texts of rows, shape (rows, columns), NaN for missing heights."""
        values = [list(map(self.signs.value, row)) for row in texts]
        for at, row, own in zip(self.block, texts, values, strict=True):
            if None in own:
                wrong = row[own.index(None)]
                self._refuse(at, f"has {shown(wrong)} for a number", self._arguments(TABLE_END_ARGUMENTS, wrong))
        return np.array(values, float)

    def _decimals(self, numbers: Sequence[str]) -> int:
        """Return the largest number of decimals of positions, at the largest of their exponents."""
        parts = [text.lower().replace("d", "e").partition("e") for text in numbers]
        exponents = [int(exponent or 0) for digits, _, exponent in parts if digits.strip("+-0.,")]
        return max(len(digits.partition(self.signs.decimal)[2]) for digits, _, _ in parts) - max(exponents, default=0)

    def _check_neighbours(self) -> None:
        """Refuse a line above or below the table that may belong to it, unless `skip` or `rows` is given."""
        single, (first, last) = len(self.columns) == 1, (self.block[0], self.block[-1])
        above = next((at for at in reversed(self.every) if at < first and (self.lines[at] or single)), None)
        below = next((at for at in self.every if at > last and self.lines[at]), None)
        belongs = self._lacks_height_heading if single else self._may_belong
        if self.layout.skip is None and above is not None and belongs(above):
            remedy = self._arguments(f"skip={first} for headings", self.lines[above])
            self._refuse(above, "stands above the numbers, and may be a heading or a missing height", remedy)
        if self.layout.rows is None and below is not None and (single or self._may_belong(below)):
            remedy = self._arguments(f"rows={len(self.block)} for a remark", self.lines[below])
            self._refuse(below, "stands below the numbers, and may be a remark or a missing height", remedy)

    def _check_thousands(self, texts: Sequence[Sequence[str]]) -> None:
        """Refuse a sign that may precede decimals or separate thousands.

        All digits of a column are in groups of three, and some of its numbers lack the sign, or no other column
        shows that it precedes decimals.
        """
        if self.layout.decimal or self.layout.thousands:
            return
        columns = [[row[at] for row in texts] for at in range(len(self.columns))]
        has_decimals = [any(map(self._has_decimals, column)) for column in columns]
        for column, clear in zip(columns, has_decimals, strict=True):
            if clear or (any(has_decimals) and not any(map(DIGIT_GROUP.fullmatch, column))):
                continue
            row = next((row for row, text in enumerate(column) if GROUPED_NUMBER.fullmatch(text)), None)
            if row is not None:
                problem = f"has a sign of decimals or between thousands in {column[row]!r}"
                sign = self.signs.decimal
                self._refuse(self.block[row], problem, f"say decimal={sign!r} or thousands={sign!r}")

    def _has_decimals(self, text: str) -> bool:
        """Return whether a number has a sign that cannot separate thousands."""
        return self.signs.is_number(text) and not GROUPED_NUMBER.fullmatch(text) and not DIGIT_GROUP.fullmatch(text)

    def _check_ends(self, texts: Sequence[str], values: Array) -> None:
        """Refuse a number at an end of one column that may be a count, a step or a length in place of a height.

        It is about the number of rows, or has other decimals than the rows between the ends, which all have as many.
        """
        rows = np.flatnonzero(~np.isnan(values)).tolist()
        decimals = {row: len(texts[row].partition(self.signs.decimal)[2]) for row in rows}
        usual = {decimals[row] for row in rows[END_ROWS:-1]}
        first = rows[:END_ROWS] if self.layout.skip is None else []
        for row in [*first, *rows[-1:]] if self.layout.rows is None else first:
            count = min(abs(values[row] - number) for number in (len(rows), values.size))
            is_count = values[row] >= MIN_HEIGHTS and count <= END_ROWS
            if is_count or (len(usual) == 1 and decimals[row] not in usual):
                above = f"skip={self.block[0]} if it is a height, or skip={self.block[row] + 1} to leave it out"
                below = f"rows={values.size} if it is a height, or rows={row} to leave it out"
                problem = f"may be a count, a step or a length at an end of {len(rows)} numbers"
                self._refuse(self.block[row], problem, f"say {above if row in first else below}")

    def _is_row(self, at: int) -> bool:
        """Return whether a line has numbers, or words for missing ones, in the columns of numbers."""
        fields = self.signs.split(self.lines[at])
        return len(fields) == self.width and self.signs.is_row(fields, self.of_numbers)

    def _may_belong(self, at: int) -> bool:
        """Return whether a line next to a table has a number, or the same word in all columns."""
        words = self.signs.split(self.lines[at])
        fields = self.signs.split(self.lines[at].lstrip(PREFIXES))
        return any(map(self.signs.is_number, fields)) or (len(words) >= self.width and len(set(words)) == 1)

    def _lacks_height_heading(self, at: int) -> bool:
        """Return whether the cell of a line above the heights contains neither their name nor a unit."""
        cell = self._cells(self.lines[at])[self.columns[0]]
        return length_units.cell_quantity(cell) != length_units.HEIGHTS and not length_units.cell_unit(cell)

    def _cells(self, heading: str) -> list[str]:
        return length_units.heading_cells(heading.lstrip(PREFIXES), self.count, self.signs.delimiter)

    def _arguments(self, where: str, text: str) -> str:
        """Return advice on the arguments that settle a text in or next to the table."""
        number = "decimal= or thousands= for the signs of a number, " if re.search(r"\d", text) else ""
        return (
            f"say {where}, comment= for a remark, delimiter= for columns, {number}"
            f"or missing_value={shown(text)} for a missing height"
        )

    def _refuse(self, at: int, problem: str, remedy: str) -> NoReturn:
        raise ValueError(f"{self.path}, line {at + 1}, {problem}, got {shown(self.lines[at])}: {remedy}")


def _text(path: Path, encoding: str | None) -> str:
    """Return the text of a file, in the given encoding, or UTF-8, UTF-16 with its mark, or old Windows's."""
    with path.open("rb") as file:
        content = file.read(MAX_BYTES + 1)
    own = encoding or next((name for mark, name in MARKS.items() if content.startswith(mark)), None)
    bare = content.rstrip(END_OF_FILE.encode())
    if not own and (first := BINARY.search(bare)):
        line = bare.count(b"\n", 0, first.start()) + 1
        raise NotTextError(
            f"{path} is no text, got the control character {first[0]!r} in line {line}: save the heights as text, "
            "such as the sheet of a workbook as CSV, unpack an archive, leave the character out, or say encoding="
        )
    if len(content) > MAX_BYTES:
        raise ValueError(f"{path} must be a text of at most {MAX_BYTES:.0e} bytes: keep one line of heights in it")
    try:
        return content.decode(own or "utf-8")
    except LookupError:
        known = "encoding must be one that Python knows, as in encoding='latin-1'"
        raise ValueError(f"{known}, got {shown(encoding)}") from None
    except UnicodeError as error:
        if not own:
            return content.removeprefix(codecs.BOM_UTF8).decode("cp1252", "replace")
        raise ValueError(f"encoding must be that of {path}, got {shown(encoding)}: {error}") from None
