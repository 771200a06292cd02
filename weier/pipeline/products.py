"""The products of a scene, each with a digest of everything that it was made of.

A product carries this digest, so that an outdated one is detected, also in a copy of the folder. The digest covers
the curves that the product reads, their order, the product's entry in the scene, and the code that makes it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

from weier.data.netcdf import sealed_name
from weier.data.provenance import source_date
from weier.digests import RESOURCES, Name, digest, digest_of_code, digest_of_sources
from weier.methods.registry import METHODS
from weier.pipeline.batches import Solutions
from weier.scene import Scene

# The products of a scene besides its figures, whose names have no dot: the dataset with the claims, and the explorer.
DATA, CLAIMS, PAGE = "contact.nc", "claims.md", "page.html"
FORMATS = ("pdf", "svg", "png")  # Each figure is written in these formats, which carry what it was made of.
VALUES = "csv"  # format of its values

# Figures and tables depend on names and looks of methods; the names of batches cover the code of methods.
REGISTRY = "weier.methods.registry"
# The code of every figure.
FIGURE = (("weier.figures", "draw"), ("weier.figures", "undrawn"), ("weier.pipeline.gather", "read_study"))
LOOKS = ("name", "label", "summary", "style", "numerical", "uses_phases")
HALF = 16  # digits of a digest
MARK = re.compile(rb"made of weier:([0-9a-f]{32})")


def names_of(scene: Scene) -> list[str]:
    """Return the names of all products of a scene."""
    return [DATA, *scene.figures, PAGE]


def files_of(product: str) -> list[str]:
    """Return the files of a product, in the folder of its scene."""
    return [*marked_files_of(product), *([] if product in (DATA, PAGE) else [f"figures/{product}.{VALUES}"])]


def marked_files_of(product: str) -> list[str]:
    """Return those of its files that carry the digest of its inputs."""
    of_data = {DATA: [DATA, CLAIMS], PAGE: [PAGE]}
    return of_data.get(product) or [f"figures/{product}.{suffix}" for suffix in FORMATS]


def products_with(scene: Scene, files: Sequence[Path]) -> tuple[Path, list[str]]:
    """Return the folder of a scene and its products, from files of these; ValueError if one is of no product."""
    product = {Path(file).parts: name for name in names_of(scene) for file in files_of(name)}
    found: dict[str, Path] = {}
    for file in files:
        parts = next((parts for parts in (file.parts[-2:], file.parts[-1:]) if parts in product), None)
        if parts is None:
            raise ValueError(
                f"{file} is no file of the scene: choose from {', '.join('/'.join(each) for each in product)}"
            )
        found[product[parts]] = file.parents[len(parts) - 1]
    return next(iter(found.values())), list(found)


def is_fresh(folder: str | Path, product: str, inputs: str) -> bool:
    """Return whether all files of a product are in the folder of its scene, and were made of these inputs."""
    made = {made_of(Path(folder, file)) for file in marked_files_of(product)}
    return made == {inputs} and all(Path(folder, file).exists() for file in files_of(product))


def inputs_of(solutions: Solutions, product: str) -> str:
    """Return the digest of the inputs of a product."""
    if product == PAGE:
        return inputs_of_page(solutions)
    return inputs_of_data(solutions) if product == DATA else inputs_of_figure(solutions, product)


def inputs_of_data(solutions: Solutions) -> str:
    """Return the digest of the inputs of the data and the claims of a scene.

    Its first half is the digest of all that the variables depend on, its second half that of the scene as a text.
    """
    scene = solutions.scene
    entry = [
        list(scene.studies),
        scene.loads.tolist(),
        repr(scene.interface),
        scene.in_si,
        list(scene.claims.items()),
        source_date(),  # with it, the data have neither the date of their run nor seconds
    ]
    variables = _inputs(solutions, None, entry, [("weier.pipeline.claims", "write")])
    return variables[:HALF] + digest(scene.text)[:HALF]


def has_variables_of(path: str | Path, inputs: str) -> bool:
    """Return whether the data at a path have the variables of these inputs, and may have other attributes."""
    return (made_of(path) or "")[:HALF] == inputs[:HALF]


def inputs_of_figure(solutions: Solutions, name: str) -> str:
    """Return the digest of the inputs of a figure."""
    figure = solutions.scene.figure(name)
    code = [(f"weier.figures.{figure.draw}", "draw"), *FIGURE]
    return _inputs(solutions, figure.all_studies, [name, repr(figure)], code, "figures")


def inputs_of_page(solutions: Solutions) -> str:
    """Return the digest of the inputs of the explorer of a scene."""
    scene = solutions.scene
    entry = [scene.title, list(scene.studies), scene.loads.tolist(), repr(scene.interface), scene.in_si]
    return _inputs(solutions, None, entry, [("weier.figures.page", "write")], "figures")


def _inputs(
    solutions: Solutions, studies: Collection[str] | None, entry: Any, code: Collection[Name], *resources: str
) -> str:
    """Return the digest of a product that reads these studies, or all."""
    scene = solutions.scene
    curves = solutions.digest_of_curves(studies)
    cases = scene.digest_of_cases(*(scene.studies if studies is None else studies))
    looks = [[str(getattr(method, name)) for name in LOOKS] for method in METHODS]
    program = [digest_of_code(*code, stop=[REGISTRY]), digest_of_sources(*resources, suffixes=RESOURCES), looks]
    return digest([scene.name, entry, curves, cases, program])[:32]


def mark(inputs: str) -> str:
    """Return the text by which a product that is not netCDF carries the digest of its inputs."""
    return f"made of weier:{inputs}"


def made_of(path: str | Path) -> str | None:
    """Return the digest of the inputs that a product carries; None if it has none, or there is no such file."""
    path = Path(path)
    if path.suffix == ".nc":
        return sealed_name(path)
    try:
        found = MARK.search(path.read_bytes())
    except FileNotFoundError:
        return None
    return found[1].decode() if found else None
