"""One run compiles every kernel there is."""

import subprocess
import sys

from tests.marks import compiled

# In a process that has solved nothing before, and so remembers no result: a kernel is compiled if Python calls it, or
# if one that is compiled names it, since numba compiles the branches that are not taken as well.
PROGRAM = """
import inspect, pkgutil
from importlib import import_module
import weier
from numba.types import BaseNamedTuple, BaseTuple
from weier.kernels.jit import Kernel
from weier.pipeline.compile import compile_kernels

def inside(kernel):
    code, given = kernel.function.__code__, kernel.function.__globals__
    names = {name for part in (code, *filter(inspect.iscode, code.co_consts)) for name in part.co_names}
    places = [given, *(vars(given[name]) for name in names if inspect.ismodule(given.get(name)))]
    return {place[name] for place in places for name in names & place.keys() if isinstance(place[name], Kernel)}

def names_fields(kind):
    return isinstance(kind, BaseNamedTuple) or isinstance(kind, BaseTuple) and any(map(names_fields, kind))

compile_kernels()
names = [module.name for module in pkgutil.walk_packages(weier.__path__, "weier.") if "__main__" not in module.name]
modules = list(map(import_module, names))
known = {value for module in modules for value in vars(module).values() if isinstance(value, Kernel)}
called = {kernel for kernel in known if "compiled" in vars(kernel)}
signatures = {kernel: kernel.compiled.nopython_signatures for kernel in called}
crashing = {kernel for kernel, made in signatures.items() if any(names_fields(one.return_type) for one in made)}
reached = set()
while called:
    reached |= called
    called = set().union(*map(inside, called)) - reached
print(len(known), *(kernel.__qualname__ for kernel in known - reached | crashing))
"""


@compiled
def test_every_kernel_is_compiled_and_returns_no_named_tuple():
    """For a NamedTuple numba runs Python, and crashes where Ctrl-C comes there."""
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    count, *missing = done.stdout.split()
    assert int(count) > 20
    assert missing == []
