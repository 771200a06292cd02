# Measurements of the methods, each with a page. The trade takes all cores, since other jobs would disturb the measured
# times.
rule tradeoff:
    input:
        configured("accuracy/tradeoff.yaml"),
    output:
        multiext("results/tradeoff/tradeoff", ".pdf", ".svg", ".png", ".csv"),
        page="results/tradeoff/tradeoff.md",
    log:
        "results/logs/tradeoff/measure.log",
    conda:
        "environment.yaml"
    threads: slots
    params:
        run=command,
        code=digest_of_modules("accuracy", "figures"),
        numerics=plan.numerics,
        study=lambda wildcards, output: Path(output.page).stem,
        scene=lambda wildcards, input: [f"--scene {path}" for path in input],
    shell:
        "OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 {params.run} weier.accuracy {params.study} {params.scene} "
        "> {output.page:q} 2> >(tee -i {log:q} >&2)"


use rule tradeoff as extremes with:
    input:
        [],
    output:
        page="results/extremes/extremes.md",
    log:
        "results/logs/extremes/measure.log",
    threads: 1


use rule tradeoff as convergence with:
    input:
        configured("accuracy/infinite.yaml"),
    output:
        page="results/convergence/convergence.md",
    log:
        "results/logs/convergence/measure.log",
    threads: 1


# The documentation, with the figures of the paper: snakemake --cores 2 docs
rule docs:
    input:
        figures=lambda wildcards: [
            f"results/paper/{file}"
            for figure in plan.scene("paper").figures
            for file in files_of(figure)
        ],
        index=str(CHECKOUT / "docs/index.rst"),
        pages=[str(path) for path in sorted(CHECKOUT.glob("docs/**/*.*"))],
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
