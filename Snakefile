"""Scenes -> curves -> data, claims and figures. The rules call commands of weier and define their dependencies."""

import os
import sys
from pathlib import Path

from snakemake.utils import min_version

min_version("9.0")

VERSION = "0.1.0"  # this workflow and the package of its jobs have this version
CHECKOUT = Path(workflow.current_basedir.get_path_or_uri(secret_free=True))
# The package next to this file takes precedence, here and in jobs; a workflow without it, for example from snakedeploy,
# uses the installed package.
if (CHECKOUT / "weier").is_dir():
    sys.path.insert(0, str(CHECKOUT))
    elsewhere = filter(None, [os.environ.get("PYTHONPATH")])
    os.environ.update(PYTHONPATH=os.pathsep.join([str(CHECKOUT), *elsewhere]))

try:
    import weier.pipeline.workflow

    if weier.__version__ != VERSION:
        raise ModuleNotFoundError(name=f"weier {VERSION}, not {weier.__version__},")
except ModuleNotFoundError as error:
    raise SystemExit(
        f"weier: Snakemake needs {error.name} in its own environment: pip install 'weier[pipeline]=={VERSION}', or "
        f"pip install --require-hashes -r requirements/run.txt of a checkout"
    )

# Use the scenes of the working folder if it has any, otherwise the scenes of the checkout.
CHECKOUT = Path(os.path.relpath(CHECKOUT))
CONFIG = Path("config") if Path("config/scenes").is_dir() else CHECKOUT / "config"

# Configuration files come from the working folder or, if missing there, from the checkout.
configured = lambda path: str(
    (CONFIG if (CONFIG / path).exists() else CHECKOUT / "config") / path
)


configfile: configured("config.yaml")


include: "rules/common.smk"
include: "rules/accuracy.smk"


wildcard_constraints:
    scene=r"[A-Za-z0-9_-]+",
    share=r"\d+-of-\d+",
    stamps=plan.new_digests,


# Named here, since rules do not inherit it.
localrules:
    all,
    data,
    figure,
    page,


onstart:
    plan.check_folders()


rule all:
    default_target: True
    input:
        plan.all_files,
    message:
        f"everything of {', '.join(SCENES)}"


# One job per method compiles its kernels, in parallel and before the jobs that need them.
rule compile:
    output:
        touch(kernels_file("{method}.curves")),
    log:
        "results/logs/compile/{method}.curves.log",
    priority: 3  # compile first: it takes longest, and jobs without kernels run in parallel
    conda:
        "rules/environment.yaml"
    params:
        run=command,
        kernels=lambda wildcards, output: Path(output[0]).name,
    message:
        "compile {params.kernels}"
    shell:
        "{params.run} weier compile {params.kernels:q} 2>&1 | tee -i {log:q}"


# The sums over many contacts, which take half as long as the rest and start after it.
use rule compile as compile_others with:
    output:
        touch(kernels_file("{method}.others")),
    log:
        "results/logs/compile/{method}.others.log",
    priority: 2


# A job solves its share of the missing curves, and appends them to the store every few seconds. The name of its
# marker is a digest of these curves; the job checks again what is missing. Ctrl-C reaches all programs of a job;
# `tee -i` ignores it and writes the last messages of the others.
rule solve:
    input:
        kernels=ancient(plan.kernels),
    output:
        temp(touch("results/curves/.solved/{what}/{numerics}/{missing}/{share}")),
    log:
        "results/logs/curves/{what}.{missing}.{numerics}.{share}.log",
    priority: 1
    conda:
        "rules/environment.yaml"
    resources:
        runtime=plan.minutes,
    params:
        run=command,
        scenes=scenes_of,
        seconds=plan.seconds,
    message:
        "solve {wildcards.what}, {wildcards.share}, in about {params.seconds} s"
    shell:
        "{params.run} weier curves {wildcards.what:q} {wildcards.share} {wildcards.numerics} results/curves"
        " {params.scenes:q} 2>&1 | tee -i {log:q}"


# A job makes its share of the products of a scene, since each process spends two seconds on imports. Its folder keeps
# them by a digest of what they are made of; the rules below copy them to their places. No rule makes a folder that
# exists.
rule make:
    input:
        plan.solved,
    output:
        directory("results/{scene}/.made_of/{share}.{stamps}"),
    log:
        "results/logs/{scene}/make/{share}.{stamps}.log",
    conda:
        "rules/environment.yaml"
    params:
        run=command,
        scene=lambda wildcards, output: scene_file(wildcards.scene),
        stamps=plan.stamps,
    message:
        "{wildcards.scene}: make the share {wildcards.share} of the products"
    shell:
        "{params.run} weier make {params.scene:q} results/curves {output:q} {params.stamps:q} 2>&1 | tee -i {log:q}"


rule data:
    input:
        made_of(DATA),
    output:
        "results/{scene}/contact.nc",
        report("results/{scene}/claims.md", category="{scene}", subcategory="claims"),
    log:
        "results/logs/{scene}/data.log",
    conda:
        "rules/environment.yaml"
    params:
        product=DATA,
        folder="results/{scene}",
    message:
        "{wildcards.scene}: {params.product}"
    shell:
        "test -d {input.folder:q}/{params.product} || {{ echo 'weier: {params.product} was not made, for the reason in"
        " results/logs/{wildcards.scene}/make'; exit 1; }};"
        " cp {input.folder:q}/{params.product}/*/* {params.folder} 2>&1 | tee {log:q}"


use rule data as figure with:
    input:
        made_of("{figure}"),
    output:
        report(
            "results/{scene}/figures/{figure}.png",
            category="{scene}",
            subcategory="figures",
            labels=lambda wildcards: {
                "figure": wildcards.figure,
                "caption": caption(plan.scene(wildcards.scene), wildcards.figure).text,
            },
        ),
        multiext("results/{scene}/figures/{figure}", ".pdf", ".svg", ".csv"),
    log:
        "results/logs/{scene}/figures/{figure}.log",
    params:
        product="{figure}",
        folder="results/{scene}/figures",


use rule data as page with:
    input:
        made_of(PAGE),
    output:
        report("results/{scene}/page.html", category="{scene}", subcategory="curves"),
    log:
        "results/logs/{scene}/page.log",
    params:
        product=PAGE,
