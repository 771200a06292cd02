"""What the Snakefile asks: which curves and products are missing, and how their curves are shared among jobs.

Planning writes nothing. An invalid scene or folder ends the run with one sentence, without a traceback.
"""

from __future__ import annotations

import os
import re
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache, cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from weier.checks import shown, suggestion
from weier.data.files import check_target, check_writable
from weier.digests import DIGITS, digest, numerics
from weier.kernels.jit import cache_folder
from weier.methods.registry import methods_run_by
from weier.pipeline import products
from weier.pipeline.curves import CLOSED, SURFACE, Curves, Lacking, by_group, number_of_jobs
from weier.pipeline.forecast import forecast_scene
from weier.pipeline.store import Store
from weier.scene import Scene
from weier.scene.identity import digest_of_keys

CONFIG_KEYS = ("scenes",)  # what `snakemake --config` takes
ALL = "all"  # the curves of all products of the scenes of the configuration
BETWEEN = "~"  # between the name of a scene and of a product; neither has it
# Megabytes of a process, and of each curve of its job or case of its product, above `max_rss` in
# `results/logs/*/*.tsv`; minutes in addition to the expected ones, for a busy disk. A job that needs more is run
# again with twice as much.
BASE_MB, CURVE_MB, CASE_MB, BASE_MINUTES = 500, 0.05, 0.01, 5
SECONDS_FACTOR = 5  # Expected seconds may be wrong by this factor.


class Plan:
    """The plan of one run of Snakemake; methods that take `wildcards` are functions for its rules.

    Parameters
    ----------
    names : sequence of str
        The scenes that the configuration names.
    load : callable
        From the name of a scene to the scene; a SceneError if there is none, or it has mistakes.
    slots : int
        The number of jobs that can run at once.
    runs : callable, optional
        Whether jobs are going to run, so that folders must be open to writing.
    results : path, optional
        The folder for the results.
    """

    def __init__(
        self,
        names: Sequence[str],
        load: Callable[[str], Scene],
        slots: int,
        runs: Callable[[], bool] = lambda: True,
        results: str = "results",
    ) -> None:
        self.names, self.slots, self.results = names, slots, Path(results)
        self._load, self._runs, self._wants_all = cache(load), runs, False
        # Snakemake calls these several times.
        self.curves, self.lacking, self.stamp = cache(self._curves), cache(self._lacking), cache(self._stamp)

    @cached_property
    def numerics(self) -> str:
        """The name of the numerics of the code that plans."""
        return numerics().name

    @cached_property
    def store(self) -> Store:
        """The solved curves."""
        return Store(self.results / "curves", self.numerics)

    def scene(self, name: str) -> Scene:
        """Return the scene of this name; the run ends if it has mistakes."""
        with ending_in_one_sentence():
            return self._load(name)

    def _curves(self, name: str) -> Curves:
        return Curves(self.scene(name), self.store)

    # --- products ---

    def all_files(self, wildcards: Any) -> list[str]:
        """Return all products of the scenes of the configuration, with their stamps."""
        self._wants_all = True
        files = []
        with ending_in_one_sentence():
            for name in self.names:
                if self._runs():
                    check_writable(self.results)
                    check_target(self.results / name / "any")
                for product in products.names_of(self.scene(name)):
                    files += [str(self.results / name / file) for file in products.files_of(product)]
                    files.append(str(self.stamp(name, product)[0]))
            self._forecast()
        return files

    def _stamp(self, name: str, product: str) -> tuple[Path, bool]:
        with ending_in_one_sentence():
            curves = self.curves(name)
            return products.stamp_of(self.results / name, product, products.made_of(curves, product))

    def made_of(self, name: str, product: str) -> tuple[str, bool]:
        """Return the stamp of a product, and whether it is fresh, so that dates do not count."""
        path, fresh = self.stamp(name, product)
        return str(path), fresh

    @property
    def new_digests(self) -> str:
        """A pattern of stamps that do not exist: no rule makes those that do."""
        known = {path.name for path in self.results.glob(f"*/{products.STAMPS}/*/*")}
        return rf"(?!({'|'.join(map(re.escape, sorted(known)))})$)[0-9a-f.]+" if known else "[0-9a-f.]+"

    def memory(self, wildcards: Any, attempt: int) -> int:
        """Return the megabytes that the job of a product may need, more at each attempt."""
        return round(attempt * (BASE_MB + CASE_MB * len(self.scene(wildcards.scene).distinct)))

    def minutes(self, wildcards: Any, attempt: int) -> int:
        """Return the minutes that the job of a product may need, more at each attempt."""
        return round(attempt * (2 * BASE_MINUTES + len(self.scene(wildcards.scene).distinct) / 10_000))

    # --- curves ---

    def solved(self, wildcards: Any) -> list[str]:
        """Return the jobs that solve what the store lacks of the curves of a product."""
        name, product = wildcards.scene, wildcards.product
        with ending_in_one_sentence():
            own = f"{name}{BETWEEN}{product}"
            found = []
            for group, mine in by_group(self.lacking(own)).items():
                what = ALL if self._wants_all and name in self.names else own
                everything = by_group(self.lacking(what))[group]
                count = self._count(everything)
                keys = digest([[each.part.kind.name, digest_of_keys(each.keys)] for each in everything])[:DIGITS]
                folder = self.results / "curves" / ".solved" / what / self.numerics / keys
                spread = np.concatenate([each.spread for each in mine])
                needed = np.unique(spread % np.uint64(count)).tolist()
                found += [str(folder / f"{group}.{number}-of-{count}") for number in needed]
            return found

    def _lacking(self, what: str) -> list[Lacking]:
        """Return what the store lacks of the curves of all scenes, or of one product."""
        return self.store.lacking(wanted(what, self.names, self.curves))

    def _count(self, lacking: Sequence[Lacking]) -> int:
        seconds = sum(each.seconds for each in lacking)
        return number_of_jobs(seconds, sum(len(each.numbers) for each in lacking), self.slots)

    def _of_job(self, wildcards: Any) -> list[Lacking]:
        everything = by_group(self.lacking(wildcards.what)).get(wildcards.group, [])
        return [each.of_job(int(wildcards.number), int(wildcards.jobs)) for each in everything]

    def job_memory(self, wildcards: Any, attempt: int) -> int:
        """Return the megabytes that a job of curves may need, more at each attempt."""
        return round(attempt * (BASE_MB + CURVE_MB * sum(len(each.numbers) for each in self._of_job(wildcards))))

    def job_minutes(self, wildcards: Any, attempt: int) -> int:
        """Return the minutes that a job of curves may need, more at each attempt."""
        seconds = sum(each.seconds for each in self._of_job(wildcards))
        return round(attempt * (BASE_MINUTES + SECONDS_FACTOR * seconds / 60))

    def kernels(self, wildcards: Any) -> list[str]:
        """Return the marker files of the compiled kernels that a group of curves needs.

        Closed forms compile in seconds and need no job of their own. The list is empty if kernels are not compiled or
        the cache is not writable; each job then compiles its own kernels.
        """
        if wildcards.group == CLOSED or os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
            return []
        try:
            check_target(cache_folder() / "compiled" / "any")
        except OSError:
            return []
        methods = methods_run_by(wildcards.group)
        return [kernels_file(method.name) for method in methods if method.numerical]

    def _forecast(self) -> None:
        """Print the expected time of what is missing; ValueError if a scene would take longer than it allows."""
        for name in self.names:
            own = self.store.lacking(self.curves(name).of_studies(None))
            seconds = sum(each.seconds for each in own)
            count = sum(len(each.numbers) for each in own if each.part.kind.method != SURFACE)
            for line in forecast_scene(self.scene(name), seconds / self.slots, count, self.slots):
                print(line, file=sys.stderr, flush=True)


def wanted(what: str, names: Sequence[str], curves: Callable[[str], Curves]) -> list[Any]:
    """Return the curves that ALL scenes of these names need, or a product, named by SCENE~PRODUCT."""
    if what == ALL:
        return [part for name in names for part in curves(name).of_studies(None)]
    name, _, product = what.partition(BETWEEN)
    return curves(name).of_studies(products.studies_of(curves(name).scene, product))


def kernels_file(method: str) -> str:
    """Return the marker file of a compiled method: in the cache, so that runs in all folders share it.

    Without a home directory there is no cache, and the file is not used.
    """
    try:
        cache = cache_folder()
    except OSError:
        cache = Path("results")
    return str(cache / "compiled" / method)


def check_packages(*names: str) -> None:
    """End the run before its first job if these packages of developers are missing."""
    if missing := [name for name in names if not find_spec(name)]:
        command = "pip install --require-hashes -r requirements/dev.txt"
        raise SystemExit(f"weier: the documentation needs {', '.join(missing)}: {command}")


def names_of_scenes(config: Mapping[str, Any], folder: Path) -> list[str]:
    """Return the names of the scenes of the configuration, each once, of which a folder has the files.

    Snakemake converts 2024, 0815 and 1e5 on its command line to numbers, and true and false to flags; the name is the
    one in the folder that converts to this value.
    """
    with ending_in_one_sentence():
        for key in config:
            if key not in CONFIG_KEYS:
                what = f"there is no key {key!r} of --config, only {', '.join(CONFIG_KEYS)}"
                raise ValueError(f"{what}{suggestion(key, CONFIG_KEYS)}")
        given = config.get("scenes")
        if isinstance(given, str) and given.strip():
            return list(dict.fromkeys(name.strip() for name in given.split(",")))
        known = sorted(path.stem for path in folder.glob("*.yaml"))
        meant = [name for name in known if repr(_as_snakemake(name)) == repr(given)]
        if len(meant) == 1:
            return meant
        hint = f": quote one of {', '.join(meant)}, as in --config \"scenes='{meant[0]}'\"" if meant else ""
        raise ValueError(f"scenes must name some of {', '.join(known)} in {folder}, got {shown(given)}{hint}")


def _as_snakemake(word: str) -> Any:
    """Return the value to which Snakemake converts a word on its command line."""
    for read in (int, float):
        with suppress(ValueError):
            return read(word)
    return {"True": True, "False": False}.get(word, word)


@contextmanager
def ending_in_one_sentence() -> Iterator[None]:
    """End the run with a message if a scene or a folder is invalid, and at once by Ctrl-C.

    The event loop of Snakemake would handle Ctrl-C only after its planning, which may take minutes.
    """
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.SIG_IGN:  # as in the background of a script
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    except KeyboardInterrupt:
        raise SystemExit("weier: stopped by Ctrl-C") from None
    except (ValueError, OSError) as error:
        raise SystemExit(f"weier: {error}") from None
    finally:
        signal.signal(signal.SIGINT, before)
