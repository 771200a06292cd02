"""The products of a scene, and the stamps that say what each was made of.

`results/SCENE/.made_of/PRODUCT/DIGEST` is a stamp: its name is the digest of the curves that the product reads, its
entry in the scene and the code that makes it, so that Snakemake's plain rule, a missing file is made, does
everything. It is made empty when the curves are there, and the job that makes the product writes the digests of its
files into it, so that an edited file is found, too.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from weier.data.files import write_text
from weier.data.provenance import source_date
from weier.digests import DIGITS, digest, digest_of_modules, numerics
from weier.pipeline.curves import Curves
from weier.scene.cases import Scene
from weier.scene.identity import digest_of_keys

# The products of a scene besides its figures, whose names have no dot: the dataset with the claims, and the explorer.
DATA, CLAIMS, PAGE = "contact.nc", "claims.md", "page.html"
FORMATS = ("png", "pdf", "svg", "csv")  # of each figure
STAMPS = ".made_of"
OF_DATA, OF_FIGURES = ("data", "scene", "api", "pipeline"), ("data", "scene", "api", "pipeline", "figures")
TEXTS = (".py", ".css", ".html", ".js", ".mplstyle")  # suffixes of what figures and the explorer are made with


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
    """Return the digest of all that a product depends on."""
    scene = curves.scene
    studies = studies_of(scene, product)
    cases = [[name, [digest_of_keys(part.case_keys) for part in scene.study(name).products]] for name in studies]
    common: list[Any] = [scene.name, product, numerics(), cases, curves.digest(studies), repr(scene.interface)]
    common.append(scene.load_unit)
    if product == DATA:  # with SOURCE_DATE_EPOCH, it has neither the date of the run nor seconds
        own = [scene.text, source_date(), digest_of_modules(*OF_DATA)]
    elif product == PAGE:
        own = [scene.title, digest_of_modules(*OF_FIGURES, suffixes=TEXTS)]
    else:
        own = [repr(scene.figure(product)), digest_of_modules(*OF_FIGURES, suffixes=TEXTS)]
    return digest([*common, *own])[:DIGITS]


def stamp_of(folder: Path, product: str, made_of: str) -> tuple[Path, bool]:
    """Return the stamp of a product with this digest, and whether the files of the product are as its job left them.

    A product whose files have changed since needs a stamp of another name, which is missing.
    """
    stamps = folder / STAMPS / product
    texts = {path: path.read_text(encoding="utf-8") for path in sorted(stamps.glob(f"{made_of}*"))}
    now = _digests(folder, product)
    for wanted, is_fresh in ((now, True), ("", False)):
        if found := [path for path, text in texts.items() if text == wanted]:
            return found[0], is_fresh and bool(now)
    known = [[path.name, text] for path, text in texts.items()]  # names, too, for a second edit of the same file
    edited = f".{digest(known)[:DIGITS]}" if texts else ""
    return stamps / f"{made_of}{edited}", False


def fill_stamp(stamp: Path) -> None:
    """Write the digests of the files of a product into its stamp, and remove its other stamps."""
    product, folder = stamp.parent.name, stamp.parents[2]
    write_text(stamp, _digests(folder, product))
    for other in stamp.parent.iterdir():
        if other != stamp:
            other.unlink()


def _digests(folder: Path, product: str) -> str:
    """Return the digests of the files of a product as text; empty if one is missing."""
    found = {}
    for file in files_of(product):
        try:
            with (folder / file).open("rb") as content:
                found[file] = hashlib.file_digest(content, "sha256").hexdigest()
        except FileNotFoundError:
            return ""
    return json.dumps(found, indent=1) + "\n"
