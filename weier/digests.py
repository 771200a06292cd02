"""Digests of the values, modules and package versions on which curves and products depend.

A module counts as its syntax tree without docstrings and annotations, so that words about code change nothing. No
name is followed: a module is in a digest, or it is not.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).parent
PACKAGES = ("numpy", "scipy", "numba", "rocket-fft")  # Numbers depend on the versions of these packages.
SOURCES = (".py", ".css", ".html", ".js", ".mplstyle")  # those other than ".py" count as texts
DIGITS = 12  # length of a digest in file names
KERNELS = ("kernels", "surface", "theory", "methods")  # rooms that contain all compiled functions
# Rooms and modules that compute a curve from the parameters of its surface and store it.
CURVES = (
    *KERNELS,
    "digests.py",
    "checks.py",
    "units.py",
    "api/rows.py",
    "api/task.py",
    "scene/case.py",
    "scene/identity.py",
    "scene/study.py",
    "scene/yaml.py",
    "pipeline/needed_curves.py",
    "pipeline/jobs.py",
    "pipeline/store.py",
)
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def digest(values: Any) -> str:
    """Return a digest of plain values, of which arrays count as their bytes."""
    plain = json.dumps(values, sort_keys=True, default=lambda array: hashlib.sha256(array.data).hexdigest())
    return hashlib.sha256(plain.encode()).hexdigest()


def numerics() -> str:
    """Return a digest of the code that is on disk now and of the versions of packages.

    The numbers of a curve depend on it besides the surface, the method and the loads.
    """
    return digest([digest_of_modules(*CURVES)[:DIGITS], versions()])[:DIGITS]


def digest_of_modules(*parts: str) -> str:
    """Return a digest of all source files of some rooms, and of single modules, as they are on disk now.

    Syntax trees take 0.7 s, texts some milliseconds: the digest is remembered by that of the texts, in the cache.
    """
    texts = {path: (PACKAGE / path).read_bytes() for path in files_of(parts)}
    if not texts:  # without sources (a zip), two versions would have one digest
        raise OSError(f"there are no sources of weier in {PACKAGE}, which name what depends on them")
    known = digest([[path, hashlib.sha256(text).hexdigest()] for path, text in texts.items()])
    path = cache_root() / "digests" / known
    with suppress(OSError):
        if len(found := path.read_text(encoding="ascii")) == len(known):
            return found
    found = digest([[name, _plain(name, text)] for name, text in texts.items()])
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(found, encoding="ascii")  # readers check the length
    return found


@cache
def versions() -> str:
    """Return the versions of the packages on which numbers depend, as text."""
    from importlib.metadata import version  # takes longer than all imports above

    return ", ".join(f"{name} {version(name)}" for name in PACKAGES)


def cache_root() -> Path:
    """Return the cache folder of weier, in NUMBA_CACHE_DIR or in the user's cache.

    Without a home directory, as in a container, it is a path at which no file can be written.
    """
    if own := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(own)
    if caches := os.environ.get("XDG_CACHE_HOME"):
        return Path(caches, "weier")
    try:
        return Path.home() / ".cache" / "weier"
    except RuntimeError:
        return Path(os.devnull)


def files_of(parts: Iterable[str]) -> list[str]:
    """Return the paths, in the package, of all source files of some rooms and of single modules."""
    found = (path for part in map(PACKAGE.joinpath, parts) for path in (part, *part.rglob("*")))
    return sorted(path.relative_to(PACKAGE).as_posix() for path in found if path.suffix in SOURCES)


@cache
def _plain(name: str, text: bytes) -> str:
    """Return a digest of a text; for a module, docstrings, annotations and comments do not count."""
    if not name.endswith(".py"):
        return hashlib.sha256(text).hexdigest()
    tree = ast.parse(text)
    for node in ast.walk(tree):
        for words in {"annotation", "returns"}.intersection(node._fields):
            setattr(node, words, None)
        if isinstance(node, DOCUMENTED) and ast.get_docstring(node, clean=False) is not None:
            del node.body[0]
    # `dump` omits empty fields, which differ between versions of Python.
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()
