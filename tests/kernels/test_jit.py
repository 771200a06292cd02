"""The cache of compiled kernels: named by what it was made from."""

import ctypes
import errno
import importlib.util
import os
import re
import signal
import subprocess
import sys
from threading import Thread
from time import perf_counter
from types import SimpleNamespace

import numba
import numpy as np
import pytest

import weier
from tests.marks import compiled
from weier.digests import KERNELS, PACKAGE
from weier.kernels import jit

PATIENCE = 120  # seconds

PROGRAM = """
from weier.kernels.jit import kernel
from weier.theory import constants

@kernel
def value():
    return constants.VALUE

def unused():
    return 1
"""


@compiled
def test_kernels_are_compiled_again_for_their_code_alone(tmp_path):
    """A constant of another module, which numba alone would miss; no docstring, comment or place."""

    def package(name):
        folder = tmp_path / name / "weier"
        for part in ("", "kernels", "theory"):
            (folder / part).mkdir(parents=True)
            (folder / part / "__init__.py").touch()
        for path in [PACKAGE / "digests.py", *(PACKAGE / "kernels").glob("[a-z]*.py")]:
            (folder / path.relative_to(PACKAGE)).write_text(path.read_text())
        (folder / "theory/main.py").write_text(PROGRAM)
        (folder / "theory/constants.py").write_text("VALUE = 1\n")
        return folder

    def run(folder):
        program = "from weier.theory import main; print(main.value())"
        environment = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PATH": "", "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-c", program]
        options = {"env": environment, "capture_output": True, "text": True, "check": True}
        done = subprocess.run(command, cwd=folder.parent, **options)
        return done.stdout.strip(), "compiling" in done.stderr

    one, other = package("one"), package("other")
    assert run(one) == ("1", True)
    assert run(other) == run(one) == ("1", False)
    main = one / "theory/main.py"
    main.write_text(
        '"""What this is."""\n# Why.\n\n' + main.read_text().replace("return 1", '"""One."""\n    return 2')
    )
    assert run(one) == ("1", False)
    (one / "theory/constants.py").write_text("VALUE = 2\n")
    assert run(one) == ("2", True)
    assert run(other) == ("1", False)


def test_kernels_are_made_of_the_folders_that_name_the_cache():
    inside = tuple(f"weier.{folder}" for folder in KERNELS)
    for path in (path for folder in KERNELS for path in (PACKAGE / folder).rglob("*.py")):
        text = path.read_text()
        if "\n@kernel" in text:
            imported = re.findall(r"^(?:from|import) (weier\S*)", text, re.MULTILINE)
            assert [name for name in imported if not name.startswith(inside)] == [], path


def test_nothing_private_of_numba_is_used():
    private = ["numba.core", "numba.np", "llvmlite", "_numba_type_", "_overload_func", "PyThreadState"]
    root = PACKAGE.parent
    for path in [
        *PACKAGE.rglob("*.py"),
        *root.glob("benchmarks/**/*.py"),
        *root.glob("rules/*.smk"),
        *root.glob("Snakefile"),
    ]:
        text = path.read_text(encoding="utf-8")
        assert [name for name in private if name in text] == [], path


PROGRAM_OF_KERNELS = """
from typing import NamedTuple
import numpy as np
from weier.kernels.jit import in_any_order, kernel

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
def wrong(pair):
    return pair.neither

@in_any_order
@kernel
def scalar_product(pair):
    total = 0.0
    for i in range(pair.one.size):
        total += pair.one[i] * pair.other[i]
    return total

@kernel
def norm(pair):
    return scalar_product(pair) + offset(pair)
"""


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache."""
    folder = tmp_path / "weier-new"
    monkeypatch.setattr(jit, "cache_folder", lambda: folder)
    monkeypatch.setattr(jit, "announce", lambda module: None)
    return folder


@pytest.fixture
def load(tmp_path, monkeypatch):
    """The module of kernels, as each program has it anew."""
    source = tmp_path / "some_kernels.py"
    source.write_text(PROGRAM_OF_KERNELS)

    def program():
        spec = importlib.util.spec_from_file_location("some_kernels", source)
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, "some_kernels", module)  # where numba looks for the type of a tuple
        spec.loader.exec_module(module)
        return module

    return program


def call(module, kernel="product"):
    return getattr(module, kernel)(module.Pair(np.ones(3), np.ones(3)))


def hits(kernel):
    return sum(kernel.compiled.stats.cache_hits.values())


@compiled
def test_seconds_of_compiling_are_those_of_the_thread_that_compiles(cache, load):
    module, seconds = load(), []

    def measured():
        before, start = jit.COMPILING_SECONDS.get(), perf_counter()
        call(module)
        seconds.append((jit.COMPILING_SECONDS.get() - before, perf_counter() - start))

    elsewhere = Thread(target=measured)
    elsewhere.start()
    elsewhere.join()
    measured()
    (compiling, whole), (again, _) = seconds
    assert 0.5 * whole < compiling < whole
    assert again == 0


@compiled
def test_a_kernel_is_loaded_from_the_cache_with_those_that_it_calls(cache, load):
    for expected in (0, 1):
        module = load()
        assert call(module) == 4.0
        assert hits(module.product) == expected
    assert [path.name for path in cache.iterdir()] == ["some_kernels.product"]
    assert call(module, "offset") == 1.0  # may be called by itself


WAITER = """
import sys
from pathlib import Path
from weier.kernels import jit

jit.cache_folder = lambda: Path(sys.argv[1])
import numpy as np, some_kernels
value = some_kernels.product(some_kernels.Pair(np.ones(3), np.ones(3)))
print(value, sum(some_kernels.product.compiled.stats.cache_hits.values()))
"""


@compiled
@pytest.mark.parametrize("level", ["1", "3"])  # of the command, and of numba
@pytest.mark.parametrize("name", ["scalar_product", "norm"])
def test_sums_in_any_order_take_several_terms_at_once(cache, load, monkeypatch, name, level):
    monkeypatch.setenv("NUMBA_OPT", level)
    module = load()
    assert call(module, name) == (3 if name == "scalar_product" else 4)
    (code,) = getattr(module, name).compiled.inspect_llvm().values()
    assert "fadd reassoc <" in code  # of vectors


@compiled
def test_other_sums_keep_their_order(cache, load):
    module = load()
    call(module)
    (code,) = module.product.compiled.inspect_llvm().values()
    assert "reassoc" not in code


@compiled
def test_of_processes_that_need_a_kernel_at_once_one_compiles_it(cache, load):
    load()
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(PACKAGE.parent), str(cache.parent)])}
    command = [sys.executable, "-c", WAITER, str(cache)]
    started = [subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    said = sorted(process.communicate(timeout=PATIENCE)[0] for process in started)
    assert said == ["4.0 0\n", "4.0 1\n", "4.0 1\n"]


@compiled
def test_compiling_is_announced_for_what_python_calls(cache, load, monkeypatch):
    said = []
    monkeypatch.setattr(jit, "announce", said.append)
    module = load()
    assert said == []
    call(module)
    assert said == ["some_kernels"]  # not for the kernel inside
    call(module)
    call(load())
    assert said == ["some_kernels"]


def test_a_method_is_announced_once(capsys):
    jit._say_once.cache_clear()
    for module in (
        "weier.methods.bem.grids",
        "weier.methods.bem.edges",
        "weier.methods.chebyshev",
        "weier.surface.measured.line",
    ):
        jit.announce(module)
    assert capsys.readouterr().err.splitlines() == [
        "compiling bem, once for all later runs",
        "compiling common kernels, once for all later runs",
    ]


@compiled
def test_a_disk_without_locks_has_a_cache_all_the_same(cache, load, monkeypatch, recwarn):
    def refuse(file, operation):
        raise OSError(errno.ENOSYS, "Function not implemented")

    monkeypatch.setattr(jit.fcntl, "flock", refuse)
    for expected in (0, 1):
        module = load()
        assert call(module) == 4.0
        assert hits(module.product) == expected
    assert not recwarn.list


def cut_short(suffix, bytes_left):
    def damage(cache, load):
        call(load())
        for path in cache.rglob(f"*.{suffix}"):
            path.write_bytes(path.read_bytes()[:bytes_left])

    return damage


@compiled
def test_a_cache_that_cannot_be_made_gives_a_warning_and_no_error(cache, load):
    cache.touch()
    with pytest.warns(RuntimeWarning, match="compiled for this run alone"):
        assert call(load()) == 4.0


@compiled
@pytest.mark.parametrize(
    "damage", [cut_short("nbi", 0), cut_short("nbi", 60), cut_short("nbc", 0), cut_short("nbc", 1000)]
)
def test_what_is_torn_is_made_again(cache, load, damage):
    damage(cache, load)
    for expected in (0, 1):
        module = load()
        assert call(module) == 4.0
        assert hits(module.product) == expected


@compiled
def test_a_kernel_is_kept_for_all_types_of_arguments(cache, load):
    for expected in (0, 2):
        module = load()
        assert call(module, "offset") == 1.0
        assert module.offset(module.Pair(np.ones(3, int), np.ones(3))) == 1
        assert hits(module.offset) == expected


@compiled
def test_a_cache_on_a_disk_that_cannot_be_written_is_read(cache, load, monkeypatch, recwarn):
    call(load())
    files = {path: path.stat().st_mtime_ns for path in cache.rglob("*") if path.is_file()}
    monkeypatch.setattr(jit.os, "access", lambda path, mode: False)  # root may write wherever the disk can
    module = load()
    assert call(module) == 4.0
    assert hits(module.product) == 1
    assert not recwarn.list
    with pytest.warns(RuntimeWarning, match="compiled for this run alone .*Permission denied"):
        assert call(module, "offset") == 1.0  # which is not in it
    assert {path: path.stat().st_mtime_ns for path in cache.rglob("*") if path.is_file()} == files


@compiled
@pytest.mark.parametrize("error", [TimeoutError("out of time"), ValueError("a signal"), RuntimeError("another")])
def test_an_exception_that_comes_while_a_kernel_is_compiled_is_raised(cache, load, monkeypatch, recwarn, error):
    """As that of a signal's handler, at any place: while the cache is locked, read, or written."""

    def interrupted(*arguments, **options):
        raise error

    for owner, name in ((jit.Path, "mkdir"), (jit, "_compile_for"), (jit.Kernel, "_contents")):
        with monkeypatch.context() as patched:
            patched.setattr(owner, name, interrupted)
            with pytest.raises(type(error), match=str(error)):
                call(load())
    assert call(load()) == 4.0
    assert not recwarn.list


@compiled
def test_without_a_home_directory_it_compiles_for_this_run_and_says_how_to_keep_it(load, monkeypatch):
    """As in a container that runs for a user whom it does not know."""

    def home():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(jit.Path, "home", home)
    monkeypatch.setattr(jit, "cache_folder", jit.cache_folder.__wrapped__)
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(OSError, match="there is no home directory for the cache"):
        jit.cache_folder()
    with pytest.warns(
        RuntimeWarning, match=r"for this run alone \(OSError: there is no home .*NUMBA_CACHE_DIR name a folder"
    ):
        assert call(load()) == 4.0
    monkeypatch.setenv("XDG_CACHE_HOME", "/tmp")
    assert str(jit.cache_folder()).startswith("/tmp/weier/weier-")


@compiled
def test_an_error_of_a_kernel_is_no_damage_of_the_cache(cache, load, recwarn):
    with pytest.raises(Exception, match="neither"):
        call(load(), "wrong")
    assert not recwarn.list


@compiled
@pytest.mark.usefixtures("ctrl_c")
def test_what_a_signal_raises_in_a_callback_is_raised(cache, load, monkeypatch):
    """As where LLVM calls Python: an exception cannot pass through C, and Python reports it and goes on."""
    reported, callback, happens = [], ctypes.CFUNCTYPE(None), []

    def njit(**options):
        def decorate(function):
            def run(*arguments):
                return function(*arguments)

            run.compile = lambda types: callback(happens[0])()
            run.stats, run.overloads = SimpleNamespace(cache_hits={}), {}
            return run

        return decorate

    class Dying:
        def __del__(self):
            raise ZeroDivisionError

    def time_out():
        raise TimeoutError("out of time")

    monkeypatch.setattr(numba, "njit", njit)
    monkeypatch.setattr(sys, "unraisablehook", lambda failure: reported.append(failure.exc_type))
    for happening, error in (
        (lambda: signal.raise_signal(signal.SIGINT), KeyboardInterrupt),
        (time_out, TimeoutError),
    ):
        happens[:] = [happening]
        with pytest.raises(error):
            call(load())
    happens[:] = [lambda: [Dying()].clear()]
    assert call(load()) == 4.0
    assert set(reported) == {ZeroDivisionError}


@compiled
def test_settings_of_numba_that_the_user_has_imported_stay_as_they_are(cache, load, tmp_path, monkeypatch):
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "of the user"))
    call(load())
    assert str(tmp_path / "of the user") == numba.config.CACHE_DIR
    assert not (tmp_path / "of the user").exists()


@pytest.mark.parametrize("level", [None, "3"])
def test_the_command_compiles_at_its_own_level_unless_one_is_set(monkeypatch, level):
    monkeypatch.delenv("NUMBA_OPT", raising=False)
    if level:
        monkeypatch.setenv("NUMBA_OPT", level)
    told = "atexit.register(lambda: print(os.environ['NUMBA_OPT']))"
    program = f"import atexit, os; from weier.__main__ import run; {told}; run()"
    done = subprocess.run([sys.executable, "-c", program, "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == (level or "1")


@compiled
def test_caches_of_other_states_stay(cache, load):
    """Another process may use them."""
    others = [cache.parent / f"weier-{number}" for number in range(6)]
    for folder in others:
        folder.mkdir()
    call(load())
    assert all(folder.exists() for folder in others)


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


ON_WINDOWS = """
import sys
sys.modules["fcntl"] = None  # what Windows does not have
import weier
for method in ("demelio", "layer", "bem", "patches"):
    print(float(weier.solve(weier.Profile(1.25, 5, 2), 0.1, method).compliance.item()))
"""


@compiled
def test_curves_are_solved_without_locks_of_files():
    """As on Windows, of which no more can be tested elsewhere."""
    done = subprocess.run([sys.executable, "-c", ON_WINDOWS], capture_output=True, text=True, check=True)
    profile = weier.Profile(1.25, 5, 2)
    expected = [weier.solve(profile, 0.1, name).compliance.item() for name in ("demelio", "layer", "bem", "patches")]
    assert list(map(float, done.stdout.split())) == expected
