"""One decorator for all kernels: numba with a disk cache that cannot go stale.

numba stamps a cached kernel with the file that it stands in, so that an edited callee or constant of another
module would be ignored. Here the cache folder is named by a hash of every source file that kernels stand in or
import from, and of the versions of numba and rocket-fft: edit any of them and all kernels compile afresh, once,
for all processes that import this copy of the package.
"""

from __future__ import annotations

import hashlib
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import Any, TypeVar, cast

import numba
from numba.core import event

from weier.kernels.sources import PACKAGE, sources

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel_sources() -> list[Path]:
    """The files of the package that define kernels, and all that they import, sorted.

    Modules called `method` are left out: they gather what the program knows of a method, and no kernel uses that.
    """
    kernels = [path for path in PACKAGE.rglob("*.py") if "@kernel" in path.read_text(encoding="utf-8")]
    modules = [".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts) for path in kernels]
    return [PACKAGE.parent / path for path in sources(*modules, without=["method"])]


def cache_folder() -> Path:
    """Where compiled kernels live: NUMBA_CACHE_DIR or the user's cache folder, then the hash."""
    stamp = hashlib.sha256()
    for path in kernel_sources():
        stamp.update(path.read_bytes())
    stamp.update(f"{version('numba')} {version('rocket-fft')} {sys.version}".encode())
    user = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    base = Path(os.environ.get("NUMBA_CACHE_DIR") or Path(user) / "weier")
    return base / f"weier-{stamp.hexdigest()[:16]}"


_FOLDER = str(cache_folder())


def disabled() -> bool:
    """Whether the kernels run as plain Python, NUMBA_DISABLE_JIT=1."""
    config: Any = numba.config
    return bool(config.DISABLE_JIT)


@contextmanager
def _cached_here() -> Iterator[None]:
    # numba reads the folder when a function is decorated; other packages keep their own.
    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, _FOLDER
    try:
        yield
    finally:
        config.CACHE_DIR = before


class _Compiling(event.Listener):
    """The seconds of each thread under numba's lock: it compiles a kernel, loads one, or waits for another thread."""

    def __init__(self) -> None:
        self.of_thread = threading.local()

    def on_start(self, event: Any) -> None:
        depth = getattr(self.of_thread, "depth", 0)
        if depth == 0:
            self.of_thread.since = perf_counter()
        self.of_thread.depth = depth + 1

    def on_end(self, event: Any) -> None:
        self.of_thread.depth -= 1
        if self.of_thread.depth == 0:
            self.of_thread.seconds = self.seconds() + perf_counter() - self.of_thread.since

    def seconds(self) -> float:
        return getattr(self.of_thread, "seconds", 0.0)


_COMPILING = _Compiling()
event.register("numba:compiler_lock", _COMPILING)  # type: ignore[no-untyped-call]  # numba has no types


def compiling_seconds() -> float:
    """What this thread has spent so far on compiling and loading kernels: once a process, and no cost of a solve."""
    return _COMPILING.seconds()


class _FirstCompiling(event.Listener):
    """Calls `say` when the first kernel is compiled that the cache does not hold."""

    def __init__(self, say: Callable[[], None]) -> None:
        self.say: Callable[[], None] | None = say

    def on_start(self, event: Any) -> None:
        if self.say:
            self.say()
        self.say = None

    def on_end(self, event: Any) -> None:
        pass


def announce_compiling(say: Callable[[], None]) -> None:
    """Call `say` once, when the first kernel is compiled: without a word, nothing would be seen for many seconds."""
    event.register("numba:compile", _FirstCompiling(say))  # type: ignore[no-untyped-call]  # numba has no types


def kernel(function: Function) -> Function:
    """Compile `function` with numba on first call: arrays in, arrays out, IEEE division, no GIL."""
    with _cached_here():
        compiled: Any = numba.njit(cache=True, error_model="numpy", nogil=True)(function)
    if not disabled():
        _forgive(compiled._cache)
    return cast(Function, compiled)


def _forgive(cache: Any) -> None:
    """Treat a damaged file of the cache as a missing one; numba alone would fail on it in every run."""
    load = cache.load_overload

    def load_or_forget(*arguments: Any) -> Any:
        try:
            return load(*arguments)
        except Exception:  # whatever pickle makes of torn bytes
            cache.flush()
            return None

    cache.load_overload = load_or_forget
