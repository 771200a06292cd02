"""Digests of what compiled kernels, numbers and pictures depend on: they are made again where one has changed.

What a step depends on is known by folders of the package, whose texts are digested: no digest misses anything, and
where a comment in them is edited, the step runs again.
"""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).parent
KERNELS = ("kernels", "theory", "methods")  # what is compiled
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
