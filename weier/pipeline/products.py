"""The products of a scene, and the stamps that record what each product was made from.

`results/SCENE/.made_of/PRODUCT/DIGEST` is a stamp. Its name is the digest of the curves that the product reads, its
entry in the scene and the code that makes it, so that Snakemake only has to make missing files. It holds the original
files of the product, which reveals edited files.
"""

from __future__ import annotations

import filecmp
from pathlib import Path
from typing import Any

from weier.data.provenance import source_date
from weier.digests import DIGITS, digest, digest_of_modules, numerics
from weier.pipeline.needed_curves import Curves
from weier.scene.cases import Scene
from weier.scene.identity import digest_of_keys

# Products of a scene other than figures: the dataset with the claims, and the explorer. Figure names have no dot.
DATA, CLAIMS, PAGE = "contact.nc", "claims.md", "page.html"
FORMATS = ("png", "pdf", "svg", "csv")  # each figure is written in these formats
STAMPS = ".made_of"
DATA_ROOMS, FIGURE_ROOMS = ("data", "scene", "api", "pipeline"), ("data", "scene", "api", "pipeline", "figures")


def names_of(scene: Scene) -> list[str]:
    """Return the names of all products of a scene."""
    return [DATA, *scene.figures, PAGE]


def files_of(product: str) -> list[str]:
    """Return the files of a product, in the folder of its scene."""
    if product in (DATA, PAGE):
        return [DATA, CLAIMS] if product == DATA else [PAGE]
    return [f"figures/{product}.{suffix}" for suffix in FORMATS]


def studies_of(scene: Scene, product: str) -> tuple[str, ...]:
    """Return the studies that a product reads."""
    return tuple(scene.studies) if product in (DATA, PAGE) else scene.figure(product).all_studies


def made_of(curves: Curves, product: str) -> str:
    """Return a digest of everything that a product depends on."""
    scene = curves.scene
    studies = studies_of(scene, product)
    cases = [[name, [digest_of_keys(part.case_keys) for part in scene.study(name).products]] for name in studies]
    common: list[Any] = [scene.name, product, numerics(), cases, curves.digest(studies), repr(scene.interface)]
    common.append(scene.load_unit)
    if product == DATA:  # SOURCE_DATE_EPOCH replaces the date and omits the seconds
        own = [scene.text, source_date(), digest_of_modules(*DATA_ROOMS)]
    elif product == PAGE:
        own = [scene.title, digest_of_modules(*FIGURE_ROOMS)]
    else:
        own = [repr(scene.figure(product)), digest_of_modules(*FIGURE_ROOMS)]
    return digest([*common, *own])[:DIGITS]


def stamp_of(folder: Path, product: str, made_of: str) -> tuple[Path, bool]:
    """Return the stamp of a product with this digest, and whether the product's files equal those in the stamp.

    A product whose files have changed since needs a stamp of another name, which is missing.
    """
    stamps = folder / STAMPS / product
    known = sorted(stamps.glob(f"{made_of}*"))
    for stamp in known:
        if all(_alike(folder / file, stamp / Path(file).name) for file in files_of(product)):
            return stamp, True
    edited = f".{digest([path.name for path in known])[:DIGITS]}" if known else ""
    return stamps / f"{made_of}{edited}", False


def _alike(one: Path, other: Path) -> bool:
    """Return whether two files exist and have the same content."""
    return one.is_file() and other.is_file() and filecmp.cmp(one, other, shallow=False)
