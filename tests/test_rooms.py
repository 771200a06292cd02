"""Imports go one way: from each room of the package only to those below it."""

import ast

from weier.digests import PACKAGE
from weier.methods.registry import names

# rooms and the modules beside them: each imports only from those before its own; the library could be used alone
LIBRARY = "digests", "kernels", "units", "checks", "surface", "theory", "methods"
ORDER = *LIBRARY, "data", "scene", "api", "pipeline", "figures", "accuracy", "cli"
# what is about certain methods: measurements, the claims of the paper, and calls that only contact patches answer
ABOUT_METHODS = ("methods", "accuracy", "pipeline/claims", "api/fields.py", "figures/message.py", "__init__.py")


def imports(tree):
    """The modules and names that a file imports, each with the modules that hold it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_every_module_is_in_a_room_or_beside_them():
    modules = {path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()}
    assert modules == {"__init__", "__main__", *ORDER}


def test_imports_go_one_way_and_methods_are_known_from_their_list_alone():
    for path in (path for part in ORDER for path in [PACKAGE / f"{part}.py", *(PACKAGE / part).rglob("*.py")]):
        if not path.exists():
            continue
        part, tree = path.relative_to(PACKAGE).parts[0].removesuffix(".py"), ast.parse(path.read_text("utf-8"))
        later = {f"weier.{other}" for other in ORDER[ORDER.index(part) + 1 :]}
        found = {".".join(name.split(".")[:length]) for name in imports(tree) for length in (1, 2, 3)}
        assert not found & (later | {"xarray", "netCDF4", "snakemake"} if part in LIBRARY else later), path
        if not path.relative_to(PACKAGE).as_posix().startswith(ABOUT_METHODS):
            found |= {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
            of_bokeh = {"auto"} if path.name == "page.py" else set()
            assert not found & {*names(), *(f"weier.methods.{name}" for name in names())} - of_bokeh, path
