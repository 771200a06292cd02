"""config -> solve -> gather -> bounds -> figures -> claims. What a rule does stands in weier; when, stands here."""

import sys

sys.path.insert(0, str(workflow.basedir))  # the checkout, not an installed copy

from snakemake.utils import validate

from weier.data.files import bring_to_present, check_writable, remove_leftovers
from weier.kernels.sources import sources


configfile: "config/config.yaml"


validate(config, "config/config.schema.json")


wildcard_constraints:
    scene=r"[A-Za-z0-9_-]+",
    study=r"[A-Za-z0-9_-]+",
    figure=r"[A-Za-z0-9_-]+",
    batch=r"[A-Za-z0-9_+-]+",


include: "rules/scenes.smk"


onstart:
    check_writable("results")
    remove_leftovers("results")
    bring_to_present("results", "weier", "config")


rule all:
    input:
        [
            path
            for name in str(config["scenes"]).split(",")
            for path in products(name.strip())
        ],


# Once, so that no two jobs compile the same kernel side by side.
rule compile:
    input:
        sources("weier.methods.solve"),
    output:
        touch("results/.kernels"),
    log:
        "results/logs/compile.log",
    conda:
        "rules/environment.yaml"
    shell:
        "python -m weier compile 2>&1 | tee {log}"


rule solve:
    input:
        source=sources("weier.pipeline.batch"),
        kernels="results/.kernels",
    output:
        data="results/{scene}/batches/{batch}.nc",
        cost="results/{scene}/cost/{batch}.nc",
    log:
        "results/logs/{scene}/solve/{batch}.log",
    conda:
        "rules/environment.yaml"
    threads: 1
    params:
        digest=lambda w: scene(w.scene).digest(w.batch),
    shell:
        "python -m weier batch --threads {threads}"
        " config/scenes/{wildcards.scene}.yaml {wildcards.batch} {output} 2>&1 | tee {log}"


# From the folder of batches: the names of some thousands fit no command.
rule gather:
    input:
        source=sources("weier.pipeline.gather", "weier.data.dataset"),
        data=lambda w: expand(
            "results/{{scene}}/batches/{b}.nc", b=scene(w.scene).batches_of(w.study)
        ),
    output:
        temp("results/{scene}/gathered/{study}.nc"),
    log:
        "results/logs/{scene}/gather/{study}.log",
    conda:
        "rules/environment.yaml"
    params:
        text=lambda w: scene(w.scene).text,
    shell:
        "python -m weier gather config/scenes/{wildcards.scene}.yaml"
        " {wildcards.study} {output} results/{wildcards.scene}/batches 2>&1 | tee {log}"


rule bounds:
    input:
        source=sources("weier.pipeline.gather", "weier.data.dataset"),
        data="results/{scene}/gathered/{study}.nc",
    output:
        "results/{scene}/studies/{study}.nc",
    log:
        "results/logs/{scene}/bounds/{study}.log",
    conda:
        "rules/environment.yaml"
    shell:
        "python -m weier bounds {input.data} {output} 2>&1 | tee {log}"


rule figure:
    input:
        source=lambda w: sources(
            f"weier.figures.{scene(w.scene).figures[w.figure].draw}"
        ),
        data=studies(lambda w: scene(w.scene).figures[w.figure].studies),
    output:
        multiext("results/{scene}/figures/{figure}", pdf=".pdf", svg=".svg", png=".png"),
    log:
        "results/logs/{scene}/figure/{figure}.log",
    conda:
        "rules/environment.yaml"
    params:
        figure=lambda w: repr(scene(w.scene).figures[w.figure]),
    shell:
        "python -m weier figure config/scenes/{wildcards.scene}.yaml"
        " {wildcards.figure} {output.png} {input.data} 2>&1 | tee {log}"


rule claims:
    input:
        source=sources("weier.pipeline.claims", "weier.data.dataset"),
        data=studies(lambda w: scene(w.scene).studies),
    output:
        data="results/{scene}/contact.nc",
        table="results/{scene}/claims.md",
    log:
        "results/logs/{scene}/claims.log",
    conda:
        "rules/environment.yaml"
    params:
        text=lambda w: scene(w.scene).text,
    shell:
        "python -m weier claims config/scenes/{wildcards.scene}.yaml {output} {input.data} 2>&1 | tee {log}"


include: "rules/accuracy.smk"
include: "rules/docs.smk"
include: "rules/page.smk"
