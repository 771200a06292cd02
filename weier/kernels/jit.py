"""The decorator of all kernels: numba, imported on the first call, with a disk cache that cannot go stale.

docs/compiling.md explains the additions to numba and their reasons.
"""

from __future__ import annotations

import errno
import functools
import hashlib
import json
import os
import shutil
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from threading import RLock
from time import perf_counter
from types import FunctionType
from typing import Any, TypeVar, cast

from weier.digests import PACKAGE, cache_root, digest, digest_of_kernels, ignoring_errors_of_disks

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]  # on Windows, where each process compiles for itself

Function = TypeVar("Function", bound=Callable[..., Any])

# Kernels run as plain Python, which a debugger can follow.
DISABLED = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
NOT_CACHED = "kernels are compiled for this run alone ({}): let NUMBA_CACHE_DIR name a folder that keeps them"
CONTENTS = "contents.json"  # Names and digests of the files that numba has written for a kernel.
# One thread at a time compiles. The lock is reentrant, since a kernel may need another one.
LOCK = RLock()
# The seconds that a thread has spent on compiling and loading kernels. A process spends them once, so that they are
# subtracted from the seconds of a solution.
COMPILING_SECONDS = ContextVar("seconds", default=0.0)


# of numba, for all kernels; without a wrapper for callers in C, of which there are none
OPTIONS = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}


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
    types = 1  # The number of types of arguments that it is compiled for.

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self.function, self.name = function, f"{function.__module__}.{function.__qualname__}"
        self.options = OPTIONS

    @functools.cached_property
    def within(self) -> Any:
        """What other kernels call: numba's dispatcher, without a wrapper for Python."""
        import numba

        return numba.njit(**self.options, no_cpython_wrapper=True)(self.function)

    def __call__(self, *arguments: Any) -> Any:
        """Run the compiled function."""
        if self.compiled is None:
            start = perf_counter()
            with LOCK:
                self.compiled = self.compiled or self._compile(arguments)
            COMPILING_SECONDS.set(COMPILING_SECONDS.get() + perf_counter() - start)
        try:
            result = self.compiled(*arguments)
        except SystemError as error:  # numba runs Python for each array that it returns, where Ctrl-C may come
            cause: Any = error
            while cause.__cause__:
                cause = cause.__cause__
            raise cause from None
        if len(self.compiled.overloads) > self.types:
            self._note_more_types()
        return result

    def _compile(self, arguments: tuple[Any, ...]) -> Any:
        """Return the kernel from the cache, or else compile it and keep it there.

        Without a cache that can be written, it is read from one that can be read, or compiled for this process alone.
        """
        import numba

        _register_kernels()
        types = tuple(map(numba.typeof, arguments))
        try:
            cache_root()
        except OSError as error:
            return self._for_this_run(types, error)
        folder = cache_folder() / self.name
        try:
            with _locked(folder):
                return self._kept(folder, types)
        except OSError as error:  # a disk is full or read-only, or others may not write to the folder
            if error.errno is None:  # a TimeoutError of a signal's handler
                raise
            return self._only_read(folder, types) or self._for_this_run(types, error)

    def _kept(self, folder: Path, types: tuple[Any, ...]) -> Any:
        """Return the kernel from its own folder in the cache, or compile it into this folder."""
        if not self._is_whole(folder):
            for path in folder.iterdir():
                if path.is_dir():
                    shutil.rmtree(path)
            announce(self.function.__module__)
        compiled = _compile_for(self._in_cache(folder, folder), types)
        if not compiled.stats.cache_hits:
            self._write_contents(folder)
        return compiled

    def _note_more_types(self) -> None:
        """Note what numba has added to the cache for arguments of other types."""
        self.types, folder = len(self.compiled.overloads), cache_folder() / self.name
        with ignoring_errors_of_disks(), _locked(folder):
            self._write_contents(folder)

    def _write_contents(self, folder: Path) -> None:
        (folder / CONTENTS).write_text(json.dumps(self._contents(folder)), encoding="utf-8")

    def _only_read(self, folder: Path, types: tuple[Any, ...]) -> Any:
        """Return the kernel from a folder that cannot be written, or that was moved; None if the folder lacks it.

        Numba reads no folder that it cannot write, and names folders by their place: it reads a copy.
        """
        if not self._is_whole(folder):
            return None
        with tempfile.TemporaryDirectory() as copy:
            compiled = self._in_cache(Path(copy), folder)
            for path in folder.rglob("*.nb?"):
                shutil.copy(path, compiled.stats.cache_path)
            _compile_for(compiled, types)
        return compiled if compiled.stats.cache_hits else None

    def _contents(self, folder: Path) -> dict[str, str]:
        """Return digests of the files of numba in a folder, and of the source of a kernel outside of the package."""
        files = {str(path.relative_to(folder)): path for path in sorted(folder.rglob("*.nb?"))}
        if not self._is_of_package:
            files["source"] = Path(self.function.__code__.co_filename)
        return {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in files.items()}

    def _is_whole(self, folder: Path) -> bool:
        """Return whether a folder has the files that were written into it, so that numba reads no torn one."""
        with ignoring_errors_of_disks(), suppress(json.JSONDecodeError, UnicodeDecodeError):
            known = json.loads((folder / CONTENTS).read_text(encoding="utf-8"))
            return bool(known == self._contents(folder))
        return False

    def _in_cache(self, cache: Path, folder: Path) -> Any:
        """Return the dispatcher that keeps its code in a folder, and has none yet."""
        import numba

        before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, str(cache)
        try:
            return numba.njit(**self.options, cache=True)(self._without_place(folder))
        finally:
            numba.config.CACHE_DIR = before

    def _for_this_run(self, types: tuple[Any, ...], error: OSError) -> Any:
        import numba

        compiled = _compile_for(numba.njit(**self.options)(self.function), types)
        why = f"{error.strerror}: {cache_folder()}" if error.strerror else error
        warnings.warn(NOT_CACHED.format(f"{type(error).__name__}: {why}"), RuntimeWarning, stacklevel=1)
        return compiled

    @property
    def _is_of_package(self) -> bool:
        return self.name.startswith(f"{PACKAGE.name}.")

    def _without_place(self, folder: Path) -> Callable[..., Any]:
        """Return the function without its file and line, which numba digests: the name of the folder is enough.

        The folder has a digest of kernels of the package only: others keep their files.
        """
        if not self._is_of_package:
            return self.function
        file = folder / "source.py"
        if not file.exists():
            file.touch()
        code = self.function.__code__.replace(co_filename=str(file), co_firstlineno=1)
        function = FunctionType(code, self.function.__globals__, None, self.function.__defaults__)
        return functools.update_wrapper(function, self.function)


def _compile_for(compiled: Any, types: tuple[Any, ...]) -> Any:
    """Compile for arguments of these types, or load what is kept, and return the dispatcher."""
    with _raising_lost_exceptions():
        compiled.compile(types)
    return compiled


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Make a folder that this process alone may change; an OSError says why it cannot."""
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
    with (folder / "lock").open("w") as file:
        if fcntl:
            with ignoring_errors_of_disks():  # without locks each process compiles for itself
                fcntl.flock(file, fcntl.LOCK_EX)
        yield


@contextmanager
def _raising_lost_exceptions() -> Iterator[None]:
    """Raise what a signal's handler raises while LLVM calls Python, which C cannot pass on."""
    hook, lost = sys.unraisablehook, list[BaseException]()

    def keep(unraisable: Any) -> None:
        if unraisable.exc_value is not None and "ctypes callback" in (unraisable.err_msg or ""):
            lost.append(unraisable.exc_value)
        else:
            hook(unraisable)

    sys.unraisablehook = keep
    try:
        yield
    finally:
        sys.unraisablehook = hook
        if lost:
            raise lost[0]


@functools.cache
def _register_kernels() -> None:
    """Let numba take a kernel that another one calls for a function that it compiles with it."""
    import numba
    import rocket_fft  # noqa: F401 - which registers numpy's Fourier transforms
    from numba.extending import typeof_impl

    typeof_impl.register(Kernel)(lambda kernel, _: numba.typeof(kernel.within))


def kernel(function: Function) -> Function:
    """Compile `function` with numba on first call: arrays in, arrays out, IEEE division, no GIL."""
    return function if DISABLED else cast(Function, Kernel(function))


def in_any_order(function: Function) -> Function:
    """Let the compiler add the terms of sums in a kernel in any order, and so several at once."""
    if isinstance(function, Kernel):
        function.options = function.options | {"fastmath": {"reassoc"}}
    return function
