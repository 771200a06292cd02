"""One decorator for all kernels: numba, from the first call on, with a disk cache that cannot go stale.

A program that calls no kernel does not import numba, which takes half a second. `weier.kernels.compiler` holds all
that needs it.
"""

from __future__ import annotations

import functools
import hashlib
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, cached_property
from pathlib import Path
from time import perf_counter
from typing import Any, TypeVar, cast

from weier.kernels.interruption import run_kernel
from weier.kernels.sources import PACKAGE, sources

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel_sources() -> list[Path]:
    """The files of the package that define kernels, and all that they import, sorted.

    Modules called `method` are left out: they gather what the program knows of a method, and no kernel uses that.
    """
    kernels = [path for path in PACKAGE.rglob("*.py") if "@kernel" in path.read_text(encoding="utf-8")]
    modules = [".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts) for path in kernels]
    return [PACKAGE.parent / path for path in sources(*modules, without=["method"])]


def base_folder() -> Path:
    """Where the program keeps what it made of its own sources: NUMBA_CACHE_DIR, or a folder in the user's cache.

    Raises OSError, as a folder that is closed to writing, for a user who has no home.
    """
    if chosen := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(chosen)
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "weier"
    except RuntimeError as error:
        raise OSError("there is no home folder to keep compiled kernels in: set NUMBA_CACHE_DIR") from error


def cache_folder() -> Path:
    """Where compiled kernels live: in a folder below, named by a digest.

    It is one of every source file that kernels stand in or import from, and of the versions of numba and rocket-fft:
    edit any of them and all kernels compile afresh, once, for all copies of the package with these sources. numba
    alone stamps a kernel with its own file, so that an edited callee or constant of another module is ignored.
    """
    from importlib.metadata import version  # which takes longer than all that is imported above

    stamp = hashlib.sha256()
    for path in kernel_sources():
        stamp.update(path.read_bytes())
    stamp.update(f"{version('numba')} {version('rocket-fft')} {sys.version}".encode())
    return base_folder() / f"weier-{stamp.hexdigest()[:16]}"


@cache
def folder() -> Path:
    """The folder of this process: what it has imported stays as it is, whatever is edited meanwhile."""
    return cache_folder()


def disabled() -> bool:
    """Whether the kernels run as plain Python, NUMBA_DISABLE_JIT=1."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


class Stopwatch:
    """The seconds that each thread has spent inside: it imports numba, compiles a kernel, loads one, or waits."""

    def __init__(self) -> None:
        self.of_thread = threading.local()

    def start(self) -> None:
        """Begin to count, unless this thread does so already."""
        depth = getattr(self.of_thread, "depth", 0)
        if depth == 0:
            self.of_thread.since = perf_counter()
        self.of_thread.depth = depth + 1

    def stop(self) -> None:
        """End what began last."""
        self.of_thread.depth -= 1
        if self.of_thread.depth == 0:
            self.of_thread.seconds = self.seconds() + perf_counter() - self.of_thread.since

    def seconds(self) -> float:
        """Those of this thread so far."""
        return getattr(self.of_thread, "seconds", 0.0)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Count in a `with` statement."""
        self.start()
        try:
            yield
        finally:
            self.stop()


COMPILING = Stopwatch()


def compiling_seconds() -> float:
    """What this thread has spent so far on compiling and loading kernels: once a process, and no cost of a solve."""
    return COMPILING.seconds()


def announce_compiling(say: Callable[[str], None]) -> None:
    """Call `say` with the module of each kernel that the cache does not hold, before it is compiled.

    Without a word, nothing would be seen for many seconds.
    """
    LISTENERS.append(say)


LISTENERS: list[Callable[[str], None]] = []


class Kernel:
    """A function that numba compiles at the first call."""

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self.function = function

    def __call__(self, *arguments: Any) -> Any:
        """Run the compiled function."""
        return run_kernel(self.compiled, arguments)

    @cached_property
    def compiled(self) -> Any:
        """What a call from Python runs, numba's dispatcher: cached on disk with all kernels that it calls."""
        with COMPILING.running():
            from weier.kernels import compiler

            return compiler.entry(self.function)

    @cached_property
    def _numba_type_(self) -> Any:  # numba's name for the type that an object has in compiled code
        from weier.kernels import compiler

        return compiler.inner_type(self.function)


def kernel(function: Function) -> Function:
    """Compile `function` with numba on first call: arrays in, arrays out, IEEE division, no GIL."""
    return function if disabled() else cast(Function, Kernel(function))
