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

    typeof_impl.register(Kernel)(lambda kernel, _: numba.typeof(vars(kernel).get("compiled") or kernel.within))
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

    def __init__(self, function: Callable[..., Any], **options: Any) -> None:
        functools.update_wrapper(self, function)
        self.function, self.options = function, OPTIONS | options

    @functools.cached_property
    def within(self) -> Any:
        """The function for other kernels, without a wrapper for Python; for those compiled after `compiled`, that."""
        return _numba()[0].njit(**self.options, no_cpython_wrapper=True)(self.function)

    @functools.cached_property
    def compiled(self) -> Any:
        """The function for Python; the uncompiled function if numba's settings disable compiling."""
        numba, keeps = _numba()
        before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, str(cache_folder()) if keeps else ""
        try:
            made = numba.njit(**self.options, cache=keeps)(self.function)
        finally:
            numba.config.CACHE_DIR = before
        if made is not self.function:
            made.compile = functools.partial(self._compile, made.compile)  # numba calls it for each set of new types
        return made

    def _compile(self, compile_for: Callable[[Any], Any], types: Any) -> Any:
        """Load what is kept for arguments of these types, or compile it, which takes many seconds, and say so."""
        before, start = COMPILING_SECONDS.get(), perf_counter()
        source = Path(self.function.__code__.co_filename).parent.name  # numba names its own folder by this
        if not (_numba()[1] and any(cache_folder().glob(f"{source}_*/*.nbi"))):
            _announce(source)
        entry = compile_for(types)
        COMPILING_SECONDS.set(before + perf_counter() - start)  # These hold the seconds of kernels within this one.
        return entry

    def __call__(self, *arguments: Any) -> Any:
        """Run the compiled function."""
        try:
            return self.compiled(*arguments)
        except SystemError as error:  # numba runs Python for each array that it returns, where Ctrl-C may come
            cause: Any = error
            while cause.__cause__:
                cause = cause.__cause__
            raise cause from None


def kernel(function: Function) -> Function:
    """Compile `function` with numba on first call: arrays in, arrays out, IEEE division, no GIL."""
    return cast(Function, Kernel(function))


def fused(function: Function) -> Function:
    """Compile a kernel whose products are rounded once with the sums that they enter, as processors do at no cost."""
    return cast(Function, Kernel(function, fastmath={"contract"}))


def in_any_order(function: Function) -> Function:
    """Compile a kernel whose sums the compiler may add in any order, and so several terms at once."""
    return cast(Function, Kernel(function, fastmath={"reassoc"}))
