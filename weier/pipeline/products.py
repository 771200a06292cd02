"""The products of a scene, and the stamps that tell what each product was made from.

`results/SCENE/.made_of/JOB/PRODUCT/DIGEST` is a stamp: a folder with the files of the product as they were made. Its
name is the digest of the curves that the product reads, its entry in the scene and the code that makes it, and JOB is
named by the stamps that it makes, so that Snakemake only has to make missing folders of jobs.
"""

from __future__ import annotations

import filecmp
import shutil
from collections.abc import Callable
from pathlib import Path

from weier.data.provenance import source_date
from weier.digests import DIGITS, digest, digest_of_modules, numerics
from weier.pipeline.needed_curves import Curves, digest_of_curves
from weier.scene.cases import Scene
from weier.scene.identity import digest_of_keys

# Products of a scene other than figures: the dataset with the claims, and the explorer. Figure names have no dot.
DATA, CLAIMS, PAGE = "contact.nc", "claims.md", "page.html"
ALL = "all.products"  # stands for all products of a scene
FORMATS = ("png", "pdf", "svg", "csv")  # each figure is written in these formats
STAMPS = ".made_of"
ROOMS = ("data", "scene", "api", "pipeline", "figures")  # rooms that make products of curves


def names_of(scene: Scene) -> list[str]:
    """Return the names of all products of a scene."""
    return [DATA, *scene.figures, PAGE]


def files_of(product: str) -> list[str]:
    """Return the files of a product, in the folder of its scene."""
    if product in (DATA, PAGE):
        return [DATA, CLAIMS] if product == DATA else [PAGE]
    return [f"figures/{product}.{suffix}" for suffix in FORMATS]


def studies_of(scene: Scene, product: str) -> tuple[str, ...]:
    """Return the studies that a product reads, or ALL."""
    return tuple(scene.studies) if product in (DATA, PAGE, ALL) else scene.figure(product).all_studies


def made_of(curves: Curves, product: str) -> str:
    """Return a digest of everything that a product depends on."""
    scene = curves.scene
    studies = studies_of(scene, product)
    cases = [[name, [digest_of_keys(part.case_keys) for part in scene.studies[name].products]] for name in studies]
    wanted = digest_of_curves(curves.parts_for(studies))
    common = [scene.name, product, numerics(), digest_of_modules(*ROOMS), cases, wanted]
    if product == DATA:  # SOURCE_DATE_EPOCH replaces the date and omits the seconds
        own = [scene.text, source_date()]
    else:
        own = [scene.title if product == PAGE else repr(scene.figure(product))]
    return digest([*common, repr(scene.interface), scene.load_unit, *own])[:DIGITS]


def stamp_of(curves: Curves, folder: Path, product: str) -> tuple[str, bool]:
    """Return the stamp of a product in the folder of its scene, and whether the product is fresh.

    It is fresh if its files are those in the stamp JOB/PRODUCT/DIGEST, whatever their dates. Otherwise, the stamp is
    the PRODUCT/DIGEST to make, with another name than those of stamps with other files.
    """
    stamps, wanted = folder / STAMPS, f"{product}/{made_of(curves, product)}"
    known = sorted(path.relative_to(stamps).as_posix() for path in stamps.glob(f"*/{wanted}*"))
    files = [folder / file for file in files_of(product)]
    for stamp in known:
        if all(_same(file, stamps / stamp / file.name) for file in files):
            return stamp, True
    edited = f".{digest(known)[:DIGITS]}" if known else ""
    return f"{wanted}{edited}", False


def _same(file: Path, other: Path) -> bool:
    return file.is_file() and other.is_file() and filecmp.cmp(file, other, shallow=False)


def job_of(scene: Scene, what: str, stamp: Callable[[str], tuple[str, bool]]) -> tuple[str, list[str]]:
    """Return the name of the job that makes the missing stamps of a product, or of ALL, and these stamps.

    `stamp` returns what `stamp_of` returns for a product.
    """
    missing = [name for name, fresh in map(stamp, names_of(scene) if what == ALL else [what]) if not fresh]
    return f"{what}.{digest(missing)[:DIGITS]}", missing


def remove_older(job: Path, product: str) -> None:
    """Remove the stamps of a product that other jobs than this one have left, and their folders if these are empty.

    A job that has made other products at the same time may remove the same folder.
    """
    for other in job.parent.glob(f"*/{product}"):
        if other.parent != job:
            shutil.rmtree(other, ignore_errors=True)
            if not any(other.parent.glob("*/")):
                shutil.rmtree(other.parent, ignore_errors=True)
