"""The cache of compiled kernels: named by what it was made from."""

import re
import subprocess
import sys

import numpy as np
import pytest

from tests.marks import compiled
from weier.digests import KERNELS, PACKAGE
from weier.kernels.jit import TIMERS, kernel
from weier.methods.bem.active_set import dot

PROGRAM = """
from weier.kernels.jit import kernel
from weier.theory import constants

@kernel
def value():
    return constants.VALUE
"""
CALL = "from weier.theory import main; print(main.value())"


@pytest.fixture
def package(tmp_path):
    """A copy of the machinery with one kernel."""
    folder = tmp_path / "one" / "weier"
    for part in ("", "kernels", "theory"):
        (folder / part).mkdir(parents=True)
        (folder / part / "__init__.py").touch()
    for path in [PACKAGE / "digests.py", *(PACKAGE / "kernels").glob("[a-z]*.py")]:
        (folder / path.relative_to(PACKAGE)).write_text(path.read_text())
    (folder / "theory/main.py").write_text(PROGRAM)
    (folder / "theory/constants.py").write_text("VALUE = 1\n")
    return folder


def run(package, program=CALL, said="compiling theory"):
    """The value of the kernel, and whether it was compiled, or a warning was given."""
    own = {"NUMBA_CACHE_DIR": str(package.parent.parent / "cache"), "PATH": "", "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=package.parent, env=own, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip(), said in done.stderr


@compiled
def test_kernels_are_compiled_again_for_a_constant_of_another_module(package):
    """Which numba alone would miss; the code of another folder is kept."""
    assert run(package) == ("1", True)
    (package / "theory/constants.py").write_text("VALUE = 2\n")
    assert run(package) == ("2", True)
    (package / "theory/constants.py").write_text("VALUE = 1\n")
    assert run(package) == ("1", False)


@compiled
def test_a_cache_that_cannot_be_made_gives_a_warning_and_no_cache_beside_the_sources(package):
    (package.parent.parent / "cache").write_text("a file")
    assert run(package, said="compiling for this run alone") == ("1", True)
    assert not any(package.rglob("*.nbi"))


@kernel
def doubled(x):
    return 2 * x


@kernel
def quadrupled(x):
    return doubled(doubled(x))


@compiled
def test_seconds_of_compiling_are_counted_for_each_set_of_types():
    seconds = []
    for number in (1, 2, 1.0, 2.0):
        assert doubled(number) == 2 * number
        seconds.append(TIMERS[0].duration)
    assert 0 < seconds[0] == seconds[1] < seconds[2] == seconds[3]


@compiled
def test_a_kernel_that_python_has_called_is_compiled_once():
    assert (doubled(1.0), quadrupled(1.0)) == (2.0, 4.0)
    assert doubled.within.signatures == []


@kernel
def dot_in_order(a, b):
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@compiled
def test_sums_keep_their_order_unless_told_otherwise():
    """In its order, 1e16 + 1 + ... + 1 - 1e16 loses each 1; a sum in several lanes keeps those of other lanes."""
    values = np.array([1e16, *np.ones(998), -1e16])
    assert dot_in_order(values, np.ones(1000)) == 0
    assert dot(values, np.ones(1000)) > 100


def test_kernels_are_made_of_the_folders_that_name_the_cache():
    inside = tuple(f"weier.{folder}" for folder in KERNELS)
    for path in (path for folder in KERNELS for path in (PACKAGE / folder).rglob("*.py")):
        text = path.read_text()
        if "\n@kernel" in text:
            imported = re.findall(r"^(?:from|import) (weier\S*)", text, re.MULTILINE)
            assert [name for name in imported if not name.startswith(inside)] == [], path


# Each run of Snakemake waits for the imports of its rules.
WORKFLOW = """
from weier.figures.scene_checks import load_by_name
from weier.pipeline.workflow import Plan
Plan(("minimal",), load_by_name, "config/scenes", 1).all_files(None)
"""


def test_a_program_imports_what_it_uses():
    """The heavy packages, by what a program does; numba, xarray and pandas take a second."""
    heavy = ["bokeh", "matplotlib", "mpmath", "netCDF4", "numba", "pandas", "rocket_fft", "scipy.special", "xarray"]
    command = (
        "import sys; from weier.cli import cli; sys.argv = ['weier', 'solve', '--help']; cli(standalone_mode=False)"
    )
    closed_forms = "import weier, numpy as np; dir(weier); from weier.methods.registry import find_method"
    programs = {
        f"{closed_forms}; find_method('westergaard').solve(weier.Profile(D=1.25, gamma=5, m=1), np.array([0.1]))": [],
        "import weier; weier.solve": ["pandas", "xarray"],
        command: [],
        WORKFLOW: [],
    }
    for program, expected in programs.items():
        code = f"{program}\nimport sys; print('\\n', *sorted(sys.modules.keys() & set({heavy})))"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert done.stdout.splitlines()[-1].split() == expected, program
