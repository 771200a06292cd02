"""One decorator for all kernels: numba, from the first call on, with a cache on disk that cannot go stale.

A program that calls no kernel does not import numba, which takes half a second. The page "Compiled kernels" of the
documentation says what is here beside numba, and why.
"""

from __future__ import annotations

import fcntl
import functools
import os
import shutil
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from threading import RLock
from time import perf_counter
from types import FunctionType
from typing import Any, TypeVar, cast

from weier.digests import PACKAGE, cache_root, digest, digest_of_kernels

Function = TypeVar("Function", bound=Callable[..., Any])

# Kernels run as plain Python, which a debugger can follow.
DISABLED = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
NOT_CACHED = "kernels are compiled for this run alone ({}): let NUMBA_CACHE_DIR name a folder that keeps them"
# One thread at a time compiles. The lock is reentrant, since a kernel may need another one.
LOCK = RLock()
# The seconds that a thread has spent on compiling and loading kernels. A process spends them once, so that they are
# subtracted from the seconds of a solution.
COMPILING_SECONDS = ContextVar("seconds", default=0.0)


OPTIONS = {"nogil": True, "error_model": "numpy"}  # of numba, for all kernels
# Kernels that are not yet registered with numba.
UNREGISTERED: list[Kernel] = []


def announce(module: str) -> None:
    """Print that a kernel of this module is compiled, which takes many seconds without any other output."""
    package, _, name = module.removeprefix("weier.").partition(".")
    method, _, part = name.partition(".")
    _say_once(method if package == "methods" and part else "common kernels")


@functools.cache
def _say_once(what: str) -> None:
    print(f"compiling {what}, once for all later runs", file=sys.stderr, flush=True)


@functools.cache
def cache_folder() -> Path:
    """Return the folder of compiled kernels, named by a digest of their code and of the versions that compiled it.

    A comment, a docstring, or code that no kernel runs does not change the digest. Copies of the same code share the
    folder. What a process has imported stays as it is, whatever is edited meanwhile.

    Raises
    ------
    OSError
        If there is no folder to keep anything in: see `cache_root`.
    """
    from importlib.metadata import version  # which takes longer than all that is imported above

    made_of = digest_of_kernels(), OPTIONS, version("numba"), version("rocket-fft")
    return cache_root() / f"weier-{digest(made_of)[:16]}"


class Kernel:
    """A function that numba compiles when Python first calls it, with all kernels that it calls."""

    compiled: Any = None

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self.function, self.name = function, f"{function.__module__}.{function.__qualname__}"
        UNREGISTERED.append(self)

    def __call__(self, *arguments: Any) -> Any:
        """Run the compiled function."""
        if self.compiled is None:
            start = perf_counter()
            with LOCK:
                self.compiled = self.compiled or self._compile(arguments)
            COMPILING_SECONDS.set(COMPILING_SECONDS.get() + perf_counter() - start)
        try:
            return self.compiled(*arguments)
        except SystemError as error:  # numba runs Python for each array that it returns, where Ctrl-C may come
            cause: Any = error
            while cause.__cause__:
                cause = cause.__cause__
            raise cause from None

    def _compile(self, arguments: tuple[Any, ...]) -> Any:
        """The kernel from the cache, or else compiled, and kept there.

        If the cache is damaged or not writable, the kernel is compiled for this process alone. A damaged entry is
        removed, so that the next process makes it again.
        """
        import numba

        _register_kernels()
        types = tuple(map(numba.typeof, arguments))
        try:
            return self._cached(types)
        except Exception as error:  # there is no home, a folder or disk takes no files, or pickle reads torn ones
            with suppress(OSError):
                shutil.rmtree(cache_folder() / self.name)
            compiled = self._compiled(self.function, types)  # which raises what is wrong with the kernel itself
            warnings.warn(NOT_CACHED.format(f"{type(error).__name__}: {error}"), RuntimeWarning, stacklevel=1)
            return compiled

    def _cached(self, types: tuple[Any, ...]) -> Any:
        """The kernel from its own folder in the cache, or compiled into it, by one process at a time."""
        import numba

        folder = cache_folder() / self.name
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / "lock").open("w") as file:
            with suppress(OSError):  # of a disk without locks, where each process compiles for itself
                fcntl.flock(file, fcntl.LOCK_EX)
            if not any(folder.rglob("*.nbi")):
                announce(self.function.__module__)
            before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, str(folder)
            try:
                return self._compiled(self._without_place(folder), types, cache=True)
            finally:
                numba.config.CACHE_DIR = before

    def _without_place(self, folder: Path) -> Callable[..., Any]:
        """Return the function without its file and line, which numba digests: the name of the folder is enough.

        The folder has a digest of kernels of the package only: others keep their files.
        """
        if not self.name.startswith(f"{PACKAGE.name}."):
            return self.function
        file = folder / "source.py"
        file.touch()
        code = self.function.__code__.replace(co_filename=str(file), co_firstlineno=1)
        function = FunctionType(code, self.function.__globals__, None, self.function.__defaults__)
        return functools.update_wrapper(function, self.function)

    def _compiled(self, function: Callable[..., Any], types: tuple[Any, ...], **options: Any) -> Any:
        """The function, compiled for arguments of these types."""
        import numba

        compiled = numba.njit(**OPTIONS, **options)(function)
        with _raising_lost_interrupts():
            compiled.compile(types)
        return compiled


@contextmanager
def _raising_lost_interrupts() -> Iterator[None]:
    """Raise Ctrl-C that comes while LLVM calls Python: no exception passes through C, and Python only reports it."""
    hook, lost = sys.unraisablehook, list[Any]()
    sys.unraisablehook = lambda it: lost.append(it) if it.exc_type is KeyboardInterrupt else hook(it)
    try:
        yield
    finally:
        sys.unraisablehook = hook
        if lost:
            raise KeyboardInterrupt


def _register_kernels() -> None:
    """Register the kernels that were defined since the last call with numba, so that kernels can call each other."""
    import rocket_fft  # noqa: F401 - which registers numpy's Fourier transforms
    from numba.extending import overload

    options: Any = {"error_model": "numpy", "no_cfunc_wrapper": True}
    while UNREGISTERED:
        kernel = UNREGISTERED[-1]
        overload(kernel, options, strict=False)(lambda *_, function=kernel.function: function)
        UNREGISTERED.remove(kernel)  # at the end, since Ctrl-C may come before


def kernel(function: Function) -> Function:
    """Compile `function` with numba on first call: arrays in, arrays out, IEEE division, no GIL."""
    return function if DISABLED else cast(Function, Kernel(function))
