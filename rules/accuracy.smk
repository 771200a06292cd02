# Measurements of the methods, each with a page:
# snakemake --cores 2 tradeoff, convergence or extremes
SETTINGS = {
    "tradeoff": ["accuracy/tradeoff.yaml"],
    "convergence": ["accuracy/infinite.yaml"],
    "extremes": [],
}


rule tradeoff:
    input:
        "results/tradeoff/tradeoff.md",


rule convergence:
    input:
        "results/convergence/convergence.md",


rule extremes:
    input:
        "results/extremes/extremes.md",


# The trade takes all cores, since other jobs would disturb the measured times.
rule measure:
    input:
        settings=lambda wildcards: map(configured, SETTINGS[wildcards.study]),
    output:
        page="results/{study}/{study}.md",
    log:
        "results/logs/{study}/measure.log",
    wildcard_constraints:
        study="|".join(SETTINGS),
    conda:
        "environment.yaml"
    threads: lambda wildcards: slots() if wildcards.study == "tradeoff" else 1
    params:
        run=command,
        code=digest_of_modules("accuracy"),
        numerics=plan.numerics,
        scene=lambda wildcards, input: [f"--scene {path}" for path in input.settings],
    shell:
        "OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 {params.run}.accuracy {wildcards.study} {params.scene} "
        "--output {output.page:q} 2>&1 | tee -i {log:q}"


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
        code=digest_of_modules("cli", "api", "surface"),
    shell:
        "sphinx-build --fail-on-warning --keep-going --quiet --fresh-env"
        ' -D scene_figures="$PWD/results/paper/figures" "$(dirname {input.index:q})" results/docs 2>&1 | tee -i {log:q}'
