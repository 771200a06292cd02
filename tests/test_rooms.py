"""Imports go one way: from each room of the package only to those below it."""

import ast

import pytest

from weier.digests import PACKAGE
from weier.methods.registry import names

ROOMS = ("kernels", "surface", "theory", "methods", "data", "scene", "api", "pipeline", "figures", "accuracy", "cli")
# the modules beside the rooms at their places: each module imports only from those before its own
ORDER = ("digests", "kernels", "units", "checks", *ROOMS[1:])
LIBRARY = ORDER[: ORDER.index("methods") + 1]  # could be taken away and used alone


def imports(path):
    """The modules that a file imports, with the names taken from packages."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (
                f"{node.module}.{alias.name}" for alias in node.names if node.module in ("weier", "weier.methods")
            )


def files_of(part):
    folder = PACKAGE / part
    return sorted(folder.rglob("*.py")) if folder.is_dir() else [PACKAGE / f"{part}.py"]


def test_every_module_is_in_a_room_or_beside_them():
    assert len(ROOMS) <= 11
    assert {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists()} == set(ROOMS)
    assert {path.stem for path in PACKAGE.glob("*.py")} == {"__init__", "__main__"} | set(ORDER) - set(ROOMS)


@pytest.mark.parametrize("part", ORDER)
def test_imports_go_one_way(part):
    later = set(ORDER[ORDER.index(part) + 1 :])
    for path in files_of(part):
        assert not {name.split(".")[1] for name in imports(path) if name.startswith("weier.")} & later, path


@pytest.mark.parametrize("part", LIBRARY)
def test_the_library_knows_neither_datasets_nor_the_pipeline(part):
    for path in files_of(part):
        assert not {name.split(".")[0] for name in imports(path)} & {"xarray", "netCDF4", "snakemake"}, path


# what is about certain methods: measurements, the claims of the paper, and calls that only contact patches answer
ABOUT_METHODS = ("methods", "accuracy", "pipeline/claims", "api/fields.py", "figures/message.py", "__init__.py")


def test_the_program_knows_methods_from_their_list_alone():
    rest = [
        path for path in PACKAGE.rglob("*.py") if not path.relative_to(PACKAGE).as_posix().startswith(ABOUT_METHODS)
    ]
    known = {*names()} | {f"weier.methods.{name}" for name in names()}
    for path in rest:
        constants = {node.value for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Constant)}
        of_bokeh = {"auto"} if path.name == "page.py" else set()
        imported = {name for name in imports(path) for name in (name, ".".join(name.split(".")[:3]))}
        assert not (constants | imported) & known - of_bokeh, path
