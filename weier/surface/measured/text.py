"""Text files with heights, or positions and heights, in the columns of one table.

The table is one block of lines. The delimiter and the decimal sign follow from a sample of the lines. One pattern
defines numbers; any other text in the table is refused with its line. Lines next to the table are refused if they may
belong to it. Dialects beyond are for pandas, whose arrays `weier.Trace` takes.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import product, starmap
from pathlib import Path
from statistics import mode
from typing import Any, NamedTuple, NoReturn

import numpy as np

from weier.checks import checked_count, checked_word, shown
from weier.kernels.arrays import Array
from weier.surface.measured.lines import HEIGHTS, POSITIONS, Line, heading_of

MAX_BYTES = 2 * 10**8  # 10^6 rows of 200 characters
BINARY = re.compile("[\x00-\x08\x0e-\x19\x1c-\x1f]")  # control characters that no text has
DELIMITERS = (";", "\t", ",", None)  # None stands for any blanks between columns
PREFIXES = "#%!/*; \t"  # characters that precede remarks and headings
MISSING = {
    *("", "nan", "NaN", "NAN", "-nan", "-NaN", "-nan(ind)", "1.#QNAN", "-1.#IND", "NA", "N/A", "n/a", "#N/A", "#NV"),
    *("NULL", "null", "None", "BAD", "--", "---"),
}
RULES = {"", "--", "---"}  # words for missing heights that also form lines above and below a table
MAX_FLAGS = 3  # so few different entries of a column may be signs of numbers, or mark those that are valid
SAMPLE_LINES = 200  # approximate number of lines sampled for the signs of a table
END_ROWS = 5  # rows at the start of one column that may be a count, a step or a length
# numbers with all digits in groups of three
GROUPS_OF_THREE = re.compile(r"[+-]?(\d{1,3}|[1-9]\d{0,2}([.,]\d{3})+)", re.ASCII)
PANDAS = "read the file by pandas.read_csv and pass the arrays to weier.Trace"


class _Signs(NamedTuple):
    """The delimiter and the decimal sign of a table, and the pattern of its numbers."""

    delimiter: str | None
    decimal: str
    number: re.Pattern[str]

    @classmethod
    def of(cls, delimiter: str | None, decimal: str) -> _Signs:
        # No whole number begins with 0, so that a comma behind it precedes decimals.
        whole = r"(?!0\d)\d+" if delimiter == "," else r"\d+"
        decimals = r"\.\d*" if decimal == "." else r",\d+"
        number = rf"[+-]?(?:{whole}(?:{decimals})?|{re.escape(decimal)}\d+)(?:[eEdD][+-]?0*\d{{1,2}})?"  # below 1e100
        return cls(delimiter, decimal, re.compile(number, re.ASCII))

    def split(self, line: str) -> list[str]:
        """Return the fields of a line, without blanks and quotes around them; none of an empty line."""
        fields = line.split(self.delimiter) if line else []
        return [field.strip().removeprefix('"').removesuffix('"') for field in fields]

    def is_number(self, field: str) -> bool:
        return self.number.fullmatch(field) is not None

    def is_known(self, field: str) -> bool:
        return field in MISSING or self.is_number(field)

    def is_row(self, fields: Sequence[str], columns: Sequence[int]) -> bool:
        """Return whether these columns of a line, or all, are known, and not only a rule."""
        if columns:
            fields = [fields[column] for column in columns] if len(fields) > max(columns) else []
        return all(map(self.is_known, fields)) and not RULES.issuperset(fields)

    def value(self, field: str) -> float:
        """Return the value of a known field, also with a Fortran exponent; NaN if it is missing."""
        return math.nan if field in MISSING else float(field.replace(self.decimal, ".").upper().replace("D", "E"))


class Table:
    """The lines of a file, and the block of them that is the table: the numbers of its lines, from 0.

    `skip`, `rows`, `columns` and `decimal` are those of `weier.Trace.read`. ValueError is raised if the file is no
    text, or if something in the table is not read, or may or may not belong to it; the message has the number of the
    line and the arguments that settle it.
    """

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
        given = columns if isinstance(columns, list | tuple) else [] if columns is None else [columns]
        chosen = [checked_count("columns", column, 0) for column in given]
        if len(set(chosen)) != len(chosen) or len(chosen) > 2:
            raise ValueError(
                f"columns must be that of heights, or those of positions and heights, got {shown(columns)}"
            )
        text = _text(path).replace("\u2212", "-")  # the printed minus
        lines = [line.strip(" ") if line.strip().strip(";,") else "" for line in re.split(r"\r*\n|\r", text)]
        self.path, self.lines = path, lines
        filled = [at for at in range(self.skip or 0, len(lines)) if lines[at]]
        if not filled:
            raise ValueError(f"{path} must have a table of numbers, got no text in {len(lines)} lines: see skip=")
        self.signs, sample = self._find_signs(filled[:: max(len(filled) // SAMPLE_LINES, 1)], chosen)
        self.form = mode(tuple(map(self.signs.is_known, fields)) for fields in sample)
        # A delimiter may stand at the end of each row.
        rows_of_form = (fields for fields in sample if len(fields) == len(self.form))
        self.count = 1 + max(at for fields in rows_of_form for at, field in enumerate(fields) if field)
        first = filled[0] if self.skip is not None else next(filter(self._is_row, filled))
        counted = [at for at in filled if at >= first]
        if self.rows is not None and len(counted) < self.rows:
            raise ValueError(f"rows must be at most the {len(counted)} rows of {path}, got {self.rows}")
        last = counted[self.rows - 1] if self.rows else next(filter(self._is_row, reversed(counted)))
        above = (line for line in reversed(lines[:first]) if re.search(r"[^\W_]", line))
        self.heading = self._heading(next(above, ""))
        self.columns = self._find_columns(chosen, first)
        self.block = [at for at in range(first, last + 1) if lines[at] or len(self.columns) == 1]

    def line(self) -> Line:
        """Return the heights of the table and their positions, with all that its heading says of them."""
        self._check_neighbours()
        rows = [self.signs.split(self.lines[at]) for at in self.block]
        self._check_rows(rows)
        texts = [[row[column] for column in self.columns] for row in rows]
        self._check_thousands(texts)
        values = np.array([list(map(self.signs.value, row)) for row in texts])
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
        )

    def _find_signs(self, sample: Sequence[int], columns: Sequence[int]) -> tuple[_Signs, list[list[str]]]:
        """Return the signs that make rows of the most lines, and the fields of these lines."""
        found: list[tuple[_Signs, dict[int, list[str]]]] = []
        for signs in starmap(_Signs.of, product(DELIMITERS, self.decimal or ".,")):
            split = {at: signs.split(self.lines[at]) for at in sample if signs.delimiter != signs.decimal}
            found.append((signs, {at: fields for at, fields in split.items() if signs.is_row(fields, columns)}))
        signs, rows = max(found, key=lambda one: len(one[1]))  # the first of equals
        if not rows:
            remedy = f"say columns= or decimal= if the file has columns of numbers, or {PANDAS}"
            self._refuse(sample[len(sample) // 2], "and the others, are no rows of numbers", remedy)
        commas = [at for at in rows if "," in self.lines[at]]
        if commas and any(other.delimiter == "," and len(own) == len(rows) for other, own in found):
            read = (field for row in rows.values() for at, field in enumerate(row) if not columns or at in columns)
            if not self.decimal and not any("." in field for field in read):
                problem = "has a comma of decimals, between columns or between thousands"
                remedy = f"say decimal=',' for decimals, decimal='.' for columns of whole numbers, or {PANDAS}"
                self._refuse(commas[0], problem, remedy)
        return signs, [*rows.values()]

    def _find_columns(self, given: list[int], first: int) -> Sequence[int]:
        """Return the column of the heights, or the columns of positions and heights."""
        if self.count <= max(given, default=-1) or (not given and self.count > 2):
            remedy = (
                "say columns=(0, 1) for positions and heights in the first two, columns=0 for heights in the first, "
                f"or {PANDAS} if the sign is not between columns"
            )
            self._refuse(first, f"has {self.count} columns", remedy)
        named = [quantity == POSITIONS for quantity, _ in self.heading]
        return given or ((1, 0) if named == [False, True] else range(self.count))

    def _check_neighbours(self) -> None:
        """Refuse a line above or below the table that may belong to it, unless `skip` or `rows` is given."""
        single, first, last = len(self.columns) == 1, self.block[0], self.block[-1]
        above = [at for at in range(first) if self.lines[at] or single][-1:] if self.skip is None else []
        below = [at for at in range(last + 1, len(self.lines)) if self.lines[at]][:1] if self.rows is None else []
        for at in (*above, *below):
            fields = self.signs.split(self.lines[at].lstrip(PREFIXES))
            if single:
                quantity, unit = self._heading(self.lines[at])[self.columns[0]]
                may_belong = at > last or (quantity != HEIGHTS and not unit)
            else:
                may_belong = any(map(self.signs.is_number, fields)) or (at > last and len(fields) == len(self.form))
            if may_belong:
                place = f"stands {'below' if at > last else 'above'} the numbers"
                remedy = (
                    f"say skip={first}, rows={len(self.block)} to leave it out, or write nan for a missing height"
                )
                self._refuse(at, f"{place}, and may be a heading, a remark or a missing height", remedy)

    def _check_rows(self, rows: Sequence[Sequence[str]]) -> None:
        """Refuse rows with other columns than most, without numbers, or with an entry that may alter its height."""
        otherwise = f"say skip= or rows= for the start or end of the table, or {PANDAS}"
        problem = f"does not have the number of columns of most others, {len(self.form)}"
        remedy = f"write nan if a height is missing, leave out an empty line, {otherwise}"
        self._refuse_first((len(row) != len(self.form) for row in rows), problem, remedy)
        for column in self.columns:
            problem, remedy = f"has no number in column {column}", f"write nan for a missing height, {otherwise}"
            self._refuse_first((not self.signs.is_known(row[column]) for row in rows), problem, remedy)
        for column in {*range(len(self.form))} - {*self.columns}:
            entries = Counter(row[column] for row in rows if row[self.columns[-1]] not in MISSING)
            if 1 < len(entries) <= MAX_FLAGS or "-" in entries:
                rare = entries.most_common()[-1][0]
                problem = f"has an entry in column {column} that may be a sign, or mark heights that are not valid"
                remedy = f"write signs in front of numbers, nan for what is not valid, or {PANDAS}"
                is_wrong = (row[column] == rare and row[self.columns[-1]] not in MISSING for row in rows)
                self._refuse_first(is_wrong, problem, remedy)

    def _check_thousands(self, texts: Sequence[Sequence[str]]) -> None:
        """Refuse a sign that may precede decimals or separate thousands: all digits are in groups of three."""
        numbers = (text for row in texts for text in row if text not in MISSING)
        if self.decimal is None and all(map(GROUPS_OF_THREE.fullmatch, numbers)):
            sign = self.signs.decimal
            remedy = f"say decimal={sign!r} for decimals, or {PANDAS}"
            has_sign = (sign in "".join(row) for row in texts)
            self._refuse_first(has_sign, "has a sign of decimals or between thousands", remedy)

    def _check_ends(self, texts: Sequence[str], values: Array) -> None:
        """Refuse a number at an end of one column that may be a count, a step or a length in place of a height.

        It is about the number of rows, or has other decimals than the rows between the ends, which all have as many.
        """
        decimals = [len(text.partition(self.signs.decimal)[2]) for text in texts]
        known = np.flatnonzero(~np.isnan(values)).tolist()
        usual = {decimals[row] for row in known[END_ROWS:-1]}
        for row in (known[:END_ROWS] if self.skip is None else []) + (known[-1:] if self.rows is None else []):
            is_count = abs(values[row] - values.size) <= END_ROWS
            if is_count or (len(usual) == 1 and decimals[row] not in usual):
                problem = f"may be a count, a step or a length at an end of {len(known)} numbers"
                remedy = f"say skip={self.block[0]}, rows={values.size} if it is a height, or others to leave it out"
                self._refuse(self.block[row], problem, remedy)

    def _is_row(self, at: int) -> bool:
        """Return whether a line has numbers, or words for missing ones, in the columns of numbers."""
        fields = self.signs.split(self.lines[at])
        columns = [column for column, is_known in enumerate(self.form) if is_known]
        return len(fields) == len(self.form) and self.signs.is_row(fields, columns)

    def _heading(self, line: str) -> list[tuple[str, str]]:
        return heading_of(line.lstrip(PREFIXES), self.count, self.signs.delimiter)

    def _refuse_first(self, wrong: Iterable[Any], problem: str, remedy: str) -> None:
        """Refuse the first row that is wrong."""
        for at, is_wrong in zip(self.block, wrong, strict=True):
            if is_wrong:
                self._refuse(at, problem, remedy)

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
        raise ValueError(
            f"{path} is no text, got the control character {first[0]!r} in line {line}: save the heights as text, "
            f"such as the sheet of a workbook as CSV, unpack an archive, leave the character out, or {PANDAS}, or a "
            "file of an instrument by SurfaceTopography"
        )
    return text
