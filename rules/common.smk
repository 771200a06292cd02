# Functions for the rules; those of scenes are in weier/pipeline/workflow.py.
import re
import sys
from functools import partial
from types import SimpleNamespace

from snakemake.exceptions import WorkflowError
from snakemake.settings.types import ExecMode

from weier.digests import digest_of_code, digest_of_sources
from weier.figures import kinds
from weier.figures.captions import caption
from weier.figures.checks import load_by_name
from weier.methods.registry import METHODS
from weier.pipeline.workflow import (
    Scenes,
    check_packages,
    kernels_file,
    kernels_of,
    names_of_scenes,
)

SCENES = names_of_scenes(config, CONFIG / "scenes")


def cores():
    """The number of cores that Snakemake may use; 1 for its commands that run nothing."""
    try:
        return workflow.cores
    except WorkflowError:
        return 1


def runs():
    """Whether this process is going to run jobs; a dry run, a summary or a cluster job begins and writes nothing."""
    return (
        workflow.executor_plugin is not None
        and workflow.exec_mode == ExecMode.DEFAULT
        and not workflow.dryrun
        and not workflow.touch
    )


settings = workflow.execution_settings
scenes = Scenes(
    SCENES,
    partial(load_by_name, folder=CONFIG / "scenes"),
    CONFIG,
    cores(),
    runs=runs,
    locks=settings is None or settings.lock,
    prune=bool(config.get("prune")),
)


def labels_of_figure(wildcards):
    """The labels of a figure of a scene in the report of Snakemake."""
    scene, name = scenes.scene(wildcards.scene), wildcards.figure
    return {"figure": name, "caption": caption(scene, name).text}


def in_report(scene, figure):
    """A picture of a scene, with its place in the report of Snakemake."""
    labels = lambda wildcards: labels_of_figure(
        SimpleNamespace(scene=scene, figure=figure)
    )
    return report(
        f"results/{scene}/figures/{figure}.png",
        category=scene,
        subcategory="figures",
        labels=labels,
    )


def figures_are_named():
    """Whether the command line asks for files of figures; Snakemake has no targets yet when it reads the rules."""
    return any(re.match(r"(\./)?results/[^/]+/figures/", word) for word in sys.argv[1:])


def labels_of_measurement(wildcards):
    """The labels of a figure of the methods in the report of Snakemake."""
    return {"figure": wildcards.figure, "caption": kinds()[wildcards.figure].caption}


def figures_of_documentation(wildcards):
    """The figures of the paper; the run ends if packages for the documentation are missing."""
    check_packages("sphinx", "myst_parser", "furo")
    return scenes.figures_of("paper")
