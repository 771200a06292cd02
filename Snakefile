"""config -> solve -> gather -> bounds -> figures -> claims. What a rule does stands in weier; when, stands here."""

from functools import cache
from pathlib import Path

from weier import scene as scenes
from weier.sources import sources


configfile: "config/config.yaml"


wildcard_constraints:
    scene=r"[A-Za-z0-9_-]+",
    study=r"[A-Za-z0-9_-]+",
    figure=r"[A-Za-z0-9_-]+",
    batch=r"[A-Za-z0-9_+-]+",


@cache
def scene(name):
    return scenes.load(f"config/scenes/{name}.yaml")


@cache
def batches_of(name, study):
    return scene(name).batches_of(study)


def products(name):
    figures = expand("results/{s}/figures/{f}.{e}", s=name, f=scene(name).figures, e=["pdf", "svg", "png"])
    return [f"results/{name}/contact.nc", f"results/{name}/claims.md", *figures]


rule all:
    input:
        [path for name in str(config["scenes"]).split(",") for path in products(name.strip())],


rule compile:
    input:
        sources("weier.solve"),
    output:
        touch("results/.kernels"),
    shell:
        "python -m weier compile"


rule solve:
    input:
        source=sources("weier.batch"),
        kernels="results/.kernels",
    output:
        data="results/{scene}/batches/{batch}.nc",
        cost="results/{scene}/cost/{batch}.nc",
    params:
        definition=lambda w: scene(w.scene).definition(w.batch),
    threads: 1
    shell:
        "NUMBA_NUM_THREADS={threads} python -m weier batch config/scenes/{wildcards.scene}.yaml {wildcards.batch} {output}"


rule gather:
    input:
        source=sources("weier.study", "weier.dataset"),
        data=lambda w: expand("results/{{scene}}/batches/{b}.nc", b=batches_of(w.scene, w.study)),
    output:
        temp("results/{scene}/gathered/{study}.nc"),
    params:
        keys=lambda w: [case.key for case in scene(w.scene).studies[w.study]],
    shell:
        "python -m weier gather config/scenes/{wildcards.scene}.yaml {wildcards.study} {output} {input.data}"


rule bounds:
    input:
        source=sources("weier.study", "weier.dataset"),
        data="results/{scene}/gathered/{study}.nc",
    output:
        "results/{scene}/studies/{study}.nc",
    shell:
        "python -m weier bounds {input.data} {output}"


rule figure:
    input:
        source=lambda w: sources(f"weier.figures.{scene(w.scene).figures[w.figure].draw}"),
        data=lambda w: expand("results/{{scene}}/studies/{s}.nc", s=scene(w.scene).figures[w.figure].studies),
    output:
        multiext("results/{scene}/figures/{figure}", ".pdf", ".svg", ".png"),
    params:
        figure=lambda w: repr(scene(w.scene).figures[w.figure]),
    shell:
        "python -m weier figure config/scenes/{wildcards.scene}.yaml {wildcards.figure} --output {output[0]} {input.data}"


rule claims:
    input:
        source=sources("weier.claims", "weier.dataset"),
        data=lambda w: expand("results/{{scene}}/studies/{s}.nc", s=scene(w.scene).studies),
    output:
        data="results/{scene}/contact.nc",
        table="results/{scene}/claims.md",
    params:
        claims=lambda w: dict(scene(w.scene).claims),
    shell:
        "python -m weier claims config/scenes/{wildcards.scene}.yaml {output} {input.data}"
