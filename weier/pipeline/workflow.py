"""Functions of scenes for the rules of the Snakefile: files, digests of their dependencies, and checks before a run.

Snakemake adds a traceback to an error. An invalid scene or folder ends the run with one sentence instead.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from weier.data.files import bring_to_present, check_target, check_writable, remove_leftovers
from weier.data.netcdf import check_whole
from weier.digests import digest, digest_of_sources
from weier.kernels.jit import DISABLED, cache_folder
from weier.methods import auto
from weier.methods.method import Method
from weier.methods.registry import METHODS, find_method
from weier.pipeline.batches import NUMBERS, Solutions, read_batch
from weier.pipeline.forecast import forecast_scene
from weier.scene import Scene

# The parts of the package on which steps depend: they run again after a change of a text file in these folders.
TABLES = (*NUMBERS, "pipeline")
PICTURES = (*TABLES, "figures")
MEASURED = (*TABLES, "accuracy")
FORMATS = ("pdf", "svg", "png")  # Each figure is written in these formats.


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
    """

    def __init__(
        self, names: Sequence[str], load: Callable[[str], Scene], config: Path, cores: int, results: str = "results"
    ) -> None:
        self.names, self.config, self.cores, self.results = names, config, cores, Path(results)
        self._load, self._solutions = load, dict[str, Solutions]()
        # Snakemake calls these several times: a scene is read, divided into batches and reported once.
        self.scene, self._batches, self._report = cache(self._checked_scene), cache(self._cut_batches), cache(report)

    def _checked_scene(self, name: str) -> Scene:
        """The scene of this name."""
        with ending_in_one_sentence():
            return self._load(name)

    def scene_file(self, wildcards: Any) -> str:
        """The file of a scene, as jobs read it."""
        return str(self.config / "scenes" / f"{wildcards.scene}.yaml")

    def products(self, wildcards: Any) -> list[str]:
        """All products of the scenes of the configuration: data, claims and figures.

        No job reads the data, so that truncated files and those of other programs are detected here.
        """
        made = []
        for name in self.names:
            data, claims = self.results / name / "contact.nc", self.results / name / "claims.md"
            with ending_in_one_sentence():
                if data.exists():
                    check_whole(data)
            made += [str(data), str(claims), *self.figures_of(name)]
        return made

    def figures(self, wildcards: Any) -> list[str]:
        """The files of all figures of a scene."""
        return self.figures_of(wildcards.scene)

    def figures_of(self, name: str) -> list[str]:
        """The files of all figures of the scene of this name."""
        folder = self.results / name / "figures"
        return [str(folder / f"{figure}.{suffix}") for figure in self.scene(name).figures for suffix in FORMATS]

    def batches(self, wildcards: Any) -> list[str]:
        """The files that hold all curves of a scene."""
        return self._batches(wildcards.scene)

    def batches_of_figure(self, wildcards: Any) -> list[str]:
        """The files that hold the curves of a figure."""
        with ending_in_one_sentence():
            figure = self.scene(wildcards.scene).figure(wildcards.figure)
        return self._batches(wildcards.scene, figure.studies)

    def _cut_batches(self, name: str, studies: tuple[str, ...] | None = None) -> list[str]:
        """The batches of these studies of a scene, or of all.

        The expected cost of missing batches is reported here, so that a dry run reports it, too.
        """
        scene = self.scene(name)
        with ending_in_one_sentence():
            solutions = self._solutions.setdefault(name, Solutions(scene, self.results / name / "batches"))
            paths = [str(path) for path in solutions.files(studies, self.cores)]
            lines, refusal = self._forecast(solutions)
        for line in filter(None, [*lines, refusal]):
            self._report(line)
        return paths

    def _forecast(self, solutions: Solutions) -> tuple[list[str], str]:
        return forecast_scene(solutions.scene, solutions.to_solve.values(), self.cores)

    def batch_label(self, wildcards: Any) -> str:
        """The content of a batch, and its expected time."""
        with ending_in_one_sentence():
            return batch_label(self.results / wildcards.scene / "batches" / f"{wildcards.batch}.json")

    def kernels(self, wildcards: Any) -> list[str]:
        """The files that mark the kernels of a scene as compiled."""
        used = [find_method(name) for name in self.scene(wildcards.scene).layout.methods]
        return kernels_of(METHODS if auto.METHOD in used else used)

    def figure_digest(self, wildcards: Any) -> str:
        """A digest of everything a figure depends on."""
        scene = self.scene(wildcards.scene)
        figure = scene.figure(wildcards.figure)
        entry = [repr(figure), scene.digest_of_cases(*figure.studies)]
        return self._made_of(PICTURES, wildcards.scene, entry, figure.studies)

    def claims_digest(self, wildcards: Any) -> str:
        """A digest of everything the data and claims of a scene depend on."""
        return self._made_of(TABLES, wildcards.scene, self.scene(wildcards.scene).text)

    def page_digest(self, wildcards: Any) -> str:
        """A digest of everything the page of a scene depends on."""
        scene = self.scene(wildcards.scene)
        return self._made_of(PICTURES, wildcards.scene, [scene.text, repr(scene.figures)])

    def _made_of(self, code: Sequence[str], name: str, entry: Any, studies: tuple[str, ...] | None = None) -> str:
        """A digest of a product: the names of all batches that it reads, its own entry in the scene, and the code.

        The name of a batch is a digest of its curves, so that their surfaces, loads and settings count, too. A batch
        that was solved long ago is older than the product, hence the names and not the dates.
        """
        batches = sorted(Path(path).stem for path in self._batches(name, studies))
        return digest([entry, batches, digest_of_sources(*code)])

    def begin(self) -> None:
        """Clean up after earlier runs, and stop if a scene would take longer than it allows."""
        with ending_in_one_sentence():
            check_writable(self.results)
            remove_leftovers(self.results)
            bring_to_present(self.results, self.config)
            for solutions in self._solutions.values():
                _, refusal = self._forecast(solutions)
                if refusal:
                    raise ValueError(refusal)

    def finish(self) -> None:
        """Remove obsolete batches, and report where the curves are."""
        for name, solutions in self._solutions.items():
            solutions.tidy()
            data, page = self.results / name / "contact.nc", self.results / name / "page.html"
            how = f"`snakemake --cores 2 pages --config scenes={name}` makes a page of them"
            if data.exists():
                report(f"{name}: the curves are in {data}, {f'{page} shows them' if page.exists() else how}")


def kernels_of(methods: Iterable[Method]) -> list[str]:
    """The files that mark the kernels of these methods as compiled.

    Closed forms compile in seconds and need no job of their own. The list is empty if kernels are not compiled or the
    cache is not writable; each job then compiles its own kernels.
    """
    try:
        check_target(cache_folder() / "compiled" / "any")
    except OSError:
        return []
    return [] if DISABLED else [kernels_file(method.name) for method in methods if method.numerical]


def kernels_file(method: str) -> str:
    """The file that marks a method as compiled: in the cache, so that it serves runs in all folders.

    Without a home directory there is no cache, and the file is not used.
    """
    try:
        cache = cache_folder()
    except OSError:
        cache = Path("results")
    return str(cache / "compiled" / method)


@cache
def batch_label(description: Path) -> str:
    """The content of a batch, and its expected time."""
    batch = read_batch(description)
    return f"{batch.title}, in about {max(1, round(batch.seconds))} s"


def check_packages(*names: str) -> None:
    """End the run before its first job if these packages of developers are missing."""
    if missing := [name for name in names if not find_spec(name)]:
        command = "pip install --require-hashes -r requirements/dev.txt"
        raise SystemExit(f"weier: the documentation needs {', '.join(missing)}: {command}")


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
