"""Random one-place changes of the numerical code, each judged by the tests of its module.

    python -m tests.mutants 20 theory methods/bem/staircase --seed 1  # without paths, of all modules

A mutant is planted in the memory of a child process: files, and compiled kernels of other modules, stay as they are.
Kernels that depend on the module run as plain Python in the tests that are quick so; unless all are, a survivor is
then compiled, and judged by all tests of its module. mutmut chooses a mutant as a function runs, which numba cannot
compile, and skips constants; cosmic-ray changes files, on which all kernels depend, and has one command.
"""

import argparse
import ast
import importlib
import os
import random
import re
import resource
import signal
import tempfile
from collections import Counter
from functools import cache
from importlib.machinery import SourceFileLoader
from itertools import accumulate
from pathlib import Path

import pytest

PACKAGE, TESTS = Path(__file__).parents[1] / "weier", Path(__file__).parent
PATHS = [path for room in ("theory", "methods", "surface") for path in sorted((PACKAGE / room).rglob("[!_]*.py"))]
SOURCE = {path.relative_to(PACKAGE).with_suffix("").as_posix(): path.read_text(encoding="utf-8") for path in PATHS}
OTHER = {"+": "-", "-": "+", "*": "/", "/": "*", "**": "*", "==": "!=", "!=": "=="}
OTHER |= {"<": ">=", ">=": "<", "<=": ">", ">": "<="}


class Clock:
    """Let tests fail that take more than 2 s of the processor."""

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self):
        """Run a test, or its setup, under the limit."""
        signal.signal(signal.SIGPROF, lambda *_: pytest.fail("slow"))
        signal.setitimer(signal.ITIMER_PROF, 2)
        try:
            yield
        finally:  # else the time of a failed test is up in a later one, or in pytest itself
            signal.setitimer(signal.ITIMER_PROF, 0)

    pytest_runtest_setup = pytest_runtest_call


def mutants(text):
    """Yield start, end and replacement of each operator, comparison and number other than 0 and 1 in a module.

    Those of a method's style and of its expected time change no result.
    """
    starts, tree = [0, *accumulate(map(len, text.splitlines(keepends=True)))], ast.parse(text)
    others = [
        n
        for n in ast.walk(tree)
        if {getattr(n, "arg", ""), getattr(n, "name", "")} & {"style", "seconds", "_seconds"}
    ]
    skipped = {id(node) for other in others for node in ast.walk(other)}
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.Constant) and type(node.value) in (int, float) and node.value not in (0, 1):
            start, end = (starts[node.lineno - 1] + at for at in (node.col_offset, node.end_col_offset))
            yield start, end, repr(1.5 * node.value if isinstance(node.value, float) else node.value + 1)
        elif isinstance(node, ast.BinOp | ast.Compare):
            left, right = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.left, node.comparators[0])
            start = starts[left.end_lineno - 1] + left.end_col_offset
            between = text[start : starts[right.lineno - 1] + right.col_offset]
            if (operator := between.strip(" ()\n")) in OTHER:
                start += between.index(operator)
                yield start, start + len(operator), OTHER[operator]


@cache
def dependents(module):
    """Return the dotted names of a module and of all that import it, at any depth."""
    imports = {m: {getattr(n, "module", "") for n in ast.walk(ast.parse(SOURCE[m]))} for m in SOURCE}
    found, before = {"weier." + module.replace("/", ".")}, set()
    while found != before:
        before, found = found, found | {"weier." + m.replace("/", ".") for m in imports if imports[m] & found}
    return found


def plant(module, text, is_plain):
    """Let the module be imported with this text, and no dependent kernel be taken from the cache."""
    get_code, path = SourceFileLoader.get_code, str(PACKAGE / f"{module}.py")
    SourceFileLoader.get_code = lambda it, name: (
        compile(text, path, "exec") if it.path == path else get_code(it, name)
    )
    jit = importlib.import_module("weier.kernels.jit")
    cached = jit.Kernel.compiled.func

    def compiled(self):
        if self.function.__module__ not in dependents(module):
            return cached(self)
        return self.function if is_plain else jit._numba()[0].njit(**self.options)(self.function)

    jit.Kernel.compiled = property(cache(compiled))


def run(module, text, is_plain, limit, arguments, plugins=()):
    """Run tests in a child where the module has this text; return exit code, output and processor seconds."""
    with tempfile.TemporaryFile("w+") as output:
        if not (child := os.fork()):
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1))
            os.dup2(output.fileno(), 1), os.dup2(output.fileno(), 2)
            plant(module, text, is_plain)
            os._exit(pytest.main(["-q", "-p", "no:cacheprovider", *arguments], plugins))
        _, status, usage = os.wait4(child, 0)
        output.seek(0)
        return os.waitstatus_to_exitcode(status), output.read(), usage.ru_utime + usage.ru_stime


@cache
def control(module, is_plain):
    """Return the tests that pass without a change, a limit of processor seconds, and whether they are all.

    A module without a file of tests is judged by those of its room that import it, or by all of its room.
    """
    name = Path(module).name
    own, word = (TESTS / module).with_name(f"test_{name}.py"), re.compile(rf"import .*\b{name}\b|\.{name} import")
    room = sorted(own.parent.glob("test_*.py"))
    files = [own] if own.exists() else [path for path in room if word.search(path.read_text())] or room
    arguments = module, SOURCE[module], is_plain, 3600, ["-rp", *map(str, files)], [Clock()] * is_plain
    run(*arguments)  # which compiles other kernels
    code, output, seconds = run(*arguments)
    passed = [line[7:] for line in output.splitlines() if line.startswith("PASSED ")]
    print(f"{module} unchanged{' and plain' * is_plain}: {len(passed)} tests in {seconds:.0f} s", flush=True)
    if code and not is_plain:
        raise SystemExit(output)
    return passed, 60 + int(4 * seconds), code == 0


def judge(module, text):
    """Return the verdict of the tests of a module."""
    for is_plain in (True, False):
        tests, limit, is_judged = control(module, is_plain)
        if code := run(module, text, is_plain, limit, ["-x", *tests])[0] if tests else 0:
            return "failed" if code > 0 else "endless"
        if is_judged:
            break
    return "SURVIVES"


def named(module, start, end, new):
    """Name a mutant by its module, line of code and change, as `equivalent_mutants.txt` lists it before a reason.

    A number follows if the line has the same text before: #2 is the second time.
    """
    text, line, old = SOURCE[module], SOURCE[module].count("\n", 0, start), SOURCE[module][start:end]
    time = 1 + text.count(old, text.rfind("\n", 0, start) + 1, start)
    return f"{module} | {text.splitlines()[line].strip()} | {old} -> {new}" + f" #{time}" * (time > 1)


def every_mutant():
    """Return all mutants, each with its module."""
    return [(module, *mutant) for module in SOURCE for mutant in mutants(SOURCE[module])]


def known_equivalent(every):
    """Return the names of the mutants that change no result; SystemExit if the code of one is not there."""
    lines = (TESTS / "equivalent_mutants.txt").read_text(encoding="utf-8").splitlines()
    equivalent = {line.rpartition(" | ")[0] for line in lines}
    if stale := equivalent - {named(*mutant) for mutant in every}:
        raise SystemExit("\n".join(["equivalent_mutants.txt lists code that is gone:", *sorted(stale)]))
    return equivalent


def main():
    parser = argparse.ArgumentParser(prog="python -m tests.mutants")
    parser.add_argument("count", type=int)
    parser.add_argument("paths", nargs="*", default=[""])
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    os.environ |= {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTHONDONTWRITEBYTECODE": "1", "OMP_NUM_THREADS": "1"}
    list(map(importlib.import_module, ("numba", "rocket_fft", "scipy.optimize", "mpmath", "hypothesis")))
    every = every_mutant()
    equivalent = known_equivalent(every)
    chosen = [each for each in every if each[0].startswith(tuple(options.paths)) and "/measured/" not in each[0]]
    table, verdicts = Counter(), ("failed", "endless", "SURVIVES", "equivalent")
    for mutant in random.Random(options.seed).sample(chosen, min(options.count, len(chosen))):
        module, start, end, new = mutant
        text, what = SOURCE[module], named(*mutant)
        verdict = "equivalent" if what in equivalent else judge(module, text[:start] + new + text[end:])
        print(f"{verdict:10} {text.count(chr(10), 0, start) + 1:4} {what}", flush=True)
        table[module.rpartition("/")[0], verdict] += 1
    print(("\n{:24}" + 4 * "{:>12}").format("", *verdicts))
    for room in sorted({room for room, _ in table}):
        print(f"{room:24}" + "".join(f"{table[room, verdict]:12}" for verdict in verdicts))


if __name__ == "__main__":
    main()
