"""config -> solve -> claims and figures. What a rule does stands in weier; when it runs, stands here."""

import atexit
import os
import sys
from pathlib import Path

# The checkout, not an installed copy, here and in the jobs, from whatever folder Snakemake runs and in other workflows.
CHECKOUT = Path(workflow.current_basedir)
sys.path.insert(0, str(CHECKOUT))
ELSEWHERE = filter(None, [os.environ.get("PYTHONPATH")])
os.environ.update(PYTHONPATH=os.pathsep.join([str(CHECKOUT), *ELSEWHERE]))
# Scenes of the folder where Snakemake runs, if it has any, else those of the checkout.
CONFIG = Path("config" if Path("config/scenes").is_dir() else CHECKOUT / "config")

from snakemake.utils import validate

from weier.data.files import bring_to_present, check_writable, remove_leftovers
from weier.kernels.jit import cache_folder
from weier.pipeline import server
from weier.pipeline.dependencies import batch_digest, claims_digest, figure_digest


configfile: str(CONFIG / "config.yaml")


validate(config, "config/config.schema.json")


wildcard_constraints:
    scene=r"[A-Za-z0-9_-]+",
    figure=r"[A-Za-z0-9_-]+",
    batch=r"[A-Za-z0-9_+-]+",


include: "rules/scenes.smk"


onstart:
    check_writable("results")
    remove_leftovers("results")
    bring_to_present("results", str(CONFIG))
    atexit.register(server.start())  # whose end is waited for


rule all:
    input:
        [path for name in scene_names() for path in products(name)],


# Ctrl-C reaches all programs of a job, and `tee -i` stays to write what the others say of it.
# A job runs again when what it depends on has changed, in the program or in the scene: digests tell. A batch
# finds compiled kernels or compiles them itself: as an input, they would make all batches depend on all methods.
rule solve:
    output:
        data="results/{scene}/batches/{batch}.nc",
        cost="results/{scene}/cost/{batch}.nc",
    log:
        "results/logs/{scene}/solve/{batch}.log",
    conda:
        "rules/environment.yaml"
    threads: 1
    params:
        scene=lambda w: scene_file(w.scene),
        digest=lambda w: scene(w.scene).digest(w.batch),
        program=lambda w: batch_digest(scene(w.scene).methods_of(w.batch)),
    shell:
        "python -m weier batch --threads {threads}"
        " {params.scene} {wildcards.batch} {output} 2>&1 | tee -i {log}"


rule figure:
    input:
        data=batches(lambda w: scene(w.scene).figures[w.figure].studies),
    output:
        pdf="results/{scene}/figures/{figure}.pdf",
        svg="results/{scene}/figures/{figure}.svg",
        png=report(
            "results/{scene}/figures/{figure}.png",
            caption="rules/captions/figure.rst",
            category="{scene}",
            subcategory="figures",
        ),
    log:
        "results/logs/{scene}/figure/{figure}.log",
    conda:
        "rules/environment.yaml"
    params:
        scene=lambda w: scene_file(w.scene),
        figure=lambda w: repr(scene(w.scene).figures[w.figure]),
        caption=lambda w: caption_as_rst(w.scene, w.figure),
        cases=lambda w: scene(w.scene).digest_of_cases(
            *scene(w.scene).figures[w.figure].studies
        ),
        program=lambda w: figure_digest(scene(w.scene).figures[w.figure].draw),
    shell:
        "python -m weier figure {params.scene}"
        " {wildcards.figure} {output.png} results/{wildcards.scene}/batches 2>&1 | tee -i {log}"


rule claims:
    input:
        data=batches(lambda w: scene(w.scene).studies),
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
        scene=lambda w: scene_file(w.scene),
        text=lambda w: scene(w.scene).text,
        program=lambda w: claims_digest(),
    shell:
        "python -m weier claims {params.scene} {output.data} {output.table}"
        " results/{wildcards.scene}/batches 2>&1 | tee -i {log}"


# For the rules that measure seconds, so that none of them are spent on compiling.
rule compile:
    output:
        touch("results/.kernels"),
    log:
        "results/logs/compile.log",
    conda:
        "rules/environment.yaml"
    params:
        kernels=lambda w: cache_folder().name,  # a digest of their sources
    shell:
        "python -m weier compile 2>&1 | tee -i {log}"


include: "rules/accuracy.smk"
include: "rules/docs.smk"
include: "rules/page.smk"
