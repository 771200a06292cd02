"""One run compiles every kernel there is, so that no two jobs of a scene compile the same one side by side."""

import ast
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from weier.kernels.sources import PACKAGE
from weier.pipeline import compile
from weier.pipeline.compile import compile_kernels

# As plain Python, which shows what is called.
PROGRAM = """
import sys
from weier.kernels import jit
from weier.pipeline import compile

jit.disabled = lambda: False
called = set()
sys.setprofile(lambda frame, *_: called.add((frame.f_code.co_filename, frame.f_code.co_name)))
compile.compile_kernels()
sys.setprofile(None)
print(*(f"{file}:{name}" for file, name in called), sep="\\n")
"""


def kernels():
    """The names that each kernel mentions, by its file and its own name."""
    found = {}
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef) and "kernel" in map(ast.unparse, node.decorator_list):
                found[f"{path}:{node.name}"] = {each.id for each in ast.walk(node) if isinstance(each, ast.Name)}
    return found


def test_every_kernel_is_compiled():
    """Called, or by one that is: numba compiles the branches that are not taken as well."""
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-c", PROGRAM]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    mentions = kernels()
    assert len(mentions) > 20
    compiled, more = set(), mentions.keys() & set(done.stdout.splitlines())
    assert more
    while more:
        compiled |= more
        names = set.union(*(mentions[kernel] for kernel in more))
        more = {kernel for kernel in mentions if kernel.rpartition(":")[2] in names} - compiled
    assert mentions.keys() - compiled == set()


def test_nothing_is_run_where_nothing_is_compiled(monkeypatch):
    monkeypatch.setattr("weier.kernels.jit.disabled", lambda: True)
    monkeypatch.setattr("weier.pipeline.compile.solve", lambda *_: pytest.fail("solved"))
    compile_kernels()


def test_one_process_compiles_and_the_others_find_it_done(tmp_path, monkeypatch):
    compiled = []

    def compile_all():
        compiled.append(1)
        (tmp_path / "cache" / compile.COMPLETE).touch()

    monkeypatch.setattr("weier.kernels.jit.disabled", lambda: False)
    monkeypatch.setattr("weier.kernels.jit.cache_folder", lambda: tmp_path / "cache")
    monkeypatch.setattr(compile, "compile_kernels", compile_all)
    with ThreadPoolExecutor(4) as pool:
        for _ in pool.map(lambda _: compile.compile_once(), range(4)):
            pass
    assert compiled == [1]


def test_a_cache_that_cannot_be_written_stops_nothing(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setattr("weier.kernels.jit.disabled", lambda: False)
    monkeypatch.setattr("weier.kernels.jit.cache_folder", lambda: tmp_path / "file" / "cache")
    monkeypatch.setattr(compile, "compile_kernels", lambda: pytest.fail("compiled"))
    compile.compile_once()
