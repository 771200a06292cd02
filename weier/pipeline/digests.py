"""Digests of definitions, kept from run to run: finding them takes most of a second, and looking them up a fiftieth.

They belong to the texts of all modules of the package, whose digest stands in the name of their file: where any of
these has changed, all are found anew, and two checkouts that are used in turn each keep theirs.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Collection, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path

from weier.data.files import write_text
from weier.kernels.definitions import definitions
from weier.kernels.jit import base_folder
from weier.kernels.sources import PACKAGE

MAX_FILES = 8  # of digests, for as many checkouts and Pythons in turn: where more are written, the oldest go


def digest_of_definitions(*names: str, without: Collection[str] = ()) -> str:
    """A digest of `definitions` of the same arguments."""
    sources = _sources()  # before anything is parsed: what is edited after this is not kept
    known, key = _known(sources), json.dumps([sorted(names), sorted(without)])
    if key not in known:
        known[key] = digest(definitions(*names, without=without))
        _keep(known, sources)
    return known[key]


def digest(texts: Mapping[str, str]) -> str:
    """A digest of texts and of their names, in whatever order they come."""
    return hashlib.sha256(repr(sorted(texts.items())).encode()).hexdigest()


def texts_of_modules() -> dict[str, str]:
    """The texts of all modules of the package, by their files."""
    return {str(path.relative_to(PACKAGE)): path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}


def _file(sources: str) -> Path:
    return base_folder() / f"digests-{sources[:16]}.json"


@cache
def _known(sources: str) -> dict[str, str]:
    """Digests by the arguments of `definitions`: those that the file of these sources has, and those found since."""
    with suppress(OSError, TypeError, ValueError):  # whatever else has written there
        return dict(json.loads(_file(sources).read_text(encoding="utf-8")))
    return {}


def _keep(known: Mapping[str, str], sources: str) -> None:
    """Write the file, where that is possible and the sources are still those that this process began with."""
    with suppress(OSError):
        if _read_sources() == sources:
            write_text(_file(sources), json.dumps(known, indent=1))
            _remove_oldest()


def _remove_oldest() -> None:
    files = sorted(base_folder().glob("digests-*.json"), key=lambda path: path.stat().st_mtime)
    for path in files[:-MAX_FILES]:
        path.unlink()


@cache
def _sources() -> str:
    return _read_sources()


def _read_sources() -> str:
    """A digest of all modules, and of Python, which writes the texts of definitions."""
    return digest(texts_of_modules() | {"Python": sys.version})
