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
include: "rules/page.smk"


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
        "rules/environment.yaml"
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


rule claims:
    input:
        settled=ancient(scenes.settled_batches),
        unsettled=scenes.unsettled_batches,
        outdated=scenes.outdated_data,
    output:
        data=update("results/{scene}/contact.nc"),  # else Snakemake removes it first
        table=report(
            "results/{scene}/claims.md",
            caption="rules/captions/claims.rst",
            category="{scene}",
            subcategory="claims",
        ),
    log:
        "results/logs/{scene}/claims.log",
    benchmark:
        "results/logs/{scene}/claims.tsv"
    conda:
        "rules/environment.yaml"
    resources:
        mem_mb=scenes.memory,
        runtime=scenes.minutes,
    params:
        scene=scenes.scene_file,
    message:
        "{wildcards.scene}: gather all curves and check the claims"
    shell:
        "python -m weier claims {params.scene:q} results/curves {output:q} 2>&1 | tee -i {log:q}"


rule figure:
    input:
        settled=ancient(scenes.settled_batches),
        unsettled=scenes.unsettled_batches,
        outdated=scenes.outdated_figure,
    output:
        pdf="results/{scene}/figures/{figure}.pdf",
        svg="results/{scene}/figures/{figure}.svg",
        csv="results/{scene}/figures/{figure}.csv",
        png=report(
            "results/{scene}/figures/{figure}.png",
            category="{scene}",
            subcategory="figures",
            labels=labels_of_figure,
        ),
    log:
        "results/logs/{scene}/figure/{figure}.log",
    benchmark:
        "results/logs/{scene}/figure/{figure}.tsv"
    conda:
        "rules/environment.yaml"
    resources:
        mem_mb=scenes.memory,
        runtime=scenes.minutes,
    params:
        scene=scenes.scene_file,
    message:
        "{wildcards.scene}: draw {wildcards.figure}"
    shell:
        "python -m weier figures {params.scene:q} results/curves"
        " results/{wildcards.scene}/figures {wildcards.figure:q} 2>&1 | tee -i {log:q}"


# One process draws the figures of a scene, or two draw many, the smaller part after the claims. Figures that are not
# outdated stay. Without wildcards, these rules go before `figure`, which draws those that the command line names.
for name in [] if figures_are_named() else SCENES:
    for place, (drawing, figures) in enumerate(scenes.drawing_rules(name).items()):

        rule:
            name:
                drawing
            input:
                settled=ancient(
                    scenes.of_figures(name, figures, scenes.settled_batches)
                ),
                unsettled=scenes.of_figures(name, figures, scenes.unsettled_batches),
                outdated=scenes.of_figures(name, figures, scenes.outdated_figure),
            output:
                [
                    update(path)
                    for figure in figures
                    for path in scenes.files_of_figure(name, figure)
                    if not path.endswith(".png")
                ],
                [update(in_report(name, figure)) for figure in figures],
            log:
                f"results/logs/{name}/{drawing}.log",
            benchmark:
                f"results/logs/{name}/{drawing}.tsv"
            priority: -place
            conda:
                "rules/environment.yaml"
            resources:
                mem_mb=lambda wildcards, attempt, scene=SimpleNamespace(
                    scene=name
                ): scenes.memory(scene, attempt),
                runtime=lambda wildcards, attempt, scene=SimpleNamespace(
                    scene=name
                ): scenes.minutes(scene, attempt),
            params:
                scene=scenes.scene_file(SimpleNamespace(scene=name)),
                figures=figures,
            message:
                f"{name}: draw those of {', '.join(figures)} that are missing or outdated"
            shell:
                f"python -m weier figures {{params.scene:q}} results/curves results/{name}/figures {{params.figures:q}}"
                " 2>&1 | tee -i {log:q}"


rule all:
    default_target: True
    input:
        scenes.products,
    message:
        f"everything of {', '.join(SCENES)}"
