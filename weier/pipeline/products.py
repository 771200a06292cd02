"""The products of a scene, and the stamps that record what each product was made from.

`results/SCENE/.made_of/JOB/PRODUCT/DIGEST` is a stamp. Its name is the digest of the curves that the product reads,
its entry in the scene and the code that makes it, so that Snakemake only has to make missing folders of jobs. It
holds the checksums of the product's files, which reveal edited files.
"""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterable
from contextlib import suppress
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
STAMPS, FILES = ".made_of", "files"
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
    """Return the stamp of a product with this digest, and whether the product's files are those of the stamp.

    A product whose files have changed since needs a stamp of another name. Where it is missing, the path is relative
    to the job that makes it.
    """
    known = sorted((folder / STAMPS).glob(f"*/{product}/{made_of}*"))
    files = [folder / file for file in files_of(product)]
    if all(file.is_file() for file in files):
        sums = checksums(files)
        for stamp in known:
            if stamp.read_text(encoding="ascii") == sums:
                return stamp, True
    edited = f".{digest([str(path.relative_to(folder)) for path in known])[:DIGITS]}" if known else ""
    return Path(product, f"{made_of}{edited}"), False


def checksums(files: Iterable[Path]) -> str:
    """Return the checksums of files, as the command sha256sum writes them."""
    lines = []
    for file in files:
        with file.open("rb") as content:
            lines.append(f"{hashlib.file_digest(content, 'sha256').hexdigest()}  {file.name}\n")
    return "".join(lines)


def remove_older(job: Path, product: str) -> None:
    """Remove the stamps of a product that other jobs than this one have left, and their folders if these are empty.

    A job that has made other products at the same time may remove the same folder.
    """
    for other in job.parent.glob(f"*/{product}"):
        if other.parent != job:
            shutil.rmtree(other, ignore_errors=True)
            with suppress(FileNotFoundError):
                if not any(path.is_dir() for path in other.parent.iterdir()):
                    shutil.rmtree(other.parent, ignore_errors=True)
