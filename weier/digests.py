"""Digests of the dependencies of compiled kernels, numbers and figures, which are remade if a digest changes.

The dependencies of a step are whole folders of the package, whose text files are digested. So no dependency is
missed, and a step also runs again after a change of a comment.
"""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).parent
KERNELS = ("kernels", "surface", "theory", "methods")  # All compiled functions are in these folders.
# The text files of the package have these suffixes.
SUFFIXES = {".py", ".json", ".js", ".css", ".html", ".md", ".mplstyle"}


@cache
def digest_of_program(*parts: str) -> str:
    """A digest of all texts in some folders and files of the package."""
    paths = {path for part in parts for path in (PACKAGE / part, *(PACKAGE / part).rglob("*"))}
    texts = [path for path in sorted(paths) if path.suffix in SUFFIXES]
    return digest([[str(path.relative_to(PACKAGE)), path.read_text(encoding="utf-8")] for path in texts])


def digest(values: Any) -> str:
    """A digest of plain values."""
    return hashlib.sha256(json.dumps(values).encode()).hexdigest()
