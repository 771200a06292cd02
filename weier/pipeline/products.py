"""The products of a scene, and the stamps that tell what each product was made from.

`results/SCENE/.made_of/JOB/PRODUCT/DIGEST.SUM` is a stamp: a folder with the files of the product, which are linked
to their places. DIGEST is that of the curves that the product reads, of its entry in the scene and of the code that
makes it, SUM is that of its files, and JOB is named by what it makes: Snakemake only has to make missing folders.
"""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path

from weier.data.provenance import source_date
from weier.digests import DIGITS, digest, digest_of_modules, numerics
from weier.pipeline.needed_curves import Curves
from weier.scene.cases import Scene

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
    of_figure = [f"figures/{product}.{suffix}" for suffix in FORMATS]
    return {DATA: [DATA, CLAIMS], PAGE: [PAGE]}.get(product, of_figure)


def studies_of(scene: Scene, product: str) -> tuple[str, ...]:
    """Return the studies that a product reads, or ALL."""
    return tuple(scene.studies) if product in (DATA, PAGE, ALL) else scene.figure(product).all_studies


def made_of(curves: Curves, product: str) -> str:
    """Return a digest of everything that a product depends on."""
    scene = curves.scene
    studies = studies_of(scene, product)
    cases = [[name, [product.case_keys for product in scene.studies[name].products]] for name in studies]
    wanted = [[part.kind.name, part.keys] for part in curves.parts_for(studies)]
    common = [scene.name, product, numerics(), digest_of_modules(*ROOMS), cases, wanted]
    if product == DATA:  # SOURCE_DATE_EPOCH replaces the date and omits the seconds
        own = [scene.text, source_date()]
    else:
        own = [scene.title if product == PAGE else repr(scene.figure(product))]
    return digest([*common, repr(scene.interface), scene.load_unit, *own])[:DIGITS]


def stamp_of(curves: Curves, folder: Path, product: str) -> tuple[str, bool]:
    """Return the stamp of a product in the folder of its scene, JOB/PRODUCT/DIGEST.SUM, and whether it is fresh.

    It is fresh if its files have this sum, whatever their dates. Otherwise, a text names what is to be made: another
    one than for earlier jobs, whose files have been edited.
    """
    stamps, wanted = folder / STAMPS, f"{product}/{made_of(curves, product)}"
    known = sorted(path.relative_to(stamps).as_posix() for path in stamps.glob(f"*/{wanted}.*"))
    own = sum_of(folder / file for file in files_of(product)) if known else ""
    fresh = [stamp for stamp in known if stamp.endswith(f".{own}")]
    return (fresh[0], True) if fresh else (f"{wanted}{known}", False)


def sum_of(files: Iterable[Path]) -> str:
    """Return a digest of the contents of some files, of which one may be missing."""
    sums = list[str]()
    for file in files:
        if not file.is_file():
            return "missing"
        with file.open("rb") as content:
            sums.append(hashlib.file_digest(content, "sha256").hexdigest())
    return digest(sums)[:DIGITS]


def job_of(scene: Scene, what: str, stamp: Callable[[str], tuple[str, bool]]) -> tuple[str, list[str]]:
    """Return the name of the job that makes a product, or ALL outdated ones, and their names.

    `stamp` returns what `stamp_of` returns for a product.
    """
    found = {name: stamp(name) for name in (names_of(scene) if what == ALL else [what])}
    outdated = {name: stamp for name, (stamp, fresh) in found.items() if not fresh}
    return f"{what}.{digest(outdated)[:DIGITS]}", [*outdated]


def remove_older(job: Path, product: str) -> None:
    """Remove the stamps of a product that other jobs than this one have left, and their folders if these are empty.

    A job that has made other products at the same time may remove the same folder.
    """
    for other in job.parent.glob(f"*/{product}"):
        if other.parent != job:
            shutil.rmtree(other, ignore_errors=True)
            if not any(other.parent.glob("*/")):
                shutil.rmtree(other.parent, ignore_errors=True)
