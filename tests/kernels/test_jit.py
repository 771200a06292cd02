"""The cache of compiled kernels: named by what it was made from."""

import subprocess
import sys
from threading import Thread
from time import perf_counter

import numba
import pytest

from weier.kernels import jit

PROGRAM = """
from weier.kernels.jit import kernel
import constants

@kernel
def value():
    return constants.VALUE

print(value())
"""


def test_the_folder_follows_sources_and_user(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    folder = jit.cache_folder()
    assert folder.parent == tmp_path
    source = tmp_path / "kernels.py"
    source.write_text("one")
    monkeypatch.setattr(jit, "kernel_sources", lambda: [source])
    one = jit.cache_folder()
    source.write_text("two")
    assert len({folder, one, jit.cache_folder()}) == 3


def test_a_constant_of_another_module_does_not_go_stale(tmp_path):
    """numba alone returns the old constant; the folder's name brings a fresh compilation."""
    package = tmp_path / "weier"
    package.mkdir()
    (package / "kernels").mkdir()
    for name in ("__init__.py", "kernels/__init__.py"):
        (package / name).touch()
    for name in ("jit.py", "sources.py"):
        (package / "kernels" / name).write_text((jit.PACKAGE / "kernels" / name).read_text())
    (package / "main.py").write_text(PROGRAM.replace("import constants", "from weier import constants"))

    def run(value):
        (package / "constants.py").write_text(f"VALUE = {value}\n")
        environment = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PATH": "", "PYTHONDONTWRITEBYTECODE": "1"}
        program = [sys.executable, "-m", "weier.main"]
        done = subprocess.run(program, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
        return done.stdout

    assert run(1) == "1\n"
    assert run(2) == "2\n"
    assert len(list((tmp_path / "cache").iterdir())) == 2


@pytest.mark.skipif(jit.disabled(), reason="nothing is compiled")
def test_seconds_of_compiling_are_those_of_the_thread_that_waits():
    def cubed(x):
        return x**3

    compiled, seconds = numba.njit(cubed), []

    def call():
        before, start = jit.compiling_seconds(), perf_counter()
        compiled(2.0)
        seconds.append((jit.compiling_seconds() - before, perf_counter() - start))

    elsewhere = Thread(target=call)
    elsewhere.start()
    elsewhere.join()
    call()
    (compiling, whole), (again, _) = seconds
    assert 0.5 * whole < compiling < whole
    assert again == 0


@pytest.mark.skipif(jit.disabled(), reason="nothing is compiled")
def test_compiling_is_announced_once():
    said = []
    jit.announce_compiling(lambda: said.append("now"))
    compiled = numba.njit(lambda x: x + 1)
    assert said == []
    assert compiled(1) + compiled(1.0) == 4
    assert said == ["now"]
