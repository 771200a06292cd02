"""One run compiles every kernel there is."""

import ast
import subprocess
import sys

import pytest

from tests.marks import compiled
from weier.kernels.digests import PACKAGE
from weier.methods.compile import compile_kernels

# Notes what Python calls, in a process that has solved nothing before, and so remembers no result.
PROGRAM = """
from weier.kernels.jit import Kernel

called, run = set(), Kernel.__call__

def noted(kernel, *arguments):
    called.add(f"{kernel.function.__module__}.{kernel.function.__name__}")
    return run(kernel, *arguments)

Kernel.__call__ = noted
from weier.methods.compile import compile_kernels

compile_kernels()
print(*called, sep="\\n")
"""


def kernels():
    """What each kernel mentions, by its full name, such as "weier.methods.bem.fft.resume"."""
    found = {}
    for path in PACKAGE.rglob("*.py"):
        module = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
        found |= kernels_of(module, ast.parse(path.read_text()))
    return found


def kernels_of(module, tree):
    imported = {
        name.asname or name.name: f"{node.module}.{name.name}"
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for name in node.names
    }
    return {
        f"{module}.{node.name}": {full_name(module, imported, each) for each in names_in(node)}
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and "kernel" in map(ast.unparse, node.decorator_list)
    }


def names_in(tree):
    """Such as "step" and "fft.resume"."""
    return {ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.Name | ast.Attribute)}


def full_name(module, imported, name):
    """Of what a module calls so, by its imports, or by its own definitions."""
    first, dot, rest = name.partition(".")
    return f"{imported.get(first, f'{module}.{first}')}{dot}{rest}"


def test_a_kernel_of_the_same_name_in_another_module_is_not_meant():
    text = """
from weier import one
from weier.two import crest as two_crest

@kernel
def own(x):
    return one.crest(x) + two_crest(x) + x.crest

@kernel
def other(x):
    return own(x).crest
"""
    found = kernels_of("weier.three", ast.parse(text))
    assert found["weier.three.own"] >= {"weier.one.crest", "weier.two.crest"}
    assert not {"weier.two_crest", "weier.three.crest"} & set.union(*found.values())
    assert "weier.three.own" in found["weier.three.other"]


@compiled
def test_every_kernel_is_compiled():
    """Called, or by one that is: numba compiles the branches that are not taken as well."""
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    mentions = kernels()
    assert len(mentions) > 20
    compiled, more = set(), mentions.keys() & set(done.stdout.splitlines())
    assert more
    while more:
        compiled |= more
        more = mentions.keys() & set.union(*(mentions[kernel] for kernel in more)) - compiled
    assert mentions.keys() - compiled == set()


def test_nothing_is_run_where_nothing_is_compiled(monkeypatch):
    monkeypatch.setattr("weier.kernels.jit.disabled", lambda: True)
    monkeypatch.setattr("weier.methods.compile.solve_curve", lambda *_: pytest.fail("solved"))
    compile_kernels()
