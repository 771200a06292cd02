"""config -> solve -> claims and figures. The rules call commands of weier and define their dependencies."""

import os
import sys
from pathlib import Path

VERSION = "0.1.0"  # of this workflow, and of the package that its jobs run
CHECKOUT = Path(workflow.current_basedir.get_path_or_uri(secret_free=True))
# The package beside this file goes first, here and in the jobs, from whatever folder they run. A workflow without one,
# as one that snakedeploy has fetched, runs the package that is installed.
if (CHECKOUT / "weier").is_dir():
    sys.path.insert(0, str(CHECKOUT))
    elsewhere = filter(None, [os.environ.get("PYTHONPATH")])
    os.environ.update(PYTHONPATH=os.pathsep.join([str(CHECKOUT), *elsewhere]))

from weier.data.provenance import VERSION as INSTALLED

if INSTALLED != VERSION:
    raise SystemExit(
        f"weier: this workflow needs weier {VERSION}, got {INSTALLED} of {sys.modules['weier'].__path__[0]}: "
        f"pip install 'weier[pipeline]=={VERSION}'"
    )

# The scenes of the folder where Snakemake runs, if it has any, else those of the checkout.
CHECKOUT = Path(os.path.relpath(CHECKOUT))
CONFIG = Path("config") if Path("config/scenes").is_dir() else CHECKOUT / "config"

# A file of the configuration is in the folder where Snakemake runs, or else in the checkout.
configured = lambda path: str(
    (CONFIG if (CONFIG / path).exists() else CHECKOUT / "config") / path
)


configfile: configured("config.yaml")


include: "rules/common.smk"
include: "rules/compile.smk"
include: "rules/accuracy.smk"
include: "rules/docs.smk"


wildcard_constraints:
    scene=r"[A-Za-z0-9_-]+",
    figure=r"[A-Za-z0-9_-]+",
    batch=r"[a-z_]+-[0-9a-f]{8}-[0-9a-f]{12}",
    method=r"[a-z_]+",


localrules:
    all,


# Ctrl-C reaches all programs of a job; `tee -i` ignores it and writes the last messages of the others.
# A job solves batches that need the same kernels. Its last batch stands for all of them, as long as it is there.
# The name of a batch is a digest of all that its curves depend on, and products carry the digest of what they were made
# of. So dates make nothing out of date: inputs are ancient. Of products, one input has the date: it is newer than a
# product that was made of something else.
rule solve:
    input:
        kernels=ancient(scenes.kernels),
    output:
        "results/curves/{batch}.nc",
    log:
        "results/logs/curves/{batch}.log",
    benchmark:
        "results/logs/curves/{batch}.tsv"
    conda:
        environment
    resources:
        mem_mb=scenes.batch_memory,
        runtime=scenes.batch_minutes,
    params:
        description=scenes.description,
        label=scenes.batch_label,
    message:
        "solve {params.label}"
    shell:
        "python -m weier batch {params.description:q} {output:q} 2>&1 | tee -i {log:q}"


# What takes longest goes first, so that no core waits for it at the end.
use rule solve as solve_by_patches with:
    output:
        "results/curves/{batch,patches-.+}.nc",
    priority: 2


use rule solve as solve_by_bem with:
    output:
        "results/curves/{batch,bem-.+}.nc",
    priority: 1


ruleorder: solve_by_patches > solve_by_bem > solve


# One command for all rules of products: where the code of rules triggers, as it does without these profiles, Snakemake
# would make again what another rule has made.
MAKE = "python -m weier products {params.scene:q} results/curves {output:q} 2>&1 | tee -i {log:q}"


# The data, with the claims, or a figure that the command line names: by itself, from its own curves.
rule data:
    input:
        settled=ancient(of_wildcards(scenes.settled_batches)),
        unsettled=of_wildcards(scenes.unsettled_batches),
        outdated=of_wildcards(scenes.outdated),
    output:
        data=update("results/{scene}/contact.nc"),
        table=in_report("results/{scene}/claims.md"),
    log:
        "results/logs/{scene}/data.log",
    benchmark:
        "results/logs/{scene}/data.tsv"
    conda:
        environment
    resources:
        mem_mb=scenes.memory,
        runtime=scenes.minutes,
    params:
        scene=scenes.scene_file,
    message:
        "{wildcards.scene}: make the data and the claims"
    shell:
        MAKE


use rule data as figure with:
    output:
        pdf="results/{scene}/figures/{figure}.pdf",
        svg="results/{scene}/figures/{figure}.svg",
        png=in_report("results/{scene}/figures/{figure}.png"),
        csv="results/{scene}/figures/{figure}.csv",
    log:
        "results/logs/{scene}/figure/{figure}.log",
    benchmark:
        "results/logs/{scene}/figure/{figure}.tsv"
    message:
        "{wildcards.scene}: draw {wildcards.figure}"


# Two jobs of a scene make all others, those alone that are missing or outdated: each starts and reads the scene once.
# Their rules have no wildcards, since outputs have the names of figures, so that they go first.
for name in SCENES:
    for maker, made in scenes.makers(name).items():
        made = [each for each in made if not is_named(name, each)]

        rule:
            name:
                maker
            input:
                settled=ancient(of_scene(scenes.settled_batches, name, made)),
                unsettled=of_scene(scenes.unsettled_batches, name, made),
                outdated=of_scene(scenes.outdated, name, made),
            output:
                # else Snakemake removes those that are fresh
                [update(in_report(path)) for path in scenes.files(name, made)],
            log:
                f"results/logs/{name}/{maker}.log",
            benchmark:
                f"results/logs/{name}/{maker}.tsv"
            conda:
                environment
            resources:
                mem_mb=of_attempts(scenes.memory, name),
                runtime=of_attempts(scenes.minutes, name),
            params:
                scene=of_output(scenes.scene_file, name),
            message:
                f"{name}: make those of {', '.join(made)} that are missing or outdated"
            shell:
                MAKE


rule all:
    default_target: True
    input:
        scenes.products,
    message:
        f"everything of {', '.join(SCENES)}"
