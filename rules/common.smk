# Functions for the rules; those of scenes are in weier/pipeline/workflow.py.
import re
import sys
from functools import partial
from types import SimpleNamespace

from snakemake.exceptions import WorkflowError
from snakemake.settings.types import DeploymentMethod, ExecMode

from weier.digests import digest_of_code, digest_of_sources
from weier.figures import kinds
from weier.figures.captions import caption
from weier.figures.checks import load_by_name
from weier.methods.registry import METHODS
from weier.pipeline.products import DATA, PAGE
from weier.pipeline.workflow import (
    Scenes,
    check_packages,
    kernels_file,
    kernels_of,
    names_of_scenes,
    prunes,
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


ENVIRONMENT = workflow.current_basedir.join("environment.yaml")


def environment(wildcards):
    """The packages of a job with `--sdm conda`; else jobs run beside Snakemake, and `--archive` packs no packages."""
    methods = workflow.deployment_settings.deployment_method
    return ENVIRONMENT if DeploymentMethod.CONDA in methods else None


settings = workflow.execution_settings
scenes = Scenes(
    SCENES,
    partial(load_by_name, folder=CONFIG / "scenes"),
    CONFIG,
    cores(),
    runs=runs,
    locks=settings is None or settings.lock,
    prune=prunes(config),
)


def in_report(path):
    """A file of a scene with its place in the report of Snakemake, if it has one; the path may have wildcards."""
    scene, name, kind = re.fullmatch(
        r"results/([^/]+)/(?:figures/)?(.+)\.(\w+)", path
    ).groups()
    in_category = partial(report, path, category=scene)
    if kind == "png":
        labels = lambda wildcards: labels_of_figure(
            scene.format(**wildcards), name.format(**wildcards)
        )
        return in_category(subcategory="figures", labels=labels)
    if kind == "md":
        return in_category(subcategory="claims", caption="rules/captions/claims.rst")
    if kind == "html":
        labels = {"figure": "explorer", "caption": "The curves of the cases"}
        return in_category(subcategory="curves", labels=labels)
    return path


def labels_of_figure(scene, name):
    """The labels of a figure of a scene in the report of Snakemake."""
    return {"figure": name, "caption": caption(scenes.scene(scene), name).text}


def is_named(scene, product):
    """Whether the command line names a file of a product; Snakemake has no targets yet when it reads the rules."""
    words = {word.removeprefix("./") for word in sys.argv[1:]}
    return product != PAGE and bool(words.intersection(scenes.files(scene, [product])))


def of_wildcards(function):
    """A function of a scene and products as an input function of a figure, or of the data."""
    return lambda wildcards: function(
        wildcards.scene, [getattr(wildcards, "figure", DATA)]
    )


def of_scene(function, scene, products):
    """A function of a scene and products as an input function of a rule without wildcards."""
    return lambda wildcards: function(scene, products)


def of_output(function, scene):
    """A function of wildcards and the output as a parameter of a rule without wildcards."""
    return lambda wildcards, output: function(SimpleNamespace(scene=scene), output)


def of_attempts(function, scene):
    """A function of wildcards and the attempt as a resource of a rule without wildcards."""
    return lambda wildcards, attempt: function(SimpleNamespace(scene=scene), attempt)


def labels_of_measurement(wildcards):
    """The labels of a figure of the methods in the report of Snakemake."""
    return {"figure": wildcards.figure, "caption": kinds()[wildcards.figure].caption}


def digest_of_study(study):
    """The digest of the code of a measurement, which takes half a second, and only its own job needs it."""
    return lambda wildcards: digest_of_code((f"weier.accuracy.{study}", ""))


def figures_of_documentation(wildcards):
    """The figures of the paper; the run ends if packages for the documentation are missing."""
    check_packages("sphinx", "myst_parser", "furo")
    return scenes.files("paper", scenes.scene("paper").figures)
