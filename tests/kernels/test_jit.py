"""The cache of compiled kernels: named by what it was made from."""

import importlib.util
import os
import subprocess
import sys
from threading import Thread
from time import perf_counter

import numpy as np
import pytest
from numba import types
from numba.core.codegen import JITCodeLibrary

from tests.marks import compiled
from weier.kernels import jit

PATIENCE = 120  # seconds

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
    for path in (jit.PACKAGE / "kernels").glob("[a-z]*.py"):
        (package / "kernels" / path.name).write_text(path.read_text())
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


@compiled
def test_seconds_of_compiling_are_those_of_the_thread_that_waits(folders):
    module, seconds = load(folders[0]), []

    def call():
        before, start = jit.compiling_seconds(), perf_counter()
        module.product(module.Pair(np.ones(3), np.ones(3)))
        seconds.append((jit.compiling_seconds() - before, perf_counter() - start))

    elsewhere = Thread(target=call)
    elsewhere.start()
    elsewhere.join()
    call()
    (compiling, whole), (again, _) = seconds
    assert 0.5 * whole < compiling < whole
    assert again == 0


KERNELS = """
from typing import NamedTuple
import numpy as np
from weier.kernels.jit import kernel

class Pair(NamedTuple):
    one: np.ndarray
    other: np.ndarray

@kernel
def product(pair):
    return pair.one @ pair.other + offset(pair)

@kernel
def offset(pair):
    return pair.one[0]

@kernel
def count(steps):
    total = 0
    for _ in range(steps):
        total = increment(total)
    return total

@kernel
def increment(total):
    return total + 1
"""


def load(folder):
    """The module of kernels in a folder, as a program of its own would have it."""
    spec = importlib.util.spec_from_file_location("some_kernels", folder / "some_kernels.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["some_kernels"] = module  # where numba looks for the type of a tuple
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """Two copies of one module of kernels, and an empty cache."""
    monkeypatch.setattr(jit, "folder", lambda: tmp_path / "cache")
    monkeypatch.delitem(sys.modules, "some_kernels", raising=False)
    for name in ("checkout", "installed"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "some_kernels.py").write_text(KERNELS)
    yield tmp_path / "checkout", tmp_path / "installed"
    sys.modules.pop("some_kernels", None)


@compiled
def test_two_copies_of_the_same_sources_share_a_cache(folders):
    hits = []
    for folder in folders:
        module = load(folder)
        assert module.product(module.Pair(np.ones(3), np.ones(3))) == 4.0
        hits.append(sum(module.product.compiled.stats.cache_hits.values()))
    assert hits == [0, 1]


@compiled
def test_a_kernel_inside_another_is_not_cached_by_itself_and_can_still_be_called(folders):
    module = load(folders[0])
    pair = module.Pair(np.ones(3), np.ones(3))
    module.product(pair)
    cached = {path.name.partition("-")[0] for path in (folders[0].parent / "cache").rglob("*.nbc")}
    assert cached == {"some_kernels.product"}
    assert module.offset(pair) == 1.0


@compiled
def test_a_kernel_inside_another_becomes_machine_code_there_alone(folders, monkeypatch):
    translated, translate = [], JITCodeLibrary._finalize_final_module
    monkeypatch.setattr(
        JITCodeLibrary, "_finalize_final_module", lambda self: (translated.append(self.name), translate(self))
    )
    module = load(folders[0])
    module.product(module.Pair(np.ones(3), np.ones(3)))
    assert "product" in translated
    assert "offset" not in translated


WAITER = """
import sys
from pathlib import Path
from weier.kernels import jit

jit.folder = lambda: Path(sys.argv[1])
import some_kernels
print(some_kernels.count(3), sum(some_kernels.count.compiled.stats.cache_hits.values()))
"""


@compiled
def test_of_processes_that_need_a_kernel_at_once_one_compiles_it(folders):
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(jit.PACKAGE.parent), str(folders[0])])}
    command = [sys.executable, "-c", WAITER, str(folders[0].parent / "cache")]
    started = [subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    said = sorted(process.communicate(timeout=PATIENCE)[0] for process in started)
    assert said == ["3 0\n", "3 1\n", "3 1\n"]


@compiled
def test_a_kernel_inside_another_is_compiled_once_for_all_integers(folders):
    module = load(folders[0])
    assert module.count(5) == 5
    assert list(module.increment._numba_type_.dispatcher.overloads) == [(types.int64,)]


@compiled
def test_compiling_is_announced_for_what_python_calls(folders, monkeypatch):
    said = []
    monkeypatch.setattr(jit, "LISTENERS", [])
    jit.announce_compiling(said.append)
    module = load(folders[0])
    assert said == []
    module.product(module.Pair(np.ones(3), np.ones(3)))
    assert said == ["some_kernels"]  # not for the kernel inside
    module.product(module.Pair(np.ones(2), np.ones(2)))
    assert said == ["some_kernels"]


@compiled
def test_a_cache_that_cannot_be_made_stops_nothing(folders, monkeypatch):
    (folders[0] / "file").touch()
    monkeypatch.setattr(jit, "folder", lambda: folders[0] / "file" / "cache")
    module = load(folders[0])
    assert module.product(module.Pair(np.ones(3), np.ones(3))) == 4.0


def test_a_program_imports_what_it_uses():
    """The heavy packages, by what a program does; numba, xarray and pandas take a second."""
    heavy = ["bokeh", "matplotlib", "mpmath", "netCDF4", "numba", "pandas", "rocket_fft", "scipy.special", "xarray"]
    command = "import sys; from weier.cli import cli; sys.argv = ['weier', '--help']; cli(standalone_mode=False)"
    closed_forms = "from weier.methods.registry import find_method; import numpy as np; from weier import Profile"
    programs = {
        "import weier; dir(weier)": [],
        "import weier; weier.Profile(D=1.25, gamma=5, m=2)": [],
        "import weier.methods.registry": [],
        f"{closed_forms}; find_method('westergaard').solve(Profile(D=1.25, gamma=5, m=1), np.array([0.1]))": [],
        "import weier; weier.solve": ["netCDF4", "pandas", "xarray"],
        command: [],
        command.replace("'--help'", "'solve', '--help'"): [],
    }
    for program, expected in programs.items():
        code = f"{program}; import sys; print('\\n', *sorted(sys.modules.keys() & set({heavy})))"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert done.stdout.splitlines()[-1].split() == expected, program
