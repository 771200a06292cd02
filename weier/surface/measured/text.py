"""Text files with heights, or positions and heights, in the columns of one table.

The table is one block of lines of numbers or words for missing heights; anything else in it is refused with its line
and the arguments that resolve the ambiguity. Lines above and below are kept as `Line.left_out`; those next to the
table are refused if they may belong to it. pandas converts the numbers, whose signs are known by then.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from io import StringIO
from itertools import zip_longest
from pathlib import Path
from statistics import mode
from typing import NoReturn

import numpy as np

from weier.checks import shown
from weier.kernels.arrays import Array
from weier.surface.measured import units
from weier.surface.measured.artefacts import MAX_HEIGHTS, MIN_HEIGHTS
from weier.surface.measured.content import read_text
from weier.surface.measured.layout import (
    BLANK,
    DIGITS,
    SEPARATORS,
    Layout,
    UnclearError,
    find_decimal,
    find_delimiter,
    number_pattern,
)
from weier.surface.measured.line import Line

BLANKS = " \f\v\u00a0\u200b\ufeff"  # At the ends of a line; a tab may stand between columns.
MARKS = "#%!/*; \t"  # In front of remarks and headings.
MINUS = re.compile(r"^[\u2010-\u2013\u2212\ufe63\uff0d](?=[\d.,]|$)")  # Signs that are printed for minus.
# Words and signs that programs write for a missing height. Signs alone may also be a rule.
MISSING = re.compile(
    r"[+-]?nan(\((s?nan|ind)\))?|[+-]?1\.#([qs]?nan|ind)|#?n/?a|#nv|null|none|bad|-{1,3}|\*+", re.IGNORECASE
)
SIGNS = re.compile(r"[\W_]+")
SIGN_OF_NUMBER = re.compile(r"[+(-]?|plus|minus|pos(itive)?|neg(ative)?", re.IGNORECASE)
OF_HEIGHTS = re.compile(r"(z|y|h|heights?|values?|profile|roughness|data|depth|elevation)", re.IGNORECASE)
OF_VALID = re.compile(r"(is[ _]?)?valid(ity)?", re.IGNORECASE)
VALID, INVALID = re.compile(r"1(\.0*)?|true|yes|valid"), re.compile(r"0(\.0*)?|false|no|invalid")
ENDS = "skip= or rows= for the start or end of the table"
HEADER_NUMBERS = 5  # A count of heights is sought among this many numbers at the start of one column.


def read_columns(path: Path, layout: Layout | None = None) -> Line:
    """Return the line of heights in a file of text.

    Raises
    ------
    NoTextError
        If the file is no text.
    ValueError
        If something in the table is not read, or may or may not belong to it: the message has the number of the line
        and the arguments that settle it.
    """
    layout = layout or Layout()
    lines = [_bare(line) for line in re.split(r"\r*\n|\r", read_text(path, layout.encoding))]
    return _Table(path, lines if lines[-1] else lines[:-1] or lines, layout).line()


class _Table:
    """The lines of a file, and the block of them that is the table: the numbers of its lines, from 0."""

    def __init__(self, path: Path, lines: list[str], layout: Layout) -> None:
        self.path, self.lines, self.layout = path, lines, layout
        every = [at for at in range(layout.skip or 0, len(lines)) if not self._is_comment(at)]
        sample = [at for at in every if self._looks_numeric(lines[at])] or [at for at in every if lines[at]]
        if not sample:
            raise ValueError(
                f"{path} must have a table of numbers, got no text in {len(lines)} lines: see skip= and comment="
            )
        try:
            self.delimiter = find_delimiter([lines[at] for at in sample], self._text_above(sample[0]), layout)
            self.words = _pattern_of_words(layout.missing, self.delimiter)
            self.fields = {at: self._split(lines[at]) for at in every}
            columns = zip_longest(*(self._chosen(self.fields[at]) for at in sample))
            numbers = [[field for field in column if field and DIGITS.fullmatch(field)] for column in columns]
            self.decimal = find_decimal(numbers, layout)
        except UnclearError as error:
            at = next(at for at in sample if error.text in lines[at])
            raise ValueError(f"{path}, line {at + 1}, {error}") from None
        self.number = number_pattern(self.decimal, layout.thousands)
        self.block = self._find_block(every, sample[len(sample) // 2])
        self.rows = [at for at in self.block if lines[at]]
        self.count = mode(len(_without_empty_ends(self.fields[at])) for at in self.rows)
        heading = self._text_above(self.block[0]).lstrip(MARKS)
        self.cells = units.cells_of_heading(heading, self.count, self.delimiter)
        self.valid, self.columns = self._find_columns()
        if layout.skip is not None and len(self.columns) == 1 and every[0] < self.block[0]:
            self._refuse_empty(every[0])

    def line(self) -> Line:
        """Return the heights of the table and their positions, with all that its heading says of them."""
        with_positions = len(self.columns) == 2
        counted = self.rows if with_positions else self.block
        if len(counted) > MAX_HEIGHTS:
            raise ValueError(f"{self.path} must have at most {MAX_HEIGHTS} heights, got {len(counted)}: say rows=")
        if not with_positions:
            self._check_ends()
        self._check_neighbours()
        self._check_words()
        self._check_signs()
        values = self._values([self._row(at) for at in counted])
        cells = [self.cells[column] for column in self.columns]
        others = (units.HEIGHTS, units.POSITIONS) if with_positions else (units.POSITIONS,)
        named = [
            "" if units.quantity_of_cell(cell) == other else units.unit_of_cell(cell)
            for cell, other in zip(cells, others, strict=True)
        ]
        within = set(self.block)
        return Line(
            values[:, -1],
            values[:, 0] if with_positions else None,
            x_units=tuple(filter(None, named[:-1])),
            height_units=tuple(filter(None, named[-1:])),
            numbers=tuple(at + 1 for at in counted),
            left_out=tuple(line for at, line in enumerate(self.lines) if line and at not in within),
        )

    def _find_block(self, every: list[int], middle: int) -> list[int]:
        """Return the lines from the first row to the last, where the arguments do not name them."""
        skip, rows = self.layout.skip, self.layout.rows
        found = [at for at in every if self._is_row(at)]
        filled = [at for at in found if self.lines[at]]
        if not filled:
            self._refuse(
                middle,
                "and the others, are no rows of numbers",
                "say columns=, delimiter=, decimal=, thousands= or encoding= if the file has columns of numbers",
            )
        start = found[0] if skip is not None else filled[0]
        unread = [at for at in every if at < start and self.lines[at]]
        if skip is not None and unread:
            self._refuse(unread[0], "is no row of numbers", f"say skip={start}, or missing_value= for a word")
        if rows is None:
            return [at for at in every if start <= at <= filled[-1]]
        counted = [at for at in every if at >= start and ("" in self.layout.missing or self.lines[at])]
        if len(counted) < rows:
            raise ValueError(f"rows must be at most the {len(counted)} rows of {self.path}, got {rows}")
        return [at for at in every if start <= at <= counted[rows - 1]]

    def _find_columns(self) -> tuple[int | None, tuple[int, ...]]:
        """Return the column of valid heights, if any, and those of the heights, or of positions and heights."""
        given, valid, last = self.layout.columns, self.layout.valid, self.count - 1
        if valid is not None and valid > last:
            raise ValueError(f"valid must be a column from 0 to {last}, got {valid}")
        if given is not None and max(given) > last:
            raise ValueError(
                f"columns must be numbers from 0 to {last}, of {self.count} columns in line {self.rows[0] + 1} of "
                f"{self.path}, got {max(given)}: say delimiter= if it has more"
            )
        if valid is None:
            named = [column for column, cell in enumerate(self.cells) if OF_VALID.fullmatch(cell)]
            valid = next((column for column in named if column not in (given or ())), None)
        if given is not None:
            return valid, given
        columns = [column for column in range(self.count) if column != valid]
        if len(columns) > 2 or not columns:
            self._refuse(
                self.rows[0],
                f"has {self.count} columns",
                "say columns=(0, 1) for positions and heights in the first two, columns=0 for heights in the first, "
                "or delimiter= or thousands= for a sign that is not between columns",
            )
        named = [units.quantity_of_cell(self.cells[column]) == units.POSITIONS for column in columns]
        if named == [False, True]:
            columns.reverse()
        return valid, tuple(columns)

    def _row(self, at: int) -> list[str]:
        """Return the number, or `nan`, in each of the columns of a line of the table."""
        fields = self.fields[at]
        if not self.lines[at]:
            if "" not in self.layout.missing:
                self._refuse_empty(at)
            return ["nan"]
        if not len(_without_empty_ends(fields)) <= self.count <= len(fields):
            problem = f"has {len(fields)} columns, and most others have {self.count}"
            self._refuse(at, problem, self._arguments(ENDS, self.lines[at]))
        row = []
        for column in self.columns:
            if (text := self._number(fields[column])) is None:
                problem = f"has {shown(fields[column])} for a number"
                self._refuse(at, problem, self._arguments(ENDS, fields[column]))
            row.append(text)
        if len(row) == 2 and row[0] == "nan":
            self._refuse(at, "has no position", "say columns=1 for heights alone, or rows= or skip= for a part")
        if self.valid is not None and not self._is_valid(at, fields[self.valid].casefold()):
            row[-1] = "nan"
        return row

    def _number(self, field: str) -> str | None:
        """Return the number in a field for pandas, `nan` if it is missing; None if it is neither."""
        if self.number.fullmatch(field):
            text = field.lower().replace("d", "e")
            return re.sub(f"[{SEPARATORS[sign]}]", sign, text) if (sign := self.layout.thousands) else text
        return "nan" if not field or MISSING.fullmatch(field) else None

    def _values(self, rows: Sequence[Sequence[str]]) -> Array:
        """Return the numbers in the texts of rows, shape (rows, columns)."""
        import pandas as pd  # which takes half a second

        table = StringIO("\n".join(map("\t".join, rows)))
        frame = pd.read_csv(
            table,
            sep="\t",
            header=None,
            dtype=float,
            decimal=self.decimal,
            thousands=self.layout.thousands,
            na_values=["nan"],
            keep_default_na=False,
            skip_blank_lines=False,
            quoting=csv.QUOTE_NONE,
        )
        return frame.to_numpy()

    def _is_row(self, at: int) -> bool:
        """Return whether all chosen fields of a line are numbers or words for missing heights."""
        columns = self.layout.columns
        if not self.lines[at]:
            return "" in self.layout.missing and len(columns or "1") == 1
        chosen = self._chosen(_without_empty_ends(self.fields[at]))
        if columns is not None and len(self.fields[at]) <= max(columns):
            return False
        words = [field for field in chosen if field]
        only_signs = all(SIGNS.fullmatch(word) and word not in self.layout.missing for word in words)
        return None not in map(self._number, chosen) and bool(words) and not only_signs

    def _chosen(self, fields: Sequence[str]) -> list[str]:
        """Return the fields in the columns that a call names, or all."""
        columns = self.layout.columns
        return list(fields) if columns is None else [fields[c] for c in columns if c < len(fields)]

    def _check_ends(self) -> None:
        """Refuse a number at an end of one column that may be a count, a step or a length in place of a height.

        It is about the number of rows, or has other decimals than the rows between the ends, which all have as many.
        """
        (column,) = self.columns
        texts = {at: self.fields[at][column] for at in self.rows if len(self.fields[at]) > column}
        texts = {at: text for at, text in texts.items() if self._number(text) not in (None, "nan")}
        rows = list(texts)
        sign = re.compile(rf"[^{self.decimal}]*{re.escape(self.decimal)}?(\d*).*")
        decimals = {at: len(sign.sub(r"\1", texts[at])) for at in rows}
        usual = {decimals[at] for at in rows[HEADER_NUMBERS:-1]}
        first = rows[:HEADER_NUMBERS] if self.layout.skip is None else []
        last = rows[-1:] if self.layout.rows is None else []
        ends, counts = [*first, *last], np.array([len(rows), len(self.block)])
        for at, value in zip(ends, self._values([[self._number(texts[at]) or ""] for at in ends]), strict=True):
            is_count = value >= MIN_HEIGHTS and min(abs(counts - value)) <= HEADER_NUMBERS
            if not is_count and (len(usual) != 1 or decimals[at] in usual):
                continue
            heights = f"skip={rows[0]}" if at in first else f"rows={len(rows)}"
            others = f"skip={at + 1}" if at in first else f"rows={len(rows) - 1}"
            self._refuse(
                at,
                f"may be a count, a step or a length at an end of {len(rows)} numbers",
                f"say {heights} if it is a height, or {others} to leave it out",
            )

    def _check_neighbours(self) -> None:
        """Refuse a line above or below the table that may belong to it, unless `skip` or `rows` is given."""
        single = len(self.columns) == 1
        above = [at for at in range(self.block[0]) if self.lines[at] or single]
        while above and self._is_comment(above[-1]) and not self._is_heading_of_heights(above[-1]):
            above.pop()
        if self.layout.skip is None and above:
            at = above[-1]
            if not self._is_heading_of_heights(at) if single else self._may_belong(at):
                problem = "stands above the numbers, and may be a heading or a missing height"
                remedy = self._arguments(f"skip={self.block[0]} for headings", self.lines[at])
                self._refuse(at, problem, remedy)
        end = self.block[-1] + 1
        below = [at for at in range(end, len(self.lines)) if self.lines[at] and not self._is_comment(at)]
        if self.layout.rows is None and below and (single or self._may_belong(below[0])):
            problem = "stands below the numbers, and may be a remark or a missing height"
            remedy = self._arguments(f"rows={len(self.rows)} for a remark", self.lines[below[0]])
            self._refuse(below[0], problem, remedy)

    def _check_words(self) -> None:
        """Refuse a row at an end of the table with a word where the next row has a number, as in `Ra,0.7`."""
        for given, at, near in ((self.layout.skip, 0, 1), (self.layout.rows, -1, -2)):
            if given is not None or len(self.rows) < MIN_HEIGHTS:
                continue
            words, numbers = (
                [self._number(field) is None for field in _without_empty_ends(self.fields[self.rows[row]])]
                for row in (at, near)
            )
            if any(word and not number for word, number in zip(words, numbers, strict=False)):
                problem = "has a word where the next row has a number"
                self._refuse(
                    self.rows[at], problem, "say skip= or rows= if the table begins behind it or ends before it"
                )

    def _check_signs(self) -> None:
        """Refuse a column of signs, which are those of the numbers in another one."""
        for column in set(range(self.count)) - {*self.columns, self.valid}:
            fields = {at: self.fields[at][column] for at in self.rows if column < len(self.fields[at])}
            if any(fields.values()) and all(map(SIGN_OF_NUMBER.fullmatch, fields.values())):
                at = next(at for at, field in fields.items() if field)
                problem = f"has {fields[at]!r} in a column of its own, which may be the sign of a number"
                self._refuse(
                    at, problem, "write the sign in front of the number, or leave the column out of the file"
                )

    def _may_belong(self, at: int) -> bool:
        """Return whether a line next to a table has its columns, with a number or the same word in all of them."""
        fields = self._split(self.lines[at])
        if len(fields) >= self.count and len(set(fields)) == 1:
            return True
        uncommented = self._split(self.lines[at].lstrip(MARKS))
        are_numbers = [self._number(field) not in (None, "nan") for field in uncommented]
        return are_numbers[0] or (len(uncommented) <= self.count and any(are_numbers))

    def _is_heading_of_heights(self, at: int) -> bool:
        """Return whether a line names the heights in their column, or their unit."""
        cells = units.cells_of_heading(self.lines[at].lstrip(MARKS), self.count, self.delimiter)
        cell = cells[self.columns[0]]
        return bool(OF_HEIGHTS.fullmatch(cell) or units.unit_of_cell(cell))

    def _is_valid(self, at: int, word: str) -> bool:
        if not VALID.fullmatch(word) and not INVALID.fullmatch(word):
            self._refuse(at, f"has {shown(word)} for 0 or 1", "say valid= for the column of valid heights")
        return bool(VALID.fullmatch(word))

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
        """Return the fields of a line, stripped of blanks and quotes, with ASCII minus signs."""
        if self.words:
            line = self.words.sub(r"\1nan", line)
        if self.delimiter == BLANK:
            fields = re.split(r"[ \t]+", line.strip(" \t"))
        elif '"' in line:
            fields = next(csv.reader([line], delimiter=self.delimiter, skipinitialspace=True))
        else:
            fields = line.split(self.delimiter)
        return [MINUS.sub("-", _unquoted(field.strip(" \t"))) for field in fields]

    def _is_comment(self, at: int) -> bool:
        return any(self.lines[at].startswith(mark) if mark else not self.lines[at] for mark in self.layout.comment)

    def _arguments(self, where: str, text: str) -> str:
        """Return the arguments for a text in or next to the table that is not read."""
        number = "decimal= or thousands= for the signs of a number, " if re.search(r"\d", text) else ""
        return (
            f"say {where}, comment= for a remark, delimiter= for columns, {number}"
            f"or missing_value={shown(text)} for a missing height"
        )

    def _refuse_empty(self, at: int) -> NoReturn:
        self._refuse(
            at, "is empty", "say missing_value='' if heights are missing in empty lines, or comment='' if not"
        )

    def _refuse(self, at: int, problem: str, remedy: str) -> NoReturn:
        raise ValueError(f"{self.path}, line {at + 1}, {problem}, got {shown(self.lines[at])}: {remedy}")


def _bare(line: str) -> str:
    """Return a line without blanks and quotes around the whole of it; empty if it has only separators."""
    line = line.strip(BLANKS)
    if line.count('"') == 2 and len(line) > 2 and line[0] == line[-1] == '"':
        line = line[1:-1].strip(BLANKS)
    return line if line.strip(";,\t" + BLANKS) else ""


def _pattern_of_words(words: Sequence[str], delimiter: str) -> re.Pattern[str] | None:
    """Return a pattern of the words for missing heights, which may have blanks, as whole fields; None without any."""
    split = [word.split() for word in sorted(words, key=len, reverse=True) if word and not MISSING.fullmatch(word)]
    if not split:
        return None
    sign = r"[ \t]" if delimiter == BLANK else re.escape(delimiter)
    listed = "|".join(r"\s+".join(map(re.escape, parts)) for parts in split)
    return re.compile(rf"((?:^|(?<={sign}))[ \t\"']*)(?:{listed})(?=[ \t\"']*(?:{sign}|$))", re.IGNORECASE)


def _unquoted(field: str) -> str:
    return field[1:-1].strip() if len(field) > 1 and field[0] == field[-1] and field[0] in "\"'" else field


def _without_empty_ends(fields: Sequence[str]) -> Sequence[str]:
    """Return the fields up to the last that is not empty."""
    used = len(fields)
    while used > 1 and not fields[used - 1]:
        used -= 1
    return fields[:used]
