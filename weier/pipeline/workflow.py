"""The plan of the Snakefile: which curves and products are missing, and how jobs share them.

Planning writes nothing. An invalid scene or folder ends the run with one sentence, without a traceback.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from typing import Any, TypeVar

from weier.checks import checked_word, shown
from weier.data.files import check_target
from weier.digests import DIGITS, digest, numerics
from weier.kernels.jit import cache_folder
from weier.methods.registry import methods_run_by
from weier.pipeline import products
from weier.pipeline.needed_curves import SURFACE, Curves, Part, share
from weier.pipeline.products import ALL
from weier.pipeline.store import Store
from weier.scene import Scene

RESULTS = Path("results")
# Minutes of a job in addition to the expected ones, for a busy disk; expected seconds may be wrong by this factor. A
# job that needs more is run again with twice as many.
BASE_MINUTES, SECONDS_FACTOR = 5, 5
# arbitrary within a factor of two, since curves do not depend on the jobs that solve them: starting a job takes 1 s
JOB_SECONDS = 10.0

T = TypeVar("T")


@contextmanager
def ending_in_one_sentence() -> Iterator[None]:
    """End the run with a message if a scene or a folder is invalid."""
    try:
        yield
    except (ValueError, OSError) as error:
        raise SystemExit(f"weier: {error}") from None


def once(function: Callable[..., T]) -> Callable[..., T]:
    """Return a function that remembers what it returns, since Snakemake calls it several times, and ends as above."""
    return cache(ending_in_one_sentence()(function))


class Plan:
    """The plan of one run of Snakemake; methods that take `wildcards` are functions for its rules.

    `names` are the scenes of the configuration, `load` loads a scene by its name from a folder, and `slots` is the
    number of jobs that can run at once.
    """

    def __init__(self, names: Sequence[str], load: Callable[[str, str], Scene], folder: str, slots: int) -> None:
        self.names, self.folder, self.slots, self.numerics, self._makes_all = names, folder, slots, numerics(), False
        store = Store(RESULTS / "curves", self.numerics)
        self.scene = once(lambda name: load(name, folder))
        self.curves = once(lambda name: Curves(self.scene(name), store))
        self.missing = once(lambda what: missing(what, self.curves))
        self.stamp = once(lambda name, product: products.stamp_of(self.curves(name), RESULTS / name, product))

    # --- products ---

    def all_files(self, wildcards: Any) -> list[str]:
        """Return all products of the scenes of the configuration, with the folders of the jobs that made them."""
        self._makes_all = True
        files = []
        for name in self.names:
            for product in products.names_of(self.scene(name)):
                files += [str(RESULTS / name / file) for file in products.files_of(product)]
                files.append(self.job(name, product)[0])
        return files

    def job(self, name: str, product: str) -> tuple[str, bool]:
        """Return the folder of the job that makes a product, or that made it, and whether the product is fresh.

        A product that is named is made alone. All others of a scene are made by one job, since a process spends two
        seconds on imports.
        """
        stamp, fresh = self.stamp(name, product)
        if not fresh:
            what = ALL if self._makes_all and name in self.names else product
            stamp, _ = products.job_of(self.scene(name), what, partial(self.stamp, name))
        return str(RESULTS / name / products.STAMPS / stamp.partition("/")[0]), fresh

    def made_of(self, wildcards: Any, product: str, ancient: Callable[[str], Any]) -> dict[str, Any]:
        """Return the folder of the job that makes a product, and the file of its scene; `ancient` if it is fresh."""
        folder, fresh = self.job(wildcards.scene, product.format(**wildcards))
        files = {"folder": folder, "scene": f"{self.folder}/{wildcards.scene}.yaml"}
        return {name: ancient(file) for name, file in files.items()} if fresh else files

    @property
    def new_digests(self) -> str:
        """A pattern that matches digests of missing folders of jobs only, since no rule makes existing ones."""
        known = {path.suffix[1:] for path in RESULTS.glob(f"*/{products.STAMPS}/*")}
        return rf"(?!({'|'.join(sorted(known))})$)[0-9a-f]+" if known else "[0-9a-f]+"

    # --- curves ---

    def solved(self, wildcards: Any) -> list[str]:
        """Return the jobs that solve the missing curves of the products that a job makes.

        These are at most `slots`, and none is too short.
        """
        names = self.names if wildcards.what == ALL else [wildcards.scene]
        what = "/".join([*names, wildcards.what])
        parts = self.missing(what)
        curves, seconds = sum(len(part.keys) for part in parts), _seconds(parts)
        count = min(self.slots, curves, 1 + int(seconds / JOB_SECONDS))
        own = digest([[part.kind.name, part.keys] for part in parts])[:DIGITS]
        folder = RESULTS / "curves" / ".solved" / what / self.numerics / own
        return [str(folder / f"{number}-of-{count}") for number in range(count)]

    def seconds(self, wildcards: Any, output: Any = None) -> int:
        """Return the expected seconds of a job of curves."""
        return round(_seconds(self.missing(wildcards.what)) / int(wildcards.share.partition("-of-")[2]))

    def minutes(self, wildcards: Any, attempt: int) -> int:
        """Return the minutes that a job of curves may need, more at each attempt."""
        return round(attempt * (BASE_MINUTES + SECONDS_FACTOR * self.seconds(wildcards) / 60))

    def kernels(self, wildcards: Any) -> list[str]:
        """Return the marker files of the compiled kernels that the missing curves need.

        Closed forms compile in seconds and need no job of their own. The list is empty if kernels are not compiled or
        the cache is not writable; each job then compiles its own kernels.
        """
        if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
            return []
        try:
            check_target(kernels_file("any"))
        except OSError:
            return []
        named = {part.kind.method for part in self.missing(wildcards.what)} - {SURFACE}
        methods = (method for name in named for method in methods_run_by(name) if method.numerical)
        return sorted({kernels_file(share) for method in methods for share in method.kernels})


def _seconds(parts: Iterable[Part]) -> float:
    return float(sum(part.seconds.sum() for part in parts))


def missing(what: str, curves: Callable[[str], Curves], job: str = "") -> list[Part]:
    """Return curves that the store lacks, of a product of one scene or of ALL of several, SCENE/.../PRODUCT.

    The share of a `job` such as 0-of-2 does not depend on what others have solved meanwhile.
    """
    *names, product = what.split("/")
    scenes = list(map(curves, names))
    wanted = [part for own in scenes for part in own.parts_for(products.studies_of(own.scene, product))]
    return scenes[0].store.lacking(share(wanted, *map(int, job.split("-of-"))) if job else wanted)


def kernels_file(kernels: str) -> str:
    """Return the marker file of some kernels: in the cache, so that runs in all folders share it."""
    return str(cache_folder() / "compiled" / kernels)


def names_of_scenes(config: Mapping[str, Any]) -> list[str]:
    """Return the names of the scenes of the configuration, each once."""
    with ending_in_one_sentence():
        for key in config:
            checked_word("a key of --config", key, ["scenes"])
        given = config.get("scenes")
        if not isinstance(given, str) or not given.strip():  # Snakemake reads 0815 as 815, perhaps another scene
            raise ValueError(f"scenes must be names, with commas between, got {shown(given)}: numbers need quotes")
        return list(dict.fromkeys(name.strip() for name in given.split(",")))
