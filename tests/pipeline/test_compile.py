"""One run compiles every kernel there is."""

import subprocess
import sys

import pytest

from tests.marks import compiled

# In a process that has solved nothing before, and so remembers no result: a kernel is compiled if Python calls it, or
# if one that is compiled names it, since numba compiles the branches that are not taken as well.
PROGRAM = """
import inspect, pkgutil, sys
from importlib import import_module
import weier
from weier.kernels.jit import Kernel

called, run = set(), Kernel.__call__

def noted(kernel, *arguments):
    called.add(kernel)
    return run(kernel, *arguments)

def inside(kernel):
    code, given = kernel.function.__code__, kernel.function.__globals__
    names = {name for part in (code, *filter(inspect.iscode, code.co_consts)) for name in part.co_names}
    places = [given, *(vars(given[name]) for name in names if inspect.ismodule(given.get(name)))]
    return {place[name] for place in places for name in names & place.keys() if isinstance(place[name], Kernel)}

Kernel.__call__ = noted
from numba.types import BaseNamedTuple, BaseTuple
from weier.pipeline.compile import compile_kernels

def names_fields(kind):
    return isinstance(kind, BaseNamedTuple) or isinstance(kind, BaseTuple) and any(map(names_fields, kind))

compile_kernels()
signatures = {kernel: kernel.compiled.nopython_signatures for kernel in called}
crashing = {kernel for kernel, made in signatures.items() if any(names_fields(one.return_type) for one in made)}
names = [module.name for module in pkgutil.walk_packages(weier.__path__, "weier.") if "__main__" not in module.name]
modules = list(map(import_module, names))
known = {value for module in modules for value in vars(module).values() if isinstance(value, Kernel)}
reached = set()
while called:
    reached |= called
    called = set().union(*map(inside, called)) - reached
print(len(known), *(kernel.__qualname__ for kernel in known - reached | crashing))
"""

# In the process of a batch, after the job that has compiled its method.
SOLUTION = """
import sys
import numpy as np
import weier
from weier.kernels.jit import Kernel
from weier.methods.registry import find_method
from weier.pipeline.compile import compile_kernels

def compiled():
    modules = [module for name, module in sys.modules.items() if name.startswith("weier.")]
    kernels = {value for module in modules for value in vars(module).values() if isinstance(value, Kernel)}
    return {(one.__qualname__, str(types)) for one in kernels for types in one.compiled.signatures}

method, loads = find_method(sys.argv[1]), np.geomspace(1e-4, 12, 12)
compile_kernels([method.name])
known = compiled()
phases, heights = np.random.default_rng(1).uniform(0, 6, 5), np.random.default_rng(2).normal(size=64)
surfaces = [weier.Profile(1.25, gamma, m, phases[:m]) for gamma, m in ((5, 1), (2, 2), (5, 3), (5, 4), (1.5, 5))]
for surface in (*surfaces, weier.Trace(1e-6 * heights, 1e-3, unit="m")):
    for settings in ({}, {"staircase": "kept"}) if method.name == "bem" else ({}, {"tolerance": 1e-3}):
        method.solve(surface, loads, **settings)
print(len(known), *(f"{name}{types}" for name, types in compiled() - known))
"""


@compiled
@pytest.mark.parametrize("method", ["bem", "patches"])
def test_nothing_is_compiled_after_the_job_of_a_method(method):
    """A batch that compiles would keep a core busy that the plan of a run knows nothing of."""
    done = subprocess.run([sys.executable, "-c", SOLUTION, method], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    count, *missed = done.stdout.split(maxsplit=1)
    assert int(count) > 2
    assert missed == []


@compiled
def test_every_kernel_is_compiled_and_returns_no_named_tuple():
    """For a NamedTuple numba runs Python, and crashes where Ctrl-C comes there."""
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    count, *missing = done.stdout.split()
    assert int(count) > 20
    assert missing == []
