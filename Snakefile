"""Scenes -> curves -> data, claims and figures. The rules call commands of weier and define their dependencies."""

import os
import shlex
import sys
from pathlib import Path

from snakemake.settings.types import DeploymentMethod
from snakemake.utils import min_version

min_version("9.0")

VERSION = "0.1.0"  # this workflow and the package of its jobs have this version
CHECKOUT = Path(workflow.current_basedir.get_path_or_uri(secret_free=True))
# The package next to this file takes precedence, here and in jobs; a workflow without it, for example from snakedeploy,
# uses the installed package.
if (CHECKOUT / "weier").is_dir():
    sys.path.insert(0, str(CHECKOUT))
    elsewhere = os.environ.get("PYTHONPATH") or CHECKOUT
    os.environ.update(PYTHONPATH=f"{CHECKOUT}:{elsewhere}")

try:
    from weier import __version__ as installed

    if installed != VERSION:
        raise ModuleNotFoundError(name=f"weier {VERSION}, not {installed},")
    from weier.digests import digest_of_modules
    from weier.figures import caption
    from weier.figures.scene_checks import load_by_name
    from weier.pipeline.products import DATA, PAGE
    from weier.pipeline.workflow import Plan, kernels_file, names_of_scenes
except ModuleNotFoundError as error:
    raise SystemExit(
        f"weier: Snakemake needs {error.name} in its own environment: pip install 'weier[pipeline]=={VERSION}', or "
        f"pip install --require-hashes -r requirements/run.txt of a checkout"
    )

# Configuration files come from the working folder or, if missing there, from the checkout.
configured = lambda path: (
    path if Path(path).exists() else os.path.relpath(CHECKOUT / path)
)


configfile: configured("config/config.yaml")


settings = workflow.resource_settings
jobs_at_once = settings.nodes or settings.cores or 1
scenes = names_of_scenes(config)
plan = Plan(scenes, load_by_name, configured("config/scenes"), jobs_at_once)

# Jobs run modules by the Python of Snakemake, or of their own environment. Since the parameter is a function of the
# output, another Python makes nothing again.
in_conda = DeploymentMethod.CONDA in workflow.deployment_settings.deployment_method
python = "python" if in_conda else shlex.quote(sys.executable)
command = lambda wildcards, output: f"{python} -P -m"

# The folder of the job that makes a product, and its scene. Dates do not count for a fresh product. For a stale one,
# that of an edited scene does: without records, as in a copy, Snakemake keeps a product whose folder is missing.
made_of = lambda product: unpack(
    lambda wildcards: plan.made_of(wildcards, product, ancient)
)


rule all:
    input:
        plan.all_files,
    message:
        f"everything of {', '.join(scenes)}"


# Jobs compile the kernels of methods in parallel, before the jobs that need them. Those of curves take longest.
rule compile:
    output:
        touch(kernels_file("{kernels}")),
    log:
        "results/logs/compile/{kernels}.log",
    priority: lambda wildcards: 2 if wildcards.kernels.endswith(".curves") else 1
    conda:
        "rules/environment.yaml"
    params:
        run=command,
    message:
        "compile {wildcards.kernels}"
    shell:
        "{params.run} weier compile {wildcards.kernels:q} 2>&1 | tee -i {log:q}"


# A job solves its share of the missing curves, and appends them to the store every few seconds. The name of its
# marker is a digest of these curves; the job checks again what is missing. Ctrl-C reaches all programs of a job;
# `tee -i` ignores it and writes the last messages of the others.
rule solve:
    input:
        kernels=ancient(plan.kernels),
    output:
        temp(touch("results/curves/.solved/{what}/{numerics}/{missing}/{share}")),
    log:
        "results/logs/curves/{what}/{numerics}/{missing}/{share}.log",
    conda:
        "rules/environment.yaml"
    resources:
        runtime=plan.minutes,
    params:
        run=command,
        scenes=plan.folder,
        seconds=plan.seconds,
    message:
        "solve {wildcards.what}, {wildcards.share}, in about {params.seconds} s"
    shell:
        "{params.run} weier curves {wildcards.what:q} {wildcards.share} {wildcards.numerics} results/curves"
        " {params.scenes:q} 2>&1 | tee -i {log:q}"


# One job makes all outdated products of a scene, since a process spends two seconds on imports, or the one that is
# named. Its folder keeps them by a digest of what they are made of; the rules below copy them to their places. No rule
# makes a folder that exists.
rule make:
    input:
        plan.solved,
    output:
        directory("results/{scene}/.made_of/{what}.{digest}"),
    log:
        "results/logs/{scene}/make/{what}.{digest}.log",
    wildcard_constraints:
        digest=plan.new_digests,
    conda:
        "rules/environment.yaml"
    params:
        run=command,
        scenes=plan.folder,
    message:
        "{wildcards.scene}: make {wildcards.what}"
    shell:
        "{params.run} weier make {params.scenes:q}/{wildcards.scene}.yaml results/curves {output:q} 2>&1 | tee -i {log:q}"


rule data:
    input:
        made_of(DATA),
    output:
        report("results/{scene}/claims.md", category="{scene}", subcategory="claims"),
        to="results/{scene}/contact.nc",
    log:
        "results/logs/{scene}/data.log",
    localrule: True
    conda:
        "rules/environment.yaml"
    message:
        "{output.to}"
    shell:
        'made={input.folder:q}/$(basename {output.to} .png); test -d "$made" || {{ echo "weier: {output.to} was not made,'
        ' for the reason in results/logs/{wildcards.scene}/make"; exit 1; }};'
        ' {{ ln -f "$made/"*/* $(dirname {output.to}) 2>/dev/null || cp "$made/"*/* $(dirname {output.to}); }} 2>&1 | tee {log:q}'


use rule data as figure with:
    input:
        made_of("{figure}"),
    output:
        multiext("results/{scene}/figures/{figure}", ".pdf", ".svg", ".csv"),
        to=report(
            "results/{scene}/figures/{figure}.png",
            category="{scene}",
            subcategory="figures",
            labels=lambda wildcards: {
                "figure": wildcards.figure,
                "caption": caption(plan.scene(wildcards.scene), wildcards.figure),
            },
        ),
    log:
        "results/logs/{scene}/figures/{figure}.log",
    localrule: True


use rule data as page with:
    input:
        made_of(PAGE),
    output:
        to=report("results/{scene}/page.html", category="{scene}", subcategory="curves"),
    log:
        "results/logs/{scene}/page.log",
    localrule: True


include: "rules/accuracy.smk"
