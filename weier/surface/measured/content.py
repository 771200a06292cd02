"""Content of a file: text in its encoding, or a named kind of binary file."""

from __future__ import annotations

import codecs
import re
import zipfile
from contextlib import suppress
from pathlib import Path

from weier.checks import shown

HEAD = 2**16  # bytes that identify the kind of a file
MAX_BYTES = 2 * 10**8  # 10^6 rows of 200 characters
MARKS = {  # Byte-order marks; UTF-32 before UTF-16, whose mark it begins with.
    b"\xff\xfe\0\0": "utf-32",
    b"\0\0\xfe\xff": "utf-32",
    b"\xff\xfe": "utf-16",
    b"\xfe\xff": "utf-16",
}
END_OF_FILE = "\x1a"  # DOS programs end a text by this sign.
BINARY = re.compile(rb"[\x00-\x08\x0e-\x19\x1c-\x1f]")  # Control characters that no text has.

# Kinds of files that are no text, by their first bytes, with the remedy for each; others are saved as text.
SAVE_AS_TEXT, UNPACK = "save the heights as text", "unpack it"
SIGNATURES = {
    b"\xd0\xcf\x11\xe0": ("a workbook or document of an old Office (.xls)", SAVE_AS_TEXT),
    b"\x1f\x8b": ("compressed by gzip", UNPACK),
    b"BZh": ("compressed by bzip2", UNPACK),
    b"\xfd7zXZ": ("compressed by xz", UNPACK),
    b"\x89HDF": ("an HDF5 or netCDF file", "take its heights by xarray or h5py, and weier.Trace"),
    **dict.fromkeys((b"CDF\x01", b"CDF\x02"), ("a netCDF file", "take its heights by xarray, and weier.Trace")),
    b"\x93NUMPY": ("an array of NumPy", "take weier.Trace of what numpy.load returns"),
}
# Kinds of zip archives by a member that only they have, and the remedy for each.
ARCHIVES = {
    "xl/workbook.xml": ("a workbook (.xlsx)", "save its sheet as text"),
    "content.xml": ("a workbook or document of OpenDocument (.ods)", "save its sheet as text"),
    "main.xml": ("an X3P file of ISO 25178-72", SAVE_AS_TEXT),
}


class NoTextError(ValueError):
    """A file that is no text, but may be in the format of an instrument: the message names its kind."""


def read_text(path: Path, encoding: str | None = None) -> str:
    """Return the text of a file, in the given encoding or in UTF-8, UTF-16 by its mark, or that of old Windows.

    Raises
    ------
    NoTextError
        If the file is no text.
    ValueError
        If the text is not in this encoding, or in UTF-16 without a mark.
    """
    if path.stat().st_size > MAX_BYTES:
        with path.open("rb") as file:
            _check_kind(path, file.read(HEAD), encoding)
        raise ValueError(f"{path} must be a text of at most {MAX_BYTES:.0e} bytes: keep one line of heights in it")
    content = path.read_bytes()
    _check_kind(path, content, encoding)
    try:
        text = _decoded(content, encoding)
    except LookupError:
        raise ValueError(
            f"encoding must be one that Python knows, as in encoding='latin-1', got {shown(encoding)}"
        ) from None
    except UnicodeError as error:
        raise ValueError(f"encoding must be that of {path}, got {shown(encoding)}: {error}") from None
    return text.lstrip("\ufeff").rstrip(END_OF_FILE)


def _decoded(content: bytes, encoding: str | None) -> str:
    if encoding is not None:
        return content.decode(encoding)
    if marked := next((name for mark, name in MARKS.items() if content.startswith(mark)), None):
        return content.decode(marked)
    content = content.removeprefix(codecs.BOM_UTF8)
    try:
        return content.decode()
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace")  # encoding of text that is not UTF-8


def _check_kind(path: Path, content: bytes, encoding: str | None) -> None:
    """Refuse content that is no text, unless an encoding is given or a mark names one."""
    if encoding is not None or content.startswith(tuple(MARKS)):
        return
    known = next((kind for start, kind in SIGNATURES.items() if content.startswith(start)), None)
    if content.startswith(b"PK\x03\x04"):
        known = ("a zip archive", UNPACK)
        with suppress(zipfile.BadZipFile, OSError), zipfile.ZipFile(path) as archive:
            members = archive.namelist()
            known = next((kind for member, kind in ARCHIVES.items() if member in members), known)
    if known is None and (order := _order_of_utf_16(content[:HEAD])):
        raise ValueError(f"{path} must have a mark if it is UTF-16 text: say encoding='utf-16-{order}'")
    text = content.rstrip(END_OF_FILE.encode())
    if known is None and (first := BINARY.search(text)):
        # Random bytes have ten times as many control characters.
        if len(BINARY.findall(text)) < 0.01 * len(text):
            line = text.count(b"\n", 0, first.start()) + 1
            raise ValueError(
                f"{path}, line {line}, must be text, got the control character {first[0]!r}: leave it out, or say "
                "encoding="
            )
        known = ("no text", SAVE_AS_TEXT)
    if known is not None:
        raise NoTextError(f"{path} is {known[0]}, not a table of heights as text: {known[1]}")


def _order_of_utf_16(head: bytes) -> str:
    """Return the byte order of UTF-16 text without a mark, recognised by its zero bytes; otherwise empty."""
    head = head[: len(head) // 2 * 2]
    halves = {"le": (head[1::2], head[::2]), "be": (head[::2], head[1::2])}
    for order, (zeros, letters) in halves.items():
        if zeros and not any(zeros) and not BINARY.search(letters):
            return order
    return ""
