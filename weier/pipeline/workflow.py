"""The plan of the Snakefile: which curves and products are missing, and how jobs share them.

Planning writes nothing. An invalid scene or folder ends the run with one sentence, without a traceback.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from weier.checks import checked_word, shown
from weier.data.files import check_target
from weier.digests import DIGITS, digest, numerics
from weier.kernels.jit import cache_folder
from weier.methods.registry import methods_run_by
from weier.pipeline import products
from weier.pipeline.needed_curves import SURFACE, Curves, Part, share
from weier.pipeline.store import Store
from weier.scene import Scene
from weier.scene.identity import digest_of_keys

RESULTS = Path("results")
ALL = "all.products"  # of the scenes of the configuration; the name of a figure has no dot
BETWEEN = "~"  # separates scene and product; neither name contains it
# Minutes of a job in addition to the expected ones, for a busy disk; expected seconds may be wrong by this factor. A
# job that needs more is run again with twice as many.
BASE_MINUTES, SECONDS_FACTOR = 5, 5
# arbitrary within a factor of two, since curves do not depend on the jobs that solve them: starting a job takes 1 s
JOB_SECONDS = 10.0


@contextmanager
def ending_in_one_sentence() -> Iterator[None]:
    """End the run with a message if a scene or a folder is invalid."""
    try:
        yield
    except (ValueError, OSError) as error:
        raise SystemExit(f"weier: {error}") from None


class Plan:
    """The plan of one run of Snakemake; methods that take `wildcards` are functions for its rules.

    `names` are the scenes of the configuration, `load` finds a scene by its name, and `slots` is the number of jobs
    that can run at once.
    """

    def __init__(self, names: Sequence[str], load: Callable[[str], Scene], slots: int) -> None:
        self.names, self.slots, self.numerics, self._makes_all = names, slots, numerics(), False
        store = Store(RESULTS / "curves", self.numerics)
        # Cached, since Snakemake calls them several times.
        self.scene = cache(ending_in_one_sentence()(load))
        self.curves = cache(lambda name: Curves(self.scene(name), store))
        self.missing, self.stamp = cache(self._missing), cache(self._stamp)

    @ending_in_one_sentence()
    def check_folders(self) -> None:
        """Refuse folders of results that are closed to writing, before anything runs."""
        for folder in ("", *self.names) if self._makes_all else ("",):
            check_target(RESULTS / folder / "any")

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

    @ending_in_one_sentence()
    def _stamp(self, name: str, product: str) -> tuple[Path, bool]:
        """Return the stamp of a product, and whether it is fresh; dates do not matter."""
        curves = self.curves(name)
        return products.stamp_of(RESULTS / name, product, products.made_of(curves, product))

    def job(self, name: str, product: str) -> tuple[str, bool]:
        """Return the folder of the job that makes a product, or that made it, and whether the product is fresh.

        A product that is named is made alone, others together, since a process spends two seconds on imports.
        """
        stamp, fresh = self.stamp(name, product)
        if fresh:
            return str(stamp.parents[1]), True
        named = products.names_of(self.scene(name))
        count = self.slots if self._is_of_all(name) else len(named)
        share = f"{named.index(product) % count}-of-{count}"
        stamps = digest(self._stamps(name, share))[:DIGITS]
        return str(RESULTS / name / products.STAMPS / f"{share}.{stamps}"), False

    def stamps(self, wildcards: Any, output: Any = None) -> list[str]:
        """Return the stamps of the products that a job makes."""
        return self._stamps(wildcards.scene, wildcards.share)

    def _stamps(self, name: str, share: str) -> list[str]:
        """Return the stamps of a share of the products, but of those that are fresh."""
        stamps = [self.stamp(name, product) for product in dealt(products.names_of(self.scene(name)), share)]
        return [str(stamp) for stamp, fresh in stamps if not fresh]

    def _is_of_all(self, name: str) -> bool:
        return self._makes_all and name in self.names

    @property
    def new_digests(self) -> str:
        """A pattern that matches digests of missing folders of jobs only, since no rule makes existing ones."""
        known = {path.suffix[1:] for path in RESULTS.glob(f"*/{products.STAMPS}/*")}
        return rf"(?!({'|'.join(sorted(known))})$)[0-9a-f]+" if known else "[0-9a-f]+"

    # --- curves ---

    def solved(self, wildcards: Any) -> list[str]:
        """Return the jobs that solve the missing curves of the products that a job makes."""
        name = wildcards.scene
        if self._is_of_all(name):
            return self._jobs(ALL)
        named = dealt(products.names_of(self.scene(name)), wildcards.share)
        return [job for product in named for job in self._jobs(f"{name}{BETWEEN}{product}")]

    @ending_in_one_sentence()
    def _missing(self, what: str) -> list[Part]:
        return missing(what, self.names, self.curves)

    def _jobs(self, what: str) -> list[str]:
        """Return the jobs that solve the missing curves: at most `slots`, and none too short."""
        parts = self.missing(what)
        curves, seconds = sum(len(part.keys) for part in parts), _seconds(parts)
        count = min(self.slots, curves, 1 + int(seconds / JOB_SECONDS))
        keys = digest([[part.kind.name, digest_of_keys(part.keys)] for part in parts])[:DIGITS]
        folder = RESULTS / "curves" / ".solved" / what / self.numerics / keys
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
            check_target(cache_folder() / "compiled" / "any")
        except OSError:
            return []
        named = {part.kind.method for part in self.missing(wildcards.what)} - {SURFACE}
        methods = {method.name: method for name in named for method in methods_run_by(name) if method.numerical}
        return sorted(kernels_file(share) for method in methods.values() for share in method.kernels)


def _seconds(parts: Iterable[Part]) -> float:
    return float(sum(part.seconds.sum() for part in parts))


def dealt(names: Sequence[str], share: str) -> Sequence[str]:
    """Return a share of some names, such as 0-of-2."""
    number, count = map(int, share.split("-of-"))
    return names[number::count]


def missing(what: str, names: Sequence[str], curves: Callable[[str], Curves], job: str = "") -> list[Part]:
    """Return curves that the store lacks, of ALL products of the named scenes or of one, SCENE~PRODUCT.

    The share of a `job` such as 0-of-2 does not depend on what others have solved meanwhile.
    """
    if what == ALL:
        wanted = [part for name in names for part in curves(name).parts_for()]
    else:
        name, _, product = what.partition(BETWEEN)
        names, wanted = [name], curves(name).parts_for(products.studies_of(curves(name).scene, product))
    return curves(names[0]).store.lacking(share(wanted, *map(int, job.split("-of-"))) if job else wanted)


def kernels_file(kernels: str) -> str:
    """Return the marker file of some kernels: in the cache, so that runs in all folders share it.

    Without a home directory there is no cache, and the file is not used.
    """
    try:
        cache = cache_folder()
    except OSError:
        cache = Path("results")
    return str(cache / "compiled" / kernels)


def names_of_scenes(config: Mapping[str, Any]) -> list[str]:
    """Return the names of the scenes of the configuration, each once.

    On its command line Snakemake reads 0815 as the number 815, which may be another scene.
    """
    with ending_in_one_sentence():
        for key in config:
            checked_word("a key of --config", key, ["scenes"])
        given = config.get("scenes")
        if not isinstance(given, str) or not given.strip():
            raise ValueError(
                f"scenes must be names of scenes with commas between, got {shown(given)}: rename a scene whose name "
                "is a number, or name it in a file for --configfile, with quotes"
            )
        return list(dict.fromkeys(name.strip() for name in given.split(",")))
