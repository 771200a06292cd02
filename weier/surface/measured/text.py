"""Text files with heights, or positions and heights, in the columns of one table.

The table is one block of lines. The delimiter and the decimal sign follow from a sample of the lines. One pattern
defines numbers; any other text in the table is refused with its line. Lines next to the table are refused if they may
belong to it. Dialects beyond are for pandas, whose arrays `weier.Trace` takes.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from statistics import mode
from typing import Any, NamedTuple, NoReturn

import numpy as np

from weier.checks import checked_count, checked_word, shown
from weier.kernels.arrays import Array
from weier.surface.measured.artefacts import MIN_HEIGHTS
from weier.surface.measured.lines import HEIGHTS, POSITIONS, Line, cell_quantity, cell_unit, heading_cells

MAX_BYTES = 2 * 10**8  # 10^6 rows of 200 characters
BINARY = re.compile("[\x00-\x08\x0e-\x19\x1c-\x1f]")  # control characters that no text has
BLANK = " "  # the delimiter that stands for any blanks between columns
TYPOGRAPHIC_SIGNS = {  # ASCII signs in numbers for typographic ones
    **dict.fromkeys(map(ord, "\u2010\u2011\u2012\u2013\u2212\ufe63\uff0d"), "-"),
    **dict.fromkeys(map(ord, "\u00a0\u2007\u2009\u202f\u200b\ufeff\f\v"), " "),
    ord("\u2019"): "'",
}
PREFIXES = "#%!/*; \t"  # characters that precede remarks and headings
MISSING = {
    *("nan", "NaN", "NAN", "-nan", "-NaN", "-nan(ind)", "1.#QNAN", "-1.#IND", "NA", "N/A", "n/a", "#N/A", "#NV"),
    *("NULL", "null", "None", "none", "BAD", "bad", "--", "---", ""),
}
RULES = {"", "--", "---"}  # words for missing heights that also form lines above and below a table
VALIDITY = re.compile(r"(is[ _]?)?valid(ity)?", re.IGNORECASE)  # heading of a column that marks valid heights
VALID = re.compile(r"1([.,]0*)?|true|yes|valid", re.IGNORECASE)
QUOTED = re.compile('^"(.*)"$')
SEPARATE_SIGNS = frozenset("+-(") | {"plus", "minus", "pos", "neg"}  # signs in a column of their own
SAMPLE_LINES = 200  # approximate number of lines sampled for the signs of a table
END_ROWS = 5  # rows at the start of one column that may be a count, a step or a length
# numbers with all digits in groups of three, and a single group
GROUPED_NUMBER = re.compile(r"[+-]?[1-9]\d{0,2}([.,]\d{3})+", re.ASCII)
DIGIT_GROUP = re.compile(r"[+-]?\d{1,3}", re.ASCII)
PANDAS = "read the file by pandas.read_csv and pass the arrays to weier.Trace"
OTHERWISE = f"say skip= or rows= for the start or end of the table, or {PANDAS}"


class NotTextError(ValueError):
    """Raised for a file that is not text, but may be in the format of an instrument."""


def read_columns(
    path: Path,
    skip: int | None = None,
    rows: int | None = None,
    columns: int | Sequence[int] | None = None,
    decimal: str | None = None,
) -> Line:
    """Return the line of heights in a file of text, with arguments as of `weier.Trace.read`.

    NotTextError is raised if the file is no text, and ValueError if something in the table is not read, or may or may
    not belong to it; the message has the number of the line and the arguments that settle it.
    """
    if skip is not None:
        skip = checked_count("skip", skip, 0)
    if rows is not None:
        rows = checked_count("rows", rows, 1)
    if decimal is not None:
        checked_word("decimal", decimal, (".", ","))
    chosen = None
    if columns is not None:
        given: Any = columns if isinstance(columns, list | tuple) else [columns]
        chosen = [checked_count("columns", column, 0) for column in given]
        if not 1 <= len(set(chosen)) == len(chosen) <= 2:
            raise ValueError(
                "columns must be the number of the column of heights, from 0, or those of positions and heights, "
                f"got {shown(columns)}"
            )
    text = _text(path).translate(TYPOGRAPHIC_SIGNS)
    lines = [line.strip(" ") if line.strip(" ;,\t") else "" for line in re.split(r"\r*\n|\r", text)]
    return _Table(path, lines if lines[-1] else lines[:-1] or lines, skip, rows, chosen, decimal).line()


class _Signs(NamedTuple):
    """The delimiter and the decimal sign of a table, and the pattern of its numbers."""

    delimiter: str
    decimal: str
    number: re.Pattern[str]

    @classmethod
    def of(cls, delimiter: str, decimal: str) -> _Signs:
        sign = re.escape(decimal)
        # No whole number begins with 0, so that a comma behind it precedes decimals.
        whole = r"(?!0\d)\d+" if delimiter == "," else r"\d+"
        exponent = r"(?:[eEdD](?:[+-]?0*\d{1,2}|-\d{3}))?"  # below 1e100
        number = rf"[+-]?(?:{whole}(?:{sign}\d{'*' if decimal == '.' else '+'})?|{sign}\d+){exponent}"
        return cls(delimiter, decimal, re.compile(number, re.ASCII))

    def split(self, line: str) -> list[str]:
        """Return the fields of a line, without blanks and quotes around them."""
        fields = [field.strip(" \t") for field in line.split(None if self.delimiter == BLANK else self.delimiter)]
        return [QUOTED.sub(r"\1", field) for field in fields] if '"' in line else fields

    def is_number(self, field: str) -> bool:
        return self.number.fullmatch(field) is not None

    def value(self, field: str) -> float | None:
        """Return the value of a text, also with a Fortran exponent; NaN if it is missing, None if it is no number."""
        if self.number.fullmatch(field):
            return float(field.replace(self.decimal, ".").translate({ord("d"): "e", ord("D"): "e"}))
        return math.nan if field in MISSING else None

    def is_row(self, fields: Sequence[str], columns: Sequence[int] | None) -> bool:
        """Return whether these columns of a line, or all, have numbers or words for missing heights."""
        if columns is not None and len(fields) <= max(columns):
            return False
        chosen = fields if columns is None else [fields[column] for column in columns]
        known = all(self.is_number(field) or field in MISSING for field in chosen)
        return known and not RULES.issuperset(chosen)


class _Table:
    """The lines of a file, and the block of them that is the table: the numbers of its lines, from 0."""

    def __init__(
        self,
        path: Path,
        lines: list[str],
        skip: int | None,
        rows: int | None,
        columns: list[int] | None,
        decimal: str | None,
    ) -> None:
        self.path, self.lines, self.skip, self.rows, self.decimal = path, lines, skip, rows, decimal
        every = range(skip or 0, len(lines))
        filled = [at for at in every if lines[at]]
        if not filled:
            raise ValueError(f"{path} must have a table of numbers, got no text in {len(lines)} lines: see skip=")
        self.signs, sample = self._find_signs(filled[:: max(len(filled) // SAMPLE_LINES, 1)], columns)
        self.width = mode(map(len, sample))
        fields = list(zip(*(row for row in sample if len(row) == self.width), strict=True))
        # A delimiter may stand at the end of each row.
        self.count = 1 + max(at for at, column in enumerate(fields) if any(column))
        words = [sum(not self.signs.is_row([field], None) for field in column if field) for column in fields]
        self.of_numbers = [column for column, number in enumerate(words) if number < len(fields[0]) / 2]
        self.block = self._find_block(filled)
        above = lines[: skip or self.block[0]]
        self.cells = self._cells(next((line for line in reversed(above) if re.search(r"[^\W_]", line)), ""))
        self.columns = self._find_columns(columns)
        if len(self.columns) == 2:
            self.block = [at for at in self.block if lines[at]]

    def line(self) -> Line:
        """Return the heights of the table and their positions, with all that its heading says of them."""
        with_positions = len(self.columns) == 2
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
        others = (HEIGHTS, POSITIONS)[-len(cells) :]
        named = [
            "" if cell_quantity(cell) == other else cell_unit(cell) for cell, other in zip(cells, others, strict=True)
        ]
        return Line(
            values[:, -1],
            values[:, 0] if with_positions else None,
            x_units=tuple(filter(None, named[:-1])),
            height_units=tuple(filter(None, named[-1:])),
            numbers=tuple(at + 1 for at in self.block),
        )

    def _find_signs(self, sample: Sequence[int], columns: Sequence[int] | None) -> tuple[_Signs, list[list[str]]]:
        """Return the signs that make rows of the most lines, and the fields of these lines."""
        lines = self.lines
        found = []
        for delimiter in ";\t, ":
            for decimal in self.decimal or ".,":
                if delimiter != decimal:
                    signs = _Signs.of(delimiter, decimal)
                    found.append((signs, [at for at in sample if signs.is_row(signs.split(lines[at]), columns)]))
        most = max(len(rows) for _, rows in found)
        if not most:
            remedy = f"say columns= or decimal= if the file has columns of numbers, or {PANDAS}"
            self._refuse(sample[len(sample) // 2], "and the others, are no rows of numbers", remedy)
        (best, rows), *others = [(signs, rows) for signs, rows in found if len(rows) == most]
        if commas := [at for at in rows if "," in lines[at]]:
            hidden = any((best.delimiter == ",") != (signs.delimiter == ",") for signs, _ in others)
            fields = [best.split(lines[at]) for at in rows]
            read = [row if columns is None else [row[column] for column in columns] for row in fields]
            clear = self.decimal or any("." in field for row in read for field in row if best.is_number(field))
            if hidden or (best.delimiter == "," and not clear):
                problem = "has a comma of decimals, between columns or between thousands"
                remedy = f"say decimal=',' for decimals, decimal='.' for columns of whole numbers, or {PANDAS}"
                self._refuse(commas[0], problem, remedy)
        return best, [best.split(lines[at]) for at in rows]

    def _find_block(self, filled: list[int]) -> list[int]:
        """Return the lines from the first row to the last, unless the arguments give them."""
        first = self.skip if self.skip is not None else next(at for at in filled if self._is_row(at))
        counted = [at for at in filled if at >= first]
        if self.rows is not None and len(counted) < self.rows:
            raise ValueError(f"rows must be at most the {len(counted)} rows of {self.path}, got {self.rows}")
        last = counted[self.rows - 1] if self.rows else next(at for at in reversed(counted) if self._is_row(at))
        return list(range(first, last + 1))

    def _find_columns(self, given: list[int] | None) -> Sequence[int]:
        """Return the column of the heights, or the columns of positions and heights."""
        if given is None and self.count > 2:
            remedy = (
                "say columns=(0, 1) for positions and heights in the first two, columns=0 for heights in the first, "
                f"or {PANDAS} if the sign is not between columns"
            )
            self._refuse(self.block[0], f"has {self.count} columns", remedy)
        if given is not None and max(given) >= self.count:
            raise ValueError(
                f"columns must be numbers from 0 to {self.count - 1}, of {self.count} columns in line "
                f"{self.block[0] + 1} of {self.path}, got {max(given)}"
            )
        named = [cell_quantity(cell) == POSITIONS for cell in self.cells]
        return given or ((1, 0) if named == [False, True] else range(self.count))

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
                self._refuse(at, f"has {len(fields)} columns, and most others have {self.width}", OTHERWISE)
            elif not SEPARATE_SIGNS.isdisjoint(fields):
                sign = min(SEPARATE_SIGNS & {*fields})
                problem = f"has {sign!r} in a column of its own, which may be the sign of a number"
                self._refuse(at, problem, "write the sign in front of the number, and nan for a missing value")
            elif fields[self.columns[-1]] not in MISSING and not all(VALID.fullmatch(fields[mark]) for mark in marks):
                problem = "has a height that is not valid by the column of validity"
                self._refuse(at, problem, "write nan for heights that are not valid, or leave out this column")
            texts.append([fields[column] for column in self.columns])
        return texts

    def _values(self, texts: Sequence[Sequence[str]]) -> Array:
        """Return the numbers in the texts of rows, shape (rows, columns), NaN for missing heights."""
        values = [list(map(self.signs.value, row)) for row in texts]
        for at, row, own in zip(self.block, texts, values, strict=True):
            if None in own:
                problem = f"has {shown(row[own.index(None)])} for a number"
                self._refuse(at, problem, f"write nan for a missing height, {OTHERWISE}")
        return np.array(values, float)

    def _check_neighbours(self) -> None:
        """Refuse a line above or below the table that may belong to it, unless `skip` or `rows` is given."""
        single, (first, last) = len(self.columns) == 1, (self.block[0], self.block[-1])
        above = next((at for at in range(first - 1, -1, -1) if self.lines[at] or single), None)
        below = next((at for at in range(last + 1, len(self.lines)) if self.lines[at]), None)
        belongs = self._lacks_height_heading if single else self._may_belong
        if self.skip is None and above is not None and belongs(above):
            problem = "stands above the numbers, and may be a heading or a missing height"
            self._refuse(above, problem, f"say skip={first} for headings, or write nan for a missing height")
        if self.rows is None and below is not None and (single or self._may_belong(below)):
            problem = "stands below the numbers, and may be a remark or a missing height"
            self._refuse(
                below, problem, f"say rows={len(self.block)} for a remark, or write nan for a missing height"
            )

    def _check_thousands(self, texts: Sequence[Sequence[str]]) -> None:
        """Refuse a sign that may precede decimals or separate thousands.

        All digits of a column are in groups of three, and some of its numbers lack the sign, or no other column
        shows that it precedes decimals.
        """
        columns = list(zip(*texts, strict=True)) if not self.decimal else []
        shown_by = [any(map(self._has_decimals, column)) for column in columns]
        for column, clear in zip(columns, shown_by, strict=True):
            grouped = [row for row, text in enumerate(column) if GROUPED_NUMBER.fullmatch(text)]
            if grouped and not clear and (not any(shown_by) or any(map(DIGIT_GROUP.fullmatch, column))):
                problem = f"has a sign of decimals or between thousands in {column[grouped[0]]!r}"
                remedy = f"say decimal={self.signs.decimal!r} for decimals, or {PANDAS}"
                self._refuse(self.block[grouped[0]], problem, remedy)

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
        first = rows[:END_ROWS] if self.skip is None else []
        for row in [*first, *rows[-1:]] if self.rows is None else first:
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
        return cell_quantity(cell) != HEIGHTS and not cell_unit(cell)

    def _cells(self, heading: str) -> list[str]:
        return heading_cells(heading.lstrip(PREFIXES), self.count, self.signs.delimiter)

    def _refuse(self, at: int, problem: str, remedy: str) -> NoReturn:
        raise ValueError(f"{self.path}, line {at + 1}, {problem}, got {shown(self.lines[at])}: {remedy}")


def _text(path: Path) -> str:
    """Return the text of a file in UTF-16 with a mark, UTF-8 or Windows-1252."""
    if path.stat().st_size > MAX_BYTES:
        raise ValueError(f"{path} must be a text of at most {MAX_BYTES:.0e} bytes: keep one line of heights in it")
    content = path.read_bytes()
    try:
        text = content.decode("utf-16" if content.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig")
    except UnicodeError:
        text = content.removeprefix(b"\xef\xbb\xbf").decode("cp1252", "replace")
    if first := BINARY.search(text):
        line = text.count("\n", 0, first.start()) + 1
        raise NotTextError(
            f"{path} is no text, got the control character {first[0]!r} in line {line}: save the heights as text, "
            f"such as the sheet of a workbook as CSV, unpack an archive, leave the character out, or {PANDAS}"
        )
    return text
