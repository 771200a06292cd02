"""Which files of the package a module is made of: its own and all that it imports.

The folder of compiled kernels is named by them. Snakemake reruns a job when an input changes, and knows nothing of
imports; rules list them.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
IMPORT = re.compile(r"^[ \t]*(from weier\b[^(\n]*\([^)]*\)|from weier\b[^(\n]*$|import weier\b.*$)", re.MULTILINE)


def sources(*modules: str, without: Collection[str] = ()) -> list[str]:
    """Paths, from the folder of the project, of modules such as "weier.theory.bounds" and of what they import.

    Imports of modules whose last name is in `without`, such as "registry", are not followed.
    """
    reached: set[Path] = set()
    pending = [path for module in modules for path in _files(module)]
    while pending:
        path = pending.pop()
        if path not in reached:
            reached.add(path)
            followed = [module for module in _imports(path) if module.rpartition(".")[2] not in without]
            pending += [file for module in followed for file in _files(module)]
    return sorted(str(path.relative_to(PACKAGE.parent)) for path in reached)


def _files(module: str) -> list[Path]:
    """The file of a module, or of a package; the bare package `weier` stands for what a line takes from it."""
    base = PACKAGE.parent.joinpath(*module.split("."))
    files = [base.with_suffix(".py"), base / "__init__.py"]
    return [path for path in files if path.exists() and path != PACKAGE / "__init__.py"]


@cache
def _imports(path: Path) -> tuple[str, ...]:
    """The modules of the package that a file imports; only these statements are parsed, which takes a tenth."""
    statements = IMPORT.findall(path.read_text(encoding="utf-8"))
    return tuple(name for statement in statements for name in _imported(ast.parse(statement)))


def _imported(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names if name.name.startswith("weier"))
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("weier"):
            yield node.module
            yield from (f"{node.module}.{name.name}" for name in node.names)
