# Functions for the rules; what they ask is in weier/pipeline/workflow.py.
import shlex
from functools import partial

from snakemake.exceptions import WorkflowError
from snakemake.settings.types import DeploymentMethod

from weier.figures import caption
from weier.figures.scene_checks import load_by_name
from weier.digests import digest_of_modules
from weier.pipeline.products import DATA, FILES, PAGE, files_of
from weier.pipeline.workflow import (
    ALL,
    BETWEEN,
    Plan,
    kernels_file,
    names_of_scenes,
)

SCENES = names_of_scenes(config)
# Jobs run the Python of Snakemake, or of their own environment, and no module of the folder that they run in.
in_conda = DeploymentMethod.CONDA in workflow.deployment_settings.deployment_method
RUN = f"{'python' if in_conda else shlex.quote(sys.executable)} -P -m weier"


def command(wildcards, output):
    """The command of jobs: Snakemake makes nothing again where a parameter that is a function of the output differs."""
    return RUN


def memory(wildcards, attempt):
    """The megabytes that a job may need; a million cases by two methods at 8 loads took 1100."""
    return 2000 * attempt


def slots():
    """The number of jobs that run at once; 1 for commands of Snakemake that run nothing."""
    try:
        return workflow.resource_settings.nodes or workflow.cores
    except WorkflowError:
        return 1


def runs():
    """Whether this process is going to run jobs; a dry run, a summary or a report writes nothing."""
    return workflow.executor_plugin is not None and not workflow.dryrun


plan = Plan(SCENES, partial(load_by_name, folder=CONFIG / "scenes"), slots(), runs)


def scene_file(name):
    """The file of a scene."""
    return str(CONFIG / "scenes" / f"{name}.yaml")


def scenes_of(wildcards, output):
    """The files of the scenes that a job solves curves of."""
    names = SCENES if wildcards.what == ALL else wildcards.what.split(BETWEEN)[:1]
    return [scene_file(name) for name in names]


def job_of(product):
    """The folder of the job that makes a product, and its scene, as an input function.

    Dates do not count for a fresh product. For a stale one, the date of an edited scene does: without records, as in a
    copy of the results, Snakemake keeps a product whose folder is missing.
    """

    def made_of(wildcards):
        path, fresh = plan.job(wildcards.scene, product.format(**wildcards))
        files = [path, scene_file(wildcards.scene)]
        return list(map(ancient, files)) if fresh else files

    return made_of


def files_made(wildcards, input, output):
    """The folder with the files of a product, as its job has left them."""
    product = wildcards.get("figure", Path(output[0]).name)
    return f"{input.made_of[0]}/{product}/{FILES}"


def labels_of_figure(wildcards):
    """The labels of a figure of a scene in the report of Snakemake."""
    text = caption(plan.scene(wildcards.scene), wildcards.figure).text
    return {"figure": wildcards.figure, "caption": text}
