"""The decorator of all kernels: numba, imported on the first call, with its cache in a folder named by a digest.

docs/compiling.md explains the additions to numba and their reasons.
"""

from __future__ import annotations

import functools
import os
import sys
import warnings
from collections.abc import Callable
from contextvars import ContextVar
from pathlib import Path
from time import perf_counter
from typing import Any, TypeVar, cast

from weier.digests import KERNELS, cache_root, digest, digest_of_modules

Function = TypeVar("Function", bound=Callable[..., Any])
# no_cfunc_wrapper: no C code calls the kernels
OPTIONS = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
NOT_CACHED = "kernels are compiled for this run alone ({}): let NUMBA_CACHE_DIR name a folder that keeps them"
# The seconds that a thread has spent on compiling and loading kernels. A process spends them once, so that they are
# subtracted from the seconds of a solution.
COMPILING_SECONDS = ContextVar("seconds", default=0.0)


@functools.cache
def cache_folder() -> Path:
    """Return the folder of compiled kernels, named by a digest of their code and of the versions that compiled it."""
    from importlib.metadata import version  # this import takes longer than all imports above

    made_of = digest_of_modules(*KERNELS), OPTIONS, version("numba"), version("rocket-fft")
    return cache_root() / f"weier-{digest(made_of)[:16]}"


@functools.cache
def _numba() -> tuple[Any, bool]:
    """Return numba, set up to call kernels from kernels, and whether it can keep compiled code.

    If its folder is not writable, numba would cache code next to the sources, without a digest.
    """
    import numba
    import rocket_fft  # noqa: F401 - registers numpy's Fourier transforms
    from numba.extending import typeof_impl

    typeof_impl.register(Kernel)(lambda kernel, _: numba.typeof(kernel.within))
    try:
        cache_folder().mkdir(parents=True, exist_ok=True)
        if not os.access(cache_folder(), os.W_OK):
            raise PermissionError(f"{cache_folder()} is closed to writing")
    except OSError as error:
        warnings.warn(NOT_CACHED.format(error), RuntimeWarning, stacklevel=1)
        return numba, False
    return numba, True


@functools.cache
def _announce(method: str) -> None:
    print(f"compiling {method}, once for all later runs", file=sys.stderr, flush=True)


class Kernel:
    """A function that numba compiles when Python first calls it, with all kernels that it calls."""

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self.function, self.options, self.run = function, OPTIONS, self._run_first

    @functools.cached_property
    def within(self) -> Any:
        """The function for other kernels, without a wrapper for Python."""
        return _numba()[0].njit(**self.options, no_cpython_wrapper=True)(self.function)

    @functools.cached_property
    def compiled(self) -> Any:
        """The function for Python; the uncompiled function if numba's settings disable compiling."""
        numba, keeps = _numba()
        before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, str(cache_folder()) if keeps else ""
        try:
            return numba.njit(**self.options, cache=keeps)(self.function)
        finally:
            numba.config.CACHE_DIR = before

    def __call__(self, *arguments: Any) -> Any:
        """Run the compiled function."""
        try:
            return self.run(*arguments)
        except SystemError as error:  # numba runs Python for each array that it returns, where Ctrl-C may come
            cause: Any = error
            while cause.__cause__:
                cause = cause.__cause__
            raise cause from None

    def _run_first(self, *arguments: Any) -> Any:
        """Load what is kept for arguments of these types, or compile it, which takes many seconds, and say so."""
        if self.compiled is not self.function:
            start = perf_counter()
            source = Path(self.function.__code__.co_filename).parent.name  # numba names its own folder by this
            if not (_numba()[1] and any(cache_folder().glob(f"{source}_*/*.nbi"))):
                _announce(source)
            self.compiled.compile(tuple(map(_numba()[0].typeof, arguments)))
            COMPILING_SECONDS.set(COMPILING_SECONDS.get() + perf_counter() - start)
        self.run = self.compiled
        return self.run(*arguments)


def kernel(function: Function) -> Function:
    """Compile `function` with numba on first call: arrays in, arrays out, IEEE division, no GIL."""
    return cast(Function, Kernel(function))


def fused(function: Function) -> Function:
    """Let the compiler round a product and the sum that it enters once, as processors do at no cost."""
    return _with_fastmath(function, "contract")


def in_any_order(function: Function) -> Function:
    """Let the compiler add the terms of sums in a kernel in any order, and so several at once."""
    return _with_fastmath(function, "reassoc")


def _with_fastmath(function: Function, flag: str) -> Function:
    kernel = cast(Any, function)
    kernel.options = kernel.options | {"fastmath": kernel.options.get("fastmath", set()) | {flag}}
    return function
