"""Digests of definitions, kept from run to run: finding them takes most of a second, and looking them up a fiftieth.

They belong to the texts of all modules of the package, whose digest stands beside them: where any of these has
changed, all are found anew.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Collection, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from weier.data.files import write_text
from weier.kernels.definitions import definitions
from weier.kernels.jit import base_folder
from weier.kernels.sources import PACKAGE


def digest_of_definitions(*names: str, without: Collection[str] = ()) -> str:
    """A digest of `definitions` of the same arguments."""
    known, key = _known(), json.dumps([sorted(names), sorted(without)])
    if key not in known:
        known[key] = digest(definitions(*names, without=without))
        _keep(known)
    return known[key]


def digest(texts: Mapping[str, str]) -> str:
    """One of texts by name, in whatever order."""
    return hashlib.sha256(repr(sorted(texts.items())).encode()).hexdigest()


def texts_of_modules() -> dict[str, str]:
    """The texts of all modules of the package, by their files."""
    return {str(path.relative_to(PACKAGE)): path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}


def _file() -> Path:
    return base_folder() / "digests.json"


@cache
def _known() -> dict[str, str]:
    """Digests by the arguments of `definitions`: those of this program that the file has, and those found since."""
    kept: Any = {}
    with suppress(OSError, ValueError):
        kept = json.loads(_file().read_text(encoding="utf-8"))
    try:
        return dict(kept["digests"]) if kept["sources"] == _sources() else {}
    except (KeyError, TypeError, ValueError):  # whatever else has written there
        return {}


def _keep(known: Mapping[str, str]) -> None:
    """Write the file, where that is possible and the sources are still those that this process began with."""
    with suppress(OSError):
        if _read_sources() == _sources():
            write_text(_file(), json.dumps({"sources": _sources(), "digests": known}, indent=1))


@cache
def _sources() -> str:
    return _read_sources()


def _read_sources() -> str:
    """A digest of all modules, and of Python, which writes the texts of definitions."""
    return digest(texts_of_modules() | {"Python": sys.version})
