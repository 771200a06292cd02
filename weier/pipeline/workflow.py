"""Functions of scenes for the rules of the Snakefile: files, digests of inputs, and checks before a run.

An invalid scene or folder ends the run with one sentence, without a traceback. A dry run writes nothing.
"""

from __future__ import annotations

import atexit
import math
import os
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache, partial
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import Any

from weier.checks import shown, suggestion
from weier.data.files import bring_to_present, check_target, check_writable, remove_leftovers
from weier.data.netcdf import check_sealed, sealed_name
from weier.kernels.jit import DISABLED, cache_folder
from weier.methods.method import Method
from weier.methods.registry import methods_run_by
from weier.pipeline.batches import Solutions, unused
from weier.pipeline.curves import PART, Store, title_of
from weier.pipeline.forecast import forecast_scene
from weier.pipeline.products import DATA, PAGE, files_of, inputs_of, is_fresh, made_of, marked_files_of, names_of
from weier.scene import Scene

CONFIG_KEYS = "scenes", "prune"  # What `snakemake --config` takes.
# The data, claims and explorer of the paper's scene take as long as so many of its figures: Snakemake writes the
# seconds of both jobs into `results/logs/paper/*.tsv`. Products do not depend on it.
AS_FIGURES = 4
RECORDS = Path(".snakemake")
LOCKS = RECORDS / "locks"
READ_ONLY = (
    "{} cannot be written to: Snakemake refuses a dry run if a file there is to be made again; `snakemake --summary` "
    "lists what is missing or outdated"
)
LOCKED = (
    "results/{} is locked by another run of snakemake: wait for it. If no other one runs, since it was killed or the "
    "power was lost, the lock can be removed with the --unlock argument"
)
PRUNED_BESIDE = "another run of snakemake has locked this folder, and needs its curves: wait for it before prune=1"
# megabytes of a process and of each of its cases, above `max_rss` in `results/logs/curves/*.tsv`; minutes in addition
# to the expected ones, for a busy disk; a job that needs more is run again with twice as much
BATCH_MB, CASE_MB, BATCH_MINUTES = 500, 0.05, 5
# Expected seconds of a batch may be wrong by this factor (`python -m weier.accuracy expected_seconds`).
SECONDS_FACTOR = 3


class Scenes:
    """The scenes of one run of Snakemake; methods that take `wildcards` are functions for its rules.

    Parameters
    ----------
    names : sequence of str
        The scenes that the configuration names.
    load : callable
        From the name of a scene to the scene; a SceneError if there is none, or it has mistakes.
    config : path
        The folder whose folder `scenes` has the files of the scenes.
    cores : int
        The number of cores that Snakemake may use.
    results : path, optional
        The folder for the results.
    runs : callable, optional
        Whether jobs are going to run: a dry run writes nothing.
    locks : bool, optional
        Whether locks of other runs are respected.
    prune : bool, optional
        Whether batches that no scene of the configuration folder uses are removed.
    """

    def __init__(
        self,
        names: Sequence[str],
        load: Callable[[str], Scene],
        config: Path,
        cores: int,
        results: str = "results",
        runs: Callable[[], bool] = lambda: True,
        locks: bool = True,
        prune: bool = False,
    ) -> None:
        self.names, self.config, self.cores, self.results = names, config, cores, Path(results)
        self._load, self._runs, self._locks, self._prune = cache(load), runs, locks, prune
        # Snakemake calls these several times: a scene is read, divided into batches and reported once.
        self._batches, self._report = cache(self._cut_batches), cache(report)
        self.solutions, self._begin, self._inputs = cache(self._solved), cache(self.begin), cache(self._made_of)
        self.store = Store(self.results / "curves")
        with ending_in_one_sentence():  # Snakemake writes records in a dry run, too.
            check_writable(RECORDS if RECORDS.is_dir() else Path())

    def scene(self, name: str) -> Scene:
        """Return the scene of this name; the run ends if it has mistakes."""
        with ending_in_one_sentence():
            return self._load(name)

    def _solved(self, name: str) -> Solutions:
        """Return the curves of a scene."""
        self._begin()
        scene = self.scene(name)
        with ending_in_one_sentence():
            return Solutions(scene, self.store)

    # Snakemake makes again what was made with other parameters, but not with those of functions of the output: the
    # place of a checkout and expected seconds change no curve.
    def scene_file(self, wildcards: Any, output: Any = None) -> str:
        """Return the file of a scene, as jobs read it."""
        return str(self.config / "scenes" / f"{wildcards.scene}.yaml")

    def products(self, wildcards: Any) -> list[str]:
        """Return all products of the scenes of the configuration.

        No job reads the data, so that damaged files and those of other programs are detected here.
        """
        made = []
        for name in self.names:
            self._begin()
            with ending_in_one_sentence():
                if (data := self.results / name / DATA).exists():
                    check_sealed(data)
            made += self.files(name, names_of(self.scene(name)))
        return made

    def makers(self, name: str) -> dict[str, list[str]]:
        """Return the products of a scene by the rule that makes them: the data with the explorer, and the figures.

        The first one also draws the second half of those beyond `AS_FIGURES`, so that both take as long.
        A scene with mistakes has no rules, so that rules without scenes run; `products` reports them.
        """
        with ending_in_one_sentence():
            try:
                figures = list(self._load(name).figures)
            except (ValueError, OSError):
                return {}
        few = len(figures) - max(0, len(figures) - AS_FIGURES) // 2
        makers = {f"data_of_{name}": [DATA, PAGE, *figures[few:]], f"figures_of_{name}": figures[:few]}
        return {maker: made for maker, made in makers.items() if made}

    def files(self, name: str, products: Iterable[str]) -> list[str]:
        """Return the files of products of a scene."""
        return [str(self.results / name / file) for product in products for file in files_of(product)]

    def batches(self, name: str, product: str = DATA) -> list[str]:
        """Return the files that hold the curves of a product of a scene."""
        with ending_in_one_sentence():
            scene = self.scene(name)
            studies = tuple(scene.studies) if product in (DATA, PAGE) else scene.figure(product).all_studies
        return self._batches(name, None if {*studies} == {*scene.studies} else studies)

    def settled_batches(self, name: str, products: Iterable[str]) -> list[str]:
        """Return the batches of those products that are fresh, which stay so if a batch is made again.

        Those that an outdated product needs, too, are not among them: Snakemake has one flag for a file of a job.
        """
        unsettled = {*self.unsettled_batches(name, products)}
        fresh = self._batches_of(name, [product for product in products if self._is_fresh(name, product)])
        return [batch for batch in fresh if batch not in unsettled]

    def unsettled_batches(self, name: str, products: Iterable[str]) -> list[str]:
        """Return the batches of those products that are missing or outdated.

        If all inputs of a product are ancient, Snakemake does not remake it when one of them is remade.
        """
        return self._batches_of(name, [product for product in products if not self._is_fresh(name, product)])

    def _batches_of(self, name: str, products: Iterable[str]) -> list[str]:
        return list(dict.fromkeys(chain.from_iterable(self.batches(name, product) for product in products)))

    def _is_fresh(self, name: str, product: str) -> bool:
        with ending_in_one_sentence():
            return is_fresh(self.results / name, product, self._inputs(name, product))

    def _cut_batches(self, name: str, studies: tuple[str, ...] | None) -> list[str]:
        """Return the batches of these studies of a scene, or of all.

        The expected cost of missing batches is reported here, so that a dry run reports it, too.
        """
        solutions = self.solutions(name)
        with ending_in_one_sentence():
            batches = solutions.batches(studies, self.cores)
            self._check_batches(name, self.store.solved.keys() & batches)
            paths = list(dict.fromkeys(str(self.store.target(batch)) for batch in batches))
            lines, refusal = forecast_scene(solutions.scene, solutions.to_solve, self.cores)
            for line in filter(None, [*lines, refusal]):
                self._report(line)
            if self._runs():
                if refusal:
                    raise ValueError(refusal)
                self.store.write()
        return paths

    def _check_batches(self, name: str, batches: Iterable[str]) -> None:
        """Refuse batches whose content does not match their name, or has changed since the data were gathered.

        A job reads a batch only if a product is to be made, and verifies it then.
        """
        data = self.results / name / DATA
        gathered = data.stat().st_mtime if data.exists() else math.inf
        for batch in sorted(batches):
            path = self.store.folder / f"{batch}.nc"
            if sealed_name(path) != batch or path.stat().st_mtime > gathered:
                check_sealed(path, batch)

    def description(self, wildcards: Any) -> str:
        """Return the description of the last batch of a job, which names the others."""
        return str(self.store.folder / f"{wildcards.batch}.json")

    def batch_label(self, wildcards: Any, output: Any = None) -> str:
        """Return the content of a job, and its expected time."""
        with ending_in_one_sentence():
            job = self.store.job(wildcards.batch)
        return f"{title_of(job)}, in about {max(1, round(sum(batch.seconds for batch in job)))} s"

    def batch_memory(self, wildcards: Any, attempt: int) -> int:
        """Return the megabytes that a job may need, more at each attempt."""
        with ending_in_one_sentence():
            cases = max(len(batch.surfaces) for batch in self.store.job(wildcards.batch))
        return round(attempt * (BATCH_MB + CASE_MB * cases))

    def batch_minutes(self, wildcards: Any, attempt: int) -> int:
        """Return the minutes that a job may need, more at each attempt."""
        with ending_in_one_sentence():
            seconds = sum(batch.seconds for batch in self.store.job(wildcards.batch))
        return round(attempt * (BATCH_MINUTES + SECONDS_FACTOR * seconds / 60))

    def memory(self, wildcards: Any, attempt: int) -> int:
        """Return the megabytes that a product of a scene may need, more at each attempt."""
        return round(attempt * 2 * (BATCH_MB + CASE_MB * len(self.scene(wildcards.scene).distinct) / 10))

    def minutes(self, wildcards: Any, attempt: int) -> int:
        """Return the minutes that a product of a scene may need, more at each attempt."""
        return round(attempt * (10 + len(self.scene(wildcards.scene).distinct) / 10_000))

    def kernels(self, wildcards: Any) -> list[str]:
        """Return the marker files of compiled kernels for the method of a batch."""
        return kernels_of(methods_run_by(wildcards.batch.partition("-")[0]))

    def outdated(self, name: str, products: Iterable[str]) -> list[str]:
        """Return inputs that are older than products of a scene, or newer than those whose digest has changed."""
        return list(chain.from_iterable(self._outdated(name, product) for product in products))

    def _outdated(self, name: str, product: str) -> list[str]:
        paths = [path for path in (self.results / name / file for file in marked_files_of(product)) if path.exists()]
        with ending_in_one_sentence():
            stale = bool({made_of(path) for path in paths} - {self._inputs(name, product)})
        marker = self.results / "logs" / name / "inputs" / product
        if stale:
            self._report(f"{name}: {product} is outdated")
        if self._runs():
            marker.parent.mkdir(parents=True, exist_ok=True)
            if stale:
                marker.write_text(f"{time.time_ns()}")  # Snakemake ignores a new date of the same content.
            else:
                marker.touch()
                os.utime(marker, (0, 0))
        elif not marker.exists() or stale != any(map(partial(_is_newer, marker), paths)):
            # A dry run writes nothing into the folder.
            return [str(_temporary_file(f"{name} {marker.name}"))] if stale else []
        return [str(marker)]

    def _made_of(self, name: str, product: str) -> str:
        """Return the digest of the inputs of a product of a scene."""
        return inputs_of(self.solutions(name), product)

    def begin(self) -> None:
        """Clean up after earlier runs, and refuse a folder that another run has locked; do nothing in a dry run."""
        with ending_in_one_sentence():
            if self._runs():
                self._check_unlocked()
                check_writable(self.results)
                for name in self.names:
                    check_target(self.results / name / DATA)
                remove_leftovers(self.results)
                bring_to_present(self.results, self.config)
            elif self.results.exists() and not os.access(self.results, os.W_OK):
                self._report(READ_ONLY.format(self.results))
            if self._prune:
                self._remove_unused()

    def _check_unlocked(self) -> None:
        files = LOCKS.glob("*.lock") if self._locks and LOCKS.is_dir() else ()
        held = {line for path in files for line in path.read_text(encoding="utf-8").splitlines()}
        for name in self.names:
            if any(line.startswith(f"{self.results / name}/") for line in held):
                raise ValueError(LOCKED.format(name))
        if self._prune and held:
            raise ValueError(PRUNED_BESIDE)

    def _remove_unused(self) -> None:
        """Remove batches that no scene in the folder of scenes uses, and descriptions of which no curve is solved."""
        names = sorted(path.stem for path in (self.config / "scenes").glob("*.yaml"))
        found = unused(self.store, [Solutions(self.scene(name), Store(self.store.folder)) for name in names])
        size = sum(found.values()) / 1e6
        does = "removed" if self._runs() else "would be removed"
        report(f"{len(found)} of {len(self.store.solved)} batches are of no scene: {does}, which frees {size:.1f} MB")
        if self._runs():
            solved = self.store.solved
            for path in self.store.folder.glob("*.json"):
                is_begun = path.stem in solved or path.with_suffix(PART).exists()
                if path.stem in found or not is_begun:
                    path.with_suffix(".nc").unlink(missing_ok=True)
                    path.unlink()
            self.store = Store(self.store.folder)


def _is_newer(path: Path, other: Path) -> bool:
    return path.stat().st_mtime > other.stat().st_mtime


@cache
def _temporary_file(name: str) -> Path:
    """Return a file of this date, which is removed at the end of the process."""
    folder = Path(tempfile.mkdtemp(prefix="weier-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    (folder / name).touch()
    return folder / name


def kernels_of(methods: Iterable[Method]) -> list[str]:
    """Return the marker files of the compiled kernels of these methods.

    Closed forms compile in seconds and need no job of their own. The list is empty if kernels are not compiled or the
    cache is not writable; each job then compiles its own kernels.
    """
    try:
        check_target(cache_folder() / "compiled" / "any")
    except OSError:
        return []
    return [] if DISABLED else [kernels_file(method.name) for method in methods if method.numerical]


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
    """Return the names of the scenes of the configuration, of which a folder has the files.

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
            return [name.strip() for name in given.split(",")]
        known = sorted(path.stem for path in folder.glob("*.yaml"))
        meant = [name for name in known if repr(_as_snakemake(name)) == repr(given)]
        if len(meant) == 1:
            return meant
        hint = f": quote one of {', '.join(meant)}, as in --config \"scenes='{meant[0]}'\"" if meant else ""
        raise ValueError(f"scenes must name some of {', '.join(known)} in {folder}, got {shown(given)}{hint}")


def prunes(config: Mapping[str, Any]) -> bool:
    """Return whether the configuration asks to remove unused curves; the run ends if that is not clear."""
    with ending_in_one_sentence():
        if (given := config.get("prune", 0)) not in (0, 1):
            raise ValueError(f"prune must be 0 or 1, got {shown(given)}")
    return bool(given)


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


def report(line: str) -> None:
    """Print a line to standard error, since standard output belongs to Snakemake."""
    print(line, file=sys.stderr, flush=True)
