# Scenes by name, and what is made of them.
import signal
import sys
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from weier.data.files import check_target
from weier.data.netcdf import check_whole
from weier.figures import checks, kinds
from weier.figures.captions import caption
from weier.digests import KERNELS, PACKAGE
from weier.kernels.jit import DISABLED, LISTENERS, cache_folder
from weier.methods.registry import METHODS, find_method
from weier.pipeline.batches import NUMBERS, Solutions, read_batch
from weier.pipeline.forecast import forecast_scene
from weier.scene import SceneError

SUFFIXES = ("pdf", "svg", "png")
# What steps depend on, of the package: whether they run again is told by a digest of all texts in these folders.
TABLES = (*NUMBERS, "pipeline")
PICTURES = (*TABLES, "figures")
MEASURED = (*TABLES, "accuracy")


@cache
def tell(line):
    """Say something once a run."""
    print(line, file=sys.stderr, flush=True)


# Plans count contacts, before any job.
LISTENERS[:] = [
    lambda module: tell("compiling what plans need, once for all later runs")
]


@contextmanager
def stoppable():
    """Let Ctrl-C end what takes long: Snakemake's event loop would note it, and go on until all is planned."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def in_one_sentence():
    """End the run with what is wrong with a scene or a folder; Snakemake would add a traceback."""
    try:
        yield
    except (SceneError, OSError) as error:
        sys.exit(f"weier: {error}")


@cache
def scene(name):
    with in_one_sentence():
        return checks.load_by_name(name, CONFIG / "scenes")


def scene_file(name):
    """The file of a scene, as jobs read it."""
    return str(CONFIG / "scenes" / f"{name}.yaml")


def in_checkout(*paths):
    """Paths of the checkout as they are called from the folder where Snakemake runs."""
    return [os.path.relpath(CHECKOUT / path) for path in paths]


def scene_names():
    """The scenes that the configuration names, separated by commas."""
    return [name.strip() for name in str(config["scenes"]).split(",")]


@cache
def solutions(name):
    """What is solved of a scene, as the run begins."""
    return Solutions(scene(name), f"results/{name}/batches")


@cache
def batches(name, studies=()):
    """The files that hold the cases of some studies of a scene, or all: what is missing is cut for the cores there are.

    What it will take is said now, so that a dry run says it, too.
    """
    with stoppable(), in_one_sentence():
        paths = [str(path) for path in solutions(name).files(studies, cores())]
    lines, refusal = forecast(name)
    for line in [*lines, refusal] if refusal and workflow.dryrun else lines:
        tell(line)
    return paths


def cores():
    """As many as Snakemake may use; those of its commands that run nothing need not be told."""
    return workflow.resource_settings.cores or 1


def forecast(name):
    """What the batches take that are to be solved of a scene."""
    return forecast_scene(scene(name), solutions(name).to_solve.values(), cores())


@cache
def batch(name, stem):
    """The description of a batch of a scene."""
    return read_batch(f"results/{name}/batches/{stem}.json")


def kernels(*names):
    """What says that the kernels of scenes are compiled, or without a scene all: that is no reason to solve again.

    Those of closed forms take seconds, and no job of their own. There are none where nothing is compiled, or where the
    cache takes no files: then each job compiles what it needs.
    """
    used = [find_method(each) for name in names for each in scene(name).layout.methods]
    if not names or any(method.runs_others for method in used):
        used = METHODS
    try:
        check_target(cache_folder() / "compiled" / "any")
    except OSError:
        return []
    numerical = [method.name for method in used if method.numerical]
    return [] if DISABLED else ancient(list(map(compiled, numerical)))


def compiled(method):
    """The file that says that a method is compiled: in the cache, so that it serves runs in all folders.

    Since numba compiles again what is called from a file of another date, the newest one is in its name. Without a
    home directory there is no cache, and nothing asks for this file.
    """
    try:
        cache = cache_folder()
    except OSError:
        cache = Path("results")
    return str(cache / "compiled" / f"{method}-{newest_source()}")


@cache
def newest_source():
    """The date of the newest source of kernels, in nanoseconds."""
    return max(
        path.stat().st_mtime_ns
        for part in KERNELS
        for path in (PACKAGE / part).rglob("*.py")
    )


def documentation_tools(wildcards):
    """No files; the run ends before its first job where the documentation could not be built after its last one."""
    if missing := [
        name for name in ("sphinx", "myst_parser", "furo") if not find_spec(name)
    ]:
        sys.exit(
            f"weier: the documentation needs {', '.join(missing)}: "
            "pip install --require-hashes -r requirements/dev.txt"
        )
    return []


def drawn_together():
    """The scenes whose figures one job draws: those of the configuration, and the one that the documentation shows."""
    shown = ["paper"] if Path(scene_file("paper")).exists() else []
    return list(dict.fromkeys([*scene_names(), *shown]))


def drawn(name):
    """The files of all figures of a scene; those of Snakemake's report come with their captions."""
    return [
        (
            picture(name, figure)
            if suffix == "png"
            else f"results/{name}/figures/{figure}.{suffix}"
        )
        for figure in scene(name).figures
        for suffix in SUFFIXES
    ]


def picture(name, figure):
    return report(
        f"results/{name}/figures/{figure}.png",
        category=name,
        subcategory="figures",
        labels={"figure": figure, "caption": caption(scene(name), figure).text},
    )


def products(name):
    """All that is made of a scene: its figures by the rule that draws them together."""
    results = [whole(f"results/{name}/contact.nc"), f"results/{name}/claims.md"]
    return results + list(getattr(rules, f"figures_{name}").output)


def whole(path):
    """Stop at a file that is cut short or of another program: where no job reads it, none would notice."""
    if Path(path).exists():
        check_whole(path)
    return path
