"""Cost of curves with each tuned number halved and doubled, in a copy of the package."""

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
from weier.accuracy.measurement import measurement
from weier.data import markdown

PACKAGE = Path(weier.__file__).parent
# cost with few to very many contacts: pairs of FFTs of boundary elements, reproducible, and the least processor
# seconds of three curves by contact patches, which vary by a third on a loaded machine
BEM = """
found = []
for m, points in ((3, 64), (5, 64), (7, 16)):
    variant, loads = Variant("bem", {"points_per_wave": points}), MANY if m < 7 else np.array([2.0])
    found.append(run(variant, series(m), loads).others["work"].sum())
"""
PATCHES = """
found = []
for m, loads in ((3, MANY), (5, MANY), (7, np.array([0.1]))):
    runs = [run(Variant("patches"), series(m), loads).seconds for _ in range(4)]
    found.append(min(runs[1:]))
"""
SOLVE = """
import json
import numpy as np
from weier import Profile
from weier.accuracy.runner import Variant, run

MANY, series = np.geomspace(1e-3, 2, 12), lambda m: Profile(1.25, 5, m, [0.0] + [1.0] * (m - 1))
{}
print(json.dumps(found))
"""
# module and name of each number
BEM_CONSTANTS = (
    ("bem.active_set", "FIRST_PATIENCE"),
    ("bem.edges", "REACH"),
    ("bem.grids", "MIN_POINTS"),
    ("bem.grids", "MIN_POINTS_PER_CARRIED_WAVE"),
    ("bem.grids", "COARSE_ACCURACY"),
)
PATCHES_CONSTANTS = (
    ("punches", "NEIGHBOURS"),
    ("patches.pair_sums", "LEAF_POINTS"),
    ("patches.pair_sums", "MAX_DIRECT"),
)
FACTORS = (0.5, 2.0)
HEADER = ("module", "number", "cost if halved", "cost if doubled")


def copy_package(folder: Path, changes: Mapping[str, Collection[str]], factor: float) -> None:
    """Copy the package into a folder and multiply the given numbers in modules of `weier.methods`."""
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
    """Return the JSON printed by a program that imports the package of this folder and caches kernels in it."""
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


@measurement("Cost of the tuned numbers")
@click.option("--only", default="", help="Names of the numbers, with commas; all by default.")
def main(only: str) -> list[str]:
    """Solve curves with each tuned number halved and doubled, which takes a quarter of an hour.

    The table has cost ratios, changed over usual number, for 25, 625 and 15 625 waves. The cost of boundary elements
    is in pairs of FFTs, of contact patches in least processor seconds of three curves, on an idle machine. Results
    do not depend on these numbers (docs/numerics.md, "Limits without an effect"). Each is changed in a copy of the
    package, which compiles its kernels anew.
    """
    rows, chosen = [], only.split(",") if only else [name for _, name in BEM_CONSTANTS + PATCHES_CONSTANTS]
    for program, numbers in ((BEM, BEM_CONSTANTS), (PATCHES, PATCHES_CONSTANTS)):
        listed = [(module, name) for module, name in numbers if name in chosen]
        usual = costs(program, {}, 1.0) if listed else []
        for module, name in listed:
            cells = []
            for factor in FACTORS:
                changed = costs(program, {module: [name]}, factor)
                cells.append(" / ".join(f"{new / old:.2f}" for new, old in zip(changed, usual, strict=True)))
            rows.append([f"`{module}`", f"`{name}`", *cells])
    return [markdown.table(HEADER, rows)]
