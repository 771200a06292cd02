"""Imports go one way: from each room of the package only to those below it."""

import ast

import pytest

from weier.digests import PACKAGE

FLOORS = ("kernels", "surface", "theory", "methods", "data", "scene", "pipeline", "accuracy", "figures", "cli")
LIBRARY = FLOORS[: FLOORS.index("methods") + 1]  # could be taken away and used alone
EVERYWHERE = {"checks", "digests", "units"}  # modules beside the rooms


def imports(path):
    """The modules that a file imports, with the names taken from packages."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names if node.module == "weier")


def rooms_imported(path):
    found = {name.split(".")[1] for name in imports(path) if name.startswith("weier.")}
    return found & set(FLOORS)


def test_every_module_is_in_a_room():
    assert len(FLOORS) <= 10
    rooms = {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists()}
    assert rooms == set(FLOORS)
    assert {path.stem for path in PACKAGE.glob("*.py")} == {"__init__", "__main__"} | EVERYWHERE


@pytest.mark.parametrize("room", FLOORS)
def test_imports_go_downwards(room):
    allowed = set(FLOORS[: FLOORS.index(room) + 1])
    for path in (PACKAGE / room).rglob("*.py"):
        assert rooms_imported(path) <= allowed, path


def test_modules_beside_the_rooms_import_the_lowest_alone():
    for name in EVERYWHERE:
        assert rooms_imported(PACKAGE / f"{name}.py") <= {"kernels"}, name


@pytest.mark.parametrize("part", [*LIBRARY, *(f"{name}.py" for name in sorted(EVERYWHERE))])
def test_the_library_knows_neither_datasets_nor_the_pipeline(part):
    found = PACKAGE / part
    for path in found.rglob("*.py") if found.is_dir() else [found]:
        assert not {name.split(".")[0] for name in imports(path)} & {"xarray", "netCDF4", "snakemake"}, path


OF_DATASETS = {"attrs", "data_vars", "coords", "dims", "variables", "isel", "sel", "to_dataset", "assign_coords"}


def names_in(path):
    """The names of attributes that a file uses, also those given to `getattr` and `hasattr`."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("getattr", "hasattr"):
            yield getattr(node.args[1], "value", "")


@pytest.mark.parametrize("room", LIBRARY)
def test_the_library_handles_no_datasets(room):
    """They may come as heights with units alone, whose positions are in a coordinate."""
    for path in (PACKAGE / room).rglob("*.py"):
        found = OF_DATASETS & set(names_in(path))
        assert found <= ({"coords", "dims"} if path.match("surface/measured/line.py") else set()), path
