"""Digests of code: the definitions that a function reaches, whatever stands beside them."""

from pathlib import Path

import pytest

from weier import digests
from weier.digests import digest_of_code, digest_of_kernels

MODULES = {
    "__init__": "",
    "one": '''
"""A module."""
from __future__ import annotations
from typing import TYPE_CHECKING
from weier import two
from weier.three import LIMIT, table as lookup

if TYPE_CHECKING:
    from weier.four import Type

def function(x: Type) -> float:
    """Return a number."""
    from weier.four import late
    return min(x, LIMIT) + two.more(x) + lookup[x] + late(x)

def unused(x):
    return x
''',
    "two": "def more(x):\n    return 2 * x\n",
    "three": "LIMIT = 1\ntable = {}\ntable[1] = 2\nOTHER = 3\n",
    "four": "class Type:\n    size = 1\n\ndef late(x):\n    return x\n",
    "kernels/__init__": "",
    "kernels/jit": "def kernel(function):\n    return function\n\ndef in_any_order(function):\n    return function\n",
    "kernels/sums": "from weier.kernels.jit import in_any_order, kernel\nfrom weier.three import LIMIT\n\n"
    "@in_any_order\n@kernel\ndef add(x):\n"
    "    return x + LIMIT\n\ndef drive(x):\n    return add(x)\n",
}


@pytest.fixture
def package(tmp_path, monkeypatch):
    folder = tmp_path / "weier"
    for name, text in MODULES.items():
        path = folder / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    monkeypatch.setattr(digests, "PACKAGE", folder)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    return folder


def forget():
    for function in (digests._source, digests._definitions, digests.digest_of_sources, digest_of_kernels):
        function.cache_clear()


def of_function():
    forget()
    return digest_of_code(("weier.one", "function"))


def of_kernels():
    forget()
    return digest_of_kernels()


@pytest.fixture(autouse=True)
def unchanged():
    yield
    forget()


NOTHING = [
    ("one", '"""A module."""', "# Another.\n\n"),
    ("one", '"""Return a number."""', '"""Return\n\n    something else."""'),
    ("one", "    from weier.four import late\n", "\n    # Late.\n\n    from weier.four import late\n"),
    ("one", "x: Type) -> float", "x)"),
    ("one", "    return x\n", "    return -x\n"),
    ("three", "OTHER = 3", "OTHER = 4"),
    ("four", "size = 1", "size = 2"),
]
SOMETHING = [
    ("one", "min(x", "max(x"),
    ("two", "2 * x", "3 * x"),
    ("three", "LIMIT = 1", "LIMIT = 2"),
    ("three", "table[1] = 2", "table[1] = 3"),
    ("four", "    return x", "    return -x"),
]


@pytest.mark.parametrize(
    ("module", "old", "new", "changes"), [(*case, False) for case in NOTHING] + [(*case, True) for case in SOMETHING]
)
def test_a_digest_changes_with_what_a_function_runs_alone(package, module, old, new, changes):
    before = of_function()
    path = package / f"{module}.py"
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))
    assert (of_function() != before) == changes
    path.write_text(text)
    assert of_function() == before


@pytest.mark.parametrize(
    ("module", "old", "new", "changes"),
    [
        ("kernels/sums", "x + LIMIT", "x - LIMIT", True),
        ("kernels/sums", "@in_any_order\n", "", True),
        ("three", "LIMIT = 1", "LIMIT = 2", True),
        ("kernels/sums", "return add(x)", "return -add(x)", False),
        ("kernels/jit", "return function", "return  function  # as it is", False),
        ("kernels/jit", "return function", "return print(function)", False),
    ],
)
def test_kernels_depend_on_their_code_and_constants(package, module, old, new, changes):
    before = of_kernels()
    path = package / f"{module}.py"
    path.write_text(path.read_text().replace(old, new))
    assert (of_kernels() != before) == changes


def test_where_nothing_can_be_kept_the_digest_is_the_same(package, tmp_path, monkeypatch):
    before = of_kernels()
    assert len(list((tmp_path / "cache/digests").iterdir())) == 1
    (closed := tmp_path / "closed").touch()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(closed))
    assert of_kernels() == before


@pytest.mark.parametrize("name", ["read_text", "write_text"])
def test_an_alarm_while_a_digest_is_read_or_kept_is_no_error_of_a_disk(package, monkeypatch, name):
    usual = getattr(Path, name)

    def alarmed(path, *arguments, **options):
        if path.parent.name == "digests":
            raise TimeoutError("after 10 s")  # as the handler of a signal
        return usual(path, *arguments, **options)

    monkeypatch.setattr(Path, name, alarmed)
    with pytest.raises(TimeoutError, match=r"^after 10 s$"):
        of_function()


def test_what_functions_enclose_counts():
    def outer(inner):
        def both(x):
            return inner(x)

        return both

    named = list(digests._named([outer(digest_of_code)]))
    assert ("weier.digests", "digest_of_code") in named
    assert named[0][0] == __name__
