"""Cost of curves with each tuned number halved and doubled: `python -m weier.accuracy.tuning`, a quarter of an hour.

Results do not depend on these numbers (docs/numerics.md, "Limits without an effect"), only the cost does. Each is
changed in a copy of the package, whose kernels are compiled again.
"""

from __future__ import annotations

import ast
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click

import weier
from weier.data import markdown

PACKAGE = Path(weier.__file__).parent
# Pairs of FFTs of boundary elements, which are reproducible, and the least processor seconds of three curves by
# contact patches, which vary by a third on a loaded machine; with few to very many contacts.
BEM = """
from weier.methods import bem
found = []
for m, points in ((3, 64), (5, 64), (7, 16)):
    profile = Profile(1.25, 5, m, [0.0] + [1.0] * (m - 1))
    loads = np.geomspace(1e-3, 2, 12) if m < 7 else [2.0]
    found.append(bem.curve(profile, loads, points * 5 ** (m - 1)).work.sum())
"""
PATCHES = """
from time import process_time
from weier.methods import patches
found = []
for m, loads in ((3, np.geomspace(1e-3, 2, 12)), (5, np.geomspace(1e-3, 2, 12)), (7, [0.1])):
    profile, seconds = Profile(1.25, 5, m, [0.0] + [1.0] * (m - 1)), []
    for _ in range(4):
        start = process_time()
        patches.curve(profile, loads)
        seconds.append(process_time() - start)
    found.append(min(seconds[1:]))
"""
SOLVE = "import json\nimport numpy as np\nfrom weier import Profile\n{}print(json.dumps(found))"
# module and name of each number
OF_BEM = (
    ("bem.active_set", "FIRST_PATIENCE"),
    ("bem.edges", "REACH"),
    ("bem.grids", "MIN_POINTS"),
    ("bem.grids", "MIN_POINTS_PER_CARRIED_WAVE"),
    ("bem.grids", "COARSE_ACCURACY"),
)
OF_PATCHES = (
    ("punches", "NEIGHBOURS"),
    ("patches.pair_sums", "LEAF_POINTS"),
    ("patches.fields", "MIN_SUM"),
    ("patches.start", "MANY_WAVES"),
)
FACTORS = (0.5, 2.0)
HEADER = ("module", "number", "cost halved: 25, 625, 15 625 waves", "cost doubled: 25, 625, 15 625 waves")


def copy_package(folder: Path, changes: Mapping[str, Collection[str]], factor: float) -> None:
    """Copy the package into a folder, with the numbers of these modules of `weier.methods` multiplied."""
    shutil.copytree(PACKAGE, folder / "weier", ignore=shutil.ignore_patterns("__pycache__"))
    for module, names in changes.items():
        scale(folder / "weier" / "methods" / f"{module.replace('.', '/')}.py", names, factor)


def scale(path: Path, names: Collection[str], factor: float) -> None:
    """Multiply the numbers that a module assigns to these names; whole numbers stay whole, and at least 1."""
    source, left = path.read_text(encoding="utf-8"), set(names)
    lines, places = source.splitlines(keepends=True), []
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign):
            target, value = node.targets[0], node.value
            pairs: Iterable[tuple[ast.expr, ast.expr]] = [(target, value)]
            if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
                pairs = zip(target.elts, value.elts, strict=True)
            places += [(number, one.id) for one, number in pairs if isinstance(one, ast.Name) and one.id in left]
    for value, name in sorted(places, key=lambda place: (-place[0].lineno, -place[0].col_offset)):
        number = eval(compile(ast.Expression(value), "", "eval"))
        new = max(1, round(number * factor)) if isinstance(number, int) else number * factor
        line = lines[value.lineno - 1]
        lines[value.lineno - 1] = line[: value.col_offset] + repr(new) + line[value.end_col_offset :]
        left.discard(name)
    if left:
        raise ValueError(f"{path.name} assigns no number to {', '.join(sorted(left))}")
    path.write_text("".join(lines), encoding="utf-8")


def run_in(folder: Path, program: str) -> list[Any]:
    """Return the JSON that a program prints with the package in this folder, whose kernels are kept there, too."""
    environment = os.environ | {"PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(folder / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    return list(json.loads(done.stdout))


def costs(program: str, changes: Mapping[str, Collection[str]], factor: float) -> list[float]:
    """Return the costs of curves with changed numbers."""
    with TemporaryDirectory() as folder:
        copy_package(Path(folder), changes, factor)
        return run_in(Path(folder), SOLVE.format(program))


@click.command()
@click.option("--only", default="", help="Names of the numbers, with commas; all by default.")
def main(only: str) -> None:
    """Print the cost with each number halved and doubled, over the usual cost."""
    rows, chosen = [], only.split(",") if only else [name for _, name in OF_BEM + OF_PATCHES]
    for program, numbers in ((BEM, OF_BEM), (PATCHES, OF_PATCHES)):
        listed = [(module, name) for module, name in numbers if name in chosen]
        usual = costs(program, {}, 1.0) if listed else []
        for module, name in listed:
            cells = []
            for factor in FACTORS:
                changed = costs(program, {module: [name]}, factor)
                cells.append(" / ".join(f"{new / old:.2f}" for new, old in zip(changed, usual, strict=True)))
            rows.append([f"`{module}`", f"`{name}`", *cells])
    click.echo(markdown.table(HEADER, rows))


if __name__ == "__main__":
    main()
