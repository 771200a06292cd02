"""How numba compiles kernels: those that Python calls into the disk cache, with all that they call inside.

A kernel that only other kernels call needs no way in from Python, which takes numba as long to make as the rest of a
small kernel whose arguments are tuples of arrays, and no place in the cache. Nor does it need own machine code.
numba alone would optimise and translate it by itself, and then again within each kernel that calls it, directly or
through others: where kernels call each other through ten levels, that takes longer than all the rest.
"""

from __future__ import annotations

import fcntl
import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress
from functools import cache
from typing import Any

import numpy as np
from numba.core import event, types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, NullCache, UserProvidedCacheLocator
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher, cpu_target
from numba.extending import overload
from numba.np import arrayobj
from rocket_fft import c2r, r2c

from weier.kernels import jit
from weier.kernels.transform import backward, forward

OPTIONS: dict[str, Any] = {"nopython": True, "boundscheck": None, "error_model": "numpy", "nogil": True}
AXES = np.zeros(1, np.int64)  # along which to transform: made here, since in a kernel each product would make it anew
_LOCK = threading.RLock()


class _Locator(UserProvidedCacheLocator):
    """Where a kernel is kept: below the folder that digests its sources, by the module and not by its path."""

    def __init__(self, function: Any, file: str) -> None:
        self._py_file, self._lineno = file, function.__code__.co_firstlineno
        self._cache_path = str(jit.folder() / function.__module__)

    @classmethod
    def from_function(cls, function: Any, file: str) -> Any:
        locator = cls(function, file)
        locator.ensure_cache_path()
        return locator


class _Layout(CompileResultCacheImpl):
    _locator_classes = [_Locator]  # noqa: RUF012 - as numba has it


class _Cache(FunctionCache):
    """A damaged file counts as a missing one, and a full disk as no cache; numba alone would fail in every run."""

    _impl_class = _Layout

    def load_overload(self, signature: Any, context: Any) -> Any:
        try:
            return super().load_overload(signature, context)
        except Exception:  # whatever pickle makes of torn bytes
            self.flush()
            return None

    def save_overload(self, signature: Any, result: Any) -> None:
        with suppress(OSError):
            super().save_overload(signature, result)


def entry(function: Callable[..., Any]) -> Any:
    """The dispatcher of a kernel for calls from Python, with a cache unless none can be written."""
    with _LOCK:
        return _entry(function)


@cache
def _entry(function: Callable[..., Any]) -> Any:
    dispatcher: Any = _EntryDispatcher(function, targetoptions=OPTIONS)
    try:
        dispatcher._cache = _Cache(function)
    except OSError:
        dispatcher._cache = NullCache()
    return dispatcher


def inner_type(function: Callable[..., Any]) -> Any:
    """The type of a kernel for calls from other kernels."""
    with _LOCK:
        return types.Dispatcher(_inner(function))


@cache
def _inner(function: Callable[..., Any]) -> Any:
    options = OPTIONS | {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return _InnerDispatcher(function, targetoptions=options, pipeline_class=_InnerCompiler)


class _EntryDispatcher(CPUDispatcher):
    """What compiles a kernel for calls from Python, in one process while others wait for it and load what it made."""

    def compile(self, signature: Any) -> Any:
        """The compiled kernel, from the cache or for it."""
        with ExitStack() as stack, jit.COMPILING.running():
            with suppress(OSError):  # a folder that is closed to writing has no cache, either
                name = f"{self.py_func.__module__}.{self.py_func.__qualname__}.lock"
                fcntl.flock(stack.enter_context((jit.folder() / name).open("w")), fcntl.LOCK_EX)
            return super().compile(signature)


class _InnerDispatcher(CPUDispatcher):
    """What compiles a kernel for calls from other kernels, and is never called from Python."""

    def get_call_template(self, arguments: Any, keywords: Any) -> Any:
        """Compile for an integer what is called with 0, and not once more for the type of this number alone."""
        return super().get_call_template([types.unliteral(each) for each in arguments], keywords)

    def add_overload(self, result: Any) -> None:
        """Keep what was compiled; numba alone would also tell how Python calls it."""
        self.overloads[tuple(result.signature.args)] = result


class _InnerCompiler(Compiler):
    """Leaves the code of a kernel as it is, for the kernels that call it to be optimised with theirs."""

    def __init__(
        self, typing: Any, target: Any, library: Any, arguments: Any, returned: Any, flags: Any, local: Any
    ) -> None:
        flags.no_compile = True  # to machine code
        super().__init__(typing, target, library, arguments, returned, flags, local)

    def compile_extra(self, function: Any) -> Any:
        """The compiled kernel, with a key instead of an address by which callers find it."""
        code = _InnerLibrary(self.state.targetctx.codegen(), function.__qualname__)
        self.state["library"] = code  # or numba would make one of its own, which it optimises and translates
        result = super().compile_extra(function)
        self.state.targetctx.insert_user_function(result.fndesc, result.fndesc, [code])
        return result._replace(entry_point=result.fndesc)


class _InnerLibrary(JITCodeLibrary):
    """The code of a kernel and of all that it calls, neither optimised nor translated."""

    def finalize(self) -> None:
        """Bring the code together, once that of all callees is known."""
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalized = True


class _Watch(event.Listener):
    """Counts the time under numba's lock, of a thread that compiles a kernel, loads one, or waits for another."""

    def on_start(self, event: Any) -> None:
        jit.COMPILING.start()

    def on_end(self, event: Any) -> None:
        jit.COMPILING.stop()


class _Announcer(event.Listener):
    """Tells whose kernel is compiled; a kernel inside another one belongs to that."""

    def __init__(self) -> None:
        self.depth = 0

    def on_start(self, event: Any) -> None:
        self.depth += 1
        if self.depth == 1:
            for say in jit.LISTENERS:
                say(str(event.data["dispatcher"].py_func.__module__))

    def on_end(self, event: Any) -> None:
        self.depth -= 1


event.register("numba:compiler_lock", _Watch())
event.register("numba:compile", _Announcer())


def _leave_shapes_out_of_messages() -> None:
    """An assignment between arrays of different shapes fails in fewer words.

    numba writes both shapes into them, and compiling what makes strings of integers takes each process three seconds.
    """
    cpu_target.typing_context.refresh()
    raising = cpu_target.typing_context.resolve_value_type(arrayobj.raise_with_shape_context)
    for template in raising.templates:
        template._overload_func = staticmethod(arrayobj.ol_raise_with_shape_context_generic)


_leave_shapes_out_of_messages()


@overload(forward, strict=False)
def _compiled_forward(x: Any, spectrum: Any) -> Any:
    return lambda x, spectrum: r2c(x, spectrum, AXES, True, 1.0, 1)


@overload(backward, strict=False)
def _compiled_backward(spectrum: Any, x: Any) -> Any:
    return lambda spectrum, x: c2r(spectrum, x, AXES, False, 1.0 / x.size, 1)
