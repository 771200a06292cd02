"""The decorator of all kernels: numba, imported on the first call, with its cache in a folder named by a digest.

docs/compiling.md explains the additions to numba and their reasons.
"""

import functools
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

from weier.digests import KERNELS, cache_root, digest, digest_of_modules, versions

Function = TypeVar("Function", bound=Callable[..., Any])
OPTIONS = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}  # no C code calls the kernels
TIMERS: list[Any] = []  # numba's timer of loading and compiling kernels, once numba is imported


@functools.cache
def cache_folder() -> Path:
    """Return the folder of compiled kernels, named by a digest of their code and of the versions that compiled it."""
    return cache_root() / f"weier-{digest([digest_of_modules(*KERNELS), OPTIONS, versions()])[:16]}"


@functools.cache
def _numba() -> tuple[Any, str]:
    """Return numba, set up to call kernels from kernels, and its folder of compiled code, or "" without a cache."""
    import numba
    import rocket_fft  # noqa: F401 - registers numpy's Fourier transforms
    from numba.core import event  # noqa: TID251 - documented as numba's event API
    from numba.extending import typeof_impl

    typeof_impl.register(Kernel)(lambda kernel, _: numba.typeof(vars(kernel).get("compiled") or kernel.within))
    TIMERS.append(event.TimingListener())
    event.register("numba:compiler_lock", TIMERS[0])  # the lock is held while a kernel is loaded or compiled
    try:
        cache_folder().mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=cache_folder()).close()
    except OSError as error:  # numba would cache code next to the sources, without a digest
        warnings.warn(f"compiling for this run alone: {error}; see NUMBA_CACHE_DIR", RuntimeWarning, stacklevel=1)
        return numba, ""
    return numba, str(cache_folder())


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
        numba, folder = _numba()
        before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, folder
        made = numba.njit(**self.options, cache=bool(folder))(self.function)
        numba.config.CACHE_DIR = before
        source = Path(self.function.__code__.co_filename).parent.name  # numba names its own folder by this
        if folder and made is not self.function and not any(Path(folder).glob(f"{source}_*/*.nbi")):
            print(f"compiling {source}, once for all later runs", file=sys.stderr, flush=True)
        return made

    def __call__(self, *arguments: Any) -> Any:
        """Run the compiled function."""
        try:
            return self.compiled(*arguments)
        except SystemError as error:  # numba runs Python for each array that it returns, where Ctrl-C may come
            cause: Any = error
            while cause.__cause__:
                cause = cause.__cause__
            raise cause from None


def kernel(function: Function, **options: Any) -> Function:
    """Compile `function` with numba on first call: arrays in, arrays out, IEEE division, no GIL."""
    return cast(Function, Kernel(function, **options))


# Products are rounded once with the sums that they enter, as processors do at no cost.
fused: Callable[[Function], Function] = functools.partial(kernel, fastmath={"contract"})
# The compiler may add the terms of sums in any order, and so several at once.
in_any_order: Callable[[Function], Function] = functools.partial(kernel, fastmath={"reassoc"})
