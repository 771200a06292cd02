"""One decorator for all kernels: numba, from the first call on, with a cache on disk that cannot go stale.

A program that calls no kernel does not import numba, which takes half a second.
"""

from __future__ import annotations

import fcntl
import functools
import os
import shutil
import sys
import warnings
from collections.abc import Callable
from contextlib import suppress
from contextvars import ContextVar
from pathlib import Path
from threading import RLock
from time import perf_counter
from typing import Any, TypeVar, cast

from weier.digests import KERNELS, PACKAGE, digest, digest_of_program

Function = TypeVar("Function", bound=Callable[..., Any])

DISABLED = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")  # kernels run as plain Python
TOLD = "kernels are compiled for this run alone ({}): let NUMBA_CACHE_DIR name a folder that keeps them"
LOCK = RLock()
# What a thread has spent so far on compiling and loading kernels: once a process, and no cost of a solve.
COMPILING_SECONDS = ContextVar("seconds", default=0.0)


@functools.cache
def _announce(what: str) -> None:
    print(f"compiling {what}, once for all later runs", file=sys.stderr, flush=True)


def _owner(module: str) -> str:
    """The method in whose folder a module of kernels is, or else what it is for."""
    package, _, name = module.removeprefix("weier.").partition(".")
    method, _, part = name.partition(".")
    return method if package == "methods" and part else "what methods share"


# Called with the module of each kernel that the cache does not hold, before it is compiled: for many seconds, nothing
# else would be seen. A method is announced once.
LISTENERS: list[Callable[[str], None]] = [lambda module: _announce(_owner(module))]
UNKNOWN: list[Kernel] = []  # to numba


@functools.cache
def cache_folder() -> Path:
    """Where compiled kernels live, in NUMBA_CACHE_DIR or the cache of the user: named by a digest of their sources.

    numba alone stamps a kernel with its own file, so that an edited callee or constant of another module is ignored.
    It compiles again for sources in another place, whose folder has another name then, too.
    What a process has imported stays as it is, whatever is edited meanwhile.

    Raises
    ------
    OSError
        If the user has no home directory, as in a container that knows no such user, and no variable names a cache.
    """
    from importlib.metadata import version  # which takes longer than all that is imported above

    made_of = digest_of_program(*KERNELS), str(PACKAGE), version("numba"), version("rocket-fft")
    own = os.environ.get("NUMBA_CACHE_DIR")
    caches = os.environ.get("XDG_CACHE_HOME")
    if not own and not caches:
        try:
            caches = str(Path.home() / ".cache")
        except RuntimeError:
            raise OSError("there is no home directory for the cache") from None
    return Path(own or Path(str(caches), "weier"), f"weier-{digest(made_of)[:16]}")


class Kernel:
    """A function that numba compiles when Python first calls it, with all kernels that it calls."""

    compiled: Any = None

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self.function, self.name = function, f"{function.__module__}.{function.__qualname__}"
        UNKNOWN.append(self)

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
        """The kernel from its own folder in the cache, or compiled for it.

        Where the cache cannot be used, it is compiled for this process alone, and a torn folder is removed.
        Ctrl-C may come while LLVM calls Python. No exception passes through C, so that Python only reports it, and it
        is raised here.
        """
        import numba

        _introduce_kernels()
        types = tuple(map(numba.typeof, arguments))
        base, hook, lost = numba.config.CACHE_DIR, sys.unraisablehook, list[Any]()
        folder: Path | None = None
        try:
            sys.unraisablehook = lambda it: lost.append(it) if it.exc_type is KeyboardInterrupt else hook(it)
            try:
                folder = cache_folder() / self.name
            except OSError as error:
                warnings.warn(TOLD.format(error), RuntimeWarning, stacklevel=1)
                return self._compiled(types)
            return self._compiled_into(folder, types)
        except Exception as error:  # a folder or disk that takes no files, or what pickle makes of torn ones
            if lost or folder is None:
                raise
            shutil.rmtree(folder, ignore_errors=True)
            compiled = self._compiled(types)  # which raises what is wrong with the kernel, if that was it
            warnings.warn(TOLD.format(repr(error)), RuntimeWarning, stacklevel=1)
            return compiled
        finally:
            numba.config.CACHE_DIR, sys.unraisablehook = base, hook
            if lost:
                raise KeyboardInterrupt

    def _compiled_into(self, folder: Path, types: tuple[Any, ...]) -> Any:
        """The kernel from its folder in the cache, or compiled into it, by one process at a time."""
        import numba

        folder.mkdir(parents=True, exist_ok=True)
        with (folder / "lock").open("w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            os.utime(folder.parent)
            if not any(folder.rglob("*.nbi")):
                with suppress(OSError):  # another process may be at it; the three that were used last stay
                    for earlier in sorted(folder.parent.parent.glob("weier-*"), key=os.path.getmtime)[:-3]:
                        shutil.rmtree(earlier, ignore_errors=True)
                for say in LISTENERS:
                    say(self.function.__module__)
            numba.config.CACHE_DIR = str(folder)
            return self._compiled(types, cache=True)

    def _compiled(self, types: tuple[Any, ...], **options: Any) -> Any:
        """The kernel, compiled for arguments of these types."""
        import numba

        compiled = numba.njit(nogil=True, error_model="numpy", **options)(self.function)
        compiled.compile(types)
        return compiled


def _introduce_kernels() -> None:
    """Tell numba of the kernels that were defined since the last time, for others to call as parts of theirs."""
    import rocket_fft  # noqa: F401 - which registers numpy's Fourier transforms
    from numba.extending import overload

    options: Any = {"error_model": "numpy", "no_cfunc_wrapper": True}
    while UNKNOWN:
        kernel = UNKNOWN[-1]
        overload(kernel, options, strict=False)(lambda *_, function=kernel.function: function)
        UNKNOWN.remove(kernel)  # at the end, since Ctrl-C may come before


def kernel(function: Function) -> Function:
    """Compile `function` with numba on first call: arrays in, arrays out, IEEE division, no GIL."""
    return function if DISABLED else cast(Function, Kernel(function))
