"""Which definitions of the package a function depends on: the functions, classes and constants that it leads to.

This is finer than a list of files: a file that defines a solver may also define the model of its costs, on which no
solution depends. Names are followed as Python resolves them, through imports and modules. What is reached by a text,
through getattr or import_module, is not found: the caller has to name such modules.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from weier.kernels.sources import PACKAGE


class Module(NamedTuple):
    """A module, parsed from its text and not imported.

    definitions : the statements that define a name, by that name
    imports : what is imported from the package, by the name it has here
    statements : all others, which run when the module is imported
    """

    definitions: dict[str, list[ast.stmt]]
    imports: dict[str, str]
    statements: list[ast.stmt]


def definitions(*names: str, without: Collection[str] = ()) -> dict[str, str]:
    """The text of these definitions and of all in the package that they depend on, by name, without comments.

    Parameters
    ----------
    *names : str
        Such as "weier.pipeline.batch.solve_batch", or a module for all that it defines.
    without : collection of str
        Names, such as "weier.methods.registry.METHODS", that are not followed.
    """
    reached: dict[str, str] = {}
    pending = list(names)
    while pending:
        module, attribute = _split(pending.pop())
        if not module:
            continue
        name, _, rest = attribute.partition(".")
        if not name:
            pending += [f"{module}.{each}" for each in _parsed(module).definitions]
        elif name in _parsed(module).imports:
            pending.append(".".join(filter(None, [_parsed(module).imports[name], rest])))
        for part in (name, ""):  # and what runs when the module is imported
            key = f"{module}.{part}"
            if key not in reached and key not in without:
                reached[key] = _text(module, part)
                pending += _mentioned(module, part)
    return reached


def modules_of(package: str) -> list[str]:
    """The names of all modules in a folder of the package, sorted."""
    folder = PACKAGE.parent.joinpath(*package.split("."))
    return sorted(map(_module_of, folder.rglob("*.py")))


@cache
def _split(name: str) -> tuple[str, str]:
    """The module that a dotted name begins with, and the rest: empty where there is no such module."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        if ".".join(parts[:count]) in _paths():
            return ".".join(parts[:count]), ".".join(parts[count:])
    return "", name


@cache
def _paths() -> dict[str, Path]:
    """The file of each module, by its name: they are listed once, which is faster than to look for each."""
    return {_module_of(path): path for path in PACKAGE.rglob("*.py")}


def _module_of(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def _parsed(module: str) -> Module:
    text = _paths()[module].read_text(encoding="utf-8")
    lines, made = text.split("\n"), Module({}, {}, [])
    for statement in ast.parse(text).body:
        if any("import" in line for line in lines[statement.lineno - 1 : statement.end_lineno]):  # few have any
            made.imports.update(_imports(statement))
        defined = _defined(statement)
        for name in defined:
            made.definitions.setdefault(name, []).append(statement)
        if not defined and not isinstance(statement, ast.Import | ast.ImportFrom) and not _is_docstring(statement):
            made.statements.append(statement)
    return made


def _imports(tree: ast.AST) -> Iterator[tuple[str, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((name.asname or PACKAGE.name, name.name if name.asname else PACKAGE.name)
                        for name in node.names if name.name.split(".")[0] == PACKAGE.name)  # fmt: skip
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == PACKAGE.name:
            yield from ((name.asname or name.name, f"{node.module}.{name.name}") for name in node.names)


def _defined(statement: ast.stmt) -> list[str]:
    """The names that a statement defines."""
    match statement:
        case ast.FunctionDef() | ast.ClassDef():
            return [statement.name]
        case ast.Assign():
            targets: list[ast.expr] = statement.targets
        case ast.AnnAssign() | ast.AugAssign():
            targets = [statement.target]
        case _:
            return []
    names = [[node.id for node in ast.walk(target) if isinstance(node, ast.Name)] for target in targets]
    plain = all(isinstance(target, ast.Name | ast.Tuple) for target in targets)
    return [name for each in names for name in each] if plain else []


def _is_docstring(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _statements(module: str, name: str) -> list[ast.stmt]:
    """Those that define a name, or, without one, those that run when the module is imported."""
    parsed = _parsed(module)
    return parsed.definitions.get(name, []) if name else parsed.statements


@cache
def _text(module: str, name: str) -> str:
    return "\n".join(map(ast.unparse, _statements(module, name)))


@cache
def _mentioned(module: str, name: str) -> tuple[str, ...]:
    """What is named there, of this module and of what it imports."""
    parsed = _parsed(module)
    chains = {chain for statement in _statements(module, name) for chain in _chains(statement)}
    known = parsed.definitions.keys() | parsed.imports.keys()
    return tuple(f"{module}.{chain}" for chain in sorted(chains) if chain.split(".")[0] in known)


def _chains(node: ast.AST) -> Iterator[str]:
    """The names in a statement with what is taken of them, such as "bem.error_model.RESISTANCE"."""
    if isinstance(node, ast.Name):
        yield node.id
    elif isinstance(node, ast.Attribute):
        for chain in _chains(node.value):
            is_value = isinstance(node.value, ast.Name | ast.Attribute)
            yield f"{chain}.{node.attr}" if is_value else chain
    else:
        for child in ast.iter_child_nodes(node):
            yield from _chains(child)
