# Functions for the rules; what they ask is in weier/pipeline/workflow.py.
import shlex
from functools import partial

from snakemake.settings.types import DeploymentMethod
from weier.digests import digest_of_modules
from weier.figures import caption
from weier.figures.scene_checks import load_by_name
from weier.pipeline.products import DATA, PAGE, files_of
from weier.pipeline.workflow import (
    ALL,
    BETWEEN,
    Plan,
    kernels_file,
    names_of_scenes,
)

SCENES = names_of_scenes(config)
settings = workflow.resource_settings
slots = settings.nodes or settings.cores or 1  # jobs that run at once
plan = Plan(SCENES, partial(load_by_name, folder=CONFIG / "scenes"), slots)

# Jobs run modules by the Python of Snakemake, or of their own environment. Since the parameter is a function of the
# output, another Python makes nothing again.
in_conda = DeploymentMethod.CONDA in workflow.deployment_settings.deployment_method
python = "python" if in_conda else shlex.quote(sys.executable)
command = lambda wildcards, output: f"{python} -P -m"


def scene_file(name):
    """The file of a scene."""
    return str(CONFIG / "scenes" / f"{name}.yaml")


def scenes_of(wildcards, output):
    """The files of the scenes that a job solves curves of."""
    names = SCENES if wildcards.what == ALL else wildcards.what.split(BETWEEN)[:1]
    return [scene_file(name) for name in names]


def made_of(product):
    """The folder of the job that makes a product, and its scene, as an input function.

    Dates do not count for a fresh product. For a stale one, the date of an edited scene does: without records, as in a
    copy of the results, Snakemake keeps a product whose folder is missing.
    """

    def folder_and_scene(wildcards):
        folder, fresh = plan.job(wildcards.scene, product.format(**wildcards))
        files = {"folder": folder, "scene": scene_file(wildcards.scene)}
        return {name: ancient(file) for name, file in files.items()} if fresh else files

    return unpack(folder_and_scene)
