# What rules ask; functions of the scenes stand in weier/pipeline/workflow.py.
from functools import partial

from snakemake.exceptions import WorkflowError

from weier.figures import kinds
from weier.figures.captions import caption
from weier.figures.checks import load_by_name
from weier.methods.registry import METHODS
from weier.pipeline.workflow import (
    MEASURED,
    PICTURES,
    Scenes,
    check_packages,
    kernels_file,
    kernels_of,
)

SCENES = [name.strip() for name in config["scenes"].split(",")]


def cores():
    """As many as Snakemake may use; those of its commands that run nothing need not be told."""
    try:
        return workflow.cores
    except WorkflowError:
        return 1


scenes = Scenes(
    SCENES, partial(load_by_name, folder=CONFIG / "scenes"), CONFIG, cores()
)


def labels_of_figure(wildcards):
    """What Snakemake's report says of a figure of a scene."""
    scene, name = scenes.scene(wildcards.scene), wildcards.figure
    return {"figure": name, "caption": caption(scene, name).text}


def labels_of_measurement(wildcards):
    """What Snakemake's report says of a figure of the methods."""
    return {"figure": wildcards.figure, "caption": kinds()[wildcards.figure].caption}


def figures_of_documentation(wildcards):
    """The figures of the paper, if the packages are there that put them into the documentation."""
    check_packages("sphinx", "myst_parser", "furo")
    return scenes.figures_of("paper")
