# Measurements of the methods, each with a page.
rule extremes:
    output:
        page="results/extremes/extremes.md",
    log:
        "results/logs/extremes/measure.log",
    conda:
        "environment.yaml"
    params:
        run=command,
        code=[digest_of_modules("accuracy"), plan.numerics],
        scene=lambda wildcards, input: [f"--scene {path}" for path in input],
    shell:
        "{params.run} weier.accuracy $(basename {output.page:q} .md) {params.scene} > {output.page:q} 2> >(tee -i {log:q} >&2)"


use rule extremes as convergence with:
    input:
        configured("config/accuracy/infinite.yaml"),
    output:
        page="results/convergence/convergence.md",
    log:
        "results/logs/convergence/measure.log",


# This takes all cores, since other jobs would disturb the measured times.
use rule extremes as tradeoff with:
    input:
        configured("config/accuracy/tradeoff.yaml"),
    output:
        page="results/tradeoff/tradeoff.md",
    log:
        "results/logs/tradeoff/measure.log",
    threads: settings.cores or 1
