"""Digests of the code that kernels, curves and products depend on; a changed digest makes them again.

A digest covers, as syntax trees, all definitions that some functions reach by name across modules. It is independent
of comments, docstrings, annotations, layout and code that these functions do not use.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

PACKAGE = Path(__file__).parent
KERNELS = ("kernels", "surface", "theory", "methods")  # All compiled functions are in these folders.
PACKAGES = ("numpy", "scipy", "numba", "rocket-fft")  # Numbers depend on the versions of these packages.
# text files of the package other than modules
RESOURCES = frozenset({".json", ".js", ".css", ".html", ".md", ".mplstyle"})
# How kernels are compiled changes no number; in what order their sums are added is in their statements.
DECORATORS, MACHINERY = frozenset({"kernel", "in_any_order"}), "weier.kernels.jit"

Name = tuple[str, str]  # A definition: its module and its name.


class Definition(NamedTuple):
    """A statement of a module.

    digest : of its syntax tree; empty for an import
    uses : names in it
    imports : modules and names that it imports, itself or within a function
    is_kernel : whether it defines a kernel
    """

    digest: str
    uses: frozenset[str]
    imports: tuple[Name, ...]
    is_kernel: bool


def digest(values: Any) -> str:
    """Return a digest of plain values."""
    return hashlib.sha256(json.dumps(values).encode()).hexdigest()


@cache
def digest_of_sources(*parts: str, suffixes: frozenset[str] = frozenset({".py", *RESOURCES})) -> str:
    """Return a digest of all texts in some folders of the package, with comments and docstrings."""
    paths = sorted({path for part in parts for path in (PACKAGE / part).rglob("*") if path.suffix in suffixes})
    return digest([[str(path.relative_to(PACKAGE)), path.read_text(encoding="utf-8")] for path in paths])


@cache
def digest_of_kernels() -> str:
    """Return a digest of all kernels, with the functions and constants that they use."""
    return _remembered(["kernels"], lambda: _digest_of(_reached(_all_kernels(), ())))


def digest_of_code(*functions: Name, stop: Collection[str] = ()) -> str:
    """Return a digest of what some functions, named by module and name, reach.

    Parameters
    ----------
    *functions : pairs of str
        Modules and names; an empty name is the whole module.
    stop : collection of str
        Modules whose definitions are not followed.
    """
    return _remembered([sorted(functions), sorted(stop)], lambda: _digest_of(_reached(functions, stop)))


def digest_of_callables(functions: Iterable[Callable[..., Any]], *more: Name, stop: Collection[str] = ()) -> str:
    """Return a digest of what some functions reach, with the functions that they enclose."""
    return digest_of_code(*_named(functions), *more, stop=stop)


@cache
def versions() -> str:
    """Return the versions of the packages on which numbers depend, as text."""
    from importlib.metadata import version  # which takes longer than all that is imported above

    return ", ".join(f"{name} {version(name)}" for name in PACKAGES)


def cache_root() -> Path:
    """Return the folder of everything that weier keeps for the user: in NUMBA_CACHE_DIR, or his cache.

    Raises
    ------
    OSError
        If the user has no home directory, as in a container that knows no such user, and no variable names a cache.
    """
    if own := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(own)
    if caches := os.environ.get("XDG_CACHE_HOME"):
        return Path(caches, "weier")
    try:
        return Path.home() / ".cache" / "weier"
    except RuntimeError:
        raise OSError("there is no home directory for the cache") from None


@contextmanager
def ignoring_errors_of_disks() -> Iterator[None]:
    """Ignore errors of the operating system, but no TimeoutError of a signal's handler, which has no number."""
    try:
        yield
    except OSError as error:
        if isinstance(error, TimeoutError) and error.errno is None:
            raise


def _remembered(what: Any, compute: Callable[[], str]) -> str:
    """Return a digest of code, which is computed once for each state of the package.

    Syntax trees of the package take a second, and its texts some milliseconds.
    """
    known: Path | None = None
    with ignoring_errors_of_disks():
        known = cache_root() / "digests" / digest([what, digest_of_sources("")])[:32]
        if len(found := known.read_text(encoding="ascii")) == 64:
            return found
    found = compute()
    if known is not None:
        with ignoring_errors_of_disks():
            known.parent.mkdir(parents=True, exist_ok=True)
            beside = known.with_name(f".{known.name}.{os.getpid()}")
            beside.write_text(found, encoding="ascii")
            beside.replace(known)
    return found


def _named(functions: Iterable[Any]) -> Iterator[Name]:
    """Yield the definitions of functions, and those of the functions that they enclose; of a lambda its module."""
    for function in functions:
        inner = getattr(function, "function", getattr(function, "func", function))  # of a kernel or a partial
        if not callable(inner) or not hasattr(inner, "__qualname__"):
            continue
        first = inner.__qualname__.partition(".")[0]
        yield inner.__module__, first if first.isidentifier() else ""
        yield from _named(cell.cell_contents for cell in getattr(inner, "__closure__", None) or ())


@cache
def _source(module: str) -> Path | None:
    """Return the file of a module of the package; None if it is none."""
    top, _, rest = module.partition(".")
    if top != PACKAGE.name:
        return None
    path = PACKAGE.joinpath(*rest.split(".")) if rest else PACKAGE
    return next((file for file in (path / "__init__.py", path.with_suffix(".py")) if file.is_file()), None)


@cache
def _definitions(module: str) -> dict[str, Definition]:
    """Return the statements of a module by the names that they define; others have numbers for names."""
    path = _source(module)
    tree = ast.parse(path.read_text(encoding="utf-8")) if path else ast.Module([], [])
    found: dict[str, Definition] = {}
    for number, statement in enumerate(_Plain().visit(tree).body):
        if isinstance(statement, ast.ImportFrom):
            found.update(
                {name: Definition("", frozenset(), (origin,), False) for name, origin in _origins(statement)}
            )
        else:
            definition = _definition(statement)
            found.update(dict.fromkeys(_defined_by(statement) or [str(number)], definition))
    return found


def _definition(statement: ast.stmt) -> Definition:
    """Return a statement that is no import from a module; a kernel does not run its decorators."""
    nodes = list(ast.walk(statement))
    is_kernel = isinstance(statement, ast.FunctionDef) and any(
        isinstance(decorator, ast.Name) and decorator.id in DECORATORS for decorator in statement.decorator_list
    )
    uses = {node.id for node in nodes if isinstance(node, ast.Name)} - (DECORATORS if is_kernel else set())
    imports = [origin for node in nodes if isinstance(node, ast.ImportFrom) for _, origin in _origins(node)]
    return Definition(digest(_as_lists(statement)), frozenset(uses), tuple(imports), is_kernel)


def _origins(statement: ast.ImportFrom) -> Iterator[tuple[str, Name]]:
    """Yield the names that an import defines, each with its module and its name there."""
    for alias in statement.names:
        yield alias.asname or alias.name, (statement.module or "", alias.name)


def _defined_by(statement: ast.stmt) -> list[str]:
    if isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return [statement.name]
    if isinstance(statement, ast.Import | ast.ImportFrom):
        return [alias.asname or alias.name.partition(".")[0] for alias in statement.names]
    if isinstance(statement, ast.Assign | ast.AnnAssign):
        targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
        return [node.id for target in targets for node in ast.walk(target) if isinstance(node, ast.Name)]
    return []


class _Plain(ast.NodeTransformer):
    """Remove docstrings, annotations of functions, and what only a type checker reads."""

    def _without_docstring(self, node: Any) -> Any:
        self.generic_visit(node)
        if ast.get_docstring(node, clean=False) is not None:
            del node.body[0]
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> Any:
        node.returns = None
        return self._without_docstring(node)

    visit_Module = visit_ClassDef = _without_docstring  # noqa: N815 - names that ast gives

    def visit_arg(self, node: ast.arg) -> Any:
        node.annotation = None
        return node

    def visit_If(self, node: ast.If) -> Any:
        if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            return None
        return self.generic_visit(node)


def _all_kernels() -> list[Name]:
    found = []
    for path in (path for part in KERNELS for path in sorted((PACKAGE / part).rglob("*.py"))):
        if "@kernel" in path.read_text(encoding="utf-8"):
            module = ".".join((PACKAGE.name, *path.relative_to(PACKAGE).with_suffix("").parts))
            found += [(module, name) for name, each in _definitions(module).items() if each.is_kernel]
    return found


def _reached(functions: Iterable[Name], stop: Collection[str]) -> dict[Name, str]:
    """Return digests of the definitions that functions use, and of those that these use in turn."""
    found: dict[Name, str] = {}
    waiting, whole = list(functions), set[str]()
    while waiting:
        module, name = waiting.pop()
        definitions = _definitions(module)
        if name not in definitions:  # a whole module, or a name that it defines in a block
            waiting += [(module, each) for each in definitions if module not in whole]
            whole.add(module)
        elif (module, name) not in found:
            definition = definitions[name]
            found[module, name] = definition.digest
            # Statements that define nothing, such as registrations, count wherever anything of their module is used.
            used = {*definition.uses, *filter(str.isdigit, definitions)} if definition.digest else set[str]()
            waiting += [(module, each) for each in used if each in definitions]
            waiting += [inner for origin in definition.imports for inner in _followed(origin, stop)]
    return found


def _followed(origin: Name, stop: Collection[str]) -> list[Name]:
    """Return the definition of an import from the package, unless it stops there: of a module all its definitions."""
    source, name = origin
    if source in {MACHINERY, *stop} or _source(source) is None:
        return []
    if _source(inner := f"{source}.{name}"):
        return [] if inner in stop else [(inner, "")]
    return [origin]


def _digest_of(definitions: dict[Name, str]) -> str:
    """Return a digest of definitions; imports, which have none, do not count."""
    return digest([[*name, definitions[name]] for name in sorted(definitions) if definitions[name]])


def _as_lists(node: Any) -> Any:
    """Return a syntax tree as lists; empty fields differ between versions of Python, and are left out."""
    if isinstance(node, list):
        return [_as_lists(each) for each in node]
    if not isinstance(node, ast.AST):
        return repr(node)
    fields = [(name, value) for name, value in ast.iter_fields(node) if value is not None and value != []]
    return [type(node).__name__, *([name, _as_lists(value)] for name, value in fields)]
