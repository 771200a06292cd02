"""Text files with heights, or positions and heights, in the columns of one table.

The table is one block of lines of numbers or words for missing heights; anything else in it is refused with its line
and the argument that resolves the ambiguity. Lines above and below are kept as `Line.left_out`; those next to the
table are refused if they may belong to it.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from statistics import mode
from typing import NoReturn

import numpy as np

from weier.checks import shown
from weier.surface.measured.artefacts import MAX_HEIGHTS, MIN_HEIGHTS
from weier.surface.measured.content import read_text
from weier.surface.measured.layout import (
    BLANK,
    SEPARATORS,
    Layout,
    UnclearError,
    find_decimal,
    find_delimiter,
)
from weier.surface.measured.line import Line
from weier.surface.measured.units import units_of_heading

BLANKS = " \f\v"  # At the ends of a line; a tab may stand between columns.
MARKS = "#%!/*; \t"  # In front of remarks and headings.
MINUS = re.compile(r"^[\u2010-\u2013\u2212\ufe63\uff0d](?=[\d.,])")  # Signs that are printed for minus.
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?", re.ASCII)
DIGITS = re.compile(r"[+\-\u2010-\u2013\u2212\ufe63\uff0d]?[\d.,]*\d[\d.,]*([eEdD][+-]?\d+)?", re.ASCII)
# Words and signs that programs write for a missing height. Signs alone may also be a rule.
MISSING = re.compile(
    r"[+-]?nan(\((s?nan|ind)\))?|[+-]?1\.#([qs]?nan|ind)|#?n/?a|#nv|null|none|bad|-{1,3}|\*+", re.IGNORECASE
)
SIGNS = re.compile(r"[\W_]+")
OF_HEIGHTS = re.compile(r"(z|y|h|heights?|values?|profile|roughness|data|depth|elevation)", re.IGNORECASE)
OF_VALID = re.compile(r"(is[ _]?)?valid(ity)?", re.IGNORECASE)
VALID = dict.fromkeys(("1", "true", "yes", "valid"), True) | dict.fromkeys(("0", "false", "no", "invalid"), False)
DECIMALS = re.compile(r"[^.,]*(?:[.,](\d*).*)?")
HEADER_NUMBERS = 5  # A count of heights is sought among this many numbers at the start of one column.


def read_columns(path: Path, layout: Layout | None = None) -> Line:
    """Return the line of heights in a file of text.

    Raises
    ------
    NoTextError
        If the file is no text.
    ValueError
        If something in the table is not read, or may or may not belong to it: the message has the number of the line
        and the argument that settles it.
    """
    layout = layout or Layout()
    text = read_text(path, layout.encoding)
    lines = [_without_quotes(line.strip(BLANKS)) for line in re.split(r"\r*\n|\r", text)]
    if len(lines) > 1 and not lines[-1]:
        lines.pop()  # It is behind the last end of a line.
    return _Table(path, lines, layout).line()


class _Table:
    """The lines of a file, and the block of them that is the table: the numbers of its lines, from 0."""

    def __init__(self, path: Path, lines: list[str], layout: Layout) -> None:
        self.path, self.lines, self.layout = path, lines, layout
        self.missing = {word.strip().casefold() for word in layout.missing}
        every = [at for at in range(layout.skip or 0, len(lines)) if not self._is_comment(lines[at])]
        sample = [at for at in every if self._looks_numeric(lines[at])] or [at for at in every if lines[at]]
        if not sample:
            raise ValueError(
                f"{path} must have a table of numbers, got no text in {len(lines)} lines: see skip= and comment="
            )
        self.sample = sample
        try:
            self.delimiter = find_delimiter([lines[at] for at in sample], self._text_above(sample[0]), layout)
            self.fields = {at: self._split(lines[at]) for at in every}
            chosen = zip_longest(*(self._chosen(self.fields[at]) for at in sample))
            columns = [[field for field in column if field and DIGITS.fullmatch(field)] for column in chosen]
            self.decimal = find_decimal(columns, layout)
        except UnclearError as error:
            at = next(at for at in sample if error.text in lines[at])
            raise ValueError(f"{path}, line {at + 1}, {error}") from None
        self.block = self._find_block(every)
        rows = [at for at in self.block if not self._is_empty(at)]
        self.count = mode(len(_without_empty_ends(self.fields[at])) for at in rows)
        self.columns = self._find_columns(rows[0])
        self.with_positions = len(self.columns) == 2
        if layout.skip is not None and not self.with_positions and every[0] < self.block[0]:
            self._refuse_empty(every[0])
        self.heading = self._text_above(self.block[0])

    def line(self) -> Line:
        """Return the heights of the table and their positions, with all that its heading says of them."""
        if not self.with_positions:
            self._check_ends()
        self._check_above()
        self._check_below()
        valid = self._valid_column()
        values, numbers = [], []
        for at in self.block:
            if self._is_empty(at):
                if self.with_positions:
                    continue
                if "" not in self.missing:
                    self._refuse_empty(at)
            row = [math.nan] if self._is_empty(at) else self._row(at)
            if valid is not None and not self._is_empty(at) and not self._is_valid(at, self.fields[at][valid]):
                row[-1] = math.nan
            values.append(row)
            numbers.append(at + 1)
        if len(values) > MAX_HEIGHTS:
            raise ValueError(f"{self.path} must have at most {MAX_HEIGHTS} heights, got {len(values)}: say rows=")
        table = np.array(values)
        units = self._units()
        within = set(self.block)
        return Line(
            table[:, -1],
            table[:, 0] if self.with_positions else None,
            x_units=units[:1] if self.with_positions and units[0] else (),
            height_units=units[-1:] if units[-1] else (),
            numbers=tuple(numbers),
            left_out=tuple(line for at, line in enumerate(self.lines) if line and at not in within),
        )

    def _find_block(self, every: list[int]) -> list[int]:
        """Return the lines from the first row to the last, where the arguments do not name them."""
        layout = self.layout
        rows = [at for at in every if self._is_row(at)]
        if all(map(self._is_empty, rows)):
            self._refuse(
                self.sample[len(self.sample) // 2],
                "and the others, are no rows of numbers",
                "say columns=, delimiter=, decimal=, thousands= or encoding= if the file has columns of numbers",
            )
        start = rows[0]
        unread = [at for at in every if at < start and not self._is_empty(at)]
        if layout.skip is not None and unread:
            self._refuse(unread[0], "is no row of numbers", f"say skip={start}, or missing_value= for a word")
        if layout.rows is None:
            return [at for at in every if start <= at <= rows[-1]]
        counted = [at for at in every if at >= start and ("" in self.missing or not self._is_empty(at))]
        if len(counted) < layout.rows:
            raise ValueError(f"rows must be at most the {len(counted)} rows of {self.path}, got {layout.rows}")
        return [at for at in every if start <= at <= counted[layout.rows - 1]]

    def _find_columns(self, first: int) -> tuple[int, ...]:
        """Return the columns of the heights, or of positions and heights."""
        columns = self.layout.columns or tuple(range(self.count))
        if self.layout.columns is None and self.count > 2:
            self._refuse(
                first,
                f"has {self.count} columns",
                "say columns=(0, 1) for positions and heights in the first two, columns=0 for heights in the first, "
                "or delimiter= or thousands= for a sign that is not between columns",
            )
        if max(columns) >= self.count:
            raise ValueError(
                f"columns must be numbers from 0 to {self.count - 1}, of {self.count} columns in line {first + 1} of "
                f"{self.path}, got {max(columns)}: say delimiter= if it has more"
            )
        return columns

    def _row(self, at: int) -> list[float]:
        """Return the position and the height, or the height alone, in a line of the table."""
        fields = self.fields[at]
        if not len(_without_empty_ends(fields)) <= self.count <= len(fields):
            self._refuse(
                at,
                f"has {len(fields)} columns, and most others have {self.count}",
                "say rows= or skip= if the table ends or begins there, comment= if the line is a remark, "
                "delimiter=, decimal= or thousands= for its signs, or "
                f"missing_value={shown(self.lines[at])} for a missing height",
            )
        row = []
        for column in self.columns:
            value = self._number(fields[column])
            if value is None:
                word = fields[column]
                self._refuse(
                    at,
                    f"has {shown(word)} for a number",
                    f"say missing_value={shown(word)} for a missing height, comment= for a remark, rows= or skip= "
                    "for the end or start of the table, decimal= or thousands= for the signs of a number",
                )
            row.append(value)
        if self.with_positions and math.isnan(row[0]):
            self._refuse(at, "has no position", "say columns=1 for heights alone, or rows= or skip= for a part")
        return row

    def _number(self, field: str) -> float | None:
        """Return the number in a field, NaN if it is missing; None if it is neither."""
        if not field or (self.missing and field.casefold() in self.missing):
            return math.nan
        text = field
        if self.layout.thousands is not None:
            text = re.sub(rf"(?<=\d)[{SEPARATORS[self.layout.thousands]}](?=\d{{3}}(?!\d))", "", text)
        if self.decimal == ",":
            text = text.replace(".", "_").replace(",", ".")
        if NUMBER.fullmatch(text):
            value = float(text.lower().replace("d", "e"))
            return value if math.isfinite(value) else None
        return math.nan if MISSING.fullmatch(field) else None

    def _is_row(self, at: int) -> bool:
        """Return whether all chosen fields of a line are numbers or words for missing heights."""
        if self._is_empty(at):
            return "" in self.missing and len(self.layout.columns or "1") == 1
        fields = _without_empty_ends(self.fields[at])
        chosen = self._chosen(fields)
        if self.layout.columns is not None and len(self.fields[at]) <= max(self.layout.columns):
            return False
        numbers = [self._number(field) for field in chosen]
        if None in numbers:
            return False
        words = [field for field in chosen if field]
        only_signs = all(SIGNS.fullmatch(field) and field.casefold() not in self.missing for field in words)
        return bool(words) and not only_signs

    def _chosen(self, fields: Sequence[str]) -> list[str]:
        """Return the fields in the columns that a call names, or all."""
        return (
            list(fields)
            if self.layout.columns is None
            else [fields[c] for c in self.layout.columns if c < len(fields)]
        )

    def _check_ends(self) -> None:
        """Refuse a number at an end of one column that may be a count, a step or a length in place of a height.

        It is about the number of rows, or has other decimals than the rows between the ends, which all have as many.
        """
        fields = {at: self.fields[at][self.columns[0]] for at in self.block if len(self.fields[at]) > self.columns[0]}
        values = {at: value for at, field in fields.items() if (value := self._number(field) or 0.0) == value}
        rows = list(values)
        decimals = {at: len(DECIMALS.sub(r"\1", fields[at])) for at in rows}
        usual = {decimals[at] for at in rows[HEADER_NUMBERS:-1]}
        first = rows[:HEADER_NUMBERS] if self.layout.skip is None else []
        last = rows[-1:] if self.layout.rows is None else []
        for at in (*first, *last):
            is_count = values[at] >= MIN_HEIGHTS and abs(len(rows) - values[at]) <= HEADER_NUMBERS
            if not is_count and (len(usual) != 1 or decimals[at] in usual):
                continue
            heights = f"skip={rows[0]}" if at in first else f"rows={len(rows)}"
            others = f"skip={at + 1}" if at in first else f"rows={len(rows) - 1}"
            self._refuse(
                at,
                f"may be a count, a step or a length at an end of {len(rows)} numbers",
                f"say {heights} if it is a height, or {others} to leave it out",
            )

    def _check_above(self) -> None:
        """Refuse a line above the table that may belong to it, unless `skip` is given."""
        if self.layout.skip is not None or self.block[0] == 0:
            return
        above = [at for at in range(self.block[0]) if self.lines[at] or not self.with_positions]
        while above and self._is_comment(self.lines[above[-1]]) and not self._is_heading_of_heights(above[-1]):
            above.pop()
        if not above:
            return
        at = above[-1]
        if self._may_belong(at) if self.with_positions else not self._is_heading_of_heights(at):
            self._refuse(
                at,
                "stands above the numbers, and may be a heading or a missing height",
                f"say skip={self.block[0]} for headings, or {self._word(at)}",
            )

    def _check_below(self) -> None:
        """Refuse a line below the table that may belong to it, unless `rows` is given."""
        below = [at for at in range(self.block[-1] + 1, len(self.lines)) if not self._is_comment(self.lines[at])]
        if self.layout.rows is not None or not below:
            return
        at = next((at for at in below if self.lines[at]), below[0])
        if not self.with_positions or (self.lines[at] and self._may_belong(at)):
            rows = sum(not self._is_empty(at) for at in self.block)
            self._refuse(
                at,
                "stands below the numbers, and may be a remark or a missing height",
                f"say rows={rows} for a remark, or {self._word(at)}",
            )

    def _may_belong(self, at: int) -> bool:
        """Return whether a line next to a table has its columns, with a number or the same word in all of them."""
        fields = self._split(self.lines[at])
        if len(fields) >= self.count and len(set(fields)) == 1:
            return True
        uncommented = _split(self.lines[at].lstrip(MARKS), self.delimiter)
        are_numbers = [
            not math.isnan(math.nan if (number := self._number(field)) is None else number) for field in uncommented
        ]
        return are_numbers[0] or (len(uncommented) <= self.count and any(are_numbers))

    def _is_heading_of_heights(self, at: int) -> bool:
        """Return whether a line names the heights in their column, or their unit."""
        heading = self.lines[at].lstrip(MARKS)
        cells = _split(heading, self.delimiter) if self.count > 1 or self.delimiter != BLANK else [heading]
        cell = cells[self.columns[0]] if len(cells) > self.columns[0] else ""
        return bool(
            OF_HEIGHTS.fullmatch(cell) or units_of_heading(heading, self.count, self.delimiter)[self.columns[0]]
        )

    def _units(self) -> tuple[str, ...]:
        """Return the units of the columns from the heading directly above the table; empty without any."""
        units = units_of_heading(self.heading.lstrip(MARKS), self.count, self.delimiter)
        return tuple(units[column] for column in self.columns)

    def _valid_column(self) -> int | None:
        """Return the column that says which heights are valid: the given one, or one that is called so."""
        if self.layout.valid is not None:
            if self.layout.valid >= self.count:
                raise ValueError(f"valid must be a column from 0 to {self.count - 1}, got {self.layout.valid}")
            return self.layout.valid
        cells = _split(self.heading.lstrip(MARKS), self.delimiter)
        named = [column for column, cell in enumerate(cells[: self.count]) if OF_VALID.fullmatch(cell)]
        return next((column for column in named if column not in self.columns), None)

    def _is_valid(self, at: int, field: str) -> bool:
        number = self._number(field)
        word = str(int(number)) if number in (0, 1) else field.casefold()
        if word not in VALID:
            self._refuse(at, f"has {shown(field)} for 0 or 1", "say valid= for the column of valid heights")
        return VALID[word]

    def _text_above(self, first: int) -> str:
        """Return the last line above one that has letters or digits: the heading, if it is one."""
        above = self.lines[:first] if self.layout.skip is None else self.lines[: self.layout.skip]
        return next((line for line in reversed(above) if not SIGNS.fullmatch(line or "_")), "")

    def _looks_numeric(self, line: str) -> bool:
        """Return whether a line has only numbers and words for missing heights, whatever its signs mean."""
        for word in filter(None, self.layout.missing):
            line = line.replace(word, " nan ")
        words = [word for word in re.split(rf"[;,|\s\"'{re.escape(self.layout.delimiter or ';')}]+", line) if word]
        return any(map(DIGITS.fullmatch, words)) and all(DIGITS.fullmatch(w) or MISSING.fullmatch(w) for w in words)

    def _split(self, line: str) -> list[str]:
        """Return the fields of a line; a word for a missing height may have blanks or commas in it."""
        return [line] if line.casefold() in self.missing else _split(line, self.delimiter)

    def _is_comment(self, line: str) -> bool:
        return any(line.startswith(mark) if mark else not line for mark in self.layout.comment)

    def _refuse_empty(self, at: int) -> NoReturn:
        self._refuse(
            at, "is empty", "say missing_value='' if heights are missing in empty lines, or comment='' if not"
        )

    def _is_empty(self, at: int) -> bool:
        return not self.lines[at]

    def _word(self, at: int) -> str:
        """Return the arguments for what is not read in a line next to the table."""
        unread = [field for field in self._split(self.lines[at]) if self._number(field) is None]
        word = unread[-1] if unread else self.lines[at]
        number = "decimal= or thousands= for the signs of a number, or " if re.search(r"\d", word) else ""
        return f"{number}missing_value={shown(word)} for a missing height"

    def _refuse(self, at: int, problem: str, remedy: str) -> NoReturn:
        raise ValueError(f"{self.path}, line {at + 1}, {problem}, got {shown(self.lines[at])}: {remedy}")


def _without_quotes(line: str) -> str:
    """Return a line without quotes around the whole of it."""
    quoted = len(line) > 1 and line[0] == line[-1] == '"' and line.count('"') == 2 and len(line) > 2
    return line[1:-1].strip(BLANKS) if quoted else line


def _split(line: str, delimiter: str) -> list[str]:
    """Return the fields of a line, stripped of blanks and quotes, with ASCII minus signs."""
    if delimiter == BLANK:
        fields = re.split(r"[ \t]+", line.strip(" \t"))
    elif '"' in line:
        fields = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    else:
        fields = line.split(delimiter)
    return [MINUS.sub("-", _unquoted(field.strip(" \t"))) for field in fields]


def _unquoted(field: str) -> str:
    return field[1:-1].strip() if len(field) > 1 and field[0] == field[-1] and field[0] in "\"'" else field


def _without_empty_ends(fields: Sequence[str]) -> Sequence[str]:
    """Return the fields up to the last that is not empty."""
    used = len(fields)
    while used > 1 and not fields[used - 1]:
        used -= 1
    return fields[:used]
