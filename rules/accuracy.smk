# Measurements of the methods, each with a page, and the documentation.
rule extremes:
    output:
        page="results/extremes/extremes.md",
    log:
        "results/logs/extremes/measure.log",
    conda:
        "environment.yaml"
    params:
        run=command,
        code=digest_of_modules("accuracy", "figures"),
        numerics=plan.numerics,
        study=lambda wildcards, output: Path(output.page).stem,
        scene=lambda wildcards, input: [f"--scene {path}" for path in input],
    shell:
        "{params.run} weier.accuracy {params.study} {params.scene} > {output.page:q} 2> >(tee -i {log:q} >&2)"


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
        multiext("results/tradeoff/tradeoff", ".pdf", ".svg", ".png", ".csv"),
        page="results/tradeoff/tradeoff.md",
    log:
        "results/logs/tradeoff/measure.log",
    threads: settings.cores or 1


# The documentation, with the figures of the paper: snakemake --cores 2 docs
rule docs:
    input:
        lambda wildcards: [
            f"results/paper/figures/{figure}.png"
            for figure in plan.scene("paper").figures
        ],
        [os.path.relpath(path) for path in sorted(CHECKOUT.glob("docs/**/*.*"))],
        index=configured("docs/index.rst"),
    output:
        "results/docs/index.html",
    log:
        "results/logs/docs.log",
    conda:
        "environment.yaml"
    params:
        run=command,
        code=digest_of_modules("cli", "api", "surface"),
    shell:
        "{params.run} sphinx --fail-on-warning --keep-going --quiet --fresh-env"
        ' -D scene_figures="$PWD/results/paper/figures" "$(dirname {input.index:q})" results/docs 2>&1 | tee -i {log:q}'
