"""Content of a file: text in its encoding, or no text."""

from __future__ import annotations

import codecs
import re
from pathlib import Path

from weier.checks import shown

HEAD = 2**16  # bytes of a large file that show whether it is text
MAX_BYTES = 2 * 10**8  # 10^6 rows of 200 characters
MARKS = {  # Byte-order marks; UTF-32 before UTF-16, whose mark it begins with.
    b"\xff\xfe\0\0": "utf-32",
    b"\0\0\xfe\xff": "utf-32",
    b"\xff\xfe": "utf-16",
    b"\xfe\xff": "utf-16",
}
END_OF_FILE = "\x1a"  # DOS programs end a text by this sign.
BINARY = re.compile(rb"[\x00-\x08\x0e-\x19\x1c-\x1f]")  # Control characters that no text has.


class NoTextError(ValueError):
    """A file that is no text, but may be in the format of an instrument."""


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
            _check_text(path, file.read(HEAD), encoding)
        raise ValueError(f"{path} must be a text of at most {MAX_BYTES:.0e} bytes: keep one line of heights in it")
    content = path.read_bytes()
    _check_text(path, content, encoding)
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


def _check_text(path: Path, content: bytes, encoding: str | None) -> None:
    """Refuse content that is no text, unless an encoding is given or a mark names one."""
    text = content.rstrip(END_OF_FILE.encode())
    if encoding is not None or content.startswith(tuple(MARKS)) or not (first := BINARY.search(text)):
        return
    # Random bytes have ten times as many control characters.
    if len(BINARY.findall(text)) < 0.01 * len(text):
        line = text.count(b"\n", 0, first.start()) + 1
        raise ValueError(
            f"{path}, line {line}, must be text, got the control character {first[0]!r}: leave it out, or say "
            "encoding="
        )
    raise NoTextError(
        f"{path} is no text: save the heights as text, such as the sheet of a workbook as CSV, unpack an archive, or "
        "say encoding='utf-16-le' or the like"
    )
