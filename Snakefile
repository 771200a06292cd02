"""config -> solve -> claims and figures. What a rule does stands in weier; when it runs, stands here."""

import atexit
import gc
import os
import sys
import threading
from pathlib import Path

# Else Snakemake looks for garbage when it ends, which takes a third of a second.
atexit.register(gc.freeze)

# Ctrl-C ends a run in one line; of its own, Snakemake adds a traceback until the jobs begin.
sys.excepthook = lambda kind, error, trace: (
    print("weier: stopped by Ctrl-C", file=sys.stderr)
    if issubclass(kind, KeyboardInterrupt)
    else sys.__excepthook__(kind, error, trace)
)

# The checkout, not an installed copy, here and in the jobs, from whatever folder Snakemake runs and in other workflows.
CHECKOUT = Path(workflow.current_basedir)
sys.path.insert(0, str(CHECKOUT))
ELSEWHERE = filter(None, [os.environ.get("PYTHONPATH")])
os.environ.update(PYTHONPATH=os.pathsep.join([str(CHECKOUT), *ELSEWHERE]))
# Scenes of the folder where Snakemake runs, if it has any, else those of the checkout.
CONFIG = Path("config" if Path("config/scenes").is_dir() else CHECKOUT / "config")

from snakemake.utils import validate

from weier.data.files import bring_to_present, check_writable, remove_leftovers
from weier.digests import digest_of_program


configfile:
    str(
        (CONFIG if (CONFIG / "config.yaml").exists() else CHECKOUT / "config")
        / "config.yaml"
    )


validate(config, "config/config.schema.json")


wildcard_constraints:
    scene=r"[A-Za-z0-9_-]+",
    figure=r"[A-Za-z0-9_-]+",
    batch=r"[A-Za-z0-9_-]+",
    method=r"[a-z]+",


include: "rules/scenes.smk"


with in_one_sentence():
    check_writable("results")


onstart:
    remove_leftovers("results")
    bring_to_present("results", str(CONFIG))
    for name in scene_names():
        if refusal := forecast(name)[1]:
            sys.exit(f"weier: {refusal}")


onsuccess:
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.cancel()  # which looks for further jobs in a second, and Snakemake waits for it
    for name in scene_names():
        solutions(name).tidy()
        page = Path(f"results/{name}/page.html")
        if not Path(
            f"results/{name}/contact.nc"
        ).exists():  # figures or pages of docs alone
            continue
        made = (
            f", {page} shows them"
            if page.exists()
            else f", `snakemake --cores 2 pages --config scenes={name}` makes a page of them"
        )
        print(
            f"{name}: the curves are in results/{name}/contact.nc{made}",
            file=sys.stderr,
        )


# Ctrl-C reaches all programs of a job, and `tee -i` stays to write what the others say of it.
# The name of a batch is a digest of all that its numbers depend on, so that it never changes; to compile again is no
# reason to solve it again.
rule solve:
    input:
        batch=ancient("results/{scene}/batches/{batch}.json"),
        kernels=lambda w: kernels(w.scene),
    output:
        "results/{scene}/batches/{batch}.nc",
    log:
        "results/logs/{scene}/solve/{batch}.log",
    conda:
        "rules/environment.yaml"
    params:
        title=lambda w: batch(w.scene, w.batch).title,
        seconds=lambda w: max(1, round(batch(w.scene, w.batch).seconds)),
    message:
        "{wildcards.scene}: solve {params.title}, in about {params.seconds} s"
    shell:
        "python -m weier batch {input.batch:q} {output:q} 2>&1 | tee -i {log:q}"


# All figures of a scene in one job, since most of it is to start; one that is asked for by its name is drawn alone.
for name in drawn_together():

    rule:
        name:
            f"figures_{name}"
        input:
            data=lambda w, name=name: batches(name),
        output:
            figures=drawn(name),
        log:
            f"results/logs/{name}/figures.log",
        conda:
            "rules/environment.yaml"
        params:
            scene=scene_file(name),
            folder=lambda w, name=name: f"results/{name}",
            figures=lambda w, name=name: repr(scene(name).figures),
            cases=lambda w, name=name: scene(name).digest_of_cases(*scene(name).studies),
            program=digest_of_program(*PICTURES),
        message:
            f"{name}: draw all figures"
        shell:
            "python -m weier figures {params.scene:q} {params.folder}/batches {params.folder}/figures 2>&1 | tee -i {log:q}"

    workflow.ruleorder("figure", f"figures_{name}")


rule all:
    default_target: True
    input:
        [path for name in scene_names() for path in products(name)],
    message:
        f"everything of {', '.join(scene_names())}"


rule figure:
    input:
        data=lambda w: batches(w.scene, scene(w.scene).figures[w.figure].studies),
    output:
        [f"results/{{scene}}/figures/{{figure}}.{suffix}" for suffix in SUFFIXES],
    log:
        "results/logs/{scene}/figure/{figure}.log",
    conda:
        "rules/environment.yaml"
    params:
        scene=lambda w: scene_file(w.scene),
        figure=lambda w: repr(scene(w.scene).figures[w.figure]),
        cases=lambda w: scene(w.scene).digest_of_cases(
            *scene(w.scene).figures[w.figure].studies
        ),
        program=digest_of_program(*PICTURES),
    message:
        "{wildcards.scene}: draw {wildcards.figure}"
    shell:
        "python -m weier figures {params.scene:q} results/{wildcards.scene}/batches"
        " results/{wildcards.scene}/figures {wildcards.figure:q} 2>&1 | tee -i {log:q}"


rule claims:
    input:
        data=lambda w: batches(w.scene),
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
        program=digest_of_program(*TABLES),
    message:
        "{wildcards.scene}: gather all curves and check the claims"
    shell:
        "python -m weier claims {params.scene:q} results/{wildcards.scene}/batches {output:q} 2>&1 | tee -i {log:q}"


# A job for each method, so that they are compiled side by side, before any batch waits for them.
rule compile:
    output:
        touch(compiled("{method}")),
    log:
        "results/logs/compile/{method}.log",
    conda:
        "rules/environment.yaml"
    message:
        "compile {wildcards.method}, once for all later runs"
    shell:
        "python -m weier compile {wildcards.method:q} 2>&1 | tee -i {log:q}"


include: "rules/accuracy.smk"
include: "rules/docs.smk"
include: "rules/page.smk"
