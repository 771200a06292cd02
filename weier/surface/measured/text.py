"""Text files with heights, or positions and heights, in the columns of one table.

The table is one block of lines. The delimiter and the decimal sign follow from a sample of the lines. One pattern
defines numbers; any other text in the table is refused with its line. Lines next to the table are refused if they may
belong to it. Dialects beyond are for pandas, whose arrays `weier.Trace` takes. Its parser does not read the table:
with any arguments it fills short rows with NaN, reads 1e400 as infinite and 1.2.3 with points between thousands as
123, and its errors name no line.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from statistics import mode
from typing import Any, NamedTuple, NoReturn

import numpy as np

from weier.checks import checked_count, checked_word, shown
from weier.kernels.arrays import Array
from weier.surface.measured.artefacts import MIN_HEIGHTS
from weier.surface.measured.lines import HEIGHTS, POSITIONS, Line, heading_of

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
QUOTED = re.compile('^"(.*)"$')
MAX_FLAGS = 3  # so few different entries of a column may be signs of numbers, or mark those that are valid
SAMPLE_LINES = 200  # approximate number of lines sampled for the signs of a table
END_ROWS = 5  # rows at the start of one column that may be a count, a step or a length
# numbers with all digits in groups of three
GROUPS_OF_THREE = re.compile(r"[+-]?(\d{1,3}|[1-9]\d{0,2}([.,]\d{3})+)", re.ASCII)
PANDAS = "read the file by pandas.read_csv and pass the arrays to weier.Trace"
OTHERWISE = f"say skip= or rows= for the start or end of the table, or {PANDAS}"


class NotTextError(ValueError):
    """Raised for a file that is not text, but may be in the format of an instrument."""


def read_columns(path: Path, **layout: Any) -> Line:
    """Return the line of heights in a file of text, with `skip`, `rows`, `columns`, `decimal` of `weier.Trace.read`.

    NotTextError is raised if the file is no text, and ValueError if something in the table is not read, or may or may
    not belong to it; the message has the number of the line and the arguments that settle it.
    """
    return _Table(path, **layout).line()


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
        """Return the fields of a line, without blanks and quotes around them; none of an empty line."""
        fields = line.split(None if self.delimiter == BLANK else self.delimiter) if line else []
        fields = [field.strip(" \t") for field in fields]
        return [QUOTED.sub(r"\1", field) for field in fields] if '"' in line else fields

    def is_number(self, field: str) -> bool:
        return self.number.fullmatch(field) is not None

    def are_known(self, fields: Iterable[str]) -> bool:
        """Return whether all fields are numbers or words for missing heights."""
        return all(field in MISSING or self.is_number(field) for field in fields)

    def is_row(self, fields: Sequence[str], columns: Sequence[int] | None) -> bool:
        """Return whether these columns of a line, or all, are known, and not only a rule."""
        if columns is not None:
            fields = [fields[column] for column in columns] if len(fields) > max(columns) else []
        return not RULES.issuperset(fields) and self.are_known(fields)

    def value(self, field: str) -> float:
        """Return the value of a known field, also with a Fortran exponent; NaN if it is missing."""
        return math.nan if field in MISSING else float(field.replace(self.decimal, ".").upper().replace("D", "E"))


class _Table:
    """The lines of a file, and the block of them that is the table: the numbers of its lines, from 0."""

    def __init__(
        self,
        path: Path,
        skip: int | None = None,
        rows: int | None = None,
        columns: int | Sequence[int] | None = None,
        decimal: str | None = None,
    ) -> None:
        self.skip = skip if skip is None else checked_count("skip", skip, 0)
        self.rows = rows if rows is None else checked_count("rows", rows, 1)
        self.decimal = decimal if decimal is None else checked_word("decimal", decimal, (".", ","))
        chosen = _checked_columns(columns)
        text = _text(path).translate(TYPOGRAPHIC_SIGNS)
        lines = [line.strip(" ") if line.strip(" ;,\t") else "" for line in re.split(r"\r*\n|\r", text)]
        self.path, self.lines = path, lines if lines[-1] else lines[:-1] or lines
        filled = [at for at in range(self.skip or 0, len(self.lines)) if lines[at]]
        if not filled:
            raise ValueError(
                f"{path} must have a table of numbers, got no text in {len(self.lines)} lines: see skip="
            )
        self.signs, sample = self._find_signs(filled[:: max(len(filled) // SAMPLE_LINES, 1)], chosen)
        self.width = mode(map(len, sample))
        fields = [*zip(*(row for row in sample if len(row) == self.width), strict=True)]
        # A delimiter may stand at the end of each row.
        self.count = 1 + max(at for at, column in enumerate(fields) if any(column))
        words = [sum(not self.signs.is_row([field], None) for field in column if field) for column in fields]
        self.of_numbers = [column for column, number in enumerate(words) if number < len(fields[0]) / 2]
        self.block = self._find_block(filled)
        above = (line for line in reversed(lines[: self.block[0]]) if re.search(r"[^\W_]", line))
        self.heading = self._heading(next(above, ""))
        self.columns = self._find_columns(chosen)
        if len(self.columns) == 2:
            self.block = [at for at in self.block if lines[at]]

    def line(self) -> Line:
        """Return the heights of the table and their positions, with all that its heading says of them."""
        self._check_neighbours()
        rows = [self.signs.split(self.lines[at]) for at in self.block]
        self._check_rows(rows)
        texts = [[row[column] for column in self.columns] for row in rows]
        values = np.array([list(map(self.signs.value, row)) for row in texts])
        self._check_thousands(texts)
        if len(self.columns) == 1:
            self._check_ends([text for (text,) in texts], values[:, 0])
        cells = [self.heading[column] for column in self.columns]
        others = (HEIGHTS, POSITIONS)[-len(cells) :]
        named = ["" if quantity == other else unit for (quantity, unit), other in zip(cells, others, strict=True)]
        return Line(
            values[:, -1],
            values[:, 0] if len(self.columns) == 2 else None,
            x_unit="".join(named[:-1]),
            height_unit=named[-1],
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
        best, rows = next(one for one in found if len(one[1]) == most)
        fields = [best.split(lines[at]) for at in rows]
        delimiters = {signs.delimiter for signs, own in found if len(own) == most}
        if "," in delimiters and (commas := [at for at in rows if "," in lines[at]]):
            read = [row if columns is None else [row[column] for column in columns] for row in fields]
            clear = self.decimal or any("." in field for row in read for field in row if best.is_number(field))
            if len(delimiters) > 1 or not clear:
                problem = "has a comma of decimals, between columns or between thousands"
                remedy = f"say decimal=',' for decimals, decimal='.' for columns of whole numbers, or {PANDAS}"
                self._refuse(commas[0], problem, remedy)
        return best, fields

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
        if self.count <= max(given or [0]) or (given is None and self.count > 2):
            remedy = (
                "say columns=(0, 1) for positions and heights in the first two, columns=0 for heights in the first, "
                f"or {PANDAS} if the sign is not between columns"
            )
            self._refuse(self.block[0], f"has {self.count} columns", remedy)
        named = [quantity == POSITIONS for quantity, _ in self.heading]
        return given or ((1, 0) if named == [False, True] else range(self.count))

    def _check_rows(self, rows: Sequence[Sequence[str]]) -> None:
        """Refuse rows with other columns than most, without numbers, or with an entry that may alter its height."""
        problem = f"does not have the number of columns of most others, {self.width}"
        remedy = f"write nan if a height is missing, leave out an empty line, {OTHERWISE}"
        self._refuse_first((len(row) != self.width for row in rows), problem, remedy)
        for column in self.columns:
            problem, remedy = f"has no number in column {column}", f"write nan for a missing height, {OTHERWISE}"
            self._refuse_first((not self.signs.are_known([row[column]]) for row in rows), problem, remedy)
        known = [row for row in rows if row[self.columns[-1]] not in MISSING]
        for column in {*range(self.width)} - {*self.columns}:
            entries = Counter(row[column] for row in known)
            if 1 < len(entries) <= MAX_FLAGS or "-" in entries:
                rare = entries.most_common()[-1][0]
                problem = f"has an entry in column {column} that may be a sign, or mark heights that are not valid"
                remedy = f"write signs in front of numbers, nan for what is not valid, or {PANDAS}"
                self._refuse_first(
                    (row[column] == rare and row[self.columns[-1]] not in MISSING for row in rows), problem, remedy
                )

    def _check_neighbours(self) -> None:
        """Refuse a line above or below the table that may belong to it, unless `skip` or `rows` is given."""
        single, first, last = len(self.columns) == 1, self.block[0], self.block[-1]
        above = [at for at in range(first) if self.lines[at] or single][-1:] if self.skip is None else []
        below = [at for at in range(last + 1, len(self.lines)) if self.lines[at]][:1] if self.rows is None else []
        for at in above:
            if self._lacks_height_heading(at) if single else self._may_belong(at):
                problem = "stands above the numbers, and may be a heading or a missing height"
                self._refuse(at, problem, f"say skip={first} for headings, or write nan for a missing height")
        for at in below:
            if single or self._may_belong(at):
                problem = "stands below the numbers, and may be a remark or a missing height"
                remedy = f"say rows={len(self.block)} for a remark, or write nan for a missing height"
                self._refuse(at, problem, remedy)

    def _check_thousands(self, texts: Sequence[Sequence[str]]) -> None:
        """Refuse a sign that may precede decimals or separate thousands.

        All digits of a column are in groups of three, and some of its numbers lack the sign, or no other column
        shows that it precedes decimals.
        """
        if self.decimal:
            return
        sign = self.signs.decimal
        columns = [[text for text in column if text not in MISSING] for column in zip(*texts, strict=True)]
        clear = [not all(map(GROUPS_OF_THREE.fullmatch, column)) for column in columns]
        for at, column in enumerate(columns):
            if not clear[at] and not (any(clear) and all(sign in text for text in column)):
                remedy = f"say decimal={sign!r} for decimals, or {PANDAS}"
                self._refuse_first(
                    (sign in row[at] for row in texts), "has a sign of decimals or between thousands", remedy
                )

    def _check_ends(self, texts: Sequence[str], values: Array) -> None:
        """Refuse a number at an end of one column that may be a count, a step or a length in place of a height.

        It is about the number of rows, or has other decimals than the rows between the ends, which all have as many.
        """
        decimals = [len(text.partition(self.signs.decimal)[2]) for text in texts]
        known = np.flatnonzero(~np.isnan(values)).tolist()
        usual = {decimals[row] for row in known[END_ROWS:-1]}
        first = known[:END_ROWS] if self.skip is None else []
        last = known[-1:] if self.rows is None else []
        for row in (*first, *last):
            is_count = (
                values[row] >= MIN_HEIGHTS and np.abs(values[row] - (len(known), values.size)).min() <= END_ROWS
            )
            if is_count or (len(usual) == 1 and decimals[row] not in usual):
                above = f"skip={self.block[0]} if it is a height, or skip={self.block[row] + 1}"
                below = f"rows={values.size} if it is a height, or rows={row}"
                problem = f"may be a count, a step or a length at an end of {len(known)} numbers"
                self._refuse(self.block[row], problem, f"say {above if row in first else below} to leave it out")

    def _is_row(self, at: int) -> bool:
        """Return whether a line has numbers, or words for missing ones, in the columns of numbers."""
        fields = self.signs.split(self.lines[at])
        return len(fields) == self.width and self.signs.is_row(fields, self.of_numbers)

    def _may_belong(self, at: int) -> bool:
        """Return whether a line next to a table has a number, or in all columns the same word that is no unit."""
        words = self.signs.split(self.lines[at])
        fields = self.signs.split(self.lines[at].lstrip(PREFIXES))
        alike = len(words) >= self.width and len(set(words)) == 1 and not self._heading(self.lines[at])[0][1]
        return alike or any(map(self.signs.is_number, fields))

    def _lacks_height_heading(self, at: int) -> bool:
        """Return whether the cell of a line above the heights contains neither their name nor a unit."""
        quantity, unit = self._heading(self.lines[at])[self.columns[0]]
        return quantity != HEIGHTS and not unit

    def _heading(self, line: str) -> list[tuple[str, str]]:
        return heading_of(line.lstrip(PREFIXES), self.count, self.signs.delimiter)

    def _refuse_first(self, wrong: Iterable[Any], problem: str, remedy: str) -> None:
        """Refuse the first row that is wrong."""
        for at, is_wrong in zip(self.block, wrong, strict=True):
            if is_wrong:
                self._refuse(at, problem, remedy)

    def _refuse(self, at: int, problem: str, remedy: str) -> NoReturn:
        raise ValueError(f"{self.path}, line {at + 1}, {problem}, got {shown(self.lines[at])}: {remedy}")


def _checked_columns(given: Any) -> list[int] | None:
    """Return the numbers of the columns that are read; None leaves the choice to the table."""
    if given is None:
        return None
    columns = [checked_count("columns", one, 0) for one in (given if isinstance(given, list | tuple) else [given])]
    if not 1 <= len(set(columns)) == len(columns) <= 2:
        raise ValueError(
            "columns must be the number of the column of heights, from 0, or those of positions and heights, "
            f"got {shown(given)}"
        )
    return columns


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
