"""config -> solve -> claims and figures. The rules call commands of weier and define their dependencies."""

import os
from pathlib import Path

from snakemake.utils import validate

from weier.digests import PACKAGE, digest_of_sources

# Snakemake imports weier from the folder of this file, and so do the jobs, from whatever folder they run.
ELSEWHERE = filter(None, [os.environ.get("PYTHONPATH")])
os.environ.update(PYTHONPATH=os.pathsep.join([str(PACKAGE.parent), *ELSEWHERE]))
CHECKOUT = Path(os.path.relpath(PACKAGE.parent))
# The scenes of the folder where Snakemake runs, if it has any, else those of the checkout.
CONFIG = Path("config") if Path("config/scenes").is_dir() else CHECKOUT / "config"


configfile:
    str(
        (CONFIG if (CONFIG / "config.yaml").exists() else CHECKOUT / "config")
        / "config.yaml"
    )


validate(config, "config/config.schema.json")


include: "rules/common.smk"
include: "rules/compile.smk"
include: "rules/accuracy.smk"
include: "rules/docs.smk"
include: "rules/page.smk"


wildcard_constraints:
    scene=r"[A-Za-z0-9_-]+",
    figure=r"[A-Za-z0-9_-]+",
    batch=r"[A-Za-z0-9_-]+",
    method=r"[a-z]+",


onstart:
    scenes.begin()


onsuccess:
    scenes.finish()


# Ctrl-C reaches all programs of a job; `tee -i` ignores it and writes the last messages of the others.
# The name of a batch is a digest of all its dependencies, so that it never changes, and compiling again does not make it
# out of date.
rule solve:
    input:
        batch=ancient("results/{scene}/batches/{batch}.json"),
        kernels=ancient(scenes.kernels),
    output:
        "results/{scene}/batches/{batch}.nc",
    log:
        "results/logs/{scene}/solve/{batch}.log",
    conda:
        "rules/environment.yaml"
    params:
        label=scenes.batch_label,
    message:
        "{wildcards.scene}: solve {params.label}"
    shell:
        "python -m weier batch {input.batch:q} {output:q} 2>&1 | tee -i {log:q}"


rule claims:
    input:
        scenes.batches,
    output:
        data="results/{scene}/contact.nc",
        table=report(
            "results/{scene}/claims.md",
            caption="rules/captions/claims.rst",
            category="{scene}",
            subcategory="claims",
        ),
    log:
        "results/logs/{scene}/claims.log",
    conda:
        "rules/environment.yaml"
    params:
        scene=scenes.scene_file,
        depends_on=scenes.claims_digest,
    message:
        "{wildcards.scene}: gather all curves and check the claims"
    shell:
        "python -m weier claims {params.scene:q} results/{wildcards.scene}/batches {output:q} 2>&1 | tee -i {log:q}"


rule figure:
    input:
        scenes.batches_of_figure,
    output:
        pdf="results/{scene}/figures/{figure}.pdf",
        svg="results/{scene}/figures/{figure}.svg",
        png=report(
            "results/{scene}/figures/{figure}.png",
            category="{scene}",
            subcategory="figures",
            labels=labels_of_figure,
        ),
    log:
        "results/logs/{scene}/figure/{figure}.log",
    conda:
        "rules/environment.yaml"
    params:
        scene=scenes.scene_file,
        depends_on=scenes.figure_digest,
    message:
        "{wildcards.scene}: draw {wildcards.figure}"
    shell:
        "python -m weier figures {params.scene:q} results/{wildcards.scene}/batches"
        " results/{wildcards.scene}/figures {wildcards.figure:q} 2>&1 | tee -i {log:q}"


rule all:
    default_target: True
    input:
        scenes.products,
    message:
        f"everything of {', '.join(SCENES)}"
