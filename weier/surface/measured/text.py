"""Files of text with heights in one column, or positions and heights in two, as people and instruments write them."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np

from weier.checks import shown
from weier.kernels.arrays import Array
from weier.surface.measured.artefacts import MAX_HEIGHTS
from weier.surface.measured.line import Line
from weier.surface.measured.units import units_in

HEAD = 2**16  # The kind and the encoding of a file are recognised from so many bytes.
UNEVEN = 0.01  # Positions in files are rounded, so that equal steps may differ by this part of a step.
MOST_DIGITS = 9  # Positions that are rounded have at most so many decimals: instruments write no more.
# Words and signs that programs write in place of a missing height.
NO_NUMBER = {"na", "n/a", "#n/a", "null", "none", "-", "--", "---", "bad", "*", "***", "1.#qnan", "-1.#ind", "1.#ind"}
# Numbers with a decimal comma beside another number.
DECIMAL_COMMA = re.compile(r"\d,\d+\s*[;\t ]\s*-?\d|;\s*-?\d+,\d")
# Comments that head a column of heights, and headings that are about positions.
OF_HEIGHTS = re.compile(r"#\s*(z|y|heights?|values?|profile|roughness|data|depth|elevation)\b|#\s*\W?\w+\W?$", re.I)
OF_POSITIONS = re.compile(r"\b(x|lateral|positions?|distance|length)\b", re.IGNORECASE)

# Kinds of files that cannot be read as text by their first bytes, and the remedy for each.
SAVE_AS_TEXT = "save the heights as text, one or two columns"
SIGNATURES = {
    b"\xff\xfe\0\0": ("UTF-32 text", "save it as UTF-8"),
    b"\0\0\xfe\xff": ("UTF-32 text", "save it as UTF-8"),
    b"\xff\xfe": ("UTF-16 text", "save it as UTF-8"),
    b"\xfe\xff": ("UTF-16 text", "save it as UTF-8"),
    b"\xd0\xcf\x11\xe0": ("a workbook or document of an old Office (.xls)", SAVE_AS_TEXT),
    b"\x1f\x8b": ("compressed by gzip", "unpack it"),
    b"BZh": ("compressed by bzip2", "unpack it"),
    b"\xfd7zXZ": ("compressed by xz", "unpack it"),
    b"7z\xbc\xaf": ("a 7z archive", "unpack it"),
    b"%PDF": ("a PDF document", SAVE_AS_TEXT),
    b"{\\rtf": ("a document of rich text", SAVE_AS_TEXT),
    b"\x89PNG": ("a PNG picture", SAVE_AS_TEXT),
    b"\xff\xd8\xff": ("a JPEG picture", SAVE_AS_TEXT),
    b"II*\0": ("a TIFF picture", SAVE_AS_TEXT),
    b"MM\0*": ("a TIFF picture", SAVE_AS_TEXT),
    b"\x89HDF": ("an HDF5 or netCDF file", "take its heights by xarray or h5py, and weier.Trace"),
    b"CDF\x01": ("a netCDF file", "take its heights by xarray, and weier.Trace"),
    b"CDF\x02": ("a netCDF file", "take its heights by xarray, and weier.Trace"),
    b"\x93NUMPY": ("an array of NumPy", "take weier.Trace of what numpy.load returns"),
    b"MATLAB 5.0 MAT-file": ("a file of MATLAB", SAVE_AS_TEXT),
}
# Kinds of zip archives by a member that only they have, and the remedy for each.
ARCHIVES = {
    "xl/workbook.xml": ("a workbook (.xlsx)", "save its sheet as text, one or two columns"),
    "content.xml": ("a workbook or document of OpenDocument (.ods)", "save its sheet as text, one or two columns"),
    "word/document.xml": ("a document (.docx)", SAVE_AS_TEXT),
    "main.xml": ("an X3P file of ISO 25178-72", SAVE_AS_TEXT),
}


class NoTableError(ValueError):
    """A file that holds no table of one or two columns, but may be an instrument's own."""


def read_columns(path: Path) -> Line:
    """The table of a file of text.

    Lines before the first number are headings; between heights of one column, an empty line and a height behind #
    are missing heights.

    Raises
    ------
    NoTableError
        If the file is no text, or no table of one or two columns: the message names the kind of the file.
    ValueError
        If it is text in an encoding or with decimals that are not read.
    """
    with path.open("rb") as file:
        head = file.read(HEAD)
    _check_text(path, head)
    with path.open(encoding=_encoding(head), errors="replace") as lines:
        headings, rows = _table(path, lines)
    table = np.array(rows)
    x_units, height_units = _units(headings, table.shape[1])
    return Line(table[:, -1], table[:, 0] if table.shape[1] == 2 else None, None, x_units, height_units)


def on_grid(x: Array, heights: Array, length: float | None) -> tuple[Array, float]:
    """Heights at equal steps, NaN in rows that are left out, and the length of the trace, which is all steps.

    A length that is given must agree with the positions, which may then be rounded to some digit.

    Raises
    ------
    ValueError
        If the steps are not equal; the message says whether rounding made them so.
    """
    rise = np.diff(x)
    if not (rise > 0).all():
        at = 0 if x[-1] <= x[0] else int(np.argmin(rise > 0)) + 1
        raise ValueError(
            f"positions must rise in equal steps, and decimals have points, got {x[at]} at position {at}"
        )
    digit = _digit(x)
    even = (x[-1] - x[0]) / rise.size * np.arange(x.size)
    if length is not None:
        if np.abs(x - x[0] - length / x.size * np.arange(x.size)).max() <= max(digit, UNEVEN * length / x.size):
            return heights, length
        raise ValueError(
            f"length must be that of {x.size} steps where positions go from {x[0]:g} to {x[-1]:g}, about "
            f"{x.size * even[1]:.6g}, got {length:g}: leave out the length, or the positions"
        )
    step = float(np.median(rise))
    step = float((x[-1] - x[0]) / np.rint((x[-1] - x[0]) / step))
    number = np.rint((x - x[0]) / step)
    off = np.abs(x - x[0] - number * step)
    if (off <= UNEVEN * step).all() and (np.diff(number) > 0).all() and number[-1] < MAX_HEIGHTS:
        full = np.full(int(number[-1]) + 1, np.nan)
        full[number.astype(int)] = heights
        return full, step * full.size
    if np.abs(x - x[0] - even).max() <= digit:
        raise ValueError(
            f"positions must rise in equal steps, got ones that are rounded to {digit:g}: give the length, which is "
            f"{x.size} steps, or the heights as one column with the length"
        )
    at = int(off.argmax())
    raise ValueError(
        f"positions must rise in equal steps, got {x[at]} at position {at}: interpolate the heights at equal steps"
    )


def _digit(x: Array) -> float:
    """The last decimal digit that positions have: 0.1 of 0.0, 0.2, 0.3."""
    for digits in range(MOST_DIGITS):
        if np.allclose(x, np.round(x, digits), rtol=0, atol=1e-6 * 10.0**-digits):
            return 10.0**-digits
    return 0.0


def _check_text(path: Path, head: bytes) -> None:
    """Refuse a file whose first bytes are no text in the encodings that are read."""
    known = next((kind for start, kind in SIGNATURES.items() if head.startswith(start)), None)
    if head.startswith(b"PK\x03\x04"):
        known = ("a zip archive", "unpack it")
        with suppress(zipfile.BadZipFile, OSError), zipfile.ZipFile(path) as archive:
            members = archive.namelist()
            known = next((kind for member, kind in ARCHIVES.items() if member in members), known)
    if known is None and b"\0" in head:
        known = ("UTF-16 text", "save it as UTF-8") if _is_utf_16(head) else ("no text", SAVE_AS_TEXT)
    if known is not None:
        kind = ValueError if known[0].startswith("UTF") else NoTableError
        raise kind(f"{path} is {known[0]}, not a table of heights as text: {known[1]}")


def _is_utf_16(head: bytes) -> bool:
    """Whether every other byte is 0, and the others can be read: UTF-16 without a mark, in a language of Europe."""
    halves = head[::2], head[1::2]
    readable = [half.decode("cp1252", "replace").split() for half in halves]
    return any(
        not any(zeros) and all(map(str.isprintable, words))
        for zeros, words in zip(halves, reversed(readable), strict=True)
    )


def _encoding(head: bytes) -> str:
    """UTF-8, or the encoding of old Windows programs, which has the sign of micrometres, too."""
    try:
        head[: len(head) - 3].decode("utf-8")  # the last letter may be cut
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


def _table(path: Path, lines: Iterator[str]) -> tuple[list[str], list[list[float]]]:
    """The lines before the first number, and the rows from there to the last one."""
    headings: list[str] = []
    rows: list[list[float]] = []
    gap, commented = 0, 0  # missing heights since the last row of one column, and those up to the last one behind #
    for number, line in enumerate(map(str.strip, lines), 1):
        found = _numbers(line.lstrip("#"))
        if not rows and (not found or line.startswith("#") or not any(map(str.isalnum, line))):
            headings.append(line)
            continue
        columns = len(rows[0]) if rows else len(found)
        if not line or line.startswith("#"):
            gap += columns == 1 and (not line or bool(found))
            commented = gap if found else commented
            continue
        if DECIMAL_COMMA.search(line) and "." not in line:
            raise ValueError(f"{path}, line {number}, must have decimal points, got {shown(line)}")
        if columns > 2 or len(found) != columns or (columns == 2 and not np.isfinite(found[0])):
            raise NoTableError(
                f"{path}, line {number}, must have one or two numbers, with decimal points and as many as the lines "
                f"before, or begin with #, got {shown(line)}"
            )
        rows += [[np.nan]] * gap + [found]
        gap, commented = 0, 0
        if len(rows) > MAX_HEIGHTS:
            break  # no trace has so many
    if not rows:
        words = next((heading for heading in headings if heading), "")
        raise NoTableError(
            f"{path} must have one or two columns of numbers, got none{words and f', but {shown(words)}'}"
        )
    return headings, rows + [[np.nan]] * commented


def _numbers(line: str) -> list[float]:
    """The numbers of a line, NaN where one is missing; none of a line that has anything else, or nothing."""
    fields = re.split(r"\s*[,;\s]\s*", line.strip())
    while len(fields) > 2 and not fields[-1]:
        fields.pop()  # separators at the end
    try:
        numbers = [np.nan if not field or field.lower() in NO_NUMBER else float(field) for field in fields]
    except ValueError:
        return []
    return numbers if line.strip() else []


def _units(headings: list[str], columns: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The units that headings name for positions and for heights.

    The lines before the numbers are headings of columns, and so is the last comment among them. Other comments count
    where they speak of units, as those of Gwyddion do.
    """
    written = [line for line in headings if line]
    x_units: list[str] = []
    height_units: list[str] = []
    for line in written:
        found = units_in(line.lstrip("#").strip())
        if line.startswith("#") and re.search(r"\bunits?\b", line, re.IGNORECASE) and len(found) == 1:
            lateral = OF_POSITIONS.search(line)
            of_both = columns == 2 and re.match(r"#\s*units?\b", line, re.IGNORECASE)
            x_units += found if lateral or of_both else []
            height_units += [] if lateral else found
        elif not line.startswith("#") or line is written[-1]:
            if len(found) == columns == 2:
                x_units.append(found[0])
                height_units.append(found[1])
            elif len(found) == columns == 1 and (not line.startswith("#") or OF_HEIGHTS.match(line)):
                height_units.append(found[0])
    return tuple(filter(None, x_units)), tuple(filter(None, height_units))
